// The service at an address: documents go in, typed arrays come out, refusals are exceptions. Needs nothing but `fetch`,
// so that a page may import it as it is.
import { JobFailed, Refused } from "./errors.js";
import { Response as PlanResponse } from "./response.js";
import { authorization, post, type Uploading } from "./sending.js";
import { readGlb, type Surface } from "./surface.js";
import type { components } from "./rest.js";

export { FaciesError, JobFailed, NoKey, Refused } from "./errors.js";
export { Response, type Movement, type Triple } from "./response.js";
export { type Upload, type Uploading } from "./sending.js";
export { readGlb, type Surface } from "./surface.js";

export type Documents = components["schemas"];
type Job = Documents["StatusInfo"];
type Results = Documents["ResultDocument"];
export type Progress = (event: Documents["JobEvent"]) => unknown;
/** Further members of the document of a job. */
type Members<Document, Known extends keyof Document> = Partial<Omit<Document, "kind" | "case" | Known>>;
type PredictOptions = Members<Documents["PredictDocument"], "plan"> & { progress?: Progress; uploading?: Uploading };

/** How a volume mesh becomes a case: names of its node sets. Each segment of the plan is the set of its name. */
export interface MeshCase {
  volume: Blob;
  fixed: string[];
  skin?: string;
  units?: Documents["LengthUnit"];
  frame?: Documents["FrameName"];
}

/** A predicted skin; `results` is `result.json`. */
export interface Prediction {
  job: string;
  skin: Surface;
  /** xyz for each vertex of the skin, in mm. */
  displacement_mm: Float32Array;
  results: Results;
}

/** A plan that was found, with the skin that it gives. */
export interface Optimisation extends Prediction {
  found: Documents["OptimisationDocument"];
  /** As `predict` takes it. */
  plan: Documents["PlanDocument"];
}

/** A plan on a response as the service computes it, with what it says of that: `warnings`, `within_linear_range`, and
 * `nonlinearity_estimate_mm`, what the displacement leaves out, mean over the skin that moves. */
export type Applied = Omit<Documents["AppliedDocument"], "displacement_mm"> & {
  /** xyz for each node of the skin, in mm. */
  displacement_mm: Float32Array;
};

const WAIT = { Prefer: "wait=30" };
const JSON_TYPE = { "Content-Type": "application/json" };
const BUSY = [429, 503];
/** Between two requests to a busy service, also where something between us and it says less, or what is no number. */
const LEAST_PAUSE_S = 1;
const SKIN = "skin.glb";
const GLB = { Accept: "model/gltf-binary" };
const OCTETS = { Accept: "application/octet-stream" };

export class Facies {
  private readonly address: string;

  /** The service at an address, with a key where it asks for one; a busy one is waited for, so many seconds in all. */
  constructor(address: string, private readonly key?: string, private readonly patience_s = 60) {
    this.address = address.replace(/\/+$/, "");
  }

  /** The answer to any request; throws `Refused` where it is a refusal. */
  async ask(method: string, path: string, body?: BodyInit, headers: Record<string, string> = {}): Promise<Response> {
    return this.asked(() => this.send(method, path, body, headers));
  }

  private async asked(send: () => Promise<Response>): Promise<Response> {
    const until = Date.now() + this.patience_s * 1000;
    for (;;) {
      const answer = await send();
      if (answer.ok) return answer;
      // In seconds, as the service sends it.
      const pause = Math.max(Number(answer.headers.get("Retry-After")) || 0, LEAST_PAUSE_S) * 1000;
      if (!BUSY.includes(answer.status) || Date.now() + pause > until) throw await refusal(answer);
      await new Promise((resolve) => setTimeout(resolve, pause));
    }
  }

  /** The id of a mesh. The same bytes are the same mesh. */
  async upload(
    mesh: Blob, units: Documents["LengthUnit"] = "mm", frame: Documents["FrameName"] = "unspecified", uploading?: Uploading,
  ): Promise<string> {
    const path = `/v1/meshes?units=${units}&frame=${frame}`;
    const headers = { "Content-Type": "application/octet-stream" };
    if (uploading === undefined) return (await this.json("POST", path, mesh, headers)).id;
    const posted = { address: this.address + path, headers: { ...headers, ...this.authorization() }, file: mesh };
    const answer = await this.asked(() => post(posted, uploading));
    return (await answer.json()).id;
  }

