// Cuts in words and documents, bone of a scan as a surface, lengths by area, marks of charts.
import assert from "node:assert/strict";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import type { Documents, Triple } from "../../../clients/typescript/src/facies.js";
import { readNrrd, surfaceAt } from "../../src/nrrd.js";
import { anglesOf, normalOf, osteotomy, planned, throughPoints, type Cut, type Operation } from "../../src/osteotomy.js";
import { fromDocument, turningPivots } from "../../src/plan.js";
import { lengthsOver, nodeAreas } from "../../src/regions.js";
import { markOf } from "../../src/views/jobs.js";
import { surfacesDocument } from "../../src/views/meshed.js";

const near = (a: ArrayLike<number>, b: ArrayLike<number>, most: number) => Array.from(a).every((value, at) => Math.abs(value - b[at]!) <= most) && a.length === b.length;

test("a plane turns as a segment does, in either frame, and its angles are found again", () => {
  assert(near(normalOf({ facing: "up", angles: [30, 0] }, "LPS"), [0, 0.5, 0.8660254], 1e-6), "front up leans the normal back, to +y in LPS");
  assert(near(normalOf({ facing: "up", angles: [30, 0] }, "RAS"), [0, -0.5, 0.8660254], 1e-6));
  assert(near(normalOf({ facing: "up", angles: [0, 30] }, "LPS"), [-0.5, 0, 0.8660254], 1e-6), "left side up leans it to the right");
  assert(near(normalOf({ facing: "forward", angles: [0, 30] }, "LPS"), [0.5, -0.8660254, 0], 1e-6), "front to the left");
  for (const facing of ["up", "forward"] as const) {
    for (const frame of ["LPS", "RAS", "unspecified"] as const) {
      const angles: [number, number] = [-17, 23];
      assert(near(anglesOf(normalOf({ facing, angles }, frame).map((value) => -3 * value) as Triple, facing, frame), angles, 0.051), `${facing} ${frame}`);
    }
  }
});

test("the cuts of the head in examples/head_ct are those that an operation begins with, but for where they are", () => {
  const cuts = (["lefort", "rami"] as Operation[]).flatMap((operation) => planned(operation, [[0, 0, 0], [200, 200, 140]], "LPS"));
  const found = osteotomy(new Set<Operation>(["lefort", "rami"]), cuts, { maxilla: [[102.4, 42, 58]], mandible: [] }, "LPS")!;
  const stated: Record<string, Triple> = { "le-fort-1": [0, -0.2368, 1], "pterygomaxillary": [0, -1, 0], "ramus-right": [0.3, -0.95, 0.14], "ramus-left": [-0.3, -0.95, 0.14], "ramus-horizontal": [0, -0.24, 1] };
  assert.deepEqual(found.cuts!.map(({ name }) => name), Object.keys(stated));
  for (const { name, normal } of found.cuts!) {
    const length = Math.hypot(...stated[name]!);
    assert(near(normal, stated[name]!.map((value) => value / length), 0.005), `${name} ${normal}`);
  }
  assert.deepEqual(found.segments, [{ name: "maxilla", below: ["le-fort-1"], above: ["pterygomaxillary"], seeds_mm: [[102.4, 42, 58]] },
    { name: "mandible", below: ["ramus-horizontal"], above: ["ramus-right", "ramus-left"] }]);
  const [right, left] = ["ramus-right", "ramus-left"].map((name) => cuts.find((cut) => cut.name === name)!) as [Cut, Cut];
  assert(right.point_mm[0] < left.point_mm[0], "in LPS the left is at larger x");
});

test("each cut is named by a segment, and a cut between the teeth is of both jaws", () => {
  const cuts = (["lefort", "rami", "occlusal"] as Operation[]).flatMap((operation) => planned(operation, [[0, 0, 0], [1, 1, 1]], "RAS"));
  const of = (...operations: Operation[]) => osteotomy(new Set(operations), cuts, { maxilla: [], mandible: [] }, "RAS");
  assert.equal(of("occlusal"), undefined);
  assert.deepEqual(of("lefort", "occlusal")!.segments, [{ name: "maxilla", below: ["le-fort-1"], above: ["pterygomaxillary", "occlusal"] }]);
  assert.deepEqual(of("lefort", "occlusal")!.cuts!.map(({ name }) => name), ["le-fort-1", "pterygomaxillary", "occlusal"]);
  assert.deepEqual(of("lefort", "rami", "occlusal")!.segments.map(({ below }) => below), [["le-fort-1"], ["ramus-horizontal", "occlusal"]]);
});

test("three points make a plane unless they lie on a line", () => {
  const found = throughPoints([[0, 0, 10], [10, 0, 10], [0, 10, 15]], "up", "LPS")!;
  assert(near(found.point_mm, [3.3, 3.3, 11.7], 1e-9));
  assert(near(found.angles, [-26.6, 0], 0.05), "the front, at small y, is lower");
  assert.equal(throughPoints([[0, 0, 0], [1, 1, 1], [3, 3, 3]], "up", "LPS"), undefined);
});

