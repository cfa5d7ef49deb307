// A predicted skin against a real one: what was registered, distances on the skin, and their shares.
import { readGlb, type Documents, type Job } from "../api.js";
import { ProgressLine, refusal, type App, type Leave } from "../app.js";
import { button, choice, make, select } from "../dom.js";
import { meshOf, openCase, type Opened } from "../loading.js";
import { nodeAreas } from "../regions.js";
import { note } from "../route.js";
import type { Shape } from "../scene.js";
import { readVtp } from "../vtp.js";
import { Workbench } from "../workbench.js";
import { crumbs } from "./crumbs.js";
import { jobInWords } from "./called.js";
import { comparisonFacts, histogram } from "./distances.js";
import { alignDocument, registrations, stayingBones, type Registration } from "./registration.js";
import { reportLinks } from "./reports.js";

type How = "one" | "overlay" | "sides";

export async function comparePage(app: App): Promise<Leave> {
  const { service, words, route } = app;
  const opened = await openCase(service, route.path[1]!);
  const jobs = await service.list<Job>(`/v1/jobs?case=${opened.id}&status=successful`, 100);
  const bench = new Workbench(app, crumbs(words, opened.id, opened.name, "comparison"));
  bench.scene.orient(opened.frame);
  bench.offer([]);
  // Others that read this case among others are not of it.
  const predictions = jobs.filter((job) => job.case === opened.id && (job.kind === "predict" || job.kind === "optimise"));
  await new Comparing(app, opened, bench, predictions).start();
  return () => bench.leave();
}

class Comparing {
  private job: Job | undefined;
  private align: Registration = "none";
  /** The bone of the case that a bone of the scan is laid on. */
  private bone = "";
  /** What the registered real skin is drawn as. */
  private actual: Shape | undefined;
  private how: How;
  private turn = 0;
  private readonly said = make("div", { role: "status" });
  private readonly ways = make("div", {});
  private readonly facts = make("div", {});

  constructor(private readonly app: App, private readonly opened: Opened, private readonly bench: Workbench, private readonly predictions: Job[]) {
    const { state } = app.route;
    this.job = predictions.find(({ id }) => id === state.get("job")) ?? predictions[0];
    this.how = (["one", "sides"] as const).find((one) => one === state.get("show")) ?? "overlay";
  }

  async start(): Promise<void> {
    const { app: { words, route, service }, bench, job } = this;
    bench.section(words.comparison, make("p", {}, words.compareWhy),
      job === undefined ? make("p", { className: "warned" }, words.noPredictions) : this.form(job), this.said);
    bench.panel.append(this.facts);
    const stated = route.state.get("comparison");
    if (stated !== null) await this.show(await service.get<Job>(`/v1/jobs/${stated}`), route.state.get("actual") ?? undefined);
    else if (job !== undefined) await this.predicted(job);
  }

  private form(chosen: Job): HTMLElement {
    const { words } = this.app;
    const skin = this.picker(words.actual, { actual: "" });
    const scanned = this.picker(words.scannedBone, { bone: "" });
    const bones = stayingBones(this.opened.document);
    this.bone = bones[0]?.mesh ?? "";
    const onBone = make("div", { className: "stack", hidden: true },
      select(words.boneOfCase, bones.map(({ name, mesh }) => [mesh, name] as const), this.bone, (mesh) => { this.bone = mesh; }), scanned.element);
    const compare = button(words.compareNow, () => {
      const missing = [skin, ...(this.align === "surfaces" ? [scanned] : [])].find(({ input }) => (input.files?.length ?? 0) === 0);
      if (missing !== undefined) { missing.input.click(); return; }
      this.compare(skin.input.files![0]!, scanned.input.files?.[0]).catch((error: unknown) => this.said.replaceChildren(refusal(error, words)));
    }, { className: "primary" });
    const ways = choice(words.align, registrations(words, this.opened.document), this.align, (value) => { this.align = value; onBone.hidden = value !== "surfaces"; });
    return make("div", { className: "stack" },
      select(words.chooseJob, this.predictions.map((one) => [one.id, jobInWords(words, one)] as const), chosen.id, (id) => this.choose(id)),
      skin.element, ways, make("p", { className: "fine" }, words.alignHint), onBone, compare);
  }

  /** A field for the file of a surface. */
  private picker(label: string, data: Record<string, string>): { element: HTMLElement; input: HTMLInputElement } {
    const { words } = this.app;
    const input = make("input", { type: "file", accept: ".vtp,.stl,.ply", hidden: true, data });
    // The browser's own button speaks the language of the browser.
    const name = make("span", { className: "fine" });
    input.addEventListener("change", () => { name.textContent = input.files?.[0]?.name ?? ""; });
    return { input, element: make("div", { className: "field" }, make("span", {}, label),
      make("div", { className: "row" }, button(words.chooseFile, () => input.click(), { aria: { label: `${words.chooseFile}: ${label}` } }), name, input)) };
  }

