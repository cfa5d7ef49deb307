// What a learned model made of a prediction: whether it helps, how near the case is to those learned from, and its skin over the other.
import type { Documents, Job } from "../api.js";
import { refusal, type App } from "../app.js";
import { button, make } from "../dom.js";
import { figure, mm } from "../figures.js";
import { address } from "../route.js";
import type { Scene, Shape } from "../scene.js";
import { readVtp } from "../vtp.js";

const FILE = "corrected.vtp";

export function correctionFacts({ service, words }: App, job: Job, found: Documents["CorrectedDocument"], before: Shape, scene: Scene): HTMLElement {
  const facts: [string, string][] = [
    [words.meanErrorMm, words.learnedErrors(mm(found.model_error_mm), mm(found.mechanical_error_mm))],
    ...(found.changed_mm === undefined || found.changed_mm === null ? [] : [[words.changedBy, `${mm(found.changed_mm)} mm`] as [string, string]]),
    ...(found.band_mm === undefined || found.band_mm === null ? [] : [[words.bandWidth, `${mm(found.band_mm)} mm`] as [string, string]]),
    ...(found.distance === undefined || found.distance === null ? [] : [[words.fromLearned, `${figure(found.distance)} / ${figure(found.farthest)}`] as [string, string]]),
  ];
  const said = make("div", { role: "status" });
  const there = (job.results?.files ?? []).some(({ name }) => name === FILE);
  const over = button(words.overCorrected, () => {
    const on = over.getAttribute("aria-pressed") !== "true";
    over.setAttribute("aria-pressed", String(on));
    if (!on) { scene.overlay(undefined); return; }
    service.file(job.id, FILE).then(readVtp).then(({ points_mm, triangles }) => {
      if (points_mm.length !== before.points_mm.length) throw new Error(words.otherPoints);
      scene.overlay({ points_mm, triangles });
    }).catch((error: unknown) => said.replaceChildren(refusal(error, words)));
  }, { aria: { pressed: "false" } });
  return make("div", { className: "stack" },
    make("p", { className: found.helps ? "told" : "warned" }, found.helps ? words.learningHelps : words.learningHarms),
    typeof found.refused === "string" && make("p", { className: "warned" }, found.refused),
    make("dl", { className: "facts" }, ...facts.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)])),
    make("div", { className: "row" }, there && over, make("a", { className: "button", href: address(["job", found.model]) }, words.toModel)), said);
}
