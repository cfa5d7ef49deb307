// A set that is painted: a brush over the faces of the boundary, with undo, that the case document selects as nodes on a surface.
import { announce, refusal, type App } from "../app.js";
import { button, choice, make, select } from "../dom.js";
import { count, figure } from "../figures.js";
import type { Opened } from "../loading.js";
import { Canvas, plyOf } from "../painting.js";
import { hex, POINTED } from "../palette.js";
import { History } from "../plan.js";
import type { PaintedSet, Role } from "../roles.js";
import type { Hit } from "../scene.js";
import type { Workbench } from "../workbench.js";

type Mode = "turn" | "paint" | "rub";
const COLOUR = hex(POINTED);
/** Nodes of painted faces lie on them but for rounding. */
const WITHIN_MM = 0.01;
const ROLES: Role[] = ["region", "skin", "segment", "fixed", "sliding"];
const RADIUS = { least: 1, most: 30, first: 6 };
/** The brush is set down so often between two places of the pointer, in pixels. */
const STEP = 6;
const MOST_STEPS = 12;

/** `taken` says whether a name is that of another part; `made` is handed the set. */
export class Painter {
  readonly element: HTMLElement;
  private readonly canvas: Canvas;
  private faces = new Set<number>();
  private readonly history = new History<number[]>([]);
  private mode: Mode = "turn";
  private radius = RADIUS.first;
  private role: Role = "region";
  private last: PointerEvent | undefined;
  private next: PointerEvent | undefined;
  private readonly told = make("p", { className: "told", role: "status" });
  private readonly said = make("div", { role: "status" });
  private readonly name = make("input", { type: "text", maxLength: 60 });
  private readonly undoButton = button("", () => this.step("undo"));
  private readonly redoButton = button("", () => this.step("redo"));
  private readonly add: HTMLButtonElement;

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench,
    private readonly taken: (name: string) => boolean, private readonly made: (set: PaintedSet) => void) {
    const { words } = app;
    this.canvas = new Canvas(bench.scene.resting);
    this.add = button(words.addPainted, () => void this.finish(), { className: "primary" });
    this.element = make("details", { className: "paint" }, make("summary", {}, words.paint), this.controls());
    this.element.addEventListener("toggle", () => { if (!(this.element as HTMLDetailsElement).open) this.turnTo("turn"); });
    this.listen();
    this.draw();
  }

  /** Whether a click is the brush's. */
  get isPainting(): boolean {
    return this.mode !== "turn";
  }

  private controls(): HTMLElement {
    const { words } = this.app;
    this.name.setAttribute("aria-label", words.setName);
    this.undoButton.textContent = `↶ ${words.undo}`;
    this.redoButton.textContent = `↷ ${words.redo}`;
    const size = make("input", { type: "range", min: String(RADIUS.least), max: String(RADIUS.most), step: "0.5", value: String(this.radius), aria: { label: words.brushMm } });
    const shown = make("span", { className: "unit" }, `${this.radius} mm`);
    size.addEventListener("input", () => { this.radius = size.valueAsNumber; shown.textContent = `${this.radius} mm`; });
    const modes = choice(words.brush, [["turn", words.turning], ["paint", words.painting], ["rub", words.rubbing]] as const, "turn", (mode) => this.turnTo(mode));
    const role = select(words.roleOf, ROLES.map((one) => [one, words.role[one]] as const), this.role, (one) => { this.role = one as Role; });
    return make("div", { className: "stack" }, make("p", { className: "fine" }, words.paintHint), modes,
      make("label", { className: "brush" }, make("span", {}, words.brushMm), size, shown),
      make("div", { className: "row" }, button(words.paintMiddle, () => this.middle()), this.undoButton, this.redoButton, button(words.clearPaint, () => this.set([]))),
      this.told, make("label", { className: "field" }, make("span", {}, words.setName), this.name), role, this.add, this.said);
  }

  private turnTo(mode: Mode): void {
    this.mode = mode;
    this.bench.scene.turnable(mode === "turn");
    for (const input of this.element.querySelectorAll<HTMLInputElement>(".choice input")) input.checked = input.value === mode;
  }

  private listen(): void {
    const { canvas } = this.bench.scene;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.isPainting || event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.last = event;
      this.brush(this.bench.scene.pick(event));
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.last === undefined) return;
      if (this.next === undefined) requestAnimationFrame(() => this.stroke());
      this.next = event;
    });
    const end = () => {
      if (this.last === undefined) return;
      this.stroke();
      this.last = undefined;
      this.noted();
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && this.isPainting) this.middle();
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
      event.preventDefault();
      this.step(event.shiftKey ? "redo" : "undo");
    });
  }

  /** Along the way from where the pointer was. */
  private stroke(): void {
    const { last, next } = this;
    this.next = undefined;
    if (last === undefined || next === undefined) return;
    const [dx, dy] = [next.clientX - last.clientX, next.clientY - last.clientY];
    const count = Math.min(Math.max(Math.ceil(Math.hypot(dx, dy) / STEP), 1), MOST_STEPS);
    for (let at = 1; at <= count; at += 1) {
      const place = { clientX: last.clientX + (dx * at) / count, clientY: last.clientY + (dy * at) / count };
      this.brush(this.bench.scene.pick(new MouseEvent("pointermove", place)), at === count);
    }
    this.last = next;
  }

  private brush(hit: Hit | undefined, shown = true): void {
    if (hit !== undefined) {
      for (const face of this.canvas.under(hit.point_mm, hit.face, this.radius)) if (this.mode === "rub") this.faces.delete(face); else this.faces.add(face);
    }
    if (shown) this.draw();
  }

  private middle(): void {
    const hit = this.bench.scene.middle();
    if (hit === undefined) { announce(this.app.words.noSkinThere); return; }
    this.brush(hit);
    this.noted();
  }

  private noted(): void {
    this.history.note([...this.faces].sort((a, b) => a - b));
    this.draw();
    announce(this.told.textContent ?? "");
  }

  private set(faces: number[]): void {
    this.faces = new Set(faces);
    this.noted();
  }

  private step(which: "undo" | "redo"): void {
    const faces = this.history[which]();
    if (faces === undefined) return;
    this.faces = new Set(faces);
    this.draw();
    announce(this.told.textContent ?? "");
  }

  private draw(): void {
    const { app: { words }, faces, canvas, bench } = this;
    bench.scene.cover(faces.size === 0 ? undefined : canvas.part(faces), COLOUR);
    this.told.textContent = words.painted(count(faces.size), figure(canvas.area(faces) / 100, 1));
    this.undoButton.disabled = !this.history.canUndo;
    this.redoButton.disabled = !this.history.canRedo;
    this.add.disabled = faces.size === 0;
  }

  /** Stores the faces as a surface, on which the nodes of the set lie. */
  private async finish(): Promise<void> {
    const { app: { service, words }, opened, canvas, faces, role } = this;
    const name = this.name.value.trim();
    if (name === "" || this.taken(name)) {
      this.said.replaceChildren(make("p", { className: "refusal", role: "alert" }, name === "" ? words.nameAsked : words.nameTaken(name)));
      this.name.focus();
      return;
    }
    this.add.disabled = true;
    try {
      const strangers = canvas.strangers(faces, WITHIN_MM);
      const file = new File([plyOf(canvas.part(faces))], `${name}.ply`);
      const surface = await service.upload(file, "mm", opened.frame);
      this.made({ name, role, selection: { surface, within_mm: WITHIN_MM } });
      this.said.replaceChildren(...(strangers === 0 ? [] : [make("p", { className: "warned" }, words.strangers(strangers))]));
      this.name.value = "";
      this.set([]);
      this.turnTo("turn");
    } catch (error) {
      this.said.replaceChildren(refusal(error, words));
      this.draw();
    }
  }
}
