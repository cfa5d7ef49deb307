// What inverse planning found, with what is uncertain about it.
import type { Documents, Job } from "../api.js";
import { rowChart, type Row } from "../charts.js";
import type { App } from "../app.js";
import { make, table } from "../dom.js";
import type { Opened } from "../loading.js";
import { planState } from "../plan.js";
import { address } from "../route.js";
import { mm } from "../figures.js";

/** `mandible translation_mm.x` as a person reads it. */
const called = (segment: string, name: string) => `${segment} ${name.replace("translation_mm.", "").replace("rotation_deg.", "↻ ")}${name.startsWith("rotation") ? ", °" : ", mm"}`;

type Found = Documents["OptimisationDocument"];

export function foundFacts({ words, route }: App, job: Job, opened: Opened, found: Found): HTMLElement {
  const numbers = found.parameters.map(({ segment, name, value }, at) =>
    [called(segment, name), value.toFixed(2), found.standard_error[at]!.toFixed(2)]);
  const stopped = found.at_bound.map(({ segment, name, value }) => [called(segment, name), value.toFixed(2), words.atBound]);
  const targets = found.targets.map(({ residual_mm, largest_mm, points }, at) => [`${words.target} ${at + 1} (${points})`, mm(residual_mm), mm(largest_mm)]);
  const loose = found.undetermined.map((parts) => make("li", {}, parts.map(({ segment, name, part }) => `${part.toFixed(2)} ${segment} ${name}`).join(" + ")));
  const bars = found.parameters.map(({ segment, name, value }, at): Row => ({ name: called(segment, name), value, error: found.standard_error[at]! }));
  return make("div", {},
    rowChart(words.movement, "mm, °", [...bars, ...found.at_bound.map(({ segment, name, value }): Row => ({ name: called(segment, name), value }))], true),
    table(words.movement, ["", "mm, °", words.standardError], [...numbers, ...stopped]),
    table(words.targets, ["", `${words.left_} mm`, words.max], targets),
    loose.length > 0 && make("div", { className: "warned" }, words.notDetermined, make("ul", {}, ...loose)),
    make("a", { className: "button primary", href: address(["case", opened.id, "plan"], planState(route.state)), data: { job: job.id } }, words.openPlan));
}
