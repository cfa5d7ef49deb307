// The result of a job: its progress while it runs, then the face before and after.
import type { Documents, Job, Triple } from "../api.js";
import { readGlb, type Surface } from "../api.js";
import { announce, ProgressLine, refusal, warnings, type App, type Leave } from "../app.js";
import { button, choice, make } from "../dom.js";
import { inWords, still } from "../frame.js";
import { addBones, openCase, type Opened } from "../loading.js";
import { matrix } from "../matrix.js";
import { PLAN_STATE, planState, read, readPivots, written, type Plan, type Pivots } from "../plan.js";
import { ACCENT, hex } from "../palette.js";
import { address, note } from "../route.js";
import type { Hit, Shape } from "../scene.js";
import { asInGlb, pointArrays, readVtp } from "../vtp.js";
import { mm } from "../figures.js";
import { Workbench, type SkinMap } from "../workbench.js";
import { resultBeside } from "./above.js";
import { correctionFacts } from "./corrected.js";
import { crumbs } from "./crumbs.js";
import { foundFacts, foundLine, planOf, targetsOf } from "./found.js";
import { comparisonFacts } from "./distances.js";
import { fileList } from "./files.js";
import { inWays, told } from "./movements.js";
import { cephalometry, landmarks, provenance, regions, type Shown } from "./numbers.js";
import { kindOf, statusOf } from "./kinds.js";
import { placesOf, type Parts } from "./places.js";
import { profile } from "./profile.js";
import { reportLinks } from "./reports.js";
import { stressFacts } from "./stressed.js";
import { drawTrust } from "./trust.js";
import { resultLines } from "./trusted.js";

const WORKING = ["accepted", "running"];

export async function resultPage(app: App): Promise<Leave> {
  const id = app.route.path[1]!;
  let job = await app.service.get<Job>(`/v1/jobs/${id}`);
  let left = false;
  if (WORKING.includes(job.status)) job = await follow(app, job, () => left);
  if (left) return () => {};
  if (job.status !== "successful") {
    app.stage.replaceChildren(make("h1", {}, `${kindOf(app.words, job.kind)} · ${statusOf(app.words, job.status)}`), ended(app, job), backLink(app, job));
    return () => {};
  }
  const files = job.results?.files.map(({ name }) => name) ?? [];
  if (!isDrawn(job, files)) {
    const leave = await resultBeside(app, job);
    return () => { left = true; leave(); };
  }
  const result = new Result(app, job);
  await result.start();
  return () => { left = true; result.leave(); };
}

/** Whether the face before and after can be drawn: also from `skin.vtp`, which comparisons have of another skin. */
const isDrawn = ({ kind }: Job, files: string[]): boolean =>
  files.includes("skin.glb") || (files.includes("skin.vtp") && (kind === "predict" || kind === "optimise"));

/** Shows how far a job is until it has ended. */
async function follow(app: App, job: Job, left: () => boolean): Promise<Job> {
  const { service, words, stage } = app;
  const line = new ProgressLine(words, words.running, {
    text: words.cancel, clicked: () => service.ask("DELETE", `/v1/jobs/${job.id}`),
  });
  line.tell(job);
  stage.replaceChildren(make("h1", {}, kindOf(words, job.kind)), make("div", { className: "card" }, line.element));
  announce(words.running);
  for await (const event of service.events(job.id)) {
    if (left() || !line.element.isConnected) break;
    line.tell(event);
  }
  return (await service.ask("GET", `/v1/jobs/${job.id}`, undefined, { Prefer: "wait=5" })).json() as Promise<Job>;
}

function ended({ words }: App, job: Job): HTMLElement {
  if (job.status === "dismissed") return make("p", { role: "status" }, words.cancelled);
  const { type = job.status, detail = job.message } = job.error ?? {};
  return make("div", { className: "refusal", role: "alert" }, make("strong", {}, words.jobFailed), ` ${detail}`,
    make("a", { href: `/errors#${type}`, className: "code" }, type));
}