  /** The id of a case that is stored. The document names meshes by their ids, or by the names of `meshes`. One with a
   * `meshing` is meshed from a scan or surfaces; jobs on it wait. */
  async createCase(document: Documents["CaseDocument"] | Documents["MeshedCaseDocument"], meshes: Record<string, Blob> = {}): Promise<string> {
    const form = new FormData();
    form.append("case", new Blob([JSON.stringify(document)], { type: "application/json" }));
    for (const [name, mesh] of Object.entries(meshes)) form.append(name, mesh);
    return (await this.json("POST", "/v1/cases", form)).id;
  }

  /** The skin after a plan, of a case by its id or of a volume mesh. */
  async predict(
    of: string | MeshCase, plan: Documents["PlanDocument"], options: PredictOptions = {},
  ): Promise<Prediction> {
    const { progress, uploading, outputs = ["skin.vtp"], ...members } = options;
    const id = typeof of === "string" ? of : await this.caseOfMesh(of, plan, uploading);
    const spec = { kind: "predict" as const, case: id, plan, ...members, outputs: withSkin(outputs) };
    return this.prediction(await this.run(spec, progress));
  }

  /** The columns of a case, with which plans take milliseconds. */
  async response(
    caseId: string, options: Members<Documents["ResponseDocument"], never> & { progress?: Progress } = {},
  ): Promise<PlanResponse> {
    const { progress, ...members } = options;
    const job = await this.run({ kind: "response", case: caseId, ...members }, progress);
    const path = `/v1/cases/${caseId}/response?job=${job.id}`;
    const [description, columns, rest] = await Promise.all([
      this.json("GET", path, undefined, { Accept: "application/json" }),
      this.bytes("GET", path, undefined, OCTETS),
      this.bytes("GET", path, undefined, GLB),
    ]);
    const second = description.second_order === undefined
      ? undefined : new Int16Array(await this.bytes("GET", `${path}&order=2`, undefined, OCTETS));
    return new PlanResponse(caseId, job.id, description, new Float32Array(columns), readGlb(rest), second);
  }

  /** How far each node of the skin goes as the service computes it, which refuses plans beyond its limits, and what it
   * says of that. */
  async apply(response: PlanResponse, plan: Documents["PlanDocument"]): Promise<Applied> {
    const path = `/v1/cases/${response.caseId}/response/apply?job=${response.job}`;
    const body = JSON.stringify({ plan });
    const said = await this.json("POST", path, body, { ...JSON_TYPE, Accept: "application/json" });
    return { ...said, displacement_mm: new Float32Array(said.displacement_mm.flat()) };
  }

  /** The plan within `bounds` that brings the skin nearest to `targets`. */
  async optimise(
    caseId: string, targets: Documents["OptimiseDocument"]["targets"], bounds: Record<string, Documents["BoundsDocument"]>,
    options: Members<Documents["OptimiseDocument"], "targets" | "bounds"> & { progress?: Progress } = {},
  ): Promise<Optimisation> {
    const { progress, outputs = ["skin.vtp"], ...members } = options;
    const spec = { verify: true, kind: "optimise" as const, case: caseId, targets, bounds, ...members, outputs: withSkin(outputs) };
    const prediction = await this.prediction(await this.run(spec, progress));
    const found = prediction.results.optimisation!;
    return { ...prediction, found, plan: found.plan };
  }

  /** A predicted skin against the surface of a mesh by its id. */
  async compare(prediction: Prediction, actual: string): Promise<Documents["ComparisonDocument"]> {
    const spec = { kind: "compare" as const, prediction: { job: prediction.job }, actual: { mesh: actual } };
    return (await this.run(spec as Documents["CompareDocument"])).results!.comparison!;
  }

  /** A file of a result. */
  async file(job: string, name: string): Promise<ArrayBuffer> {
    return this.bytes("GET", `/v1/jobs/${job}/results/${name}`);
  }

