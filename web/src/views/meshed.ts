// A case whose mesh is yet to be made: of surfaces, each the skin or a bone, or of a scan. The document that says so stands beside.
import type { Documents } from "../api.js";
import { refusal, type App } from "../app.js";
import { button, make, select } from "../dom.js";
import type { FrameName } from "../frame.js";
import type { Shape } from "../geometry.js";
import type { Words } from "../words/en.js";

/** Surfaces by the names of their files, without the ending. */
export type SurfaceRole = "skin" | "bone" | "none";
export type SurfaceRoles = Record<string, SurfaceRole>;

/** By its name, to begin with. */
export const surfaceRole = (name: string): SurfaceRole => (/skin|haut|soft|face$/i.test(name) ? "skin" : "bone");

/** What has surfaces meshed; undefined without skin or without bone. Bone of which cuts are made is one surface, `stored` has the ids of files
 * that the service has already. */
export function surfacesDocument(name: string, frame: string, roles: SurfaceRoles, osteotomy?: object, stored: Record<string, string> = {}): object | undefined {
  const having = (role: SurfaceRole) => Object.keys(roles).filter((one) => roles[one] === role);
  const [skin, ...others] = having("skin");
  const bones = having("bone").map((bone) => ({ name: bone, mesh: stored[bone] ?? bone }));
  if (skin === undefined || others.length > 0 || bones.length === 0) return undefined;
  const cut = osteotomy !== undefined && bones.length === 1;
  return { name, meshing: { kind: "mesh", ...(frame === "unspecified" ? {} : { frame }),
    surfaces: { skin, ...(cut ? { bone: bones[0]!.mesh } : { bones }) }, ...(cut ? { osteotomy } : {}) } };
}

type Send = (document: unknown, parts: Record<string, Blob>, said: HTMLElement) => Promise<void>;
type Osteotomy = Documents["OsteotomyDocument"];

/** The document, to be changed by hand, and the button that sends it. */
function sender({ words }: App, send: (document: unknown, said: HTMLElement) => Promise<void>) {
  const text = make("textarea", { spellcheck: false, aria: { label: words.document } });
  const said = make("div", { role: "status" });
  const post = button(words.sendCase, () => {
    const failed = (error: unknown) => said.replaceChildren(refusal(error, words));
    try { send(JSON.parse(text.value), said).catch(failed); } catch (error) { failed(error); }
  }, { className: "primary" });
  return { text, post, element: make("div", {}, make("h3", {}, words.document), text, make("p", { className: "fine" }, words.documentHint), post, said) };
}

/** Where cuts are placed: a button that fetches the bone, and the editor that takes its place. */
class Cutting {
  readonly element = make("div", {});
  readonly start: HTMLButtonElement;
  private leave: (() => void) | undefined;

  constructor(private readonly app: App, private readonly fetch: (line: HTMLElement) => Promise<{ bone: Shape; frame: FrameName }>, private readonly changed: (osteotomy: Osteotomy | undefined) => void) {
    this.start = button(app.words.placeCuts, () => void this.open());
    this.stop();
  }

  /** Without cuts, as when other files are bone. */
  stop(): void {
    this.leave?.();
    this.leave = undefined;
    this.element.replaceChildren(this.start);
    this.start.disabled = false;
  }

  private async open(): Promise<void> {
    const { app, element } = this;
    this.start.disabled = true;
    const line = make("div", { role: "status" }, app.words.loading);
    element.replaceChildren(this.start, line);
    try {
      const { bone, frame } = await this.fetch(line);
      const { cutEditor } = await import("./three.js");
      if (!element.isConnected) return;
      const editor = cutEditor(app, bone, frame, this.changed);
      // A drawing that is no longer in the document gives its context back.
      this.leave = editor.leave;
      element.replaceChildren(editor.element);
    } catch (error) {
      this.start.disabled = false;
      line.replaceChildren(refusal(error, app.words));
    }
  }
}

const frames = (words: Words) => [["unspecified", words.frames.unspecified], ["LPS", words.frames.LPS], ["RAS", words.frames.RAS]] as const;