function backLink({ words, route }: App, job: Job): HTMLElement {
  const path = job.case === undefined ? ["cases"] : ["case", job.case, "plan"];
  return make("a", { className: "button", href: address(path, planState(route.state)) }, words.backToPlan);
}

class Result {
  private bench!: Workbench;
  private opened!: Opened;
  private after!: Omit<Surface, "extras">;
  private displacement_mm!: Float32Array;
  private before!: Shape;
  private plan: Plan | undefined;
  private pivots: Pivots = {};
  private share = 1;
  private readonly parts: Parts = {};

  constructor(private readonly app: App, private readonly job: Job) {}

  async start(): Promise<void> {
    const { app, job } = this;
    this.opened = await openCase(app.service, job.case!);
    const has = (name: string) => this.results.files.some((file) => file.name === name);
    const skin = has("skin.glb") ? readGlb(await app.service.file(job.id, "skin.glb")) : asInGlb(await readVtp(await app.service.file(job.id, "skin.vtp")));
    this.after = skin;
    this.displacement_mm = skin.values._DISPLACEMENT_MM ?? new Float32Array(skin.points_mm.length);
    this.before = { triangles: skin.triangles, points_mm: skin.points_mm.map((value, at) => value - this.displacement_mm[at]!) };
    this.bench = new Workbench(app, crumbs(app.words, this.opened.id, this.opened.name, "result"));
    this.trust();
    this.bench.scene.orient(this.opened.frame);
    this.bench.scene.showSkin(this.before);
    this.bench.scene.moveSkin(this.displacement_mm);
    this.bench.start();
    this.knowPlan();
    const values = { ...await this.furtherValues(), ...await this.stress() };
    for (const [name, chosen] of Object.entries(values)) if (name.startsWith("set_")) this.parts[name.slice("set_".length)] = chosen;
    this.bench.offer(this.maps(values));
    this.draw();
    await this.bones();
  }

  leave(): void {
    this.bench.leave();
  }

  private get results(): Documents["ResultDocument"] {
    return this.job.results!;
  }

  /** What files of skin have and GLB has not: what the model leaves out at each node, and parts of the skin. */
  private async furtherValues(): Promise<Record<string, Float32Array>> {
    if (!this.results.files.some(({ name }) => name === "skin.vtp")) return {};
    return (await readVtp(await this.app.service.file(this.job.id, "skin.vtp"))).values;
  }

  /** Stress at the nodes of the skin, from the file of the tissue. */
  private async stress(): Promise<Record<string, Float32Array>> {
    const { results, job, app: { service } } = this;
    const has = (name: string) => results.files.some((file) => file.name === name);
    if ((results.stress ?? undefined) === undefined || !has("volume.vtu") || !has("skin.vtp")) return {};
    const [tissue, skin] = await Promise.all([service.file(job.id, "volume.vtu"), service.file(job.id, "skin.vtp")]);
    const [inside, own] = await Promise.all([
      pointArrays(tissue, (name) => name === "node_id" || name === "von_mises_kpa"), pointArrays(skin, (name) => name === "node_id")]);
    if (inside.von_mises_kpa === undefined || inside.node_id === undefined || own.node_id === undefined) return {};
    const place = new Map(Array.from(inside.node_id, (node, at) => [node, at]));
    return { von_mises_kpa: own.node_id.map((node) => inside.von_mises_kpa![place.get(node) ?? -1] ?? 0) };
  }

