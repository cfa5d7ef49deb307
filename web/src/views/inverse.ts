// Planning backwards: where the skin is wanted is dragged or stated, and the service finds the movement that comes nearest.
import type { Documents, Triple } from "../api.js";
import { announce, refusal, type App, type Leave } from "../app.js";
import { button, choice, make, select } from "../dom.js";
import { inAxes, inWords, movement, still, TRANSLATIONS, type FrameName, type MotionName } from "../frame.js";
import { addBones, openCase, restingSkin, type Opened, type RestingSkin } from "../loading.js";
import { mm } from "../figures.js";
import { ACCENT, hex, POINTED } from "../palette.js";
import { address, note } from "../route.js";
import { beyondBounds, readBounds, readTargets, USUAL_SIGMA_MM, writeBounds, writeTargets, type Bounds, type Target } from "../targets.js";
import type { Hit } from "../scene.js";
import { Workbench } from "../workbench.js";
import { readTissue, regionsOf, writeTissue, type TissueBounds } from "../tissue.js";
import { crumbs } from "./crumbs.js";
import { targetTags } from "./found.js";
import { wayFor, wordFor } from "./movements.js";
import { tissueFields } from "./tissue.js";

const COLOUR = hex(POINTED);
const STARTING_BOUND_MM = 10;
/** A pull this near to a target or a landmark takes that; landmarks further from the skin than this are of bone. */
const GRIP_MM = 4;
/** What is further than this from the skin under the pointer is not meant by it. */
const BEHIND_MM = 15;

export async function inversePage(app: App): Promise<Leave> {
  const opened = await openCase(app.service, app.route.path[1]!);
  const bench = new Workbench(app, crumbs(app.words, opened.id, opened.name, "inverse"));
  bench.scene.orient(opened.frame);
  const wait = make("div", { className: "wait" }, make("p", { className: "loading" }, app.words.loading));
  bench.panel.append(wait);
  try {
    const loaded = await restingSkin(app, opened.id, wait);
    wait.remove();
    bench.scene.showSkin(loaded.rest);
    bench.offer([]);
    bench.start();
    new Inverse(app, opened, bench, loaded).start();
    await addBones(app.service, opened, bench.scene);
  } catch (error) {
    bench.refuse(error);
  }
  return () => bench.leave();
}

