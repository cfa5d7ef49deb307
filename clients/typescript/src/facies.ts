// The service at an address: documents go in, typed arrays come out, refusals are exceptions. Needs nothing but `fetch`,
// so that a page may import it as it is.
import { JobFailed, Refused, Unreachable } from "./errors.js";
import { heard, Patience } from "./patience.js";
import { Response as PlanResponse } from "./response.js";
import { authorization, post, Secrets, type Uploading } from "./sending.js";
import { readGlb, type Surface } from "./surface.js";
import type { components } from "./rest.js";

export { FaciesError, JobFailed, NoKey, Refused, Unreachable } from "./errors.js";
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

/** Distances between two surfaces, with what a reader of them must know: a scan that is mirrored, apart, or of another person. */
export type Comparison = Documents["ComparisonDocument"] & { job: string; warnings: Results["warnings"] };

/** A plan on a response as the service computes it, with what it says of that: `warnings`, `within_linear_range`, and
 * `nonlinearity_estimate_mm`, what the displacement leaves out, mean over the skin that moves. */
export type Applied = Omit<Documents["AppliedDocument"], "displacement_mm"> & {
  /** xyz for each node of the skin, in mm. */
  displacement_mm: Float32Array;
};

const WAIT = { Prefer: "wait=30" };
const JSON_TYPE = { "Content-Type": "application/json" };
const BUSY = [429, 503];
/** What a proxy says of a service that it does not reach. The request may have reached it. */
const OF_PROXY = [502, 504];
const ENDED = ["successful", "failed", "dismissed"];
const SKIN = "skin.glb";
const GLB = { Accept: "model/gltf-binary" };
const OCTETS = { Accept: "application/octet-stream" };

export class Facies {
  private readonly address: string;
  private readonly secrets: Secrets;

  /** The service at an address, with a key where it asks for one; a busy one is waited for, so many seconds in all. One that is
   * out of reach, as while it is started again, is by requests that only read, for as long or `away_s`. Whatever asks throws
   * `Unreachable` where it gets no answer. */
  constructor(address: string, private readonly key?: string, private readonly patience_s = 60, private readonly away_s = patience_s) {
    this.address = address.replace(/\/+$/, "");
    this.secrets = new Secrets(address, key);
  }

  /** The answer to any request; throws `Refused` where it is a refusal, and `Unreachable` where there is none. One that may change
   * something is sent again to a busy service alone, unless it has an `Idempotency-Key`. */
  async ask(method: string, path: string, body?: BodyInit, headers: Record<string, string> = {}): Promise<Response> {
    const isKnown = Object.keys(headers).some((name) => name.toLowerCase() === "idempotency-key");
    const mayRepeat = method === "GET" || method === "HEAD" || isKnown;
    return this.asked(() => this.send(method, path, body, headers), method, path, mayRepeat);
  }