  private maps({ nonlinearity_mm: leftOut, von_mises_kpa, contact_pressure_kpa }: Record<string, Float32Array>): SkinMap[] {
    const { words } = this.app;
    const { _DISPLACEMENT_MAGNITUDE_MM, _NUMERICAL_ERROR_MM, _SIGNED_DISTANCE_MM } = this.after.values;
    const maps: SkinMap[] = [];
    if (_DISPLACEMENT_MAGNITUDE_MM !== undefined) {
      maps.push({ name: "displacement", label: words.displacement, scheme: "length", range_mm: 10, values: () => _DISPLACEMENT_MAGNITUDE_MM });
    }
    if (_NUMERICAL_ERROR_MM !== undefined) {
      maps.push({ name: "error", label: words.numericalError, scheme: "length", range_mm: 1, values: () => _NUMERICAL_ERROR_MM });
    }
    if (leftOut !== undefined) {
      maps.push({ name: "model", label: words.leftOutMap, scheme: "length", range_mm: 1, values: () => leftOut });
    }
    if (von_mises_kpa !== undefined) {
      maps.push({ name: "stress", label: words.vonMises, unit: "kPa", scheme: "length", range_mm: 5, values: () => von_mises_kpa });
    }
    if (contact_pressure_kpa !== undefined) {
      maps.push({ name: "contact", label: words.contactPressure, unit: "kPa", scheme: "length", range_mm: 5, values: () => contact_pressure_kpa });
    }
    if (_SIGNED_DISTANCE_MM !== undefined) {
      maps.push({ name: "distance", label: words.signedDistance, scheme: "signed", range_mm: 2, values: () => _SIGNED_DISTANCE_MM });
    }
    return maps;
  }

  /** Over the head from the beginning: nothing is to be waited for. */
  private trust(): void {
    const { app: { words }, bench, results, opened, job } = this;
    const { optimisation } = results;
    const aims = optimisation === undefined ? [] : [foundLine(words, optimisation, targetsOf(words, job.tags, optimisation.targets.length), results.provenance?.frame ?? opened.frame, job.warnings)];
    drawTrust(bench.strip, words, [...aims, ...resultLines(words, results, job.warnings)]);
  }

  private draw(): void {
    const { app: { words }, bench, results, opened } = this;
    const probe = make("p", { className: "told", role: "status" }, words.probe);
    const list = this.job.warnings;
    const places = placesOf(words, opened, bench.scene, () => this.parts);
    bench.section(words.beforeAfter, this.slider(), probe);
    bench.section(words.warnings, warnings(list, words, places));
    const report = reportLinks(this.app, this.job);
    if (report !== undefined) bench.section(words.report, report);
    if (results.optimisation !== undefined) bench.section(words.found, foundFacts(this.app, this.job, opened, results.optimisation));
    if (results.comparison !== undefined) bench.section(words.comparison, comparisonFacts(this.app, results.comparison),
      make("a", { className: "button", href: address(["case", opened.id, "compare"], { comparison: this.job.id }) }, words.toComparison));
    const shown: Shown = { words, warnings: list, show: (name) => places({ code: "", detail: name }).find(({ label }) => label === name)?.show };
    bench.section(words.regions, regions(shown, results));
    if (results.correction) bench.section(words.correction, correctionFacts(this.app, this.job, results.correction, this.before, bench.scene));
    if (results.stress) bench.section(words.stress, stressFacts(words, results.stress));
    if (Object.keys(results.statistics?.landmarks ?? {}).length > 0) bench.section(words.landmarks, landmarks(shown, results, opened.frame));
    if ((results.cephalometry ?? []).length > 0) bench.section(words.cephalometry, cephalometry(words, results.cephalometry!));
    bench.section(words.profile, profile(words, opened.frame, this.before, this.after), make("p", { className: "fine" }, words.profileHint));
    bench.section(words.provenance, provenance(words, results.provenance ?? undefined));
    bench.panel.append(fileList(this.app, this.job));
    bench.caption.textContent = [opened.name, this.plan === undefined ? "" : told(this.plan, words, opened.frame), results.provenance?.method ?? this.job.kind].filter((part) => part !== "").join(" · ");
    bench.provenance = `job ${this.job.id} · ${results.provenance?.engine.version ?? ""} · ${results.provenance?.spec_hash.slice(0, 16) ?? ""}`;
    this.probing(probe);
  }

