// The cases that there are, and a place to drop another.
import type { Case, CaseDocument } from "../api.js";
import type { App, Leave } from "../app.js";
import { make } from "../dom.js";
import { count, when } from "../figures.js";
import { address } from "../route.js";
import { tail } from "./called.js";
import { uploadForm } from "./upload.js";

export async function cases(app: App): Promise<Leave> {
  const { service, words, stage } = app;
  const list = await service.list<Case>("/v1/cases");
  const row = (one: Case) => {
    const document = one.case as CaseDocument;
    const check = one.check;
    const name = document.name ?? tail(one.id);
    return make("li", { className: "card" },
      make("h2", {}, make("a", { href: address(["case", one.id]) }, name)),
      make("p", { className: "fine" }, `${words.states[one.state] ?? one.state} · ${when(one.created)} · ${tail(one.id)}`),
      check !== undefined && make("p", {}, words.size(count(check.nodes), count(check.cells))
        + ` · ${(document.segments ?? []).map((segment) => segment.name).join(", ")}`),
      (check?.warnings.length ?? 0) > 0 && make("p", { className: "warned" }, `${words.warnings}: ${check!.warnings.length}`),
      make("a", { className: "button", href: address(["case", one.id, "plan"]) }, words.planIt));
  };
  stage.replaceChildren(
    make("h1", {}, words.cases),
    list.length === 0 ? make("p", {}, words.noCases) : make("ul", { className: "cards" }, ...list.map(row)),
    uploadForm(app));
  return () => {};
}
