// A case: its meshes, what the check found, and what holds it.
import type { Case, Documents, Job } from "../api.js";
import { ProgressLine, refusal, warnings, type App, type Leave } from "../app.js";
import { button, make } from "../dom.js";
import { addBones, openCase, showBoundary, type Opened } from "../loading.js";
import { address } from "../route.js";
import { count, figure } from "../figures.js";
import { Workbench } from "../workbench.js";
import { crumbs } from "./crumbs.js";
import { placesOf } from "./places.js";
import { setsSection } from "./sets.js";

type Fact = [string, string];

export async function casePage(app: App): Promise<Leave> {
  const { service, words } = app;
  const opened = await openCase(service, app.route.path[1]!);
  if (opened.view.state !== "ready") return meshing(app, opened);
  const bench = new Workbench(app, crumbs(words, opened.id, opened.name, "overview"));
  bench.scene.orient(opened.frame);
  bench.panel.append(make("section", {}, make("a", { className: "button primary", href: address(["case", opened.id, "plan"]) }, words.planIt)));
  const { check } = opened.view;
  const loose = Object.entries(check?.classes.joined ?? {}).filter(([, count]) => count === 0).map(([name]) => name);
  if (check !== undefined) bench.section(words.checkFound, ...loose.map((name) => make("p", { className: "warned" }, words.joinedToNothing(name))), facts(checked(app, check)));
  bench.section(words.warnings, warnings(check?.warnings, words, placesOf(words, opened, bench.scene, () => ({}))));
  const place = bench.section(words.sets);
  bench.section(words.classes, held(app, opened));
  bench.section(words.meshes, ...(opened.view.meshes ?? []).map((mesh) => facts(meshFacts(app, mesh))));
  bench.section(words.document, make("details", {}, make("summary", {}, "JSON"), make("pre", {}, make("code", {}, JSON.stringify(opened.document, null, 2)))));
  try {
    const shown = showBoundary(service, opened, bench).then((nodes) => { bench.start(); return nodes; });
    const [nodes] = await Promise.all([shown, addBones(service, opened, bench.scene)]);
    await setsSection(app, opened, bench, place, nodes);
  } catch (error) {
    bench.panel.prepend(refusal(error, words));
  }
  return () => bench.leave();
}

function facts(list: Fact[]): HTMLElement {
  return make("dl", { className: "facts" }, ...list.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
}

function checked({ words }: App, check: Documents["CheckDocument"]): Fact[] {
  const { classes, skin } = check;
  const joined = Object.entries(classes.joined).map(([name, nodes]): Fact => [`${words.joined}: ${name}`, count(nodes)]);
  return [
    [words.nodes, count(check.nodes)], [words.cells, count(check.cells)], ...joined,
    [words.fixed, count(classes.fixed)], [words.sliding, count(classes.sliding)], [words.free, count(classes.free)],
    [`${words.skin}, ${words.triangles}`, count(skin.triangles)], [`${words.skin}, ${words.area}`, `${figure(skin.area_mm2 / 100, 0)} cm²`],
    [words.unknowns, check.unknowns === undefined ? "–" : count(check.unknowns!)], [words.memory, check.memory_mb === undefined ? "–" : `${figure(check.memory_mb!, 0)} MB`],
    [words.time, check.time_s === undefined || check.time_s === null ? "–" : `${figure(check.time_s.low, 1)} … ${figure(check.time_s.high, 1)} ${words.seconds}`],
  ];
}

function meshFacts({ words }: App, { report, format, units, frame }: Documents["MeshDocument"]): Fact[] {
  const quality: Fact[] = report.min_quality === undefined || report.min_quality === null ? [] : [[words.quality, figure(report.min_quality, 3)]];
  const sets: Fact[] = Object.entries(report.node_sets ?? {}).map(([name, count]) => [name, String(count)]);
  return [[`${report.kind} · ${format}`, `${units} · ${frame}`], [words.nodes, count(report.nodes)], ...quality, ...sets];
}

/** The picture that the service draws of what holds the boundary. */
function held({ service, words }: App, { id }: Opened): HTMLElement {
  const into = make("div", {});
  const draw = button(words.classes, () => {
    service.ask("POST", `/v1/cases/${id}/check`, undefined, { Accept: "image/svg+xml" }).then(async (answer) => {
      const address = URL.createObjectURL(await answer.blob());
      into.replaceChildren(make("img", { className: "drawing", src: address, alt: words.classesHint }));
    }).catch((error: unknown) => into.replaceChildren(refusal(error, words)));
  });
  return make("div", {}, make("p", { className: "fine" }, words.classesHint), into, draw);
}

/** A case whose mesh is being made of a scan or of surfaces. */
async function meshing(app: App, opened: Opened): Promise<Leave> {
  const { service, words, stage } = app;
  const { meshing: made } = opened.view as Case;
  let left = false;
  const line = new ProgressLine(words, words.running, made === undefined || made === null ? undefined : {
    text: words.cancel, clicked: () => service.ask("DELETE", `/v1/jobs/${made.job}`),
  });
  stage.replaceChildren(crumbs(words, undefined, opened.name, "overview"), make("div", { className: "card" }, line.element));
  if (made === undefined || made === null) return () => {};
  void (async () => {
    for await (const event of service.events(made.job)) { if (left) return; line.tell(event); }
    const job = await service.get<Job>(`/v1/jobs/${made.job}`);
    if (left) return;
    if (job.status === "successful") location.reload();
    else stage.append(make("div", { className: "refusal", role: "alert" }, job.error?.detail ?? job.message));
  })().catch((error: unknown) => stage.append(refusal(error, words)));
  return () => { left = true; };
}
