// A case from files: a mesh alone with roles for its sets, or a mesh with the document that says what it means.
import { Refused, type Documents } from "../api.js";
import { ProgressLine, refusal, type App } from "../app.js";
import { button, make, select } from "../dom.js";
import { count as inGroups } from "../figures.js";
import { address } from "../route.js";
import { guess, documentOf, type Role, type SetRoles } from "../roles.js";
import { scanEditor, surfacesEditor } from "./meshed.js";
import type { Words } from "../words/en.js";

/** The name stands before the choice already: it is for those who do not see that. */
function named(choice: HTMLLabelElement): HTMLLabelElement {
  choice.querySelector("span")!.className = "hidden";
  return choice;
}

const ROLES: Role[] = ["none", "skin", "region", "segment", "fixed", "sliding"];
const SURFACES = /\.(vtp|stl|ply)$/i;

/** Slices of a DICOM series, which often have no ending. */
export const isSlice = (name: string): boolean => /^[^.]+$|\.(dcm|dicom|ima)$/i.test(name);

const stem = (name: string) => name.replace(/\.[^.]+(\.gz)?$/, "");

export function uploadForm(app: App): HTMLElement {
  const { words } = app;
  const said = make("div", { role: "status" });
  const next = make("div");
  const files = make("input", { type: "file", multiple: true, hidden: true, data: { files: "" } });
  const take = (list: FileList | null | undefined) => {
    // Hidden files of a folder, such as the record of what was written into it, are none of a case.
    const chosen = [...(list ?? [])].filter(({ name }) => !name.startsWith("."));
    if (chosen.length === 0) return;
    said.replaceChildren();
    next.replaceChildren();
    taken(app, chosen, said, next).catch((error: unknown) => said.replaceChildren(refusal(error, words)));
  };
  files.addEventListener("change", () => { take(files.files); files.value = ""; });
  const drop = make("section", { className: "card drop" }, make("h2", {}, words.addCase), make("p", {}, words.dropHere),
    files, button(words.chooseFiles, () => files.click()), make("p", { className: "fine" }, words.fileHint), said, next);
  drop.addEventListener("dragover", (event) => { event.preventDefault(); drop.classList.add("over"); });
  drop.addEventListener("dragleave", () => drop.classList.remove("over"));
  drop.addEventListener("drop", (event) => {
    event.preventDefault();
    drop.classList.remove("over");
    take(event.dataTransfer?.files);
  });
  return drop;
}

/** A document of a case, alone or with its plan, or of something else. */
interface Stated { case?: unknown; volume?: unknown; meshing?: unknown }
const isCase = (stated: Stated) => stated.case !== undefined || stated.volume !== undefined || stated.meshing !== undefined;

/** What is no JSON is refused by the name of its file. */
function parsed(words: Words, name: string, text: string): Stated {
  try {
    return JSON.parse(text) as Stated;
  } catch (error) {
    throw new Error(words.noJson(name, String(error instanceof Error ? error.message : error)));
  }
}

/** Files with a document are sent as they are; a mesh alone is looked at first. */
async function taken(app: App, files: File[], said: HTMLElement, next: HTMLElement): Promise<void> {
  const { words } = app;
  const documents = await Promise.all(files.filter(({ name }) => name.endsWith(".json"))
    .map(async (file) => parsed(words, file.name, await file.text())));
  const meshes = files.filter(({ name }) => !name.endsWith(".json"));
  // A folder may hold what else to ask of its meshes, as the one of `facies face` does.
  const stated = documents.find(isCase) ?? documents[0];
  if (stated !== undefined) {
    await send(app, (stated.case ?? stated) as Documents["CaseDocument"], byReference(stated.case ?? stated, meshes), said);
    return;
  }
  if (meshes.filter(({ name }) => isSlice(name)).length > 1) throw new Error(words.seriesAsArchive);
  const parts = Object.fromEntries(meshes.map((file) => [stem(file.name), file]));
  if (meshes.every(({ name }) => SURFACES.test(name))) {
    next.replaceChildren(surfacesEditor(app, parts, (document, some, into) => send(app, document, some, into)));
    return;
  }
  const volume = meshes.find(({ name }) => !SURFACES.test(name))!;
  const line = new ProgressLine(app.words, app.words.sending);
  said.replaceChildren(line.element);
  const id = await app.service.upload(volume, "mm", "unspecified", (upload) => line.tell({ status: "", ...upload }));
  const mesh = await app.service.get<Documents["MeshDocument"]>(`/v1/meshes/${id}`);
  said.replaceChildren();
  if (mesh.report.kind === "image") {
    next.replaceChildren(scanEditor(app, stem(volume.name), mesh, (document, some, into) => send(app, document, some, into)));
    return;
  }
  next.replaceChildren(editor(app, mesh, volume.name, meshes.filter((file) => file !== volume)));
}

