// What `Facies` promises, against a service: arrays that agree with each other, progress, exceptions with codes.
import { strict as assert } from "node:assert";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { directions, meaning, type Direction } from "./directions.js";
import { Facies, JobFailed, NoKey, Refused, Response, type Documents, type Movement, type Upload } from "./facies.js";
import { connect } from "./index.js";

// Sliders go where their words say, with no service: how far a point 50 mm before the centre of a segment, or left of it, goes.
function moved(frame: "LPS" | "RAS", { member, axis, sign }: Direction, place: "front" | "left"): { forward: number; left: number; up: number } {
  const towards = frame === "LPS" ? { front: [0, -1, 0], left: [1, 0, 0] } : { front: [0, 1, 0], left: [-1, 0, 0] };
  const columns = new Float32Array(36);
  for (const i of [0, 1, 2]) {
    towards[place].forEach((share, j) => { columns[3 * (4 * i + j) + i] = 50 * share; });
    columns[3 * (4 * i + 3) + i] = 1;
  }
  const description = { node_ids: [0], segments: [{ name: "jaw", centre_mm: [0, 0, 0] }] } as never;
  const movement: Movement = { pivot_mm: [0, 0, 0], [member]: [0, 1, 2].map((at) => (at === axis ? 2 * sign : 0)) };
  const by = new Response("", "", description, columns, {} as never).displacement({ jaw: movement });
  const along = (way: number[]) => way.reduce((sum, share, at) => sum + share * by[at]!, 0);
  return { forward: along(towards.front), left: along(towards.left), up: by[2]! };
}
for (const frame of ["LPS", "RAS"] as const) {
  const of = new Map(directions(frame).map((direction) => [direction.words[1], direction]));
  const goes = (word: string, place: "front" | "left" = "front") => moved(frame, of.get(word)!, place);
  assert.equal(of.size, 6);
  assert(goes("forward").forward === 2 && goes("up").up === 2 && goes("to the left").left === 2, frame);
  assert(goes("front up").up > 1 && goes("left side down", "left").up < -1 && goes("front to the left").left > 1, frame);
}
assert.equal(meaning(directions("LPS")[0]!, -4), "4 mm back");
assert.equal(meaning(directions("unspecified")[3]!, 4), "4° about +x");

const folder = "examples/head/";
const blob = async (name: string) => new Blob([await readFile(folder + name)]);
const facies = new Facies(process.env.FACIES_ADDRESS!, process.env.FACIES_API_KEY);
const { case: document } = JSON.parse(await readFile(`${folder}case.json`, "utf8"));
const head = await facies.createCase(document, {
  "face.vtu": await blob("face.vtu"), "mandible.vtp": await blob("mandible.vtp"), "maxilla.vtp": await blob("maxilla.vtp"),
});
const movement = { translation_mm: [0, 4, 1], rotation_deg: [3, -2, 1], pivot_mm: [0, 10, 20] } satisfies Movement;
const plan = { segments: [{ name: "mandible", ...movement }] } as Documents["PlanDocument"];
const apart = (a: Float32Array, b: Float32Array) => {
  assert.equal(a.length, b.length);
  return a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at]!)), 0);
};

const events: Documents["JobEvent"][] = [];
// A response and inverse planning are of linear elements.
const prediction = await facies.predict(head, plan, { method: "fem_linear", progress: (event) => events.push(event) });
assert.deepEqual(events.map((event) => event.number), events.map((_, at) => at + 1));
assert.equal(events.at(-1)!.status, "successful");
assert.equal(prediction.displacement_mm.length, prediction.skin.points_mm.length);

const response = await facies.response(head);
const here = response.displacement({ mandible: movement });
const there = await facies.apply(response, plan);
const difference = apart(here, there.displacement_mm);
assert(difference < 1e-4, `${difference} mm from the answer of apply`);
assert(there.within_linear_range && there.nonlinearity_estimate_mm! > 0, "the linearisation error is estimated");
const unseen = [
  "numerical-error-large", "cells-inverted", "bones-overlap", "bone-in-tissue", "bone-through-skin", "large-rotation", "large-strain", "tissue-may-buckle",
  "skin-outruns-plan", "sliding-off-wall", "landmark-far", "landmarks-crowded", "landmarks-swapped", "skin-overlaps",
];
assert.deepEqual([there.warnings, there.not_measured], [[], unseen]);
const jawBy = (movement: Movement) => ({ segments: [{ name: "mandible", ...movement }] }) as Documents["PlanDocument"];
const far = await facies.apply(response, jawBy({ translation_mm: [0, -30, 0] }));
assert.deepEqual([far.within_linear_range, far.warnings.map(({ code }) => code)], [false, ["outside-linear-range"]]);
assert(far.warnings[0]!.detail.includes("mm"), "a warning comes with its sentence");

