// Planning: segments move by sliders, and the skin follows within a frame.
import type { Documents, Triple } from "../api.js";
import { announce, refusal, warnings, type App, type Leave } from "../app.js";
import { button, make, select } from "../dom.js";
import { movement, still, type Motion, type MotionName } from "../frame.js";
import { addBones, buildResponse, openCase, responseOf, showBoundary, type LoadedResponse, type Opened } from "../loading.js";
import { matrix } from "../matrix.js";
import { INNER_KINDS, innerFactors, type InnerKind } from "../columns.js";
import { atRest, document as planDocument, fromDocument, History, PLAN_STATE, planState, read, readPivots, turningPivots, withInner, written, type Pivots, type Plan } from "../plan.js";
import { coefficients, lengths, SkinSum } from "../response.js";
import { address, note } from "../route.js";
import { regionsOf } from "../tissue.js";
import { mm } from "../figures.js";
import { Workbench } from "../workbench.js";
import { crumbs } from "./crumbs.js";
import { Further } from "./further.js";
import { innerSliders, type InnerSliders } from "./inner.js";
import { movements, told, type Movements } from "./movements.js";
import { SavedPlans, type Readable } from "./plans.js";
import { placesOf } from "./places.js";
import { SecondOrder, type OfCase } from "./second.js";
import { drawTrust, reserveTrust } from "./trust.js";
import { appliedLines } from "./trusted.js";

/** The choice of a point of rotation that is neither the centre nor a landmark. */
const ELSEWHERE = " elsewhere";
/** The service is asked what is left out once nothing has moved for so long, in ms. */
const IDLE = 350;
const MOST_MEASURES = 512;
/** A slider may differ from the service by so much, in mm: f32 columns, and their sum in another order. */
const AGREED_MM = 1e-4;
/** An answer as most are, for the room that it takes. */
const NOTHING_YET = { order: 1, within_linear_range: true, nonlinearity_estimate_mm: 0, warnings: [] } as unknown as Documents["AppliedDocument"];

export async function planPage(app: App): Promise<Leave> {
  const opened = await openCase(app.service, app.route.path[1]!);
  const bench = new Workbench(app, crumbs(app.words, opened.id, opened.name, "plan"));
  bench.scene.orient(opened.frame);
  const planning = new Planning(app, opened, bench);
  try {
    await planning.start();
  } catch (error) {
    bench.refuse(error);
    if (isKeyAsked(error)) { planning.leave(); bench.leave(); throw error; }
  }
  return () => { planning.leave(); bench.leave(); };
}

const isKeyAsked = (error: unknown) => (error as { problem?: { status?: number } }).problem?.status === 401;