test("several bones are not cut, one is all bone", () => {
  const cut = { cuts: [], segments: [{ name: "maxilla" }] };
  const two = surfacesDocument("n", "LPS", { s: "skin", a: "bone", b: "bone" }, cut) as { meshing: Record<string, unknown> };
  assert.deepEqual(two.meshing, { kind: "mesh", frame: "LPS", surfaces: { skin: "s", bones: [{ name: "a", mesh: "a" }, { name: "b", mesh: "b" }] } });
  const one = surfacesDocument("n", "LPS", { s: "skin", a: "bone" }, cut, { a: "ID" }) as { meshing: Record<string, unknown> };
  assert.deepEqual(one.meshing, { kind: "mesh", frame: "LPS", surfaces: { skin: "s", bone: "ID" }, osteotomy: cut });
});

test("bone of a scan is a closed surface around its voxels, in the place that the file says", async () => {
  const size: Triple = [9, 8, 7];
  const values = new Int16Array(size[0] * size[1] * size[2]).fill(-1000);
  for (let z = 2; z < 5; z += 1) for (let y = 2; y < 6; y += 1) for (let x = 3; x < 6; x += 1) values[(z * size[1] + y) * size[0] + x] = 700;
  const head = "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 9 8 7\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nkinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: (-10,5,1)\n\n";
  const file = Buffer.concat([Buffer.from(head), gzipSync(new Uint8Array(values.buffer))]);
  const scan = await readNrrd(new Uint8Array(file).buffer);
  const { points_mm, triangles } = surfaceAt(scan, 250);
  const ends = [0, 1, 2].map((axis) => { const along = points_mm.filter((_, at) => at % 3 === axis); return [Math.min(...along), Math.max(...along)]; });
  // Between the last voxel without bone and the first with it.
  const wanted = [[-10 + 2 * 2.5, -10 + 2 * 5.5], [5 + 3 * 1.5, 5 + 3 * 5.5], [1 + 4 * 1.5, 1 + 4 * 4.5]];
  ends.forEach((end, axis) => assert(near(end, wanted[axis]!, 1e-5), `${end} ${wanted[axis]}`));
  const edges = new Map<string, number>();
  for (let at = 0; at < triangles.length; at += 3) {
    for (let corner = 0; corner < 3; corner += 1) {
      const [a, b] = [triangles[at + corner]!, triangles[at + ((corner + 1) % 3)]!];
      edges.set(`${a} ${b}`, (edges.get(`${a} ${b}`) ?? 0) + 1);
    }
  }
  assert([...edges].every(([edge, count]) => count === 1 && edges.get(edge.split(" ").reverse().join(" ")) === 1), "each edge once either way");
  // Outward: its volume is positive.
  let volume = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => [0, 1, 2].map((axis) => points_mm[3 * triangles[at + corner]! + axis]!)) as [Triple, Triple, Triple];
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
  }
  assert(volume > 0.6 * 6 * 12 * 12 && volume < 6 * 12 * 12, `${volume}`);
});

test("lengths count by the area around each node", () => {
  // A square of 2 x 2 as two triangles, and a small one beside it.
  const points = new Float32Array([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 5, 0, 0]);
  const areas = nodeAreas(points, new Uint32Array([0, 1, 2, 0, 2, 3]));
  assert(near(areas, [4 / 3, 2 / 3, 4 / 3, 2 / 3, 0], 1e-12));
  const { mean, p95, max } = lengthsOver([1, 4, 1, 4, 100], areas)!;
  assert(Math.abs(mean - 2) < 1e-12 && p95 === 4 && max === 4);
  assert.equal(lengthsOver([1, 4, 3, 4, 100], areas, [1, 0, 1, 0, 0])?.p95, 3);
  assert.equal(lengthsOver([1, 1, 1, 1, 1], areas, [0, 0, 0, 0, 1]), undefined);
});

test("a stored plan turns about the points that it names, and others keep theirs", () => {
  const stored = { frame: "RAS", segments: [{ name: "jaw", translation_mm: [0, 1, 0], rotation_deg: [0, 0, 5], pivot_mm: [1, 2, 3] }, { name: "upper", translation_mm: [1, 0, 0] }] } as unknown as Documents["PlanDocument"];
  const own = turningPivots(stored, "LPS");
  assert.deepEqual(turningPivots(stored, "LPS"), { jaw: [-1, -2, 3] });
  assert.equal(fromDocument(stored, { jaw: [9, 9, 9], upper: [7, 7, 7] }, "LPS"), undefined);
  assert.equal(fromDocument(stored, { upper: [7, 7, 7], ...own }, "LPS")?.segments.jaw?.forward, 1);
});

test("a mark is of the model and mesh level that its data say, and what has none is no mark", () => {
  assert.deepEqual(markOf({ label: "fem: corrected", method: "fem_linear", level: "1" }), { label: "fem: corrected", level: 1 });
  assert.equal(markOf({ label: "fem", method: "fem_linear" }), undefined);
  assert.equal(markOf({}), undefined);
});