  private async asked(send: () => Promise<Response>, method: string, path: string, mayRepeat: boolean): Promise<Response> {
    const patience = new Patience();
    for (;;) {
      let answer: Response;
      try {
        answer = await whole(await send());
      } catch (error) {
        // Of `fetch`, and of a body that breaks off.
        if (!(error instanceof TypeError)) throw error;
        if (mayRepeat && await patience.pause(this.away_s)) continue;
        throw new Unreachable(method, path, this.secrets.hiddenIn(error));
      }
      if (answer.ok) return answer;
      const most_s = this.waits(answer.status);
      const passes = most_s !== undefined && (mayRepeat || BUSY.includes(answer.status));
      if (!passes || !await patience.pause(most_s, retryAfter(answer))) throw await this.refusal(answer, path);
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
    return (await this.document(await this.asked(() => post(posted, uploading), "POST", path, false), path)).id;
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
  async compare(prediction: Prediction, actual: string): Promise<Comparison> {
    const spec = { kind: "compare" as const, prediction: { job: prediction.job }, actual: { mesh: actual } };
    const job = await this.run(spec as Documents["CompareDocument"]);
    return { ...job.results!.comparison!, job: job.id, warnings: job.results!.warnings };
  }

  /** A file of a result. */
  async file(job: string, name: string): Promise<ArrayBuffer> {
    return this.bytes("GET", `/v1/jobs/${job}/results/${name}`);
  }

  /** The last state of a job of any kind; throws `JobFailed` where it ended without results. Where `Unreachable` names no `job`, the
   * same call finds it again: equal inputs are one job. */
  async run(spec: Documents["JobDocument"], progress?: Progress): Promise<Job> {
    const waits = progress === undefined ? WAIT : {};
    let job: Job = await this.json("POST", "/v1/jobs", JSON.stringify(spec), { ...JSON_TYPE, ...waits });
    // Where there is no place for a stream, the job is asked for.
    if (progress !== undefined) for await (const event of this.follow(job.id)) progress(event);
    while (job.status === "accepted" || job.status === "running") {
      job = await this.json("GET", `/v1/jobs/${job.id}`, undefined, WAIT);
    }
    if (job.status !== "successful") throw new JobFailed(job);
    return job;
  }

  /** What happens to a job until it has ended. A stream that breaks is taken up where it broke; throws `Unreachable`, or `Refused`
   * where the service is busy, when nothing has come of it for `patience_s`. */
  async *events(job: string): AsyncGenerator<Documents["JobEvent"]> {
    const refused = yield* this.follow(job);
    if (refused !== undefined) throw refused;
  }

  /** The events, then the refusal of a busy service where they are not all. */
  protected async *follow(job: string): AsyncGenerator<Documents["JobEvent"], Refused | undefined> {
    const path = `/v1/jobs/${job}/events`;
    const patience = new Patience();
    for (let last = 0; ;) {
      let [hasEnded, told, refused, broken]: [boolean, number?, Refused?, unknown?] = [false];
      const headers = { Accept: "text/event-stream", "Last-Event-ID": String(last) };
      let answer: Response | undefined;
      try {
        answer = await this.send("GET", path, undefined, headers);
        if (!answer.ok) [told, refused] = [retryAfter(answer), await this.refusal(await whole(answer), path)];
      } catch (error) {
        if (!(error instanceof TypeError)) throw error;
        broken = this.secrets.hiddenIn(error);
      }
      if (answer?.status === 204) return undefined;
      const most_s = refused === undefined ? this.away_s : this.waits(answer!.status);
      if (most_s === undefined) throw refused;
      for await (const line of answer?.ok ? lines(answer) : []) {
        const event = eventOf(line);
        // The stream broke in it.
        if (event === undefined && line.startsWith("data:")) {
          hasEnded = false;
          break;
        }
        // Not what a proxy has kept.
        const isNew = event !== undefined && event.number > last;
        // Events, and what the service sends in a silent stream.
        if (isNew || line.startsWith(":")) patience.renew();
        if (!isNew) continue;
        [last, hasEnded] = [event.number, ENDED.includes(event.status)];
        yield event;
      }
      // After the end there is one more answer, that it was the last.
      if (hasEnded || await patience.pause(most_s, told)) continue;
      if (refused !== undefined) return refused;
      throw new Unreachable("GET", path, broken);
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
    // The service sends no redirect, and the key is for no other one: it is an answer as a refusal is.
    const request = { method, headers: all, redirect: "manual", ...(body === undefined ? {} : { body }) } as const;
    const isFile = body !== undefined && typeof body !== "string";
    // Nobody can tell how far a file is.
    return isFile ? fetch(this.address + path, request) : heard((signal) => fetch(this.address + path, { ...request, signal }));
  }

  /** How long a refusal is waited out, in seconds; `undefined` where it is for good. */
  private waits(status: number): number | undefined {
    return BUSY.includes(status) ? this.patience_s : OF_PROXY.includes(status) ? this.away_s : undefined;
  }

  private authorization(): Record<string, string> {
    return authorization(this.key);
  }

  private async json(...request: Parameters<Facies["ask"]>) {
    return this.document(await this.ask(...request), request[1]);
  }

  private async bytes(...request: Parameters<Facies["ask"]>): Promise<ArrayBuffer> {
    return (await this.ask(...request)).arrayBuffer();
  }

  /** The document of an answer; throws `Refused` where it is none. */
  private async document(answer: Response, path: string) {
    const text = await answer.text();
    const document = parsed(text);
    if (document === undefined) throw this.ofAnother(answer, text, path);
    return document;
  }

  /** The problem of an answer, or its status where something between us and the service answered. */
  private async refusal(answer: Response, path: string): Promise<Refused> {
    const text = await answer.text();
    const problem = this.secrets.hidden(parsed(text));
    try {
      if (typeof problem?.code === "string") return new Refused(problem);
    } catch { /* not a document of the service */ }
    return this.ofAnother(answer, text, path);
  }

  /** The status and the beginning of an answer of something between us and the service. */
  private ofAnother(answer: Response, text: string, path: string): Refused {
    // Without secrets before the cut, which would leave a part of them.
    const detail = `${this.secrets.hidden(this.address + path)} answered ${this.secrets.hidden(text).slice(0, 200)}`;
    return new Refused({ type: "", title: "", status: answer.status, code: "not-of-the-service", detail });
  }
}

function withSkin(outputs: Documents["OutputName"][]): Documents["OutputName"][] {
  return [...new Set([...outputs, SKIN as Documents["OutputName"]])];
}

/** The event of a line of a stream, or `undefined` where it has none or the stream broke in it. */
function eventOf(line: string): Documents["JobEvent"] | undefined {
  const event = line.startsWith("data:") ? parsed(line.slice("data:".length)) : undefined;
  return typeof event?.number === "number" && typeof event.status === "string" ? event : undefined;
}

/** An answer with all its bytes; one that breaks off is none. */
async function whole(answer: Response): Promise<Response> {
  if (answer.body === null) return answer;
  const all: BlobPart[] = [];
  for await (const piece of pieces(answer.body)) all.push(piece as Uint8Array<ArrayBuffer>);
  const { status, statusText, headers } = answer;
  return new Response(all.length === 0 ? null : new Blob(all), { status, statusText, headers });
}

/** The lines of an answer as they come, until it ends or breaks. */
async function* lines(answer: Response): AsyncGenerator<string> {
  let rest = "";
  try {
    for await (const piece of pieces(answer.body!.pipeThrough(new TextDecoderStream()))) {
      const parts = (rest + piece).split("\n");
      rest = parts.pop()!;
      yield* parts;
    }
  } catch { /* as if it had ended there */ }
}

/** The pieces of a body as they come. */
async function* pieces<T>(body: ReadableStream<T>): AsyncGenerator<T> {
  const reader = body.getReader();
  try {
    for (;;) {
      const { done, value } = await heard(() => reader.read());
      if (done) return;
      yield value;
    }
  } finally {
    // The connection of one that is read no further.
    void reader.cancel().catch(() => undefined);
  }
}

/** The pause that an answer asks for, in seconds as the service sends it; `undefined` where it has no such number. */
function retryAfter(answer: Response): number | undefined {
  const told = answer.headers.get("Retry-After") ?? "";
  return /^\d+$/.test(told) ? Number(told) : undefined;
}

/** The object of a text, `undefined` where it is none. */
function parsed(text: string): any {
  try {
    const said: unknown = JSON.parse(text);
    return typeof said === "object" && said !== null && !Array.isArray(said) ? said : undefined;
  } catch {
    return undefined;
  }
}
