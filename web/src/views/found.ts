// What inverse planning found, with what is uncertain about it.
import type { CaseDocument, Documents, Job, Triple, Warning } from "../api.js";
import { rowChart, type Row } from "../charts.js";
import { refusal, type App } from "../app.js";
import { button, make, table } from "../dom.js";
import { wordOf, type FrameName } from "../frame.js";
import type { Opened } from "../loading.js";
import { fromDocument, pivotsOf, written, type Pivots, type Plan } from "../plan.js";
import { address } from "../route.js";
import { figure, fixed, mm } from "../figures.js";
import { closest, TISSUE, TISSUE_SCALES } from "../tissue.js";
import { called } from "./inner.js";
import { wayFor, wordFor } from "./movements.js";
import type { TrustLine } from "./trust.js";
import type { Words } from "../words/en.js";

type Found = Documents["OptimisationDocument"];
type Parameter = { segment?: string; region?: string; name: string; value: number };

/** What a target is called, and the standard deviation of its components in mm. */
export interface NamedTarget {
  label: string;
  sigma_mm: number;
}
const TAG = /^target (\d+): (.+), sigma ([\d.e+-]+) mm$/;
/** A target is missed where more than so many standard deviations of it are left. */
const MISSED = 2;

/** Targets as they stand in the tags of the job, which keeps their names: results have numbers only. */
export const targetTags = (targets: NamedTarget[]): string[] => targets.map(({ label, sigma_mm }, at) => `target ${at + 1}: ${label}, sigma ${sigma_mm} mm`);

/** What targets are called; those of jobs that another client posted have numbers and the usual deviation of 1 mm. */
export function targetsOf(words: Words, tags: string[], count: number): NamedTarget[] {
  const stated = tags.map((tag) => TAG.exec(tag)).filter((match) => match !== null);
  return Array.from({ length: count }, (_, at) => {
    const [, , label = `${words.target} ${at + 1}`, sigma = "1"] = stated.find(([, number]) => Number(number) === at + 1) ?? [];
    return { label, sigma_mm: Number(sigma) };
  });
}

/** A parameter with the word, the sign and the unit of its slider, or of tissue; `part` is its unit in a combination. */
function inWords(words: Words, frame: FrameName, { segment, region, name, value }: Parameter): { label: string; value: number; digits: number; part: string } {
  const tissue = TISSUE.find((one) => one === name);
  if (tissue !== undefined) {
    const { factor, unit, digits, part } = TISSUE_SCALES[tissue];
    const label = `${called(region!, words)}: ${words.tissueNumbers[tissue]}`;
    return { label: unit === "" ? label : `${label}, ${unit}`, value: factor * value, digits, part: `${label}, ${part}` };
  }
  const { word, sign } = wordOf(name, frame);
  const label = `${segment} ${wordFor(words, word, frame)}, ${name.startsWith("rotation") ? "°" : "mm"}`;
  return { label, value: sign * value || 0, digits: 2, part: label };
}

/** The same within a sentence: a movement by the way that it goes, without a sign. */
function byWay(words: Words, frame: FrameName, parameter: Parameter): { label: string; value: number; digits: number } {
  const told = inWords(words, frame, parameter);
  if (TISSUE.some((one) => one === parameter.name)) return told;
  const { way, far } = wayFor(words, wordOf(parameter.name, frame).word, told.value, frame);
  return { label: `${parameter.segment} ${way}, ${parameter.name.startsWith("rotation") ? "°" : "mm"}`, value: far, digits: told.digits };
}

/** A parameter that is stopped where there was room to move. */
const stoppedOf = ({ at_bound }: Found) => at_bound.filter(({ value }) => value !== 0);

/** Warnings of growth and constants that were looked for. */
const OF_TISSUE = ["constant-at-end", "constant-not-determined", "growth-left-out"];

/** How near the plan comes to its targets; to be heeded where one is missed, a movement is stopped by its bound, or what was found of
 * tissue is warned of. */
export function foundLine(words: Words, found: Found, named: NamedTarget[], frame: FrameName, warnings: Warning[] = []): TrustLine {
  const missed = found.targets.flatMap(({ residual_mm }, at) => (residual_mm > MISSED * named[at]!.sigma_mm ? [words.missedBy(named[at]!.label, mm(residual_mm))] : []));
  const stopped = stoppedOf(found).map((one) => { const { label, value, digits } = byWay(words, frame, one); return words.stoppedAt(label, digits === 2 ? mm(value) : figure(value, digits)); });
  const told = warnings.filter(({ code }) => OF_TISSUE.includes(code)).map(({ detail }) => detail);
  const most = Math.max(0, ...found.targets.map(({ residual_mm }) => residual_mm));
  const why = [words.missedRule(MISSED), ...missed, ...stopped, ...told].join(" ");
  return { name: words.targets, value: words.leftAtMost(mm(most)), trusted: missed.length + stopped.length + told.length > 0 ? "heed" : "good", why };
}

