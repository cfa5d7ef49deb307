// What an operation did: the movement of each segment in a surgeon's words, how well surfaces fit, and the plan that it is.
import type { Case, CaseDocument, Documents, Triple } from "../api.js";
import { rowChart } from "../charts.js";
import type { App } from "../app.js";
import { tail } from "./called.js";
import { card, make, select, table } from "../dom.js";
import { fixed, mm, signed } from "../figures.js";
import { angles, inWords, motion, type FrameName } from "../frame.js";
import { noInner, written, type Pivots, type Plan } from "../plan.js";
import { address } from "../route.js";

type Reproduction = Documents["ReproductionDocument"];

export async function performedFacts(app: App, { base, segments }: Reproduction, frame: FrameName): Promise<HTMLElement[]> {
  const { words } = app;
  const axes = frame === "unspecified" ? [words.axes.forward, words.axes.up, words.axes.left] : [words.forward, words.up, words.left];
  const moved = (vector: number[]) => inWords(vector as Triple, frame);
  const bars = segments.flatMap(({ name, displacement_mm, rotation_deg }) => [
    ...moved(displacement_mm).map((value, at) => ({ name: `${name}: ${axes[at]!}`, value })), { name: `${name}: ${words.turnedBy}, °`, value: rotation_deg }]);
  const rows = segments.map(({ name, displacement_mm, rotation_deg }) => [name, ...moved(displacement_mm).map(signed), `${mm(rotation_deg)}°`]);
  const beyond = segments.filter(({ from_planned }) => from_planned !== undefined && from_planned !== null)
    .map(({ name, from_planned }) => [name, ...moved(from_planned!.displacement_mm).map(signed), `${mm(from_planned!.rotation_deg)}°`]);
  const fits = [{ name: words.unmovedBone, fit: base.fit }, ...segments].map(({ name, fit }) =>
    [name, mm(fit.rms_mm), `${fixed(100 * fit.share_above_1_mm, 1)} %`, `${fit.pairs} / ${fit.points}`]);
  const head = ["", ...axes, words.turnedBy];
  return [
    card(words.performed, rowChart(words.performed, "mm, °", bars), table(`${words.performed}, mm`, head, rows), beyond.length > 0 && table(`${words.beyondPlan}, mm`, head, beyond), await asPlan(app, segments, frame)),
    card(words.fits, table(words.fits, ["", `${words.residual} mm`, "> 1 mm", words.pairs], fits), make("p", { className: "fine" }, words.fitsHint)),
  ];
}

/** The movements as a plan of six numbers about the middle of each segment. */
function planOf(segments: Reproduction["segments"], frame: FrameName): [Plan, Pivots] {
  const moved = segments.map(({ name, displacement_mm, matrix4x4 }) =>
    [name, motion(displacement_mm as Triple, angles(matrix4x4), frame)] as const);
  const pivots = Object.fromEntries(segments.map(({ name, centre_mm }) => [name, centre_mm as Triple]));
  return [{ segments: Object.fromEntries(moved), inner: noInner() }, pivots];
}

/** Opens the plan on a case that has the same frame and segments, since bone before the operation names none. */
async function asPlan({ service, words }: App, segments: Reproduction["segments"], frame: FrameName): Promise<HTMLElement | undefined> {
  const stored = (await service.list<Case>("/v1/cases")).filter(({ state }) => state === "ready").map((one) => ({ id: one.id, document: one.case as CaseDocument }));
  const fits = stored.filter(({ document }) => (document.frame ?? "unspecified") === frame
    && segments.every(({ name }) => (document.segments ?? []).some((segment) => segment.name === name)));
  if (fits.length === 0) return stored.length === 0 ? undefined : make("p", { className: "fine" }, words.noCaseFits);
  const link = make("a", { className: "button primary" }, words.openPlan);
  const choose = (id: string) => { link.href = address(["case", id, "plan"], written(...planOf(segments, frame))); };
  const options = fits.map(({ id, document }) => [id, document.name ?? tail(id)] as const);
  choose(options[0]![0]);
  return make("div", { className: "row" }, select(words.onCase, options, options[0]![0], choose), link);
}
