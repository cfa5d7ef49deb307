// The result of a job that has no skin to show: what it found in numbers, where it leads, its report and files.
import type { CaseDocument, Job } from "../api.js";
import { refusal, warnings, type App } from "../app.js";
import { button, make } from "../dom.js";
import { when } from "../figures.js";
import { address } from "../route.js";
import type { Words } from "../words/en.js";
import { anything } from "./anything.js";
import { comparisonFacts } from "./distances.js";
import { fileList } from "./files.js";
import { reportLinks } from "./reports.js";

/** Members of a result that are told elsewhere, or are not for reading. */
const ELSEWHERE = ["files", "pictures", "warnings", "job", "kept", "case", "comparison", "provenance", "optimisation", "numerical_error_mm", "nonlinearity_mm"];

export const kindOf = (words: Words, kind: string): string => words.kinds[kind] ?? kind;
export const statusOf = (words: Words, status: string): string => words.statuses[status] ?? status;

export function plainResult(app: App, job: Job): HTMLElement[] {
  const { words } = app;
  const results = job.results;
  const found = Object.entries(results ?? {}).filter(([member, value]) => !ELSEWHERE.includes(member) && typeof value === "object" && value !== null && !Array.isArray(value));
  const report = results === undefined ? undefined : reportLinks(app, job);
  return [
    make("h1", {}, `${kindOf(words, job.kind)} · ${statusOf(words, job.status)}`),
    make("p", { className: "fine" }, `${when(job.created)} · ${job.message}`),
    make("div", { className: "row" }, ...onwards(app, job)),
    make("section", {}, make("h2", {}, words.warnings), warnings(job.warnings, words)),
    ...(report === undefined ? [] : [make("section", {}, make("h2", {}, words.report), report)]),
    ...(results?.comparison === undefined ? [] : [comparisonFacts(app, results.comparison)]),
    ...found.map(([member, value]) => anything(words, member.replaceAll("_", " "), value as Record<string, unknown>, ["case", "plan"])),
    ...(results === undefined ? [] : [fileList(app, job)]),
  ];
}

/** Where a result leads: the case it is of, the case it made, the study that it is. */
function onwards({ service, words }: App, job: Job): HTMLElement[] {
  const link = (path: string[], text: string) => make("a", { className: "button", href: address(path) }, text);
  const links: HTMLElement[] = job.case === undefined || job.case === null ? [] : [link(["case", job.case], words.toCase)];
  if (job.kind === "response" && job.case) links.push(link(["case", job.case, "plan"], words.planIt));
  if (job.kind === "study" || job.kind === "batch") links.push(link(["studies"], words.toStudies));
  const conformed = job.results?.conformation?.case;
  if (conformed === undefined) return links;
  const said = make("div", { role: "status" });
  const make_ = button(words.makeCase, () => {
    service.post<{ id: string }>("/v1/cases", conformed as CaseDocument)
      .then(({ id }) => { location.hash = address(["case", id]); }, (error: unknown) => said.replaceChildren(refusal(error, words)));
  }, { className: "primary" });
  return [...links, make_, said];
}
