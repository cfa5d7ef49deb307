// The result of a job that has no skin to show: what it found in numbers, where it leads, its report and files.
import type { CaseDocument, Documents, Job } from "../api.js";
import { refusal, warnings, type App } from "../app.js";
import { button, card, make } from "../dom.js";
import { when } from "../figures.js";
import { openCase } from "../loading.js";
import { address } from "../route.js";
import { anything } from "./anything.js";
import { conformedFacts } from "./conformed.js";
import { comparisonFacts } from "./distances.js";
import { failingRows } from "./failing.js";
import { fileList } from "./files.js";
import { foundFacts } from "./found.js";
import { groupFacts } from "./groups.js";
import { kindOf, statusOf } from "./kinds.js";
import { learnedFacts, learnedInShort } from "./learned.js";
import { cephalometry, landmarks, provenance, regions } from "./numbers.js";
import { performedFacts } from "./performed.js";
import { reportLinks } from "./reports.js";
import type { Words } from "../words/en.js";

/** Members of a result that are told elsewhere, or are not for reading. */
const ELSEWHERE = ["files", "pictures", "warnings", "job", "kept", "case", "comparison", "provenance", "numerical_error_mm", "nonlinearity_mm"];

/** Charts and tables of what a kind finds, by the members of its result. */
async function told(app: App, job: Job): Promise<Record<string, HTMLElement[]>> {
  const { words } = app;
  const { learning, cohort, conformation, reproduction, statistics, study, optimisation, provenance: stated } = job.results ?? {};
  const shown = { words, warnings: job.warnings, show: () => undefined };
  // The case may have gone since.
  const opened = optimisation && job.case ? await openCase(app.service, job.case).catch(() => undefined) : undefined;
  return {
    ...(learning ? { learning: [learnedInShort(words, learning), ...learnedFacts(words, learning)] } : {}),
    ...(optimisation && opened ? { optimisation: [card(words.found, foundFacts(app, job, opened, optimisation))] } : {}),
    ...(statistics ? { statistics: [card(words.regions, regions(shown, job.results!)),
      ...(Object.keys(statistics.landmarks ?? {}).length === 0 ? [] : [card(words.landmarks, landmarks(shown, job.results!, stated?.frame ?? "unspecified"))])] } : {}),
    ...(study ? { study: [verdictFacts(words, study)] } : {}),
    ...(cohort ? { cohort: groupFacts(words, cohort) } : {}),
    ...(conformation ? { conformation: conformedFacts(words, conformation) } : {}),
    ...(reproduction ? { reproduction: await performedFacts(app, reproduction, stated?.frame ?? "unspecified") } : {}),
  };
}

/** A prediction without a skin that can be drawn: why there is none, and the same plan with the usual files. */
function skinAsked({ service, words }: App, job: Job): HTMLElement | undefined {
  if (job.kind !== "predict" && job.kind !== "optimise") return undefined;
  const said = make("div", { role: "status" });
  const spec = againWithSkin(job);
  const again = spec !== undefined && button(words.predictAgain, () => {
    service.post<Job>("/v1/jobs", spec).then(({ id }) => { location.hash = address(["job", id]); }, (error: unknown) => said.replaceChildren(refusal(error, words)));
  }, { className: "primary" });
  return card(words.beforeAfter, make("p", { className: "warned" }, words.noSkinFile), again && make("p", { className: "fine" }, words.predictAgainHint), again, said);
}

/** Predicts the plan of a result with the usual files; undefined where the result does not say its plan. */
export function againWithSkin({ case: of, results }: Job): object | undefined {
  const plan = results?.optimisation?.plan ?? results?.provenance?.plan ?? undefined;
  const { method, model } = results?.provenance ?? {};
  // `auto` took a model that goes beyond `method`: it takes it again.
  const chosen = method === undefined || method === null || (model !== undefined && model !== null) ? {} : { method };
  return of === undefined || of === null || plan === undefined ? undefined : { kind: "predict", case: of, plan, ...chosen };
}

