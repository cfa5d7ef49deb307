// The result of a job: its progress while it runs, then the face before and after.
import type { Documents, Job, Triple } from "../api.js";
import { readGlb, type Surface } from "../api.js";
import { announce, ProgressLine, refusal, warnings, type App, type Leave } from "../app.js";
import { button, choice, make, save, table } from "../dom.js";
import { inWords, still } from "../frame.js";
import { addBones, openCase, type Opened } from "../loading.js";
import { matrix } from "../matrix.js";
import { fromDocument, read, readPivots, written, type Plan, type Pivots } from "../plan.js";
import { address, note } from "../route.js";
import type { Shape } from "../scene.js";
import { readVtp } from "../vtp.js";
import { mm, signed } from "../figures.js";
import { Workbench, type SkinMap } from "../workbench.js";
import { crumbs } from "./crumbs.js";
import { foundFacts } from "./found.js";
import { comparisonFacts } from "./distances.js";
import { profile } from "./profile.js";

const WORKING = ["accepted", "running"];

export async function resultPage(app: App): Promise<Leave> {
  const id = app.route.path[1]!;
  let job = await app.service.get<Job>(`/v1/jobs/${id}`);
  let left = false;
  if (WORKING.includes(job.status)) job = await follow(app, job, () => left);
  if (left) return () => {};
  if (job.status !== "successful") {
    app.stage.replaceChildren(make("h1", {}, `${job.kind} · ${job.status}`), ended(app, job), backLink(app, job));
    return () => {};
  }
  const files = job.results?.files.map(({ name }) => name) ?? [];
  if (!files.includes("skin.glb")) {
    app.stage.replaceChildren(make("h1", {}, `${job.kind} · ${job.status}`), make("p", {}, app.words.noSkin),
      ...(job.results?.comparison === undefined ? [] : [comparisonFacts(app, job.results.comparison)]), fileList(app, job));
    return () => { left = true; };
  }
  const result = new Result(app, job);
  await result.start();
  return () => { left = true; result.leave(); };
}

/** Shows how far a job is until it has ended. */
async function follow(app: App, job: Job, left: () => boolean): Promise<Job> {
  const { service, words, stage } = app;
  const line = new ProgressLine(words.running, {
    text: words.cancel, clicked: () => void service.ask("DELETE", `/v1/jobs/${job.id}`).catch(() => {}),
  });
  line.tell(job);
  stage.replaceChildren(make("h1", {}, `${job.kind}`), make("div", { className: "card" }, line.element));
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
  return make("a", { className: "button", href: address(path, { p: route.state.get("p") ?? undefined }) }, words.backToPlan);
}

export function fileList({ service, words }: App, job: Job): HTMLElement {
  const row = ({ name, bytes, media_type }: Documents["FileDocument"]) => make("li", {}, button(name, () => {
    void service.file(job.id, name).then((content) => save(new Blob([content], { type: media_type }), name));
  }), make("span", { className: "fine" }, ` ${(bytes / 1024).toFixed(0)} KiB`));
  return make("section", {}, make("h2", {}, words.files), make("ul", { className: "plans" }, ...(job.results?.files ?? []).map(row)));
}

class Result {
  private bench!: Workbench;
  private opened!: Opened;
  private after!: Surface;
  private displacement_mm!: Float32Array;
  private before!: Shape;
  private plan: Plan | undefined;
  private pivots: Pivots = {};
  private share = 1;

  constructor(private readonly app: App, private readonly job: Job) {}

  async start(): Promise<void> {
    const { app, job } = this;
    this.opened = await openCase(app.service, job.case!);
    const skin = readGlb(await app.service.file(job.id, "skin.glb"));
    this.after = skin;
    this.displacement_mm = skin.values._DISPLACEMENT_MM ?? new Float32Array(skin.points_mm.length);
    this.before = { triangles: skin.triangles, points_mm: skin.points_mm.map((value, at) => value - this.displacement_mm[at]!) };
    this.bench = new Workbench(app, crumbs(app.words, this.opened.id, this.opened.name, "result"));
    this.bench.scene.orient(this.opened.frame);
    this.bench.scene.showSkin(this.before);
    this.bench.scene.moveSkin(this.displacement_mm);
    this.knowPlan();
    const left = await this.leftOut();
    this.bench.offer(this.maps(left));
    this.draw();
    this.bench.start();
    await this.bones();
  }