/** Files by the names that the document has for them: `face.vtu`, a path that ends so, or `face`. */
function byReference(document: unknown, files: File[]): Record<string, Blob> {
  const text = JSON.stringify(document);
  const references = [...text.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([, reference]) => reference!);
  return Object.fromEntries(files.map((file) => {
    // A segment may be called as the file of its bone is, without the ending.
    const whole = references.find((one) => one === file.name || one.endsWith(`/${file.name}`));
    return [whole ?? references.find((one) => one === stem(file.name)) ?? file.name, file];
  }));
}

async function send(app: App, document: unknown, meshes: Record<string, Blob>, said: HTMLElement): Promise<void> {
  said.replaceChildren(make("p", {}, app.words.sending));
  const id = await app.service.createCase(document as Documents["CaseDocument"], meshes);
  location.hash = address(["case", id]);
}

/** What each set of a mesh is, beside the document that says so. */
function editor(app: App, mesh: Documents["MeshDocument"], name: string, bones: File[]): HTMLElement {
  const { words } = app;
  const sets = Object.entries(mesh.report.node_sets ?? {});
  const roles: SetRoles = Object.fromEntries(sets.map(([set]) => [set, guess(set)]));
  const settings = { name: stem(name), frame: (mesh.report.space ?? "unspecified") as string, units: "mm", mesh: mesh.id };
  const text = make("textarea", { spellcheck: false, aria: { label: words.document } });
  const found = make("div", { role: "status" });
  const write = () => { text.value = JSON.stringify(documentOf(settings, roles, bones.map((file) => stem(file.name))), null, 2); };
  const rows = sets.map(([set, count]) => make("li", {}, make("span", { className: "name" }, `${set} · ${words.nodeCount(inGroups(count))}`),
    named(select(set, ROLES.map((role) => [role, words.role[role]] as const), roles[set]!, (role) => { roles[set] = role as Role; write(); })),
    count === 0 && make("span", { className: "warned" }, words.emptySet)));
  /** What is wrong stands beside the set that it is wrong of, too. */
  const blame = (error: unknown) => {
    const faults = error instanceof Refused ? error.problem.errors ?? [] : [];
    sets.forEach(([set], at) => {
      const fault = faults.find(({ pointer }) => pointer.split("/").includes(set));
      if (fault !== undefined) rows[at]!.append(make("p", { className: "warned" }, fault.detail));
    });
  };
  const asked = make("p", { className: "warned", hidden: settings.frame !== "unspecified" }, words.frameAsked);
  const parts = () => Object.fromEntries(bones.map((file) => [stem(file.name), file]));
  const post = button(words.sendCase, () => {
    try {
      for (const row of rows) row.querySelector("p")?.remove();
      send(app, JSON.parse(text.value), parts(), found).catch((error: unknown) => {
        found.replaceChildren(refusal(error, words));
        blame(error);
      });
    } catch (error) {
      found.replaceChildren(refusal(error, words));
    }
  }, { className: "primary" });
  write();
  return make("div", { className: "split" },
    make("div", {}, make("h3", {}, words.sets), make("p", { className: "fine" }, words.setsHint),
      make("div", { className: "row" },
        select(words.frame, [["unspecified", words.frames.unspecified], ["LPS", words.frames.LPS], ["RAS", words.frames.RAS]], settings.frame,
          (value) => { settings.frame = value; asked.hidden = value !== "unspecified"; write(); }),
        select(words.units, [["mm", "mm"], ["m", "m"], ["um", "µm"]], settings.units, (value) => { settings.units = value; write(); })),
      asked, make("ul", { className: "plans" }, ...rows)),
    make("div", {}, make("h3", {}, words.document), text, make("p", { className: "fine" }, words.documentHint), post, found));
}
