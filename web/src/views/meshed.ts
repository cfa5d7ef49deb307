// A case whose mesh is yet to be made: of surfaces, each the skin or a bone, or of a scan. The document that says so stands beside.
import { refusal, type App } from "../app.js";
import { button, make, select } from "../dom.js";

/** Surfaces by the names of their files, without the ending. */
export type SurfaceRole = "skin" | "bone" | "none";
export type SurfaceRoles = Record<string, SurfaceRole>;

/** By its name, to begin with. */
export const surfaceRole = (name: string): SurfaceRole => (/skin|haut|soft|face$/i.test(name) ? "skin" : "bone");

/** What has surfaces meshed; undefined without skin or without bone. */
export function surfacesDocument(name: string, frame: string, roles: SurfaceRoles): object | undefined {
  const having = (role: SurfaceRole) => Object.keys(roles).filter((one) => roles[one] === role);
  const [skin, ...others] = having("skin");
  const bones = having("bone").map((bone) => ({ name: bone, mesh: bone }));
  if (skin === undefined || others.length > 0 || bones.length === 0) return undefined;
  return { name, meshing: { kind: "mesh", ...(frame === "unspecified" ? {} : { frame }), surfaces: { skin, bones } } };
}

type Send = (document: unknown, said: HTMLElement) => Promise<void>;

/** The document, to be changed by hand, and the button that sends it. */
function sender({ words }: App, send: Send) {
  const text = make("textarea", { spellcheck: false, aria: { label: words.document } });
  const said = make("div", { role: "status" });
  const post = button(words.sendCase, () => {
    const failed = (error: unknown) => said.replaceChildren(refusal(error, words));
    try { send(JSON.parse(text.value), said).catch(failed); } catch (error) { failed(error); }
  }, { className: "primary" });
  return { text, post, element: make("div", {}, make("h3", {}, words.document), text, make("p", { className: "fine" }, words.documentHint), post, said) };
}

export function surfacesEditor(app: App, names: string[], send: Send): HTMLElement {
  const { words } = app;
  const roles: SurfaceRoles = Object.fromEntries(names.map((name) => [name, surfaceRole(name)]));
  let frame = "unspecified";
  const { text, post, element } = sender(app, send);
  const asked = make("p", { className: "warned" }, words.frameAsked);
  const lacking = make("p", { className: "warned", role: "status" }, words.surfacesLack);
  const write = () => {
    const document = surfacesDocument(names.find((name) => roles[name] === "skin") ?? names[0]!, frame, roles);
    lacking.hidden = document !== undefined;
    post.disabled = document === undefined;
    if (document !== undefined) text.value = JSON.stringify(document, null, 2);
  };
  const rows = names.map((name) => make("li", {}, select(name, (["skin", "bone", "none"] as const).map((role) => [role, words.surfaceRole[role]] as const), roles[name]!,
    (role) => { roles[name] = role as SurfaceRole; write(); })));
  write();
  return make("div", { className: "split" },
    make("div", {}, make("h3", {}, words.surfaces), make("p", { className: "fine" }, words.surfacesWhy),
      select(words.frame, [["unspecified", words.frames.unspecified], ["LPS", words.frames.LPS], ["RAS", words.frames.RAS]], frame,
        (value) => { frame = value; asked.hidden = value !== "unspecified"; write(); }),
      asked, make("ul", { className: "plans" }, ...rows), lacking), element);
}

/** Of a scan that is stored. */
export function scanEditor(app: App, name: string, id: string, send: Send): HTMLElement {
  const { text, element } = sender(app, send);
  text.value = JSON.stringify({ name, meshing: { kind: "mesh", scan: id } }, null, 2);
  return make("div", { className: "split" }, make("div", { className: "warned" }, app.words.imageAlone(name)), element);
}