/** The document with the constants that were found over its own, field by field. */
export function withFound(document: CaseDocument, found: NonNullable<Found["materials"]>): CaseDocument {
  const stated = document.materials ?? {};
  const changed = Object.entries(found).map(([region, constants]) => [region, { ...(stated[region] ?? stated["*"]), ...constants }] as const);
  return { ...document, materials: { ...stated, ...Object.fromEntries(changed) } } as CaseDocument;
}

/** A case of its own with the constants that were found: this one stays as it is. */
function asCase({ words, service }: App, opened: Opened, materials: NonNullable<Found["materials"]>): HTMLElement {
  const said = make("div", { role: "status" });
  const document = { ...withFound(opened.document, materials), name: `${opened.name} · ${words.foundConstants}` };
  const made = button(words.caseWithFound, () => {
    service.post<{ id: string }>("/v1/cases", document)
      .then(({ id }) => { location.hash = address(["case", id]); }, (error: unknown) => said.replaceChildren(refusal(error, words)));
  });
  return make("div", {}, made, said);
}

/** A plan of the service as sliders have it, about the points that it names; undefined where six numbers of each segment do not say it. */
export function planOf({ document, frame }: Opened, stored: Documents["PlanDocument"]): { plan: Plan | undefined; pivots: Pivots } {
  const names = (document.segments ?? []).map(({ name }) => name);
  const pivots = { ...Object.fromEntries(names.map((name) => [name, [0, 0, 0] as Triple])), ...pivotsOf(stored, frame) };
  return { plan: fromDocument(stored, pivots, frame), pivots };
}

export function foundFacts(app: App, job: Job, opened: Opened, found: Found): HTMLElement {
  const { words } = app;
  const { plan, pivots } = planOf(opened, found.plan);
  const frame = job.results?.provenance?.frame ?? opened.frame;
  const error = (of: Parameter, at: number) => Math.abs(inWords(words, frame, { ...of, value: found.standard_error[at]! }).value);
  const all = found.parameters.map((of, at) => ({ ...inWords(words, frame, of), at, of, error: error(of, at) }));
  const free = all.filter(({ of }) => of.region === undefined).map(({ label, value, error }) => ({ label, value, error }));
  const stopped = stoppedOf(found).filter(({ region }) => region === undefined).map((one) => inWords(words, frame, one));
  const numbers = [...free.map(({ label, value, error }) => [label, mm(value), mm(error)]), ...stopped.map(({ label, value }) => [label, mm(value), words.atBound])];
  // At a bound as well, these have a standard error: the one that they would have without.
  const tissue = all.filter(({ of }) => of.region !== undefined).map(({ label, value, error, digits, at, of }) => {
    const other = closest(found.correlation, at);
    const isStopped = found.at_bound.some(({ region, name }) => region === of.region && name === of.name);
    return [isStopped ? `${label} (${words.atBound})` : label, figure(value, digits), figure(error, digits), other === undefined ? "–" : make("span", { className: "long" }, `${fixed(other.correlation, 2)}: ${all[other.at]!.label}`)];
  });
  const named = targetsOf(words, job.tags, found.targets.length);
  const targets = found.targets.map(({ residual_mm, largest_mm, points }, at) =>
    [points > 1 ? `${named[at]!.label}, ${words.pointsOf(points)}` : named[at]!.label, mm(residual_mm), mm(largest_mm)]);
  const loose = found.undetermined.map((parts) => make("li", {}, parts.map(({ part, ...of }) => {
    const { value, part: unit } = inWords(words, frame, { ...of, value: part });
    return `${mm(of.region === undefined ? value : part)} × ${unit}`;
  }).join(" + ")));
  const bars = [...free, ...stopped].map(({ label, ...one }): Row => ({ name: label, ...one }));
  const factor = found.residual_factor ?? undefined;
  return make("div", {},
    bars.length > 0 && rowChart(words.movement, "mm, °", bars, true),
    numbers.length > 0 && table(words.movement, ["", "mm, °", words.standardError], numbers),
    ...(tissue.length === 0 ? [] : [table(words.tissue, ["", words.foundValue, words.standardError, words.correlatedWith], tissue),
      make("p", { className: "fine" }, words.correlationHint, factor === undefined ? "" : ` ${words.residualSays(figure(factor, 2))}`)]),
    table(words.targets, ["", `${words.left_} mm`, words.max], targets),
    loose.length > 0 && make("div", { className: "warned" }, words.notDetermined, make("ul", {}, ...loose)),
    plan !== undefined && make("a", { className: "button primary", href: address(["case", opened.id, "plan"], written(plan, pivots)), data: { job: job.id } }, words.openPlan),
    tissue.length > 0 && found.materials !== undefined && asCase(app, opened, found.materials));
}
