// The files of a result, to be saved.
import type { Documents, Job } from "../api.js";
import { refusal, type App } from "../app.js";
import { button, make, save } from "../dom.js";
import { count } from "../figures.js";

export function fileList({ service, words }: App, job: Job): HTMLElement {
  const said = make("div", { role: "status" });
  const row = ({ name, bytes, media_type }: Documents["FileDocument"]) => make("li", {}, button(name, () => {
    service.file(job.id, name).then((content) => { said.replaceChildren(); save(new Blob([content], { type: media_type }), name); })
      .catch((error: unknown) => said.replaceChildren(refusal(error, words)));
  }), make("span", { className: "fine" }, ` ${count(Math.ceil(bytes / 1024))} KiB`));
  return make("section", { className: "files" }, make("h2", {}, words.files), make("ul", { className: "plans" }, ...(job.results?.files ?? []).map(row)), said);
}
