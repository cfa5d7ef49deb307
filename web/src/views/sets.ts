// The sets of a case in its view: named where the pointer is, chosen by a click, given another role, and written as a case of its own.
import type { CaseDocument } from "../api.js";
import { announce, refusal, type App } from "../app.js";
import { button, make, select } from "../dom.js";
import { count as inGroups } from "../figures.js";
import { setsOf, type Opened } from "../loading.js";
import { ACCENT, FIXED, FREE, hex, SEGMENTS, SLIDING } from "../palette.js";
import { heldBy, isHeldBySets, rolesOf, withPainted, withRoles, type PaintedSet, type Role, type SetRoles } from "../roles.js";
import { address } from "../route.js";
import type { SkinMap, Workbench } from "../workbench.js";
import { materialChoices, withPresets, type Presets } from "./materials.js";
import { Painter } from "./paint.js";

const ROLES: Role[] = ["none", "skin", "region", "segment", "fixed", "sliding"];
const HELD = "held";
/** As in the picture of what holds the nodes. */
const COLOUR = hex(ACCENT);
/** A file of more nodes than these is not fetched to name sets. */
const MOST_NODES = 500_000;

/** Shows the sets in a section of the bench; `nodes` are those of the boundary as it is drawn. */
export async function setsSection(app: App, opened: Opened, bench: Workbench, section: HTMLElement, nodes: Uint32Array | undefined): Promise<void> {
  const { service, words } = app;
  const { document, view } = opened;
  const sizes = (view.meshes ?? []).find(({ report }) => report.kind === "volume")?.report.node_sets ?? {};
  const count = view.check?.nodes ?? 0;
  if (Object.keys(sizes).length === 0) { section.remove(); return; }
  if (nodes === undefined || count > MOST_NODES) { section.append(make("p", { className: "fine" }, words.setsTooLarge(inGroups(count)))); return; }
  const inside = await setsOf(service, document.volume!, nodes);
  new Sets(app, opened, bench, section, { sizes, inside }).start();
}

interface Held {
  sizes: Record<string, number>;
  /** For each drawn node whether it is in the set. */
  inside: Record<string, Uint8Array>;
}

