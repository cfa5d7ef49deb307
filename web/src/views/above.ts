// A result with a surface of its own kind: where learned methods err, or a template on a patient, above its charts and tables.
import type { Job } from "../api.js";
import type { App, Leave } from "../app.js";
import { make } from "../dom.js";
import { when } from "../figures.js";
import type { FrameName } from "../frame.js";
import { meshOf } from "../loading.js";
import type { Shape } from "../scene.js";
import { readVtp } from "../vtp.js";
import { Workbench, type SkinMap } from "../workbench.js";
import { kindOf } from "./kinds.js";
import { learnedInShort } from "./learned.js";
import { plainResult } from "./plain.js";

/** Where methods err, of a job of learning. */
const ERRORS = "errors.vtp";
/** Arrays of that file: the mean error of a method over the cases. */
const ARRAY = /^mean_error_(.+)_mm$/;

interface Surface {
  shape: Shape;
  maps: SkinMap[];
  told: HTMLElement | undefined;
}

/** Draws the result; without a surface its charts and tables alone. */
export async function resultBeside(app: App, job: Job): Promise<Leave> {
  const { stage, words } = app;
  const facts = await plainResult(app, job);
  const frame = (job.results?.provenance?.frame ?? "unspecified") as FrameName;
  const surface = await surfaceOf(app, job, frame);
  if (surface === undefined) {
    stage.replaceChildren(...facts);
    return () => {};
  }
  const bench = new Workbench(app, make("div", { className: "crumbs" }, make("h1", {}, kindOf(words, job.kind)), make("span", { className: "fine" }, when(job.created))));
  bench.scene.orient(frame);
  bench.scene.showSkin(surface.shape);
  bench.section(kindOf(words, job.kind), surface.told);
  bench.offer(surface.maps);
  bench.caption.textContent = kindOf(words, job.kind);
  bench.provenance = `job ${job.id}`;
  bench.start();
  // The heading and the time stand there already.
  stage.append(make("div", { className: "below" }, ...facts.slice(2)));
  return () => bench.leave();
}

async function surfaceOf({ service, words }: App, job: Job, frame: FrameName): Promise<Surface | undefined> {
  const { files = [], learning, conformation } = job.results ?? {};
  if (learning && files.some(({ name }) => name === ERRORS)) {
    const { values, ...shape } = await readVtp(await service.file(job.id, ERRORS));
    const maps = Object.entries(values).filter(([name]) => ARRAY.test(name)).map(([array, errors]): SkinMap => {
      const method = ARRAY.exec(array)![1]!.replaceAll("_", " ");
      return { name: array, label: `${words.meanError}: ${method}`, scheme: "length", range_mm: 2, values: () => errors };
    });
    return { shape, maps, told: make("div", {}, learnedInShort(words, learning), make("p", { className: "fine" }, words.errorMapHint)) };
  }
  const volume = conformation?.case.volume;
  if (volume === undefined || volume === null) return undefined;
  // The mesh may have gone since.
  const shape = await meshOf(service, volume, frame).catch(() => undefined);
  return shape === undefined ? undefined : { shape, maps: [], told: make("p", { className: "fine" }, words.conformedHint) };
}
