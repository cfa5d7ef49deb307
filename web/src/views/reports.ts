// The report of a result, as a page to read and as a file to keep.
import { Service, type Job } from "../api.js";
import { refusal, type App } from "../app.js";
import { button, make, save } from "../dom.js";

const REPORTS: Record<string, string> = { "report.html": "text/html", "report.pdf": "application/pdf" };

/** Undefined where the service draws none of this job. Where a key is needed they are fetched with it, since a link has none. */
export function reportLinks({ service, words }: App, job: Job): HTMLElement | undefined {
  const there = [...(job.results?.pictures ?? []), ...(job.results?.files ?? []).map(({ name }) => name)];
  const names = Object.keys(REPORTS).filter((name) => there.some((one) => one === name));
  if (names.length === 0) return undefined;
  const said = make("div", { role: "status" });
  const language = document.documentElement.lang;
  const link = (name: string) => {
    const path = `/v1/jobs/${job.id}/results/${name}?lang=${language}`;
    const label = name.endsWith("pdf") ? words.reportPdf : words.reportHtml;
    if (!Service.hasKey) return make("a", { className: "button", href: path, target: "_blank", rel: "noopener" }, label);
    return button(label, () => {
      service.ask("GET", path).then(async (answer) => save(await answer.blob(), name)).catch((error: unknown) => said.replaceChildren(refusal(error, words)));
    });
  };
  return make("div", {}, make("p", { className: "fine" }, words.reportHint), make("div", { className: "row" }, ...names.map(link)), said);
}
