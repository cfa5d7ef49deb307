// Lists of jobs and of studies.
import type { Case, Documents, Job } from "../api.js";
import { refusal, type App, type Leave } from "../app.js";
import { button, make, scrolling, table } from "../dom.js";
import { address, note } from "../route.js";
import type { Words } from "../words/en.js";
import { mm, when } from "../figures.js";
import { aboutJob, tail } from "./called.js";
import { failingRows } from "./failing.js";
import { kindOf, statusOf } from "./kinds.js";
import { reportLinks } from "./reports.js";

/** Jobs under way are looked at again after so long, in ms. */
const AGAIN = 2000;
const WORKING = ["accepted", "running"];

export async function jobs(app: App): Promise<Leave> {
  const { service, words, stage } = app;
  let left = false;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const said = make("div", {});
  /** What became of cancelling one, and why the list is old. */
  const [refused, old] = [make("div", {}), make("div", {})];
  const body = make("tbody", {});
  const cases = await service.list<Case>("/v1/cases").catch((): Case[] => []);
  const names = new Map(cases.map(({ id, case: document }) => [id, document.name ?? tail(id)]));
  const row = (job: Job) => {
    const cancel = button(words.cancel, () => { service.ask("DELETE", `/v1/jobs/${job.id}`).then(look, (error: unknown) => refused.replaceChildren(refusal(error, words))); });
    const working = WORKING.includes(job.status);
    const bar = make("progress", { max: 100, value: job.progress, ariaLabel: `${kindOf(words, job.kind)} ${words.progress}` });
    return make("tr", {}, make("th", { scope: "row" }, make("a", { href: address(["job", job.id]) }, kindOf(words, job.kind)),
      make("span", { className: "fine" }, ` ${[aboutJob(words, job), tail(job.id)].filter((part) => part !== "").join(" · ")}`)),
      make("td", {}, names.get(job.case ?? "") ?? ""), make("td", {}, statusOf(words, job.status)), make("td", { className: "detail" }, working ? bar : failure(job)),
      make("td", {}, when(job.created)), make("td", {}, working ? cancel : ""));
  };
  const draw = async () => {
    const list = await service.list<Job>("/v1/jobs", 100);
    if (left) return;
    body.replaceChildren(...list.map(row));
    said.replaceChildren(list.length === 0 ? make("p", {}, words.noJobs) : "");
    if (list.some((job) => WORKING.includes(job.status))) timer = setTimeout(() => void look(), AGAIN);
  };
  /** Draws again and says where that fails, which is tried anew until it does not. */
  const look = async () => {
    clearTimeout(timer);
    try {
      await draw();
      old.replaceChildren();
    } catch (error) {
      if (left) return;
      if (old.childElementCount === 0) old.replaceChildren(refusal(error, words, () => void look()));
      timer = setTimeout(() => void look(), AGAIN);
    }
  };
  await draw();
  const head = [words.kind, words.overview, words.status, words.progress, words.created, ""].map((text) => make("th", { scope: "col" }, text));
  stage.replaceChildren(make("h1", {}, words.jobs), refused, old, said, make("div", { className: "card" },
    scrolling(words.jobs, make("table", { className: "listed" }, make("thead", {}, make("tr", {}, ...head)), body))));
  return () => { left = true; clearTimeout(timer); };
}

/** Why a job failed, in words. */
function failure({ error }: Job): HTMLElement | string {
  return error === undefined || error === null ? "" : make("span", { className: "failed" }, `${error.detail} `, make("a", { href: `/errors#${error.type}`, className: "code" }, error.type));
}

export async function studies(app: App): Promise<Leave> {
  const { service, words, stage } = app;
  const list = await service.list<Job>("/v1/jobs?kind=study", 50);
  const shown = make("div", {});
  const open = (job: Job) => void report(app, job, shown).catch((error: unknown) => shown.replaceChildren(refusal(error, words)));
  // Lists say the verdict of a study, its report what it was of.
  const about = (job: Job) => {
    const into = make("p", { className: "fine about" }, tail(job.id));
    if (job.status === "successful") {
      service.get<Documents["ReportDocument"]>(`/v1/jobs/${job.id}/report`)
        .then(({ rows, scenes }) => { into.title = into.textContent = [scenes.map(({ name }) => name).join(", "), each(rows.map(({ label }) => label)).join(", "), tail(job.id)].join(" · "); }, () => {});
    }
    return into;
  };
  const row = (job: Job) => make("li", { className: "card" },
    make("h2", {}, when(job.created)), about(job),
    make("p", {}, `${statusOf(words, job.status)}${job.results?.study === undefined ? "" : ` · ${words.verdict}: ${words.outcomes[job.results.study.verdict.outcome] ?? job.results.study.verdict.outcome}`}`),
    job.status === "successful" && button(words.chart, () => open(job)), " ", make("a", { className: "button", href: address(["job", job.id]) }, words.result));
  const stated = list.find(({ id, status }) => id === app.route.state.get("study") && status === "successful");
  if (stated !== undefined) open(stated);
  stage.replaceChildren(make("h1", {}, words.studies),
    list.length === 0 ? make("p", {}, words.noStudies) : make("ul", { className: "cards" }, ...list.map(row)), shown);
  return () => {};
}