class Sets {
  private readonly roles: SetRoles;
  private readonly before: SetRoles;
  private readonly here = make("p", { className: "told", role: "status" });
  private readonly text = make("textarea", { spellcheck: false });
  private readonly said = make("div", { role: "status" });
  private readonly rows = new Map<string, HTMLElement>();
  private readonly made = make("details", {}, make("summary", {}, ""));
  private readonly painted: PaintedSet[] = [];
  private readonly paintedList = make("ul", { className: "plans sets" });
  private painter: Painter | undefined;
  private presets: Presets = {};
  private chosen: string | undefined;
  private over = "";

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench, private readonly section: HTMLElement, private readonly held: Held) {
    this.before = rolesOf(opened.document, Object.keys(held.sizes));
    this.roles = { ...this.before };
  }

  start(): void {
    const { app: { words }, section, held, text, made } = this;
    text.setAttribute("aria-label", words.document);
    const list = make("ul", { className: "plans sets" }, ...Object.entries(held.sizes).map(([set, count]) => this.row(set, count)));
    const post = button(words.newCase, () => void this.post(), { className: "primary" });
    made.replaceChildren(make("summary", {}, words.document), text, make("p", { className: "fine" }, words.newCaseHint));
    this.here.textContent = words.setsClick;
    const { document } = this.opened;
    const names = [...Object.keys(held.sizes), ...(document.segments ?? []).map(({ name }) => name), ...Object.keys(document.skin_regions ?? {})];
    this.painter = new Painter(this.app, this.opened, this.bench, (name) => [...names, ...this.painted.map((one) => one.name)].includes(name), (set) => { this.painted.push(set); this.drawPainted(); });
    const materials = materialChoices(this.app, document, (presets) => { this.presets = presets; this.write(); });
    section.append(this.here, list, this.paintedList, this.painter.element, materials, make("div", { className: "row" }, post, button(words.reset2, () => this.reset())), made, this.said);
    if (isHeldBySets(document)) this.bench.offer([this.holding()], HELD);
    this.write();
    this.listen();
  }

  /** The skin by what holds it, as its sets are now. */
  private holding(): SkinMap {
    const { words } = this.app;
    const { inside } = this.held;
    const count = Object.values(inside)[0]?.length ?? 0;
    const now = () => heldBy(this.roles, inside, count);
    const segment = (name: string, at: number) => ({ name: `${name}: ${words.role.segment}`, colour: SEGMENTS[at % SEGMENTS.length]! });
    return {
      name: HELD, label: words.classes, scheme: "length", range_mm: 1, values: () => now().places,
      get kinds() { return [{ name: words.free, colour: FREE }, { name: words.sliding, colour: SLIDING }, { name: words.fixed, colour: FIXED }, ...now().segments.map(segment)]; },
    };
  }

  private row(set: string, count: number): HTMLElement {
    const { words } = this.app;
    const name = button(set, () => this.choose(set), { className: "link", aria: { pressed: "false" } });
    const role = select(set, ROLES.map((one) => [one, words.role[one]] as const), this.roles[set]!, (one) => { this.roles[set] = one as Role; this.write(); });
    role.querySelector("span")!.className = "hidden";
    const row = make("li", { data: { set } }, name, make("span", { className: "fine" }, `${words.nodeCount(inGroups(count))}`), role);
    this.rows.set(set, row);
    return row;
  }

  private drawPainted(): void {
    const { words } = this.app;
    const row = (set: PaintedSet) => make("li", { className: "changed" }, make("strong", {}, set.name), make("span", { className: "fine" }, words.role[set.role]),
      button("×", () => { this.painted.splice(this.painted.indexOf(set), 1); this.drawPainted(); }, { aria: { label: `${words.remove} ${set.name}` } }));
    this.paintedList.replaceChildren(...this.painted.map(row));
    this.write();
  }

  /** The sets of a drawn node, the smallest first. */
  private at(node: number): string[] {
    const { inside, sizes } = this.held;
    return Object.keys(inside).filter((set) => inside[set]![node] !== 0).sort((a, b) => (sizes[a] ?? 0) - (sizes[b] ?? 0));
  }

  private listen(): void {
    const { canvas } = this.bench.scene;
    let from: [number, number] = [0, 0];
    let next: PointerEvent | undefined;
    canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - from[0], event.clientY - from[1]) > 4 || this.painter?.isPainting === true) return;
      const hit = this.bench.scene.pick(event);
      const found = hit === undefined ? [] : this.at(hit.node);
      if (found.length === 0) return;
      // A click again goes on to the next larger set.
      this.choose(found[(found.indexOf(this.chosen ?? "") + 1) % found.length]!, true);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (next === undefined) requestAnimationFrame(() => { if (next !== undefined) this.hover(next); next = undefined; });
      next = event;
    });
  }

  private hover(event: PointerEvent): void {
    if (event.buttons !== 0) return;
    const { words } = this.app;
    const hit = this.bench.scene.pick(event);
    const names = hit === undefined ? "" : this.at(hit.node).map((set) => `${set} (${words.role[this.roles[set]!]})`).join(", ");
    if (names === this.over) return;
    this.over = names;
    this.bench.caption.textContent = hit === undefined ? this.opened.name : names || words.noSet;
  }

  private choose(set: string, scroll = false): void {
    const { app: { words }, bench, held } = this;
    this.chosen = set;
    bench.scene.unpoint();
    bench.scene.pointNodes(held.inside[set] ?? [], COLOUR);
    for (const [name, row] of this.rows) {
      row.classList.toggle("chosen", name === set);
      row.querySelector("button")!.setAttribute("aria-pressed", String(name === set));
    }
    if (scroll) this.rows.get(set)?.scrollIntoView({ block: "nearest" });
    this.here.textContent = `${set}: ${words.role[this.roles[set]!]}`;
    announce(this.here.textContent);
  }

  private write(): void {
    const { opened: { document, name }, app: { words } } = this;
    const changed = Object.keys(this.roles).some((set) => this.roles[set] !== this.before[set]) || this.painted.length > 0 || Object.keys(this.presets).length > 0;
    const other = withPresets(withPainted(withRoles(document, this.roles), this.painted), this.presets);
    // Two cases of one name are not told apart in a list.
    this.text.value = JSON.stringify(changed ? { ...other, name: `${name} · ${words.otherRoles}` } : other, null, 2);
    this.bench.redraw();
    for (const [set, row] of this.rows) row.classList.toggle("changed", this.roles[set] !== this.before[set]);
    if (this.chosen !== undefined) this.choose(this.chosen);
  }

  private reset(): void {
    for (const [set, role] of Object.entries(this.before)) {
      this.roles[set] = role;
      this.rows.get(set)!.querySelector("select")!.value = role;
    }
    this.write();
  }

  /** A case of its own: that which is there stays as it is, with its plans and results. */
  private async post(): Promise<void> {
    const { service, words } = this.app;
    try {
      const { id } = await service.post<{ id: string }>("/v1/cases", JSON.parse(this.text.value) as CaseDocument);
      location.hash = address(["case", id]);
    } catch (error) {
      this.said.replaceChildren(refusal(error, words));
    }
  }
}