export function surfacesEditor(app: App, files: Record<string, Blob>, send: Send): HTMLElement {
  const { words, service } = app;
  const names = Object.keys(files);
  const roles: SurfaceRoles = Object.fromEntries(names.map((name) => [name, surfaceRole(name)]));
  const stored: Record<string, string> = {};
  let frame: FrameName = "unspecified";
  let osteotomy: Osteotomy | undefined;
  const parts = () => Object.fromEntries(Object.entries(files).filter(([name]) => stored[name] === undefined));
  const { text, post, element } = sender(app, (document, said) => send(document, parts(), said));
  const asked = make("p", { className: "warned" }, words.frameAsked);
  const lacking = make("p", { className: "warned", role: "status" }, words.surfacesLack);
  const whole = make("p", { className: "fine" }, words.cutOneBone);
  const bones = () => names.filter((name) => roles[name] === "bone");
  const cutting = new Cutting(app, async () => {
    const [name] = bones();
    stored[name!] ??= await service.upload(files[name!]!, "mm", frame);
    const { boneOfSurface } = await import("./three.js");
    return { bone: await boneOfSurface(app, stored[name!]!, frame), frame };
  }, (found) => { osteotomy = found; write(); });
  const write = () => {
    const document = surfacesDocument(names.find((name) => roles[name] === "skin") ?? names[0]!, frame, roles, osteotomy, stored);
    lacking.hidden = document !== undefined;
    post.disabled = document === undefined;
    const isCuttable = bones().length === 1 && frame !== "unspecified";
    cutting.element.hidden = !isCuttable;
    whole.hidden = isCuttable;
    if (document !== undefined) text.value = JSON.stringify(document, null, 2);
  };
  /** Another bone or frame: what was stored of it and its cuts are of nothing. */
  const anew = () => { osteotomy = undefined; for (const name of names) delete stored[name]; cutting.stop(); write(); };
  const rows = names.map((name) => make("li", {}, select(name, (["skin", "bone", "none"] as const).map((role) => [role, words.surfaceRole[role]] as const), roles[name]!,
    (role) => { roles[name] = role as SurfaceRole; anew(); })));
  write();
  return make("div", {}, make("div", { className: "split" },
    make("div", {}, make("h3", {}, words.surfaces), make("p", { className: "fine" }, words.surfacesWhy),
      select(words.frame, frames(words), frame, (value) => { frame = value as FrameName; asked.hidden = value !== "unspecified"; anew(); }),
      asked, make("ul", { className: "plans" }, ...rows), lacking), element),
  make("h3", {}, words.cuts), whole, cutting.element);
}

const USUAL_BONE_HU = 250;

/** Of a scan that is stored. */
export function scanEditor(app: App, name: string, mesh: Documents["MeshDocument"], send: Send): HTMLElement {
  const { words } = app;
  const { text, element } = sender(app, (document, said) => send(document, {}, said));
  const frame: FrameName = mesh.report.space ?? mesh.frame ?? "unspecified";
  text.value = JSON.stringify({ name, meshing: { kind: "mesh", scan: mesh.id } }, null, 2);
  const threshold = make("input", { type: "number", step: "10", value: String(USUAL_BONE_HU) });
  /** What was changed by hand stays. */
  const write = (osteotomy: Osteotomy | undefined) => {
    const document = JSON.parse(text.value) as { meshing?: Record<string, unknown> };
    const { osteotomy: _, frame: __, thresholds_hu, ...meshing } = document.meshing ?? {};
    const bone = threshold.valueAsNumber;
    const stated = typeof thresholds_hu === "string" ? {} : (thresholds_hu as object | undefined);
    const thresholds = bone === USUAL_BONE_HU ? thresholds_hu : { ...stated, bone };
    document.meshing = { ...meshing, ...(thresholds === undefined ? {} : { thresholds_hu: thresholds }),
      ...(osteotomy === undefined ? {} : { ...(frame === "unspecified" ? {} : { frame }), osteotomy }) };
    text.value = JSON.stringify(document, null, 2);
  };
  const safely = (osteotomy: Osteotomy | undefined) => {
    try { write(osteotomy); problem.hidden = true; } catch { problem.hidden = false; }
  };
  const problem = make("p", { className: "warned", role: "alert", hidden: true }, words.documentBroken);
  const cutting = new Cutting(app, async () => {
    const { boneOfScan } = await import("./three.js");
    return { bone: await boneOfScan(app, mesh, threshold.valueAsNumber, frame), frame };
  }, safely);
  return make("div", {}, make("div", { className: "split" }, make("div", { className: "warned" }, words.imageAlone(name)), element), problem,
    make("h3", {}, words.cuts), make("label", { className: "field" }, make("span", {}, words.boneFrom), threshold, "HU"), cutting.element);
}