class Planning {
  private loaded!: LoadedResponse;
  private sum!: SkinSum;
  /** How far each node of the skin is from rest. */
  private moved_mm: Float32Array = new Float32Array();
  private plan: Plan = atRest([]);
  private pivots: Pivots = {};
  private history!: History<Plan>;
  private readonly controls = new Map<string, Movements>();
  private readonly undoButton = button("", () => this.step("undo"), { className: "icon" });
  private readonly redoButton = button("", () => this.step("redo"), { className: "icon" });
  private readonly told = make("div", { className: "told", role: "status" });
  private readonly warned = make("div");
  private readonly order: SecondOrder;
  private readonly segments = make("div", {});
  private inner: InnerSliders | undefined;
  private asking: ReturnType<typeof setTimeout> | undefined;
  private asked = 0;
  private ofCase: OfCase = "unknown";
  /** Draws the strip of the last answer: whether the response is that of the case is known later. */
  private strip: (() => void) | undefined;
  private model = "auto";
  private steps = 0;

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench) {
    this.order = new SecondOrder(app, opened, {
      ready: (loaded) => this.adopt(loaded), grow: (into) => void this.grow(into), judged: (ofCase) => { this.ofCase = ofCase; this.strip?.(); } });
  }

  leave(): void {
    clearTimeout(this.asking);
    this.order.leave();
  }

  async start(): Promise<void> {
    const { app, opened, bench } = this;
    const { words } = app;
    const bones = addBones(app.service, opened, bench.scene);
    reserveTrust(bench.strip, words, appliedLines(words, NOTHING_YET, { apart: 0, most: AGREED_MM }));
    await this.load();
    this.plan = this.known(read(planState(app.route.state), this.names));
    this.history = new History(this.plan);
    this.undoButton.textContent = `↶ ${words.undo}`;
    this.redoButton.textContent = `↷ ${words.redo}`;
    bench.section(words.plan,
      opened.frame === "unspecified" && make("p", { className: "warned" }, words.unspecifiedFrame),
      make("div", { className: "row" }, this.undoButton, this.redoButton, button(words.reset, () => this.set(atRest(this.names)))),
      this.told, this.segments, this.order.element);
    // Under the sliders: what comes and goes there moves none of them.
    bench.section(words.warnings, this.warned);
    this.drawSegments();
    bench.section(words.predict, this.prediction());
    const saved = new SavedPlans(app, opened, {
      now: () => planDocument(this.plan, this.pivots, opened.frame), load: (readable) => this.open(readable),
      read: (stored) => this.readable(stored), compare: (readable) => this.differenceTo(readable),
    });
    bench.section(words.savedPlans, saved.element);
    await saved.start(PLAN_STATE.some((name) => (app.route.state.get(name) ?? "") !== ""));
    bench.canvasKeys((event) => this.pressed(event));
    await bones;
    this.moveAll();
  }

  private get names(): string[] {
    return this.loaded.description.segments.map(({ name }) => name);
  }

  private async load(): Promise<void> {
    const { app, opened, bench } = this;
    const wait = make("div", { className: "wait" }, make("p", { className: "loading" }, app.words.loading));
    bench.panel.append(wait);
    let isWaiting = true;
    const face = async () => {
      await showBoundary(app.service, opened, bench);
      if (isWaiting) bench.start();
    };
    // Whoever waits sees the face at rest; without it they wait all the same.
    const shown: Promise<void>[] = [];
    this.loaded = await responseOf(app, opened.id, wait, () => { shown.push(face().catch(() => {})); });
    isWaiting = false;
    await Promise.all(shown);
    wait.remove();
    const centres = this.loaded.description.segments.map(({ name, centre_mm }) => [name, centre_mm as Triple] as const);
    this.pivots = { ...Object.fromEntries(centres), ...readPivots(planState(app.route.state)) };
    bench.scene.showSkin(this.loaded.rest);
    bench.start();
    this.summed();
  }

  /** Begins the sum of columns anew, at rest. */
  private summed(): void {
    const { app: { words }, bench, loaded, opened } = this;
    this.sum = new SkinSum(loaded.columns);
    this.moved_mm = new Float32Array(loaded.columns.nodes);
    bench.provenance = `case ${opened.id} · response ${loaded.description.job}`;
    bench.offer([
      { name: "displacement", label: words.displacement, scheme: "length", range_mm: 10, values: () => this.moved_mm },
      ...(this.sum.second_mm === undefined ? [] : [
        { name: "second", label: words.secondOrder, scheme: "length" as const, range_mm: 1, values: () => lengths(this.sum.second_mm!) },
        { name: "left", label: words.leftOutMap, scheme: "length" as const, range_mm: 1, values: () => {
          const { third_order_mm, third_order_coupling } = loaded.description.second_order!;
          return this.sum.leftOut_mm(third_order_mm, third_order_coupling);
        } }]),
    ]);
    // What the strip says is of the response before.
    this.strip = undefined;
    this.order.show(loaded);
  }

  /** Goes on with the same movements on a response of the same skin: nobody who moves a slider loses it. */
  private adopt(loaded: LoadedResponse): void {
    this.loaded = loaded;
    this.summed();
    this.moveAll();
  }

  /** The response anew with columns of growth. */
  private async grow(into: HTMLElement): Promise<void> {
    try {
      await buildResponse(this.app, this.opened.id, { growth: regionsOf(this.opened.document) }, into);
      const pivots = this.pivots;
      await this.load();
      this.pivots = pivots;
      this.drawSegments();
      this.moveAll();
    } catch (error) {
      into.append(refusal(error, this.app.words));
    }
  }

  private drawSegments(): void {
    const { words } = this.app;
    const landmarks = Object.entries(this.opened.document.landmarks ?? {});
    const open = this.app.route.state.get("segment");
    this.inner = innerSliders(words, this.loaded.columns.inner, this.plan.inner,
      { moving: (kind, name, value) => this.pulling(kind, name, value), moved: () => this.moved() });
    this.segments.replaceChildren(...this.names.map((name, at) => {
      const control = movements(words, name, this.opened.frame, this.plan.segments[name]!,
        (word, value) => this.moving(name, word, value), () => this.moved());
      this.controls.set(name, control);
      const centre = this.loaded.description.segments[at]!.centre_mm as Triple;
      const pivot = this.pivots[name]!;
      const isAt = (place: number[]) => place.every((value, axis) => Math.abs(value - pivot[axis]!) < 1e-3);
      // A plan that came from elsewhere may turn about any point: translations are those of that point.
      const elsewhere = landmarks.some(([, place]) => isAt(place)) || isAt(centre) ? []
        : [[ELSEWHERE, pivot.map((value) => value.toFixed(1)).join(", ") + " mm"] as const];
      const [chosen = elsewhere.length > 0 ? ELSEWHERE : ""] = isAt(centre) ? [] : landmarks.find(([, place]) => isAt(place)) ?? [];
      const about = select(words.turnsAbout, [["", words.itsCentre], ...elsewhere, ...landmarks.map(([mark]) => [mark, mark] as const)], chosen, (mark) => {
        this.pivots[name] = mark === "" ? centre : mark === ELSEWHERE ? pivot : landmarks.find(([called]) => called === mark)![1] as Triple;
        this.moveOne(name);
        this.after();
        note(written(this.plan, this.pivots));
      });
      return make("details", { className: "segment", open: open === null ? at < 2 : open === name },
        make("summary", {}, name), control.element, about);
    }), ...(this.inner === undefined ? [] : [this.inner.element]));
  }

  /** Without growth and muscles that the response has no columns of; which these were is said. */
  private known(plan: Plan): Plan {
    const missing = this.missing(plan);
    if (missing.length === 0) return plan;
    const names = missing.map(([, name]) => name).join(", ");
    this.bench.panel.prepend(make("div", { className: "refusal", role: "alert" }, this.app.words.notInResponse(names)));
    return missing.reduce((known, [kind, name]) => withInner(known, kind, name, 0), plan);
  }

  private missing(plan: Plan): (readonly [InnerKind, string])[] {
    const { columns } = this.loaded;
    return INNER_KINDS.flatMap((kind) => Object.keys(plan.inner[kind])
      .filter((name) => !columns.inner.some((column) => column.kind === kind && column.name === name)).map((name) => [kind, name] as const));
  }

  /** What the sliders can show of a plan of the service, about the points that it names. */
  private readable(stored: Documents["PlanDocument"]): Readable | undefined {
    const pivots = { ...this.pivots, ...turningPivots(stored, this.opened.frame) };
    const plan = fromDocument(stored, pivots, this.opened.frame);
    return plan !== undefined && this.missing(plan).length === 0 ? { plan, pivots } : undefined;
  }

  private open({ plan, pivots }: Readable): void {
    this.pivots = pivots;
    this.plan = plan;
    this.drawSegments();
    this.set(plan);
  }

  /** A muscle or growth is at another amount. */
  private pulling(kind: InnerKind, name: string, value: number): void {
    const begin = performance.now();
    this.plan = withInner(this.plan, kind, name, value);
    this.sum.pull(innerFactors(this.loaded.columns.inner, this.plan.inner));
    this.bench.scene.moveSkin(this.sum.displacement_mm);
    this.after();
    this.timed(begin);
  }

  private moving(name: string, word: MotionName, value: number): void {
    const begin = performance.now();
    const motion: Motion = { ...(this.plan.segments[name] ?? still()), [word]: value };
    this.plan = { ...this.plan, segments: { ...this.plan.segments, [name]: motion } };
    this.moveOne(name);
    this.after();
    this.timed(begin);
  }

  /** For whoever wants to know what a step of a slider takes; the browser would keep all of them. */
  private timed(start: number): void {
    performance.measure("slider", { start });
    this.steps += 1;
    if (this.steps % 64 === 0 && performance.getEntriesByName("slider").length > MOST_MEASURES) performance.clearMeasures("slider");
  }

  /** A slider was let go. */
  private moved(): void {
    this.history.note(this.plan);
    note(written(this.plan, this.pivots));
    this.drawSteps();
    announce(this.told.textContent ?? "");
  }

  private set(plan: Plan): void {
    this.plan = this.known(plan);
    for (const [name, control] of this.controls) control.show(this.plan.segments[name] ?? still());
    this.inner?.show(this.plan.inner);
    this.moveAll();
    this.moved();
  }

  private step(which: "undo" | "redo"): void {
    const plan = this.history[which]();
    if (plan === undefined) return;
    this.set(plan);
  }

  private moveAll(): void {
    for (const name of this.names) this.moveOne(name, false);
    this.sum.pull(innerFactors(this.loaded.columns.inner, this.plan.inner));
    this.bench.scene.moveSkin(this.sum.displacement_mm);
    this.after();
    this.drawSteps();
  }

  /** One segment and the skin with it. */
  private moveOne(name: string, draw = true): void {
    const motion = this.plan.segments[name] ?? still();
    const pivot_mm = this.pivots[name]!;
    const at = this.names.indexOf(name);
    const centre_mm = this.loaded.description.segments[at]!.centre_mm as Triple;
    this.sum.move(at, coefficients({ ...movement(motion, this.opened.frame), pivot_mm, centre_mm }));
    this.bench.scene.moveBone(name, matrix(motion, pivot_mm, this.opened.frame));
    if (draw) this.bench.scene.moveSkin(this.sum.displacement_mm);
  }

  private after(): void {
    const { words } = this.app;
    this.moved_mm = lengths(this.sum.displacement_mm);
    let most = 0;
    for (const one of this.moved_mm) if (one > most) most = one;
    this.told.textContent = `${words.movesMost} ${mm(most)} mm ${words.atMost}`;
    this.bench.repaint();
    this.bench.caption.textContent = `${this.opened.name} · ${told(this.plan, words, this.opened.frame)}`;
    clearTimeout(this.asking);
    this.asking = setTimeout(() => void this.ask(), IDLE);
  }

  /** What the answer leaves out, and that the service says the same. */
  private async ask(): Promise<void> {
    const { app: { service, words }, bench } = this;
    const turn = (this.asked += 1);
    const here = this.sum.displacement_mm.slice();
    const plan = planDocument(this.plan, this.pivots, this.opened.frame);
    try {
      const path = `/v1/cases/${this.opened.id}/response/apply?job=${this.loaded.description.job}`;
      const answer = await service.post<Documents["AppliedDocument"]>(path, { plan });
      if (turn !== this.asked) return;
      const apart = here.reduce((most, value, at) => Math.max(most, Math.abs(value - answer.displacement_mm[Math.floor(at / 3)]![at % 3]!)), 0);
      // Whoever has not moved anything yet knows that.
      const own = answer.warnings.filter(({ code }) => code !== "nothing-moves");
      // What the case was warned of, its meshing too, is about each of its plans.
      const ofCase = (this.opened.view.check?.warnings ?? []).filter((one) => !own.some(({ code, detail }) => code === one.code && detail === one.detail));
      const told = [...ofCase, ...own];
      this.strip = () => drawTrust(bench.strip, words, appliedLines(words, { ...answer, warnings: told }, { apart, most: AGREED_MM, ofCase: this.ofCase }));
      this.strip();
      this.warned.replaceChildren(warnings(told, words, placesOf(words, this.opened, this.bench.scene, () => ({}))));
      bench.strip.dataset.apart = String(apart);
    } catch (error) {
      if (turn === this.asked) { this.strip = undefined; bench.strip.replaceChildren(); this.warned.replaceChildren(refusal(error, words)); };
    }
  }

  private prediction(): HTMLElement {
    const { words, service } = this.app;
    const models = [["auto", words.auto], ["fem_linear", "fem_linear"], ["fem_nonlinear", "fem_nonlinear"]] as const;
    const said = make("div");
    const method = select(words.method, models, this.model, (value) => { this.model = value; });
    // What was learned is learned of one method.
    const further = new Further(this.app, this.opened.document, () => {
      if (this.model !== "auto") return;
      this.model = "fem_linear";
      method.querySelector("select")!.value = this.model;
    });
    const predict = button(words.predict, () => {
      predict.disabled = true;
      const { outputs, ...asked } = further.asked;
      const spec = {
        kind: "predict", case: this.opened.id, plan: planDocument(this.plan, this.pivots, this.opened.frame),
        outputs: ["skin.vtp", "skin.glb", ...outputs], ...asked, ...(this.model === "auto" ? {} : { method: this.model }),
      };
      service.post<Documents["StatusInfo"]>("/v1/jobs", spec).then(
        ({ id }) => { location.hash = address(["job", id], written(this.plan, this.pivots)); },
        (error: unknown) => { predict.disabled = false; said.replaceChildren(refusal(error, words)); });
    }, { className: "primary" });
    return make("div", { className: "stack wide" }, method, further.element,
      make("div", { className: "row" }, predict), said);
  }

  /** The skin of another plan as an overlay, and how far it is from this one. */
  private differenceTo(readable: Readable | undefined): string {
    if (readable === undefined) { this.bench.scene.overlay(undefined); return ""; }
    const { plan, pivots } = readable;
    const other = new SkinSum(this.loaded.columns);
    this.names.forEach((name, at) => {
      const centre_mm = this.loaded.description.segments[at]!.centre_mm as Triple;
      other.move(at, coefficients({ ...movement(plan.segments[name] ?? still(), this.opened.frame), pivot_mm: pivots[name]!, centre_mm }));
    });
    other.pull(innerFactors(this.loaded.columns.inner, plan.inner));
    const { rest } = this.loaded;
    this.bench.scene.overlay({ ...rest, points_mm: rest.points_mm.map((value, at) => value + other.displacement_mm[at]!) });
    const apart = lengths(other.displacement_mm.map((value, at) => value - this.sum.displacement_mm[at]!));
    const mean = apart.reduce((sum, value) => sum + value, 0) / apart.length;
    return `${this.app.words.difference}: ${this.app.words.mean} ${mm(mean)} mm, ${this.app.words.max} ${mm(Math.max(...apart))} mm`;
  }

  private drawSteps(): void {
    this.undoButton.disabled = !this.history.canUndo;
    this.redoButton.disabled = !this.history.canRedo;
  }

  private pressed(event: KeyboardEvent): void {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    this.step(event.shiftKey ? "redo" : "undo");
  }
}
