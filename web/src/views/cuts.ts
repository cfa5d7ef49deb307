// Cuts of bone that is to be meshed, placed in its view: by dragging a plane's handle, through three points of the bone, or by numbers.
import { readNrrd, surfaceAt } from "../nrrd.js";
import type { App, Leave } from "../app.js";
import { announce } from "../app.js";
import type { Documents, Triple } from "../api.js";
import { button, make } from "../dom.js";
import { figure } from "../figures.js";
import { inAxes, inWords, type FrameName } from "../frame.js";
import { VIEWS, type Shape } from "../geometry.js";
import { meshOf } from "../loading.js";
import { normalOf, osteotomy, planned, throughPoints, type Cut, type Operation, type Seeds } from "../osteotomy.js";
import { section } from "../outline.js";
import { inFrame } from "../ply.js";
import { BONE, hex, INK, PAPER, SERIES } from "../palette.js";
import { Scene } from "../scene.js";

/** Pixels from a handle within which a press takes it. */
const REACH = 16;
/** A press that moves no further, in pixels, is a click. */
const CLICK = 4;
/** Half the side of a plane as it is drawn, as a share of the bone's longest side. */
const SIDE = 0.28;
/** The radius of a handle, likewise. */
const HANDLE = 0.016;
const OPERATIONS: Operation[] = ["lefort", "rami", "occlusal"];
const JAWS: { name: keyof Seeds; operation: Operation }[] = [{ name: "maxilla", operation: "lefort" }, { name: "mandible", operation: "rami" }];
const SPACES: Record<string, FrameName> = { "left-posterior-superior": "LPS", "right-anterior-superior": "RAS" };
/** Above this, in voxels, a scan is not drawn here. */
const MOST_VOXELS = 250e6;

/** What a click on the bone is for. */
type Aim = { of: "points"; cut: Cut; points: Triple[] } | { of: "seed"; jaw: keyof Seeds } | undefined;

/** A stored surface of bone, in the frame that is stated. */
export const boneOfSurface = ({ service }: App, id: string, frame: FrameName): Promise<Shape> => meshOf(service, id, frame);

/** Bone of a stored scan, and the frame that it says it is in. */
export async function boneOfScan({ service, words }: App, mesh: Documents["MeshDocument"], threshold: number, frame: FrameName): Promise<Shape> {
  const voxels = (mesh.report.image?.size ?? []).reduce((product, count) => product * count, 1);
  if (voxels > MOST_VOXELS) throw new Error(words.scanTooLarge);
  const scan = await readNrrd(await (await service.ask("GET", `/v1/meshes/${mesh.id}/content`)).arrayBuffer());
  const shape = surfaceAt(scan, threshold);
  if (shape.triangles.length === 0) throw new Error(words.noBoneThere(String(threshold)));
  return { ...shape, points_mm: inFrame({ ...shape, space: SPACES[scan.space] }, frame) };
}

/** `changed` is handed the osteotomy whenever it changes: the document of it, or nothing where no cut is chosen. */
export function cutEditor(app: App, bone: Shape, frame: FrameName, changed: (osteotomy: Documents["OsteotomyDocument"] | undefined) => void): { element: HTMLElement; leave: Leave } {
  const editor = new CutEditor(app, bone, frame, changed);
  return { element: editor.element, leave: () => editor.leave() };
}

class CutEditor {
  readonly element: HTMLElement;
  private readonly scene: Scene;
  private readonly screen = make("div", { className: "screen" });
  private readonly operations = new Set<Operation>();
  private cuts: Cut[] = [];
  private readonly seeds: Seeds = { maxilla: [], mandible: [] };
  private aim: Aim;
  private readonly list = make("div", { className: "stack wide" });
  private readonly marked = make("div", { className: "stack" });
  private readonly told = make("p", { className: "told", role: "status" });
  private readonly box: [Triple, Triple];
  private dragged: Cut | undefined;
  private pressed: [number, number] = [0, 0];

  constructor(private readonly app: App, private readonly bone: Shape, private readonly frame: FrameName, private readonly changed: (osteotomy: Documents["OsteotomyDocument"] | undefined) => void) {
    const { words } = app;
    this.scene = new Scene(this.screen, words.boneLabel);
    this.scene.orient(frame);
    this.scene.showSkin(bone, hex(BONE));
    this.scene.turnable(true);
    this.box = boxOf(bone.points_mm);
    const views = Object.keys(VIEWS).map((key) => button(key, () => this.scene.view(key), { title: words.view[key]!, aria: { label: `${key}: ${words.view[key]}` } }));
    const chosen = OPERATIONS.map((operation) => {
      const input = make("input", { type: "checkbox" });
      input.addEventListener("change", () => this.choose(operation, input.checked));
      return make("label", { className: "check" }, input, words.operation[operation]);
    });
    this.element = make("div", { className: "cuts" },
      make("div", { className: "viewport" }, make("div", { className: "tools" }, make("div", { className: "row views", role: "group", aria: { label: words.views } }, ...views)), this.screen),
      make("div", { className: "stack wide" }, make("p", { className: "fine" }, words.cutsHint), ...chosen, this.told, this.list, this.marked));
    this.listen();
    // It has a size once it is in the document.
    requestAnimationFrame(() => this.scene.view("4"));
  }