  leave(): void {
    this.bench.leave();
  }

  private get results(): Documents["ResultDocument"] {
    return this.job.results!;
  }

  /** What the model leaves out at each node, which files of skin have and GLB has not. */
  private async leftOut(): Promise<Float32Array | undefined> {
    if (!this.results.files.some(({ name }) => name === "skin.vtp")) return undefined;
    const { values } = await readVtp(await this.app.service.file(this.job.id, "skin.vtp"));
    return values.nonlinearity_mm;
  }

  private maps(leftOut: Float32Array | undefined): SkinMap[] {
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
    if (_SIGNED_DISTANCE_MM !== undefined) {
      maps.push({ name: "distance", label: words.signedDistance, scheme: "signed", range_mm: 2, values: () => _SIGNED_DISTANCE_MM });
    }
    return maps;
  }

  private draw(): void {
    const { app: { words }, bench, results } = this;
    const probe = make("p", { className: "told", role: "status" }, words.probe);
    bench.section(words.beforeAfter, this.slider(), probe);
    if (results.optimisation !== undefined) bench.section(words.found, foundFacts(this.app, this.job, this.opened, results.optimisation));
    if (results.comparison !== undefined) bench.section(words.comparison, comparisonFacts(this.app, results.comparison));
    bench.section(words.warnings, warnings(this.job.warnings, words));
    bench.section(words.regions, this.regions());
    if (Object.keys(results.statistics?.landmarks ?? {}).length > 0) {
      bench.section(words.landmarks, this.landmarks());
    }
    bench.section(words.profile, profile(words, this.opened.frame, this.before, this.after), make("p", { className: "fine" }, words.profileHint));
    bench.section(words.provenance, this.provenance());
    bench.panel.append(fileList(this.app, this.job));
    bench.caption.textContent = `${this.opened.name} · ${results.provenance?.method ?? this.job.kind}`;
    this.probing(probe);
  }

  /** From before, 0, to after, 1. */
  private slider(): HTMLElement {
    const { app: { words }, bench } = this;
    const slider = make("input", { type: "range", min: "0", max: "1", step: "0.01", value: "1", aria: { label: words.beforeAfter }, data: { share: "" } });
    slider.addEventListener("input", () => this.show(slider.valueAsNumber));
    const jump = (share: number) => { slider.value = String(share); this.show(share); };
    const overlay = choice(words.overlay, [["off", "–"], ["on", "✓"]] as const, "off",
      (value) => bench.scene.overlay(value === "on" ? this.before : undefined));
    return make("div", {},
      make("div", { className: "row" }, button(words.before, () => jump(0)), button(words.after, () => jump(1)), overlay), slider,
      make("div", { className: "row" }, backLink(this.app, this.job),
        make("a", { className: "button", href: address(["case", this.opened.id, "compare"], { job: this.job.id, p: this.app.route.state.get("p") ?? undefined }) }, words.compareThis)));
  }

  private show(share: number): void {
    this.share = share;
    this.bench.scene.moveSkin(this.displacement_mm.map((value) => share * value));
    this.moveBones();
  }

  private regions(): HTMLElement {
    const { words } = this.app;
    const { statistics, numerical_error_mm: errors, nonlinearity_mm: nonlinear } = this.results;
    const numbers = (values?: { mean: number } | null) => (values === undefined || values === null ? "–" : mm(values.mean));
    const row = (name: string, region: Documents["DisplacementDocument"] | undefined, error?: { mean: number } | null, model?: { mean: number } | null) =>
      [name, ...(region === undefined ? ["–", "–", "–"] : [region.area.mean, region.area.p95, region.area.max].map(mm)), numbers(error), numbers(model)];
    const rows = Object.entries(statistics?.regions ?? {}).map(([name, region]) => row(name, region, errors?.regions?.[name], nonlinear?.regions?.[name]));
    return table(`${words.displacement}, mm`, [words.region, words.mean, words.p95, words.max, words.error, words.nonlinear],
      [row(words.whole, statistics?.skin, errors, nonlinear?.skin), ...rows]);
  }

