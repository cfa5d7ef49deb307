// What inverse planning found, with what is uncertain about it.
import type { Documents, Job } from "../api.js";
import { rowChart, type Row } from "../charts.js";
import type { App } from "../app.js";
import { make, table } from "../dom.js";
import { wordOf, type FrameName } from "../frame.js";
import type { Opened } from "../loading.js";
import { planState } from "../plan.js";
import { address } from "../route.js";
import { figure, mm } from "../figures.js";
import { wordFor } from "./movements.js";
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

/** A parameter with the word and the sign of its slider; growth and constants of tissue have none. */
function inSliders(words: Words, frame: FrameName, { segment, region, name, value }: Parameter): { label: string; value: number } {
  if (region !== undefined) return { label: `${region} ${name}`, value };
  const { word, sign } = wordOf(name, frame);
  return { label: `${segment} ${wordFor(words, word, frame)}, ${name.startsWith("rotation") ? "°" : "mm"}`, value: sign * value || 0 };
}

/** A parameter that is stopped where there was room to move. */
const stoppedOf = ({ at_bound }: Found) => at_bound.filter(({ value }) => value !== 0);

/** How near the plan comes to its targets; to be heeded where one is missed or a movement is stopped by its bound. */
export function foundLine(words: Words, found: Found, named: NamedTarget[], frame: FrameName): TrustLine {
  const missed = found.targets.flatMap(({ residual_mm }, at) => (residual_mm > MISSED * named[at]!.sigma_mm ? [words.missedBy(named[at]!.label, mm(residual_mm))] : []));
  const stopped = stoppedOf(found).map((one) => { const { label, value } = inSliders(words, frame, one); return words.stoppedAt(label, mm(value)); });
  const most = Math.max(0, ...found.targets.map(({ residual_mm }) => residual_mm));
  const why = [words.missedRule(MISSED), ...missed, ...stopped].join(" ");
  return { name: words.targets, value: words.leftAtMost(mm(most)), trusted: missed.length + stopped.length > 0 ? "heed" : "good", why };
}

export function foundFacts({ words, route }: App, job: Job, opened: Opened, found: Found): HTMLElement {
  const frame = job.results?.provenance?.frame ?? opened.frame;
  const all = found.parameters.map((one, at) => ({ ...inSliders(words, frame, one), isTissue: one.region !== undefined, error: found.standard_error[at]! }));
  const free = all.filter(({ isTissue }) => !isTissue).map(({ label, value, error }) => ({ label, value, error }));
  // At a bound as well, they have a row and a standard error of their own.
  const tissue = all.filter(({ isTissue }) => isTissue).map(({ label, value, error }) => [label, figure(value, 4), figure(error, 4)]);
  const stopped = stoppedOf(found).filter(({ region }) => region === undefined).map((one) => inSliders(words, frame, one));
  const numbers = [...free.map(({ label, value, error }) => [label, mm(value), mm(error)]), ...tissue, ...stopped.map(({ label, value }) => [label, mm(value), words.atBound])];
  const named = targetsOf(words, job.tags, found.targets.length);
  const targets = found.targets.map(({ residual_mm, largest_mm, points }, at) =>
    [points > 1 ? `${named[at]!.label}, ${words.pointsOf(points)}` : named[at]!.label, mm(residual_mm), mm(largest_mm)]);
  const loose = found.undetermined.map((parts) => make("li", {}, parts.map(({ part, ...of }) => {
    const { label, value } = inSliders(words, frame, { ...of, value: part });
    return `${mm(value)} × ${label}`;
  }).join(" + ")));
  const bars = [...free, ...stopped].map(({ label, ...one }): Row => ({ name: label, ...one }));
  return make("div", {},
    bars.length > 0 && rowChart(words.movement, "mm, °", bars, true),
    table(words.movement, ["", "mm, °", words.standardError], numbers),
    table(words.targets, ["", `${words.left_} mm`, words.max], targets),
    loose.length > 0 && make("div", { className: "warned" }, words.notDetermined, make("ul", {}, ...loose)),
    make("a", { className: "button primary", href: address(["case", opened.id, "plan"], planState(route.state)), data: { job: job.id } }, words.openPlan));
}