// What the service would refuse, or what is no number, is no displacement here either.
const withoutPivot = { rotation_deg: [5, 0, 0] } satisfies Movement;
const words = await facies.apply(response, jawBy(withoutPivot)).catch((refused: Refused) => refused.problem.errors![0]!.detail);
assert.equal(words, "`pivot_mm` is required where a rotation is not 0");
const wrong: [unknown, string][] = [
  [withoutPivot, `/mandible/pivot_mm: ${words}`],
  [{ translation: [1, 0, 0] }, "/mandible/translation: "],
  [{ name: "mandible", translation_mm: [1, 0, 0] }, "/mandible/name: "],
  [{ translation_mm: ["1", 0, 0] }, '/mandible/translation_mm: ["1", 0, 0] '],
  [{ translation_mm: [0, NaN, 0] }, "/mandible/translation_mm: [0, NaN, 0] "],
  [{ translation_mm: [0, 0, 0], rotation_deg: [0, 0, Infinity], pivot_mm: [0, 0, 0] }, "/mandible/rotation_deg: "],
  [{ translation_mm: [1, 0] }, "/mandible/translation_mm: [1, 0] "],
  [{ translation_mm: 1 }, "/mandible/translation_mm: 1 "],
  [{ rotation_deg: [5, 0, 0], pivot_mm: null }, "/mandible/pivot_mm: null "],
  [null, "/mandible: null "],
];
for (const [movement, told] of wrong) {
  assert.throws(() => response.displacement({ mandible: movement as Movement }),
    (thrown: Error) => thrown instanceof RangeError && thrown.message.startsWith(told), told);
}
assert(apart(here, prediction.displacement_mm) < 1e-3, "the response says what the prediction says");
const before = prediction.skin.points_mm.map((value, at) => value - prediction.displacement_mm[at]!);
assert(apart(response.rest.points_mm, before) < 1e-3, "vertices stand in the order of the nodes");

const found = await facies.optimise(
  head, [{ nodes: { node_set: "chin" }, displacement_mm: [null, 4, null], sigma_mm: 1 }],
  { mandible: { translation_mm: [[0, 0], [-10, 10], [-5, 5]] } });
const again = await facies.predict(head, found.plan, { method: "fem_linear" });
assert(apart(found.displacement_mm, again.displacement_mm) < 1e-3, "the plan gives the skin that is told");
const skin = await facies.upload(new Blob([await facies.file(again.job, "skin.vtp")]), "mm", "LPS");
const compared = await facies.compare(found, skin);
assert(compared.both.max < 1e-3);
assert.deepEqual(compared.warnings, []);

const mesh = { volume: await blob("face.vtu"), fixed: ["skull", "rim"], skin: "skin" };
const jaw = { segments: [{ name: "mandible", translation_mm: [0, 4, 1] as [number, number, number] }] };
const ofMesh = await facies.predict(mesh, jaw);
assert.equal(ofMesh.displacement_mm.length, here.length);
const sent: Upload[] = [];
const uploading = (upload: Upload) => sent.push(upload);
assert.equal((await facies.predict(mesh, jaw, { uploading })).displacement_mm.length, here.length);
const total_bytes = mesh.volume.size;
assert.deepEqual(sent.at(-1), { phase: "upload", sent_bytes: total_bytes, total_bytes, progress: 100 });
assert(sent.every((one, at) => at === 0 || one.sent_bytes > sent[at - 1]!.sent_bytes) && sent.length > 1, "piece by piece");
await assert.rejects(facies.upload(new Blob(["solid nothing"]), "mm", "LPS", uploading), (refused) => refused instanceof Refused);