  private landmarks(): HTMLElement {
    const { words } = this.app;
    const { statistics, numerical_error_mm: errors } = this.results;
    const rows = Object.entries(statistics?.landmarks ?? {}).map(([name, moved]) => {
      const error = errors?.landmarks?.[name];
      return [name, ...inWords(moved as Triple, this.opened.frame).map((value) => signed(value)), error === undefined ? "–" : mm(error)];
    });
    return table(`${words.displacement}, mm`, [words.landmark, words.forward, words.up, words.left, words.error], rows);
  }

  private provenance(): HTMLElement {
    const { words } = this.app;
    const { provenance } = this.results;
    const facts: [string, string][] = provenance === undefined ? [] : [
      [words.solvedBy, provenance.method ?? "–"], ["", provenance.why ?? ""],
      [words.took, `${provenance.timing?.total_s?.toFixed(1) ?? "–"} ${words.seconds}`],
      [words.nodes, String(provenance.mesh?.nodes ?? "–")], ["facies", provenance.engine.version],
      ["", provenance.statement ?? words.notice],
    ];
    return make("dl", { className: "facts" }, ...facts.filter(([, value]) => value !== "").flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
  }

  /** A click on the skin says where it is and how far it moves. */
  private probing(said: HTMLElement): void {
    const { app: { words }, bench, opened } = this;
    let from: [number, number] = [0, 0];
    bench.scene.canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; });
    bench.scene.canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - from[0], event.clientY - from[1]) > 4) return;
      const hit = bench.scene.pick(event);
      if (hit === undefined) return;
      const moved = [0, 1, 2].map((axis) => this.displacement_mm[3 * hit.node + axis]!) as Triple;
      const [forward, up, left] = inWords(moved, opened.frame);
      const error = this.after.values._NUMERICAL_ERROR_MM?.[hit.node];
      bench.scene.mark([{ at_mm: hit.point_mm, colour: 0x0b5c7a }]);
      said.textContent = `${words.point} ${hit.node} ${words.movesBy} ${mm(Math.hypot(...moved))} mm`
        + ` (${words.forward.toLowerCase()} ${signed(forward)}, ${words.up.toLowerCase()} ${signed(up)}, ${words.left.toLowerCase()} ${signed(left)})`
        + (error === undefined ? "" : ` ± ${mm(error)}`);
    });
  }

  /** The plan, from what was found or from the address; it stays unknown where neither says it. */
  private knowPlan(): void {
    const { state } = this.app.route;
    const found = this.results.optimisation?.plan;
    const names = (this.opened.document.segments ?? []).map(({ name }) => name);
    const parts = (found?.segments ?? []) as { name: string; pivot_mm?: Triple }[];
    const origins = Object.fromEntries(names.map((name) => [name, [0, 0, 0] as Triple]));
    this.pivots = found === undefined ? readPivots(state.get("p") ?? "")
      : { ...origins, ...Object.fromEntries(parts.map(({ name, pivot_mm = [0, 0, 0] as Triple }) => [name, pivot_mm])) };
    this.plan = found === undefined ? (state.has("p") ? read(state.get("p")!, names) : undefined)
      : fromDocument(found, this.pivots, this.opened.frame);
    if (this.plan === undefined) return;
    const inAddress = written(this.plan, this.pivots);
    state.set("p", inAddress);
    note({ p: inAddress });
  }

  private async bones(): Promise<void> {
    const { app, opened, bench } = this;
    if (this.plan === undefined) return;
    await addBones(app.service, opened, bench.scene);
    this.moveBones();
  }

  private moveBones(): void {
    for (const [name, motion] of Object.entries(this.plan ?? {})) {
      const part = Object.fromEntries(Object.entries(motion).map(([word, value]) => [word, this.share * value]));
      this.bench.scene.moveBone(name, matrix({ ...still(), ...part }, this.pivots[name] ?? [0, 0, 0], this.opened.frame));
    }
  }
}