/** What a study comes to: its verdict, how many of its rows were solved, and the models that none beats. */
function verdictFacts(words: Words, { verdict, on_front }: Documents["StudySummaryDocument"]): HTMLElement {
  const others = Object.entries(words.rowStates).map(([state, name]) => [name, Number((verdict as unknown as Record<string, unknown>)[state] ?? 0)] as const).filter(([, rows]) => rows > 0);
  return card(words.verdict, make("p", {}, make("strong", {}, words.outcomes[verdict.outcome] ?? verdict.outcome),
    ` · ${words.rowsOf(verdict.solved, verdict.rows)}${others.map(([name, rows]) => `, ${rows} ${name}`).join("")}`),
  ...(verdict.reasons ?? []).map((reason) => make("p", { className: "warned" }, reason)), failingRows(words, verdict),
  on_front.length > 0 && make("p", { className: "fine" }, `${words.onFront}: ${on_front.map((label) => label.replaceAll("_", " ")).join(", ")}`));
}

export async function plainResult(app: App, job: Job): Promise<HTMLElement[]> {
  const { words } = app;
  const results = job.results;
  const facts = results === undefined ? {} : await told(app, job);
  const measures = results?.cephalometry ?? [];
  const found = Object.entries(results ?? {}).filter(([member, value]) => !ELSEWHERE.includes(member) && facts[member] === undefined && typeof value === "object" && value !== null && !Array.isArray(value) && Object.keys(value).length > 0);
  const report = results === undefined ? undefined : reportLinks(app, job);
  return [
    make("h1", {}, `${kindOf(words, job.kind)} · ${statusOf(words, job.status)}`),
    make("p", { className: "fine" }, [when(job.created), job.status === "successful" ? "" : job.message].filter((part) => part !== "").join(" · ")),
    make("div", { className: "row" }, ...onwards(app, job)),
    ...[skinAsked(app, job)].filter((part) => part !== undefined),
    card(words.warnings, warnings(job.warnings, words)),
    ...(report === undefined ? [] : [card(words.report, report)]),
    ...(results?.comparison === undefined ? [] : [comparisonFacts(app, results.comparison)]),
    ...Object.values(facts).flat(),
    ...(measures.length === 0 ? [] : [card(words.cephalometry, cephalometry(words, measures))]),
    ...found.map(([member, value]) => anything(words, member.replaceAll("_", " "), value as Record<string, unknown>, ["case", "plan"])),
    ...drawings(app, job),
    ...(results?.provenance === undefined ? [] : [card(words.provenance, provenance(words, results.provenance))]),
    ...(results === undefined ? [] : [fileList(app, job)]),
  ];
}

const PICTURE = /\.(svg|png)$/;

/** Files of the result that are pictures, fetched with the key where one is needed. */
function drawings({ service, words }: App, job: Job): HTMLElement[] {
  const names = (job.results?.files ?? []).map(({ name }) => name).filter((name) => PICTURE.test(name));
  if (names.length === 0) return [];
  const images = names.map((name) => {
    const image = make("img", { className: "drawing", alt: name });
    const path = `/v1/jobs/${job.id}/results/${name}`;
    service.ask("GET", path).then(async (answer) => { image.src = URL.createObjectURL(await answer.blob()); }).catch(() => image.remove());
    return image;
  });
  return [card(words.pictures, ...images)];
}

/** Where a result leads: the case it is of, the case it made, the study that it is. */
function onwards({ service, words }: App, job: Job): HTMLElement[] {
  const link = (path: string[], text: string, state = {}) => make("a", { className: "button", href: address(path, state) }, text);
  const links: HTMLElement[] = job.case === undefined || job.case === null ? [] : [link(["case", job.case], words.toCase)];
  if (job.kind === "compare" && job.case) links.push(link(["case", job.case, "compare"], words.toComparison, { comparison: job.id }));
  if (job.kind === "response" && job.case) links.push(link(["case", job.case, "plan"], words.planIt));
  if (job.kind === "study" || (job.kind as string) === "batch") links.push(link(["studies"], words.toStudies));
  const conformed = job.results?.conformation?.case;
  if (conformed === undefined) return links;
  const said = make("div", { role: "status" });
  const make_ = button(words.makeCase, () => {
    service.post<{ id: string }>("/v1/cases", conformed as CaseDocument)
      .then(({ id }) => { location.hash = address(["case", id]); }, (error: unknown) => said.replaceChildren(refusal(error, words)));
  }, { className: "primary" });
  return [...links, make_, said];
}
