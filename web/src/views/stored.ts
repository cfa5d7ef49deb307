// Two stored plans of a case against each other: both skins, how far they are apart by region, and the numbers of both.
import type { Documents } from "../api.js";
import { refusal, type App, type Leave } from "../app.js";
import { choice, make, select, table, type Cell } from "../dom.js";
import { mm, figure, when } from "../figures.js";
import { MOTIONS, ROTATIONS, still, type MotionName } from "../frame.js";
import { addBones, openCase, restingSkin, setsOf, type Opened, type RestingSkin } from "../loading.js";
import { matrix } from "../matrix.js";
import { fromDocument, pivotsOf } from "../plan.js";
import { lengthsOver, nodeAreas, type Lengths } from "../regions.js";
import { lengths } from "../response.js";
import { address, note } from "../route.js";
import { Workbench } from "../workbench.js";
import { planInWords, planName, short } from "./called.js";
import { crumbs } from "./crumbs.js";
import { wordFor } from "./movements.js";
import { OPEN, storedPlans, type Readable, type Stored } from "./plans.js";
import { drawTrust, type TrustLine } from "./trust.js";
import { leftOutLine } from "./trusted.js";

/** Two plans: the first is that of before, or of the left. */
type Sides<Value> = [Value, Value];
const SIDES = ["a", "b"] as const;
type How = "overlay" | "sides";

interface Applied {
  stored: Stored;
  answer: Documents["AppliedDocument"];
  displacement_mm: Float32Array;
  /** Where six numbers a segment say it. */
  readable: Readable | undefined;
}

export async function plansPage(app: App): Promise<Leave> {
  const { service, words } = app;
  const opened = await openCase(service, app.route.path[1]!);
  const plans = await storedPlans(app, opened.id);
  const bench = new Workbench(app, crumbs(words, opened.id, opened.name, "plans"));
  bench.scene.orient(opened.frame);
  try {
    const wait = make("div", { className: "wait" }, make("p", { className: "loading" }, words.loading));
    bench.panel.append(wait);
    const skin = await restingSkin(app, opened.id, wait);
    const parts = await partsOf(app, opened, skin);
    wait.remove();
    bench.scene.showSkin(skin.rest);
    bench.start();
    await new PlansCompared(app, opened, bench, { skin, parts, plans }).start();
  } catch (error) {
    bench.refuse(error);
  }
  return () => bench.leave();
}

/** Nodes of the skin by its parts, as far as sets of the mesh say them. */
async function partsOf({ service }: App, { document }: Opened, { description }: RestingSkin): Promise<Record<string, Uint8Array>> {
  const regions = Object.entries(document.skin_regions ?? {});
  if (regions.length === 0) return {};
  const inside = await setsOf(service, document.volume!, Uint32Array.from(description.node_ids));
  const parts = regions.map(([name, { node_set }]) => [name, node_set === undefined ? undefined : inside[node_set.replace(/^set_/, "")]] as const);
  return Object.fromEntries(parts.filter((part): part is [string, Uint8Array] => part[1] !== undefined));
}

interface Known {
  skin: RestingSkin;
  parts: Record<string, Uint8Array>;
  plans: Stored[];
}