  /** The last state of a job of any kind; throws `JobFailed` where it ended without results. */
  async run(spec: Documents["JobDocument"], progress?: Progress): Promise<Job> {
    const waits = progress === undefined ? WAIT : {};
    let job: Job = await this.json("POST", "/v1/jobs", JSON.stringify(spec), { ...JSON_TYPE, ...waits });
    if (progress !== undefined) for await (const event of this.events(job.id)) progress(event);
    while (job.status === "accepted" || job.status === "running") {
      job = await this.json("GET", `/v1/jobs/${job.id}`, undefined, WAIT);
    }
    if (job.status !== "successful") throw new JobFailed(job);
    return job;
  }

  /** What happens to a job until it has ended. A stream that breaks is taken up where it broke. */
  async *events(job: string): AsyncGenerator<Documents["JobEvent"]> {
    let last = 0;
    for (;;) {
      const headers = { Accept: "text/event-stream", "Last-Event-ID": String(last) };
      const answer = await this.send("GET", `/v1/jobs/${job}/events`, undefined, headers);
      if (answer.status === 204 || BUSY.includes(answer.status)) return;
      if (!answer.ok) throw await refusal(answer);
      for await (const line of lines(answer)) {
        if (!line.startsWith("data:")) continue;
        const event = JSON.parse(line.slice("data:".length)) as Documents["JobEvent"];
        last = event.number;
        yield event;
      }
    }
  }

  private async caseOfMesh(mesh: MeshCase, plan: Documents["PlanDocument"], uploading?: Uploading): Promise<string> {
    const set = (name: string) => ({ node_set: name });
    const segments = (plan.segments ?? []).map(({ name }) => ({ name, nodes: set(name) }));
    const { units = "mm", frame = "LPS" } = mesh;
    const sent = uploading === undefined ? undefined : await this.upload(mesh.volume, units, frame, uploading);
    const document = {
      units, frame, volume: sent ?? "volume", segments,
      fixed: mesh.fixed.map(set), ...(mesh.skin === undefined ? {} : { skin: set(mesh.skin) }),
    };
    return this.createCase(document as Documents["CaseDocument"], sent === undefined ? { volume: mesh.volume } : {});
  }

  private async prediction(job: Job): Promise<Prediction> {
    const skin = readGlb(await this.file(job.id, SKIN));
    return { job: job.id, skin, displacement_mm: skin.values._DISPLACEMENT_MM!, results: job.results! };
  }

  private send(method: string, path: string, body?: BodyInit, headers: Record<string, string> = {}): Promise<Response> {
    const all = { ...headers, ...this.authorization() };
    // The service sends no redirect, and the key is for no other one.
    return fetch(this.address + path, { method, headers: all, redirect: "error", ...(body === undefined ? {} : { body }) });
  }

  private authorization(): Record<string, string> {
    return authorization(this.key);
  }

  private async json(...request: Parameters<Facies["ask"]>) {
    return (await this.ask(...request)).json();
  }

  private async bytes(...request: Parameters<Facies["ask"]>): Promise<ArrayBuffer> {
    return (await this.ask(...request)).arrayBuffer();
  }
}

function withSkin(outputs: Documents["OutputName"][]): Documents["OutputName"][] {
  return [...new Set([...outputs, SKIN as Documents["OutputName"]])];
}

/** The lines of an answer as they come, until it ends or breaks. */
async function* lines(answer: Response): AsyncGenerator<string> {
  const reader = answer.body!.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const piece = await reader.read().catch(() => ({ done: true as const, value: undefined }));
    if (piece.done) return;
    const parts = (rest + piece.value).split("\n");
    rest = parts.pop()!;
    yield* parts;
  }
}

/** The problem of an answer, or its status where something between us and the service answered. */
async function refusal(answer: Response): Promise<Refused> {
  const text = await answer.text();
  try {
    const problem = JSON.parse(text) as Documents["ProblemDocument"];
    if (typeof problem.code === "string") return new Refused(problem);
  } catch { /* not a document of the service */ }
  const detail = `${answer.url} answered ${text.slice(0, 200)}`;
  return new Refused({ type: "", title: "", status: answer.status, code: "not-of-the-service", detail });
}
