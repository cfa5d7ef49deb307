// The documents, bones and response of a case, as the page shows them.
import { Refused, type Case, type CaseDocument, type Documents, type Service, readGlb } from "./api.js";
import { ProgressLine, type App } from "./app.js";
import type { FrameName } from "./frame.js";
import { inFrame, readPly } from "./ply.js";
import type { Columns } from "./response.js";
import type { Scene, Shape } from "./scene.js";

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
  return { id, view, document, frame: document.frame ?? "unspecified", name: document.name ?? id.slice(0, 8) };
}

/** A surface that the service has, as it lies in the frame of the case. */
export async function meshOf(service: Service, id: string, frame: FrameName): Promise<Shape> {
  const answer = await service.ask("GET", `/v1/meshes/${id}/content?format=ply`);
  const surface = readPly(await answer.arrayBuffer());
  return { points_mm: inFrame(surface, frame), triangles: surface.triangles };
}

/** Adds the bones of a case to a scene as they come. */
export async function addBones(service: Service, opened: Opened, scene: Scene): Promise<void> {
  const moving = new Set((opened.document.segments ?? []).map(({ name }) => name));
  await Promise.all((opened.document.bones ?? []).map(async ({ name, mesh }) => {
    scene.addBone(name, await meshOf(service, mesh, opened.frame), moving.has(name));
  }));
}

/** The skin at rest and the columns that move it. */
export interface LoadedResponse {
  description: Documents["ResponseDescription"];
  rest: Shape;
  columns: Columns;
}

const OCTETS = { Accept: "application/octet-stream" };
const NOT_THERE = ["response-not-built", "response-stale"];

export async function loadResponse(service: Service, id: string): Promise<LoadedResponse> {
  const path = `/v1/cases/${id}/response`;
  const description = await service.get<Documents["ResponseDescription"]>(path);
  const job = `job=${description.job}`;
  const bytes = async (query: string, headers: Record<string, string>) =>
    (await service.ask("GET", `${path}?${query}`, undefined, headers)).arrayBuffer();
  const [linear, glb, second] = await Promise.all([
    bytes(job, OCTETS), bytes(job, { Accept: "model/gltf-binary" }),
    description.second_order === undefined ? undefined : bytes(`${job}&order=2`, OCTETS),
  ]);
  const { points_mm, triangles } = readGlb(glb);
  const columns: Columns = { segments: description.segments.length, linear: new Float32Array(linear) };
  if (second !== undefined) columns.second = { columns: new Int16Array(second), scale_mm: description.second_order!.scale_mm };
  return { description, rest: { points_mm, triangles }, columns };
}

/** The response of a case, which is built where there is none; `line` tells how far that is. */
export async function responseOf(app: App, id: string, into: HTMLElement): Promise<LoadedResponse> {
  try {
    return await loadResponse(app.service, id);
  } catch (error) {
    if (!(error instanceof Refused) || !NOT_THERE.includes(error.code)) throw error;
  }
  await buildResponse(app, id, 1, into);
  return loadResponse(app.service, id);
}

export async function buildResponse(app: App, id: string, order: 1 | 2, into: HTMLElement): Promise<void> {
  const line = new ProgressLine(app.words.building);
  into.append(line.element);
  const job = { kind: "response" as const, case: id, ...(order === 2 ? { order } : {}) };
  try {
    await app.service.run(job as Documents["JobDocument"], (event) => line.tell(event));
  } finally {
    line.element.remove();
  }
}