/** Each once. */
const each = (names: string[]): string[] => [...new Set(names)];

type StudyRow = Documents["ReportDocument"]["rows"][number];

/** The chart of a study with the rows behind its marks. */
async function report(app: App, job: Job, into: HTMLElement): Promise<void> {
  const { service, words } = app;
  const path = `/v1/jobs/${job.id}/report`;
  const chart = await (await service.ask("GET", `${path}?format=svg`)).text();
  const { rows, verdict } = await service.get<Documents["ReportDocument"]>(path);
  const told = make("p", { className: "told", role: "status" });
  const place = make("div");
  const show = (mark: Mark | undefined) => {
    const shown = mark === undefined ? rows : rows.filter((row) => row.label === mark.label && row.level === mark.level);
    told.replaceChildren(...(mark === undefined ? [] : [words.rowsOfMark(`${mark.label}, ${words.level} ${mark.level}`, shown.length, rows.length), " ", button(words.allRows, () => choose(undefined))]));
    place.replaceChildren(rowTable(words, shown));
  };
  const { drawing, choose } = clickable(chart, words.chart, (mark) => {
    note({ study: job.id, mark: mark === undefined ? undefined : `${mark.level},${mark.label}` });
    show(mark);
  });
  into.replaceChildren(make("p", { className: "fine" }, words.clickMarks), drawing, reportLinks(app, job) ?? "",
    ...verdict.reasons.map((reason) => make("p", { className: "warned" }, reason)), failingRows(words, verdict) ?? "", told, place);
  const [level = "", ...label] = (app.route.state.get("study") === job.id ? app.route.state.get("mark") ?? "" : "").split(",");
  choose(level === "" ? undefined : { level: Number(level), label: label.join(",") });
}

function rowTable(words: Words, rows: StudyRow[]): HTMLElement {
  const length = (value: number | null | undefined) => (value === undefined || value === null ? "–" : mm(value));
  const cells = rows.map((row) => [row.label, row.scene, row.plan, row.material, row.level, length(row.mean_mm), length(row.p95_mm), row.wall_s?.toPrecision(2) ?? "–", row.status]);
  return table(words.rows, [words.variant, words.scene, words.plan, words.material, words.level, words.meanMm, words.p95mm, words.wall, words.state], cells);
}

/** What a mark of the chart is of. */
export interface Mark {
  label: string;
  level: number;
}

/** What a group of the chart is of, as its data attributes say; nothing of groups that are no marks, and of charts of earlier programs. */
export function markOf({ label, level }: Record<string, string | undefined>): Mark | undefined {
  return label === undefined || level === undefined ? undefined : { label, level: Number(level) };
}

/** The chart of the service as a part of the page, whose marks are buttons; its words are the service's, and the policy of the page lets none of them run. */
function clickable(chart: string, label: string, chosen: (mark: Mark | undefined) => void) {
  const root = document.importNode(new DOMParser().parseFromString(chart, "image/svg+xml").documentElement, true);
  root.setAttribute("class", "drawing chart");
  root.setAttribute("role", "group");
  root.setAttribute("aria-label", label);
  for (const size of ["width", "height"]) root.removeAttribute(size);
  root.querySelector(":scope > title")?.remove();
  const marks = [...root.querySelectorAll<SVGElement>("g.mark, g.failure")].flatMap((element) => {
    const title = element.querySelector("title")?.textContent ?? "";
    const mark = markOf({ ...element.dataset });
    return mark === undefined ? [] : [{ element, mark, title }];
  });
  const is = (one: Mark | undefined, other: Mark) => one?.label === other.label && one.level === other.level;
  const choose = (mark: Mark | undefined) => {
    const found = marks.some((one) => is(mark, one.mark)) ? mark : undefined;
    for (const one of marks) one.element.setAttribute("aria-pressed", String(is(found, one.mark)));
    chosen(found);
  };
  for (const { element, mark, title } of marks) {
    element.setAttribute("tabindex", "0");
    element.setAttribute("role", "button");
    element.setAttribute("aria-label", title);
    const press = () => choose(element.getAttribute("aria-pressed") === "true" ? undefined : mark);
    element.addEventListener("click", press);
    element.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      press();
    });
  }
  return { drawing: root, choose };
}
