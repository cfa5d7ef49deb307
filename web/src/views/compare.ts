// A predicted skin against a real one: what was registered, distances on the skin, and their shares.
import { readGlb, type Documents, type Job } from "../api.js";
import { ProgressLine, refusal, type App, type Leave } from "../app.js";
import { button, choice, make, select } from "../dom.js";
import { openCase, type Opened } from "../loading.js";
import { note } from "../route.js";
import { readVtp } from "../vtp.js";
import { Workbench } from "../workbench.js";
import { crumbs } from "./crumbs.js";
import { jobInWords } from "./called.js";
import { comparisonFacts, histogram } from "./distances.js";

export async function comparePage(app: App): Promise<Leave> {
  const { service, words, route } = app;
  const opened = await openCase(service, route.path[1]!);
  const jobs = await service.list<Job>(`/v1/jobs?case=${opened.id}&status=successful`, 100);
  const bench = new Workbench(app, crumbs(words, opened.id, opened.name, "comparison"));
  bench.scene.orient(opened.frame);
  bench.offer([]);
  // Others that read this case among others are not of it.
  const predictions = jobs.filter((job) => job.case === opened.id && (job.kind === "predict" || job.kind === "optimise"));
  bench.section(words.comparison, make("p", {}, words.compareWhy),
    predictions.length === 0 ? make("p", { className: "warned" }, words.noPredictions) : form(app, opened, bench, predictions));
  const chosen = predictions.find(({ id }) => id === route.state.get("job")) ?? predictions[0];
  if (chosen?.results?.files.some(({ name }) => name === "skin.glb")) {
    bench.scene.showSkin(readGlb(await service.file(chosen.id, "skin.glb")));
    bench.start();
  }
  const stated = route.state.get("comparison") ?? undefined;
  const before = stated === undefined ? undefined : jobs.find(({ id }) => id === stated) ?? await service.get<Job>(`/v1/jobs/${stated}`);
  if (before !== undefined) await show(app, bench, before);
  return () => bench.leave();
}

function form(app: App, opened: Opened, bench: Workbench, predictions: Job[]): HTMLElement {
  const { words, route, service } = app;
  let job = route.state.get("job") ?? predictions[0]!.id;
  let align = "icp";
  const said = make("div", { role: "status" });
  const file = make("input", { type: "file", accept: ".vtp,.stl,.ply", aria: { label: words.actual } });
  const compare = button(words.compareNow, () => {
    const [surface] = file.files ?? [];
    if (surface === undefined) { file.click(); return; }
    const line = new ProgressLine(words, words.comparison);
    said.replaceChildren(line.element);
    void (async () => {
      const mesh = await service.upload(surface, "mm", opened.frame, (upload) => line.tell({ status: words.sending, ...upload }));
      const spec = { kind: "compare", prediction: { job }, actual: { mesh }, align };
      const done = await service.run(spec as Documents["JobDocument"], (event) => line.tell(event));
      note({ comparison: done.id });
      await show(app, bench, done);
      said.replaceChildren();
    })().catch((error: unknown) => said.replaceChildren(refusal(error, words)));
  }, { className: "primary" });
  return make("div", { className: "stack" },
    select(words.chooseJob, predictions.map((one) => [one.id, jobInWords(words, one)] as const), job, (value) => { job = value; }),
    make("label", { className: "field" }, make("span", {}, words.actual), file),
    choice(words.align, [["icp", words.alignIcp], ["none", words.alignNone]] as const, "icp", (value) => { align = value; }), compare, said);
}

/** The predicted skin, coloured by its signed distance to the real one. */
async function show(app: App, bench: Workbench, job: Job): Promise<void> {
  const { service, words } = app;
  const skin = await readVtp(await service.file(job.id, "skin.vtp"));
  bench.scene.showSkin(skin);
  const distances = skin.values.signed_distance_mm;
  note({ map: "distance" });
  bench.offer([{ name: "distance", label: words.signedDistance, scheme: "signed", range_mm: 2, values: () => distances }]);
  bench.start();
  const { comparison } = job.results!;
  const old = bench.panel.querySelector("[data-facts]");
  const section = bench.section(words.histogram, comparisonFacts(app, comparison!),
    ...(distances === undefined ? [] : [histogram(words, distances)]));
  section.dataset.facts = "";
  old?.remove();
}