  leave(): void {
    this.scene.leave();
  }

  private choose(operation: Operation, on: boolean): void {
    if (on) this.operations.add(operation); else this.operations.delete(operation);
    const known = new Map(this.cuts.map((cut) => [cut.name, cut]));
    this.cuts = OPERATIONS.filter((one) => this.operations.has(one)).flatMap((one) => planned(one, this.box, this.frame)).map((cut) => known.get(cut.name) ?? cut);
    this.aim = undefined;
    this.drawList();
    this.drawSeeds();
    this.draw();
  }

  private drawList(): void {
    const { words } = this.app;
    this.list.replaceChildren(...this.cuts.map((cut, at) => {
      const name = words.cut[cut.name] ?? cut.name;
      const field = (label: string, value: () => number, set: (value: number) => void, unit: string, step: string) => {
        const input = make("input", { type: "number", step, value: String(value()), aria: { label: `${name}: ${label}, ${unit}` } });
        input.addEventListener("input", () => { if (Number.isFinite(input.valueAsNumber)) { set(input.valueAsNumber); this.draw(); } });
        input.addEventListener("refresh", () => { input.value = String(value()); });
        return make("label", { className: "field" }, make("span", {}, label), input, make("span", { className: "unit" }, unit));
      };
      const place = ([words.forward, words.up, words.left] as const).map((label, axis) => field(this.frame === "unspecified" ? [words.axes.forward, words.axes.up, words.axes.left][axis]! : label,
        () => Number(inWords(cut.point_mm, this.frame)[axis]!.toFixed(1)),
        (value) => { const now = inWords(cut.point_mm, this.frame); now[axis] = value; cut.point_mm = inAxes(now, this.frame); }, "mm", "0.5"));
      const angles = [words.pitch, cut.facing === "up" ? words.roll : words.yaw].map((label, angle) =>
        field(label, () => cut.angles[angle]!, (value) => { cut.angles[angle] = value; }, "°", "1"));
      const kerf = field(words.kerf, () => cut.kerf_mm, (value) => { cut.kerf_mm = Math.min(Math.max(value, 0), 10); }, "mm", "0.1");
      const swatch = make("span", { className: "swatch", aria: { hidden: "true" } });
      swatch.style.backgroundColor = SERIES[at % SERIES.length]!;
      return make("fieldset", { className: "cut", data: { cut: cut.name } }, make("legend", {}, swatch, ` ${name}`), ...place, ...angles, kerf,
        button(words.threePoints, () => this.take({ of: "points", cut, points: [] }), { aria: { label: `${name}: ${words.threePoints}` } }));
    }));
  }

  private drawSeeds(): void {
    const { words } = this.app;
    this.marked.replaceChildren(...JAWS.filter(({ operation }) => this.operations.has(operation)).map(({ name }) => {
      const seeds = this.seeds[name];
      return make("div", { className: "row", data: { jaw: name } }, button(words.markJaw(words.jaw[name]), () => this.take({ of: "seed", jaw: name })),
        make("span", { className: seeds.length === 0 ? "warned" : "fine" }, seeds.length === 0 ? words.noSeed : seeds.map((seed) => inWords(seed, this.frame).map((value) => figure(value, 0)).join(", ")).join("; ")),
        seeds.length > 0 && button("×", () => { this.seeds[name] = []; this.drawSeeds(); this.draw(); }, { aria: { label: `${words.remove} ${words.jaw[name]}` } }));
    }));
  }

  private take(aim: Aim): void {
    this.aim = aim;
    this.say();
    this.scene.canvas.focus();
  }

  private say(): void {
    const { aim, app: { words } } = this;
    this.told.textContent = aim === undefined ? "" : aim.of === "seed" ? words.clickJaw(words.jaw[aim.jaw]) : words.clickPoint(words.cut[aim.cut.name] ?? aim.cut.name, aim.points.length + 1);
  }

