// The documents, bones and response of a case, as the page shows them.
import { JobFailed, Refused, type Case, type CaseDocument, type Documents, type Job, type Service, readGlb } from "./api.js";
import { ProgressLine, type App } from "./app.js";
import { readColumns, type Columns } from "./columns.js";
import { tail } from "./views/called.js";
import type { FrameName } from "./frame.js";
import { inFrame, readPly } from "./ply.js";
import { pointArrays } from "./vtp.js";
import type { Scene, Shape } from "./scene.js";
import type { Workbench } from "./workbench.js";

export interface Opened {
  id: string;
  view: Case;
  document: CaseDocument;
  frame: FrameName;
  name: string;
}

export async function openCase(service: Service, id: string): Promise<Opened> {
  const view = await service.get<Case>(`/v1/cases/${id}`);
  const document = view.case as CaseDocument;
  return { id, view, document, frame: document.frame ?? "unspecified", name: document.name ?? tail(id) };
}

/** A surface that the service has, or the boundary of a volume with its nodes, as it lies in the frame of the case. */
export async function meshOf(service: Service, id: string, frame: FrameName): Promise<Shape & { node_ids?: Uint32Array }> {
  const answer = await service.ask("GET", `/v1/meshes/${id}/content?format=ply`);
  const { triangles, node_ids, ...surface } = readPly(await answer.arrayBuffer());
  return { points_mm: inFrame({ ...surface, triangles }, frame), triangles, ...(node_ids === undefined ? {} : { node_ids }) };
}

/** For each set of a volume mesh, and each of so many nodes, whether it is in it. */
export async function setsOf(service: Service, id: string, nodes: Uint32Array): Promise<Record<string, Uint8Array>> {
  const content = await (await service.ask("GET", `/v1/meshes/${id}/content`)).arrayBuffer();
  const arrays = await pointArrays(content, (name) => name.startsWith(SET));
  return Object.fromEntries(Object.entries(arrays).map(([name, inside]) => [name.slice(SET.length), Uint8Array.from(nodes, (node) => inside[node] ?? 0)]));
}
const SET = "set_";

/** Adds the bones of a case to a scene as they come. */
export async function addBones(service: Service, opened: Opened, scene: Scene): Promise<void> {
  const moving = new Set((opened.document.segments ?? []).map(({ name }) => name));
  await Promise.all((opened.document.bones ?? []).map(async ({ name, mesh }) => {
    scene.addBone(name, await meshOf(service, mesh, opened.frame), moving.has(name));
  }));
}

type Description = Documents["ResponseDescription"];

/** The skin at rest, in the order of its nodes. */
export interface RestingSkin {
  description: Description;
  rest: Shape;
}
/** The same with the columns that move it. */
export interface LoadedResponse extends RestingSkin {
  columns: Columns;
}

const OCTETS = { Accept: "application/octet-stream" };
const NOT_THERE = ["response-not-built", "response-stale"];

/** The boundary of the mesh, for as long as nothing else is to be seen. */
export async function showBoundary(service: Service, { document, frame }: Opened, bench: Workbench): Promise<Uint32Array | undefined> {
  const shape = await meshOf(service, document.volume!, frame);
  bench.scene.showSkin(shape);
  bench.offer([]);
  return shape.node_ids;
}

/** The skin of a case with a response, which is built where there is none; `into` shows how far that is, and `waiting` is told that it
 * takes a while. */
export async function restingSkin(app: App, id: string, into: HTMLElement, waiting: () => void = () => {}): Promise<RestingSkin> {
  return atRest(app, id, await described(app, id, into, waiting));
}

async function atRest(app: App, id: string, description: Description): Promise<RestingSkin> {
  const path = `/v1/cases/${id}/response`;
  const glb = await app.service.ask("GET", `${path}?job=${description.job}`, undefined, { Accept: "model/gltf-binary" });
  const { points_mm, triangles } = readGlb(await glb.arrayBuffer());
  return { description, rest: { points_mm, triangles } };
}

async function described(app: App, id: string, into: HTMLElement, waiting: () => void): Promise<Description> {
  const path = `/v1/cases/${id}/response`;
  const built = await app.service.get<Documents["JobList"]>(`/v1/jobs?kind=response&status=successful&case=${id}&limit=1`);
  try {
    if (built.items.length > 0) return await app.service.get<Description>(path);
  } catch (error) {
    if (!(error instanceof Refused) || !NOT_THERE.includes(error.code)) throw error;
  }
  waiting();
  await buildResponse(app, id, {}, into);
  return app.service.get<Description>(path);
}

export async function responseOf(app: App, id: string, into: HTMLElement, waiting?: () => void): Promise<LoadedResponse> {
  return withColumns(app, id, await restingSkin(app, id, into, waiting));
}

/** The response that a job has built. */
export async function loadedResponse(app: App, id: string, job: string): Promise<LoadedResponse> {
  const description = await app.service.get<Description>(`/v1/cases/${id}/response?job=${job}`);
  return withColumns(app, id, await atRest(app, id, description));
}

async function withColumns(app: App, id: string, { description, rest }: RestingSkin): Promise<LoadedResponse> {
  const path = `/v1/cases/${id}/response?job=${description.job}`;
  const bytes = async (query: string) => (await app.service.ask("GET", path + query, undefined, OCTETS)).arrayBuffer();
  const [linear, second] = await Promise.all([bytes(""), description.second_order === undefined ? undefined : bytes("&order=2")]);
  const columns = readColumns(description, linear, second);
  return { description, rest, columns };
}

/** How a response is waited for that somebody may do without. */
interface Waiting {
  label: string;
  /** Nobody waits for it any more. */
  isLeft: () => boolean;
  stop: (job: string) => Promise<unknown>;
}

/** Builds a response and tells its job, or nothing where it was left; `more` is what it has beside its linear columns. */
export async function buildResponse(
  app: App, id: string, more: { order?: 2; growth?: string[] }, into: HTMLElement, waiting?: Waiting,
): Promise<string | undefined> {
  const { service, words } = app;
  const { id: job, status } = await service.post<Job>("/v1/jobs", { kind: "response", case: id, ...more });
  // An earlier job was the same.
  if (status === "successful") return job;
  const line = new ProgressLine(words, waiting?.label ?? words.building, waiting && { text: words.cancel, clicked: () => waiting.stop(job) });
  if (waiting?.isLeft() === true) return undefined;
  into.append(line.element);
  try {
    for await (const event of service.events(job)) {
      if (waiting?.isLeft() === true) return undefined;
      line.tell(event);
    }
    let ended: Job;
    do {
      ended = await (await service.ask("GET", `/v1/jobs/${job}`, undefined, { Accept: "application/json", Prefer: "wait=30" })).json() as Job;
      if (waiting?.isLeft() === true) return undefined;
    } while (ended.status === "accepted" || ended.status === "running");
    if (ended.status !== "successful") throw new JobFailed(ended);
    return job;
  } finally {
    line.element.remove();
  }
}