  /** From before, 0, to after, 1. */
  private slider(): HTMLElement {
    const { app: { words, route }, bench } = this;
    const slider = make("input", { type: "range", min: "0", max: "1", step: "0.01", value: "1", aria: { label: words.beforeAfter }, data: { share: "" } });
    slider.addEventListener("input", () => this.show(slider.valueAsNumber));
    const jump = (share: number) => { slider.value = String(share); this.show(share); };
    const stated = route.state.get("show") ?? "";
    const start = (["overlay", "sides"] as const).find((one) => one === stated) ?? "one";
    const ways = choice(words.shown, [["one", words.one], ["overlay", words.overlay], ["sides", words.sides]] as const, start, (value) => this.beside(value));
    this.beside(start);
    return make("div", { className: "stack wide" }, ways,
      make("div", { className: "row" }, button(words.before, () => jump(0)), button(words.after, () => jump(1))), slider,
      make("div", { className: "row" }, backLink(this.app, this.job),
        make("a", { className: "button", href: address(["case", this.opened.id, "compare"], { job: this.job.id, ...planState(this.app.route.state) }) }, words.compareThis)));
  }

  /** One skin, that of before over it, or both side by side under one camera. */
  private beside(how: "one" | "overlay" | "sides"): void {
    const { bench, before, app: { words } } = this;
    note({ show: how === "one" ? undefined : how });
    bench.scene.overlay(how === "overlay" ? before : undefined);
    bench.scene.beside(how === "sides" ? before : undefined);
    bench.halves(how === "sides" ? [words.before, words.after] : undefined);
  }

  private show(share: number): void {
    this.share = share;
    this.bench.scene.moveSkin(this.displacement_mm.map((value) => share * value));
    this.moveBones();
  }

  /** A click on the skin, or Enter for the middle of the view, says how far that point moves. */
  private probing(said: HTMLElement): void {
    const { scene } = this.bench;
    let from: [number, number] = [0, 0];
    scene.canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; });
    scene.canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - from[0], event.clientY - from[1]) <= 4) this.probe(scene.pick(event), said);
    });
    scene.canvas.addEventListener("keydown", (event) => { if (event.key === "Enter") this.probe(scene.middle(), said); });
  }

  private probe(hit: Hit | undefined, said: HTMLElement): void {
    const { app: { words }, bench, opened } = this;
    if (hit === undefined) return;
    const moved = [0, 1, 2].map((axis) => this.displacement_mm[3 * hit.node + axis]!) as Triple;
    const error = this.after.values._NUMERICAL_ERROR_MM?.[hit.node];
    bench.scene.mark([{ at_mm: hit.point_mm, colour: hex(ACCENT) }]);
    said.textContent = `${words.point} ${hit.node} ${words.movesBy} ${mm(Math.hypot(...moved))} mm`
      + ` (${inWays(words, inWords(moved, opened.frame), opened.frame)})`
      + (error === undefined ? "" : ` ± ${mm(error)}`);
  }

  /** The plan, as the result or what was found has it, or from the address; it stays unknown where none says it in six numbers. */
  private knowPlan(): void {
    const state = planState(this.app.route.state);
    const found = this.results.optimisation?.plan ?? this.results.provenance?.plan ?? undefined;
    const names = (this.opened.document.segments ?? []).map(({ name }) => name);
    const inAddressOnly = { plan: PLAN_STATE.some((name) => state[name] !== undefined) ? read(state, names) : undefined, pivots: readPivots(state) };
    ({ plan: this.plan, pivots: this.pivots } = found === undefined ? inAddressOnly : planOf(this.opened, found));
    if (this.plan === undefined) return;
    const inAddress = written(this.plan, this.pivots);
    for (const name of PLAN_STATE) if (inAddress[name] !== undefined) this.app.route.state.set(name, inAddress[name]);
    note(inAddress);
  }

  private async bones(): Promise<void> {
    const { app, opened, bench } = this;
    if (this.plan === undefined) return;
    await addBones(app.service, opened, bench.scene);
    this.moveBones();
  }

  private moveBones(): void {
    for (const [name, motion] of Object.entries(this.plan?.segments ?? {})) {
      const part = Object.fromEntries(Object.entries(motion).map(([word, value]) => [word, this.share * value]));
      this.bench.scene.moveBone(name, matrix({ ...still(), ...part }, this.pivots[name] ?? [0, 0, 0], this.opened.frame));
    }
  }
}