  /** Another prediction, with which nothing was compared yet. */
  private choose(id: string): void {
    const job = this.predictions.find((one) => one.id === id);
    if (job === undefined) return;
    this.job = job;
    note({ job: id, comparison: undefined, actual: undefined });
    this.said.replaceChildren();
    this.facts.replaceChildren();
    this.predicted(job).catch((error: unknown) => this.said.replaceChildren(refusal(error, this.app.words)));
  }

  /** The skin of a prediction alone. */
  private async predicted({ id, results }: Job): Promise<void> {
    const { app: { service }, bench } = this;
    const turn = (this.turn += 1);
    const has = (name: string) => results?.files.some((one) => one.name === name) ?? false;
    const skin = has("skin.glb") ? readGlb(await service.file(id, "skin.glb")) : has("skin.vtp") ? await readVtp(await service.file(id, "skin.vtp")) : undefined;
    if (turn !== this.turn) return;
    this.actual = undefined;
    this.beside();
    bench.offer([]);
    if (skin === undefined) return;
    bench.scene.showSkin(skin);
    bench.start();
  }

  private async compare(surface: File, scanned: File | undefined): Promise<void> {
    const { app: { service, words }, opened, job } = this;
    const line = new ProgressLine(words, words.comparison);
    this.said.replaceChildren(line.element);
    const { align, bone } = this;
    const sent = (file: File) => service.upload(file, "mm", opened.frame, (upload) => line.tell({ status: words.sending, ...upload }));
    const mesh = await sent(surface);
    const moving = align === "surfaces" ? await sent(scanned!) : undefined;
    const spec = { kind: "compare", prediction: { job: job!.id }, actual: { mesh }, align: alignDocument(align, bone, moving) };
    const done = await service.run(spec as Documents["JobDocument"], (event) => line.tell(event));
    // Another prediction may have been chosen meanwhile.
    if (this.job !== job) return;
    note({ job: job!.id, comparison: done.id, actual: mesh });
    this.said.replaceChildren();
    await this.show(done, mesh);
  }

  /** The predicted skin, coloured by its signed distance to the real one, and that where its registration puts it. */
  private async show(job: Job, mesh: string | undefined): Promise<void> {
    const { app, app: { service, words }, bench, opened } = this;
    const turn = (this.turn += 1);
    const comparison = job.results!.comparison!;
    const skin = await readVtp(await service.file(job.id, "skin.vtp"));
    const real = mesh === undefined ? undefined : await meshOf(service, mesh, opened.frame).catch((error: unknown) => {
      this.said.replaceChildren(refusal(error, words));
      return undefined;
    });
    if (turn !== this.turn) return;
    bench.scene.showSkin(skin);
    const distances = skin.values.signed_distance_mm;
    bench.offer(distances === undefined ? [] : [{ name: "distance", label: words.signedDistance, scheme: "signed", range_mm: 2, values: () => distances }], "distance");
    bench.start();
    bench.caption.textContent = `${opened.name} · ${words.comparison}`;
    bench.provenance = `job ${job.id}`;
    this.actual = real === undefined ? undefined : { ...real, points_mm: moved(real.points_mm, comparison.alignment.matrix4x4) };
    this.beside();
    this.facts.replaceChildren(make("section", {}, make("h2", {}, words.histogram), this.ways, comparisonFacts(app, comparison),
      distances === undefined ? "" : histogram(words, distances, nodeAreas(skin.points_mm, skin.triangles)), reportLinks(app, job) ?? ""));
  }

  /** The real skin as an outline over the predicted one, beside it, or not. */
  private beside(): void {
    const { actual, bench, how, app: { words } } = this;
    bench.scene.overlay(how === "overlay" ? actual : undefined);
    bench.scene.beside(how === "sides" ? actual : undefined);
    bench.halves(how === "sides" && actual !== undefined ? [words.actualSkin, words.kinds.predict!] : undefined);
    this.ways.replaceChildren(...(actual === undefined ? [] : [
      choice(words.shown, [["one", words.predictionAlone], ["overlay", words.overlay], ["sides", words.sides]] as const, how, (value) => {
        this.how = value;
        note({ show: value === "overlay" ? undefined : value });
        this.beside();
      }), make("p", { className: "fine" }, words.actualHint)]));
  }
}

/** Points moved by a row-major 4x4 matrix. */
function moved(points_mm: Float32Array, matrix: number[]): Float32Array {
  return points_mm.map((_, at) => {
    const [row, first] = [4 * (at % 3), at - (at % 3)];
    return matrix[row]! * points_mm[first]! + matrix[row + 1]! * points_mm[first + 1]! + matrix[row + 2]! * points_mm[first + 2]! + matrix[row + 3]!;
  });
}