// A CT of two balls, cut by a plane: predictions wait until it is meshed.
const values = new Int16Array(27000);
const share = (depth: number) => Math.min(Math.max(depth / 4 + 0.5, 0), 1);
for (let at = 0; at < values.length; at++) {
  const [x, y, z] = [at % 30, Math.floor(at / 30) % 30, Math.floor(at / 900)].map((index) => 4 * index + 2) as [number, number, number];
  const bone = 1160 * share(30 - Math.hypot(x - 60, y - 55, z - 60));
  values[at] = -1000 + 1040 * share(50 - Math.hypot(x - 60, y - 60, z - 60)) + bone;
}
const header = "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 30 30 30\n"
  + "space directions: (4,0,0) (0,4,0) (0,0,4)\nendian: little\nencoding: raw\nspace origin: (2,2,2)\n\n";
const osteotomy = {
  cuts: [{ name: "middle", point_mm: [60, 55, 60] as [number, number, number], normal: [0, 0, 1] as [number, number, number] }],
  segments: [{ name: "jaw", below: ["middle"] }],
};
const meshing = { kind: "mesh", scan: "ct", frame: "LPS", osteotomy, size: { tetrahedra: 20000 } };
const scanned = await facies.createCase({ meshing } as Documents["MeshedCaseDocument"], { ct: new Blob([header, values]) });
const cut = await facies.predict(scanned, { segments: [{ name: "jaw", translation_mm: [0, -3, 0] }] } as Documents["PlanDocument"]);
const largest = Math.max(...cut.displacement_mm.map(Math.abs));
assert(largest > 2 && largest < 4, `${largest} mm`);

// A key from a file that ends in a line break; one that no header can have is not shown.
const key = process.env.FACIES_API_KEY;
const spaced = new Facies(process.env.FACIES_ADDRESS!, key && ` ${key}\r\n`);
assert.equal((await spaced.ask("GET", "/v1/cases?limit=1")).status, 200);
assert.equal((await connect(process.env.FACIES_ADDRESS!, key && `${key}\n`).GET("/v1/cases")).response.status, 200);
for (const wrong of ["\n", " ", "\u001b", "\u00e9"]) {
  const broken = new Facies(process.env.FACIES_ADDRESS!, `fcs_secret${wrong}more`);
  await assert.rejects(broken.ask("GET", "/v1/cases"), (error) => error instanceof NoKey && !/secret|more/.test(error.message));
}

// Between us and a service: what redirects gets no second request, and what is busy is not asked again at once.
const asked: string[] = [];
const between = createServer((request, answer) => {
  const word = request.url!.slice(1);
  asked.push(word);
  request.resume();
  if (["0", "soon"].includes(word)) answer.writeHead(503, { "Retry-After": word }).end();
  else answer.writeHead(307, { Location: "/leak" }).end();
});
await new Promise<void>((resolve) => between.listen(0, "127.0.0.1", resolve));
const elsewhere = `http://127.0.0.1:${(between.address() as AddressInfo).port}`;
const impatient = new Facies(elsewhere, "key", 1.5);
const isRefused = (thrown: Error) => thrown instanceof Refused && thrown.code === "not-of-the-service" && thrown.problem.status === 307;
for (const [deed, expected] of [
  [() => impatient.ask("GET", "/moved"), isRefused],
  [() => impatient.upload(new Blob(["mesh"]), "mm", "LPS"), isRefused],
  [() => impatient.upload(new Blob(["mesh"]), "mm", "LPS", uploading), isRefused],
  [() => connect(elsewhere, "key").GET("/v1/cases"), (thrown: Error) => thrown instanceof TypeError],
] as [() => Promise<unknown>, (thrown: Error) => boolean][]) {
  asked.length = 0;
  await assert.rejects(deed, expected);
  assert(asked.length === 1 && asked[0] !== "leak", `${asked}`);
}
for (const told of ["0", "soon"]) {
  asked.length = 0;
  await assert.rejects(impatient.ask("GET", `/${told}`), (refused) => refused instanceof Refused);
  assert.deepEqual(asked, [told, told]);
}
between.closeAllConnections();
between.close();

const unknown = { segments: [{ name: "mandibel", translation_mm: [0, 4, 1] as [number, number, number] }] };
await assert.rejects(facies.predict(head, unknown), (refused) => refused instanceof Refused
  && refused.code === "unknown-segment" && refused.pointer === "/plan/segments/0/name");
await assert.rejects(facies.predict(head, plan, { budget: { wall_s: 0.001 }, element: "quadratic" }),
  (failed) => failed instanceof JobFailed && failed.code === "budget-exceeded");
console.log(`${here.length / 3} vertices, ${events.length} events, ${difference.toExponential(1)} mm from the answer of apply`);