class Inverse {
  private readonly targets: Target[];
  /** How many points of the skin were named. */
  private points: number;
  private readonly bounds: Bounds;
  /** Those to begin with. */
  private readonly usual: Bounds;
  /** Growth and constants that are looked for too. */
  private readonly tissue: TissueBounds;
  private readonly boundFields = make("div", {});
  private readonly list = make("div", {});
  private readonly said = make("div", { role: "status" });
  /** On the skin, by their names. */
  private readonly landmarks: [string, Triple][];
  private isPulling = false;
  /** Directions of targets that the bounds forbid. */
  private readonly forbidden = make("div", { role: "status" });

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench, private readonly loaded: RestingSkin) {
    const held = { forward: STARTING_BOUND_MM, up: STARTING_BOUND_MM, left: 0, pitch: 0, roll: 0, yaw: 0 };
    this.usual = Object.fromEntries(loaded.description.segments.map(({ name }) => [name, { ...held }]));
    const { state } = app.route;
    this.bounds = readBounds(state.get("bounds") ?? "", this.usual);
    this.tissue = readTissue(state.get("tissue") ?? "", regionsOf(opened.document));
    this.targets = readTargets(state.get("targets") ?? "", (opened.document.landmarks ?? {}) as Record<string, Triple>, (number) => `${app.words.point} ${number}`);
    this.landmarks = (Object.entries(opened.document.landmarks ?? {}) as [string, Triple][]).filter(([, at_mm]) => this.isOnSkin(at_mm));
    this.points = this.targets.filter(({ landmark }) => landmark === undefined).length;
  }

  start(): void {
    const { app: { words }, bench, opened } = this;
    const marks = Object.keys(opened.document.landmarks ?? {});
    const add = select(words.addLandmark, [["", "–"], ...marks.map((mark) => [mark, mark] as const)], "", (mark) => {
      if (mark !== "") this.add(ofLandmark(mark, opened.document.landmarks![mark] as Triple));
    });
    const pulling = choice(words.dragPoint, [["turn", words.turning], ["pull", words.pulling]] as const, "turn",
      (value) => { this.isPulling = value === "pull"; bench.scene.turnable(!this.isPulling); this.marks(); });
    bench.section(words.targets, make("p", {}, words.inverseWhy), pulling, make("p", { className: "fine" }, words.dragHint),
      make("div", { className: "row" }, add, button(words.addPoint, () => this.addMiddle())), this.list);
    bench.section(words.bounds, this.boundFields);
    bench.section(words.tissueSection, make("p", { className: "fine" }, words.tissueWhy), tissueFields(words, opened.document, this.tissue, () => this.warn()));
    bench.section(words.find, this.forbidden, button(words.find, () => void this.find(), { className: "primary" }), this.said);
    this.drawBounds();
    this.draw();
    this.dragging();
  }

  private add(target: Target): void {
    this.targets.push(target);
    this.draw();
  }

  /** Pulling at the skin makes a target where it was let go. */
  private dragging(): void {
    const { canvas } = this.bench.scene;
    let pulled: Target | undefined;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.isPulling) return;
      const hit = this.bench.scene.pick(event);
      if (hit === undefined) return;
      canvas.setPointerCapture(event.pointerId);
      pulled = this.targetAt(hit, event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (pulled === undefined) return;
      const to = this.bench.scene.drag(event, pulled.at_mm);
      pulled.by = inWords(to.map((value, axis) => value - pulled!.at_mm[axis]!) as Triple, this.opened.frame)
        .map((value) => Number(value.toFixed(1))) as Triple;
      this.marks();
    });
    const letGo = () => {
      if (pulled !== undefined) this.draw();
      pulled = undefined;
    };
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, letGo);
  }

  /** The target at a point of the skin: the nearest that is there already, one of a landmark, or a new one. */
  private targetAt({ node, point_mm }: Hit, event?: PointerEvent): Target {
    // As it is seen: beside an outline skin goes away from a mark at once. What lies behind the head is not meant.
    const away = (at_mm: Triple) => (event === undefined ? apart(at_mm, point_mm)
      : apart(at_mm, point_mm) < BEHIND_MM ? apart(this.bench.scene.drag(event, at_mm), at_mm) : Infinity);
    const near = <Place>(places: Place[], of: (place: Place) => Triple): Place | undefined => places
      .map((place) => [away(of(place)), place] as const).filter(([distance]) => distance < GRIP_MM).sort(([one], [other]) => one - other)[0]?.[1];
    const known = near(this.targets, (target) => target.at_mm);
    const mark = near(this.landmarks, ([, place]) => place);
    if (known !== undefined && (mark === undefined || away(known.at_mm) <= away(mark[1]))) return known;
    if (mark === undefined) this.points += 1;
    const target: Target = mark === undefined ? { label: `${this.app.words.point} ${this.points}`, at_mm: this.restAt(node), by: [0, 0, null], sigma_mm: USUAL_SIGMA_MM } : ofLandmark(...mark);
    this.targets.push(target);
    return target;
  }

  private isOnSkin(at_mm: Triple): boolean {
    const { points_mm } = this.loaded.rest;
    for (let node = 0; node < points_mm.length / 3; node += 1) if (apart(this.restAt(node), at_mm) < GRIP_MM) return true;
    return false;
  }

  /** For whoever has no pointer: the point of the skin in the middle of the view. */
  private addMiddle(): void {
    const hit = this.bench.scene.middle();
    if (hit !== undefined) this.targetAt(hit);
    this.draw();
    if (hit === undefined) this.said.textContent = this.app.words.noSkinThere;
  }

  private restAt(node: number): Triple {
    return [0, 1, 2].map((axis) => this.loaded.rest.points_mm[3 * node + axis]!) as Triple;
  }

  private draw(): void {
    const { words } = this.app;
    const row = (target: Target, at: number) => {
      const number = (word: number) => {
        const label = words[TRANSLATIONS[word]!];
        const input = make("input", { type: "number", step: "0.1", placeholder: words.emptyFree, value: target.by[word] === null ? "" : String(target.by[word]), aria: { label: `${target.label} ${label} mm` } });
        input.addEventListener("input", () => { target.by[word] = input.value === "" ? null : input.valueAsNumber; this.marks(); });
        return make("label", { className: "field" }, make("span", {}, label), input);
      };
      const sigma = make("input", { type: "number", min: "0.01", step: "0.1", value: String(target.sigma_mm), aria: { label: `${target.label} ${words.measuredTo} mm` } });
      sigma.addEventListener("input", () => { if (sigma.valueAsNumber > 0) { target.sigma_mm = sigma.valueAsNumber; this.warn(); } });
      return make("fieldset", { className: "target" }, make("legend", {}, target.label), number(0), number(1), number(2),
        make("label", { className: "field" }, make("span", {}, "± mm"), sigma),
        button(words.remove, () => { this.targets.splice(at, 1); this.draw(); }));
    };
    this.said.replaceChildren();
    this.list.replaceChildren(...(this.targets.length === 0 ? [make("p", { className: "fine" }, words.noTargets)] : this.targets.map(row)));
    this.marks();
  }

  /** Says before solving which way no segment may go as far as a target asks, and offers to allow it or to leave that way free. */
  private warn(): void {
    const { words } = this.app;
    note({ targets: writeTargets(this.targets), bounds: writeBounds(this.bounds, this.usual), tissue: writeTissue(this.tissue) });
    this.forbidden.replaceChildren(...beyondBounds(this.targets, this.bounds).map(({ target, at, wanted, allowed }) => {
      const word = TRANSLATIONS[at]!;
      const called = wordFor(words, word, this.opened.frame);
      const enough = Math.ceil(Math.abs(wanted));
      const { way, far } = wayFor(words, word, wanted, this.opened.frame);
      const sentence = allowed === 0 ? words.heldThere(target.label, way, mm(far)) : words.notThatFar(target.label, way, mm(far), mm(allowed));
      return make("p", { className: "warned" }, sentence, " ",
        button(words.allowThat(called, enough), () => {
          for (const bound of Object.values(this.bounds)) bound[word] = Math.max(bound[word], enough);
          this.drawBounds();
          this.marks();
        }), " ", button(words.leaveFree(called), () => { target.by[at] = null; this.draw(); }));
    }));
  }

  private marks(): void {
    const { frame } = this.opened;
    this.warn();
    const wanted = this.targets.map(({ at_mm, by }) => {
      const moved = inAxes(by.map((value) => value ?? 0) as Triple, frame);
      return { at_mm, colour: COLOUR, to_mm: at_mm.map((value, axis) => value + moved[axis]!) as Triple };
    });
    const held = this.landmarks.filter(([name]) => !this.targets.some(({ landmark }) => landmark === name));
    this.bench.scene.mark([...(this.isPulling ? held.map(([, at_mm]) => ({ at_mm, colour: hex(ACCENT) })) : []), ...wanted]);
  }

  private drawBounds(): void {
    this.boundFields.replaceChildren(...Object.keys(this.bounds).map((name) => this.boundsOf(name)));
  }

  private boundsOf(name: string): HTMLElement {
    const { words } = this.app;
    const bound = this.bounds[name]!;
    const unit = (word: MotionName) => ((TRANSLATIONS as readonly string[]).includes(word) ? "mm" : "°");
    const fields = (Object.keys(bound) as MotionName[]).map((word) => {
      const input = make("input", { type: "number", min: "0", step: "0.5", value: String(bound[word]), aria: { label: `${name} ${words[word]} ± ${unit(word)}` } });
      input.addEventListener("input", () => { bound[word] = Number.isFinite(input.valueAsNumber) ? Math.abs(input.valueAsNumber) : 0; this.warn(); });
      return make("label", { className: "field" }, make("span", {}, `${words[word]} ± ${unit(word)}`), input);
    });
    return make("details", { className: "segment", open: true }, make("summary", {}, name), make("div", { className: "bounds" }, ...fields));
  }

  private async find(): Promise<void> {
    const { app: { service, words }, opened } = this;
    if (this.targets.length === 0) {
      this.said.replaceChildren(make("p", { className: "warned" }, words.targetsAsked));
      announce(words.targetsAsked);
      return;
    }
    try {
      const job = await service.post<Documents["StatusInfo"]>("/v1/jobs", this.spec(opened.frame));
      location.hash = address(["job", job.id]);
    } catch (error) {
      this.said.replaceChildren(refusal(error, words));
    }
  }

  private spec(frame: FrameName): object {
    const targets = this.targets.map(({ landmark, at_mm, by, sigma_mm }) => ({ ...(landmark === undefined ? { point_mm: at_mm } : { landmark }), displacement_mm: inAxes(by, frame), sigma_mm }));
    const bounds = Object.fromEntries(this.loaded.description.segments.map(({ name, centre_mm }) => [name, interval(this.bounds[name]!, centre_mm as Triple, frame)]));
    const tissue_bounds = Object.keys(this.tissue).length === 0 ? {} : { tissue_bounds: this.tissue };
    return { kind: "optimise", case: this.opened.id, targets, bounds, ...tissue_bounds, outputs: ["skin.vtp", "skin.glb"], tags: targetTags(this.targets) };
  }
}

const apart = (one: Triple, other: Triple): number => Math.hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2]);

const ofLandmark = (landmark: string, at_mm: Triple): Target => ({ label: landmark, landmark, at_mm, by: [0, 0, null], sigma_mm: USUAL_SIGMA_MM });

/** How far a segment may go, as the service takes it. */
function interval(bound: Record<MotionName, number>, centre_mm: Triple, frame: FrameName): object {
  const { translation_mm, rotation_deg } = movement({ ...still(), ...bound }, frame);
  const ends = (value: number) => [-Math.abs(value), Math.abs(value)];
  const turns = rotation_deg.some((value) => value !== 0);
  return { translation_mm: translation_mm.map(ends), ...(turns ? { rotation_deg: rotation_deg.map(ends), pivot_mm: centre_mm } : {}) };
}