  private listen(): void {
    const { canvas } = this.scene;
    canvas.addEventListener("pointerdown", (event) => {
      this.pressed = [event.clientX, event.clientY];
      if (this.aim !== undefined || event.button !== 0) return;
      this.dragged = this.cuts.find((cut) => { const [x, y] = this.scene.seenAt(cut.point_mm); return Math.hypot(event.clientX - x, event.clientY - y) < REACH; });
      if (this.dragged === undefined) return;
      this.scene.turnable(false);
      canvas.setPointerCapture(event.pointerId);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      const { dragged } = this;
      if (dragged === undefined) return;
      dragged.point_mm = this.scene.drag(event, dragged.point_mm).map((value) => Number(value.toFixed(1)) || 0) as Triple;
      this.draw();
    });
    canvas.addEventListener("pointerup", (event) => {
      const was = this.dragged;
      this.dragged = undefined;
      this.scene.turnable(true);
      if (was === undefined && Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) <= CLICK) this.hit(this.scene.pick(event)?.point_mm);
    });
    canvas.addEventListener("keydown", (event) => {
      if (VIEWS[event.key] !== undefined) this.scene.view(event.key);
      else if (event.key === "Enter") this.hit(this.scene.middle()?.point_mm);
      else if (event.key === "Escape") { this.aim = undefined; this.say(); }
      else this.scene.turnByKey(event);
    });
  }

  /** A place on the bone, by a click or in the middle of the view. */
  private hit(point: Triple | undefined): void {
    const { aim, app: { words }, frame } = this;
    if (aim === undefined) return;
    if (point === undefined) { announce(words.noBoneHere); return; }
    const at = point.map((value) => Number(value.toFixed(1)) || 0) as Triple;
    if (aim.of === "seed") {
      this.seeds[aim.jaw] = [...this.seeds[aim.jaw], at];
      this.aim = undefined;
      this.drawSeeds();
    } else if (aim.points.push(at) === 3) {
      const found = throughPoints(aim.points as [Triple, Triple, Triple], aim.cut.facing, frame);
      if (found !== undefined) Object.assign(aim.cut, found);
      this.aim = undefined;
      if (found === undefined) announce(words.pointsOnLine);
    }
    this.say();
    this.draw();
  }

  /** Planes, handles and seeds, numbers and the document. */
  private draw(): void {
    const { scene, cuts, aim, seeds, frame } = this;
    scene.saw(cuts.map((cut, at) => ({ corners_mm: this.corners(cut), line_mm: this.line(cut), colour: hex(SERIES[at % SERIES.length]!) })));
    const dots = (points: Triple[], colour: string) => points.map((at_mm) => ({ at_mm, colour: hex(colour) }));
    const handles = cuts.map((cut, at) => ({ at_mm: cut.point_mm, colour: hex(SERIES[at % SERIES.length]!), radius_mm: HANDLE * this.longest }));
    scene.mark([...handles, ...dots(aim?.of === "points" ? aim.points : [], INK), ...dots([...seeds.maxilla, ...seeds.mandible], PAPER)]);
    for (const input of this.list.querySelectorAll("input")) if (input !== document.activeElement) input.dispatchEvent(new Event("refresh"));
    this.changed(osteotomy(this.operations, cuts, seeds, frame));
  }

  /** Of the box around the bone, in mm. */
  private get longest(): number {
    return Math.max(...this.box[1].map((high, axis) => high - this.box[0][axis]!));
  }

  private line(cut: Cut): number[][] {
    const normal = normalOf(cut, this.frame);
    return section(this.bone.points_mm, this.bone.triangles, normal, dot(normal, cut.point_mm) + 1e-4);
  }

  private corners(cut: Cut): [Triple, Triple, Triple, Triple] {
    const normal = normalOf(cut, this.frame);
    const least = [0, 1, 2].reduce((one, other) => (Math.abs(normal[other]!) < Math.abs(normal[one]!) ? other : one));
    const along = normal.map((value, axis) => (axis === least ? 1 : 0) - value * normal[least]!) as Triple;
    const length = Math.hypot(...along);
    const u = along.map((value) => value / length) as Triple;
    const v: Triple = [normal[1] * u[2] - normal[2] * u[1], normal[2] * u[0] - normal[0] * u[2], normal[0] * u[1] - normal[1] * u[0]];
    const half = SIDE * this.longest;
    return ([[-1, -1], [1, -1], [1, 1], [-1, 1]] as const).map(([a, b]) => cut.point_mm.map((value, axis) => value + half * (a * u[axis]! + b * v[axis]!)) as Triple) as [Triple, Triple, Triple, Triple];
  }
}

const dot = (a: Triple, b: Triple) => a.reduce((sum, value, axis) => sum + value * b[axis]!, 0);

function boxOf(points: Float32Array): [Triple, Triple] {
  const [low, high]: [Triple, Triple] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  points.forEach((value, at) => { low[at % 3] = Math.min(low[at % 3]!, value); high[at % 3] = Math.max(high[at % 3]!, value); });
  return [low, high];
}