class PlansCompared {
  private readonly chosen: Sides<string>;
  private how: How;
  private applied: Sides<Applied> | undefined;
  private apart: Float32Array = new Float32Array();
  private asked = 0;
  private readonly areas: Float64Array;
  private readonly found = make("div", { role: "status" });
  private readonly tables = make("div");

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench, private readonly known: Known) {
    const { state } = app.route;
    const { plans } = known;
    const stated = (side: number) => plans.find(({ id }) => id === state.get(SIDES[side]!)) ?? plans[1 - side];
    this.chosen = [stated(0)?.id ?? "", stated(1)?.id ?? ""];
    this.how = state.get("show") === "sides" ? "sides" : "overlay";
    this.areas = nodeAreas(known.skin.rest.points_mm, known.skin.rest.triangles);
  }

  async start(): Promise<void> {
    const { app: { words, service }, opened, bench, known: { plans } } = this;
    if (plans.length < 2) {
      bench.section(words.plansCompared, make("p", { className: "warned" }, words.twoPlansAsked),
        make("a", { className: "button primary", href: address(["case", opened.id, "plan"]) }, words.planIt));
      return;
    }
    const options = plans.map((stored) => [stored.id, `${planName(stored)} · ${planInWords(words, stored.plan, opened.frame)} · ${when(stored.updated)}`] as const);
    const side = (at: 0 | 1) => select(at === 0 ? words.firstPlan : words.secondPlan, options, this.chosen[at], (id) => { this.chosen[at] = id; void this.compare(); });
    bench.section(words.plansCompared, make("div", { className: "stack wide" }, side(0), side(1),
      choice(words.shown, [["overlay", words.overlay], ["sides", words.sides]] as const, this.how, (how) => { this.how = how; this.show(); })),
    make("p", { className: "fine" }, words.plansHint), this.found);
    bench.panel.append(this.tables);
    await Promise.all([addBones(service, opened, bench.scene), this.compare()]);
    this.show();
  }

  /** What the service answers to both. */
  private async compare(): Promise<void> {
    const turn = (this.asked += 1);
    note({ a: this.chosen[0], b: this.chosen[1] });
    try {
      const applied = await Promise.all(this.chosen.map((id) => this.apply(id))) as Sides<Applied>;
      if (turn !== this.asked) return;
      this.applied = applied;
      const [a, b] = applied;
      this.apart = lengths(b.displacement_mm.map((value, at) => value - a.displacement_mm[at]!));
      this.offer(applied);
      this.show();
      this.tell(applied);
    } catch (error) {
      if (turn === this.asked) { this.applied = undefined; this.tables.replaceChildren(); this.found.replaceChildren(refusal(error, this.app.words)); }
    }
  }

  private async apply(id: string): Promise<Applied> {
    const { app: { service }, opened: { frame, id: of }, known: { skin, plans } } = this;
    const stored = plans.find((plan) => plan.id === id)!;
    const answer = await service.post<Documents["AppliedDocument"]>(`/v1/cases/${of}/response/apply?job=${skin.description.job}`, { plan: stored.plan });
    const centres = Object.fromEntries(skin.description.segments.map(({ name, centre_mm }) => [name, centre_mm]));
    const pivots = { ...centres, ...pivotsOf(stored.plan, frame) } as Readable["pivots"];
    const plan = fromDocument(stored.plan, pivots, frame);
    return { stored, answer, displacement_mm: Float32Array.from(answer.displacement_mm.flat()), readable: plan === undefined ? undefined : { plan, pivots } };
  }

  private offer([a, b]: Sides<Applied>): void {
    const { app: { words }, bench } = this;
    const moved = (name: string, { stored, displacement_mm }: Applied) =>
      ({ name, label: `${words.displacement}: ${short(planName(stored))}`, scheme: "length" as const, range_mm: 10, values: () => lengths(displacement_mm) });
    bench.offer([{ name: "apart", label: words.plansApart, scheme: "length", range_mm: 5, values: () => this.apart }, moved("first", a), moved("second", b)], "apart");
  }

  /** The second skin with the outline of the first over it, or both side by side under one camera. */
  private show(): void {
    const { applied, bench, how, known: { skin: { rest } } } = this;
    note({ show: how === "overlay" ? undefined : how });
    if (applied === undefined) return;
    const [a, b] = applied;
    const first = { ...rest, points_mm: rest.points_mm.map((value, at) => value + a.displacement_mm[at]!) };
    const [bonesOfA, bonesOfB] = applied.map((one) => this.bones(one)) as Sides<Record<string, number[]>>;
    for (const [name, moved] of Object.entries(bonesOfB)) bench.scene.moveBone(name, moved);
    bench.scene.showBones(a.readable !== undefined && b.readable !== undefined);
    bench.scene.moveSkin(b.displacement_mm);
    bench.scene.overlay(how === "overlay" ? first : undefined);
    bench.scene.beside(how === "sides" ? first : undefined, bonesOfA);
    bench.halves(how === "sides" ? applied.map(({ stored }) => short(planName(stored))) as Sides<string> : undefined);
    bench.repaint();
    bench.caption.textContent = `${this.opened.name} · ${applied.map(({ stored }) => short(planName(stored))).join(" | ")}`;
  }

  private bones({ readable }: Applied): Record<string, number[]> {
    if (readable === undefined) return {};
    const { plan, pivots } = readable;
    return Object.fromEntries(Object.keys(plan.segments).map((name) => [name, matrix(plan.segments[name] ?? still(), pivots[name]!, this.opened.frame)]));
  }

  private tell(applied: Sides<Applied>): void {
    const { app: { words }, bench } = this;
    const names = applied.map(({ stored }) => short(planName(stored))) as Sides<string>;
    drawTrust(bench.strip, words, applied.map(({ answer }, at): TrustLine => {
      const line = leftOutLine(words, answer);
      return { ...line, name: `${line.name}: ${names[at]}` };
    }));
    const whole = lengthsOver(this.apart, this.areas);
    this.found.textContent = whole === undefined ? "" : words.plansAre(mm(whole.mean), mm(whole.max));
    const unnamed = Object.keys(this.opened.document.skin_regions ?? {}).filter((name) => this.known.parts[name] === undefined);
    this.tables.replaceChildren(
      make("section", {}, make("h2", {}, words.regions), this.regions(applied, names), unnamed.length > 0 && make("p", { className: "fine" }, words.partsNotTold(unnamed.join(", ")))),
      make("section", {}, make("h2", {}, words.bothPlans), this.numbers(applied, names), this.links(applied)));
  }

  /** By area: how far each moves the skin, and how far they are apart. */
  private regions(applied: Sides<Applied>, names: Sides<string>): HTMLElement {
    const { app: { words }, areas } = this;
    const moved = applied.map(({ displacement_mm }) => lengths(displacement_mm));
    const length = (found: Lengths | undefined, of: keyof Lengths) => (found === undefined ? "–" : mm(found[of]));
    const row = (name: string, inside?: Uint8Array): Cell[] => {
      const apart = lengthsOver(this.apart, areas, inside);
      return [name, ...moved.map((one) => length(lengthsOver(one, areas, inside), "mean")), length(apart, "mean"), length(apart, "p95"), length(apart, "max")];
    };
    return table(words.plansApartBy, [words.region, ...names.map((name) => `${short(name, 15)}, ${words.mean}`), `${words.apart}, ${words.mean}`, words.p95, words.max],
      [row(words.whole), ...Object.entries(this.known.parts).map(([name, inside]) => row(name, inside))]);
  }

  /** Every number that one of them states, and by how much they differ. */
  private numbers(applied: Sides<Applied>, names: Sides<string>): HTMLElement {
    const { app: { words }, opened: { frame } } = this;
    const [a, b] = applied.map(({ readable }) => readable);
    if (a === undefined || b === undefined) {
      return make("ul", {}, ...applied.map(({ stored }, at) => make("li", {}, `${names[at]}: ${planInWords(words, stored.plan, frame)}`, make("pre", {}, JSON.stringify(stored.plan, null, 1)))));
    }
    const row = (name: string, one: number, other: number, digits = 2): Cell[] => [name, figure(one, digits), figure(other, digits), figure(other - one, digits)];
    const unit = (word: MotionName) => ((ROTATIONS as readonly string[]).includes(word) ? "°" : "mm");
    const segments = Object.keys({ ...a.plan.segments, ...b.plan.segments }).flatMap((name) => {
      const [one, other] = [a, b].map(({ plan }) => plan.segments[name] ?? still()) as Sides<ReturnType<typeof still>>;
      return MOTIONS.filter((word) => one[word] !== 0 || other[word] !== 0).map((word) => row(`${name} ${wordFor(words, word, frame)}, ${unit(word)}`, one[word], other[word]));
    });
    const inner = (["growth", "muscle"] as const).flatMap((kind) => Object.keys({ ...a.plan.inner[kind], ...b.plan.inner[kind] }).map((name) => {
      const [one, other] = [a, b].map(({ plan }) => (kind === "growth" ? 100 : 1) * (plan.inner[kind][name] ?? 0)) as Sides<number>;
      return row(`${name}, ${kind === "growth" ? "%" : "kPa"}`, one, other, 1);
    }));
    return table(words.bothPlans, [words.movement, ...names.map((name) => short(name, 15)), words.apart], [...segments, ...inner]);
  }

  private links(applied: Sides<Applied>): HTMLElement {
    const { app: { words }, opened } = this;
    return make("div", { className: "row" }, ...applied.map(({ stored }) =>
      make("a", { className: "button", href: address(["case", opened.id, "plan"], { [OPEN]: stored.id }), title: planName(stored) }, `${words.load} ${short(planName(stored))}`)));
  }
}
