// Painting on a surface, coarser surfaces, and charts' scales.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Documents } from "../../../clients/typescript/src/facies.js";
import { boxOf, steps } from "../../src/charts.js";
import { coarse } from "../../src/coarse.js";
import { bandOf } from "../../src/colours.js";
import { writeGlb } from "../../src/glb.js";
import { angles, rotation } from "../../src/frame.js";
import { Canvas, distance, plyOf } from "../../src/painting.js";
import { readGlb } from "../../../clients/typescript/src/facies.js";
import { readPly } from "../../src/ply.js";
import { rolesOf, withPainted, withRoles } from "../../src/roles.js";
import { withPresets } from "../../src/views/materials.js";

/** A square of n x n mm in the plane z, two triangles to a mm²; the same again 1e-3 mm behind it, looking away. */
function sheets(n: number) {
  const points: number[] = [];
  const triangles: number[] = [];
  for (const [z, flip] of [[0, false], [-1e-3, true]] as const) {
    const first = points.length / 3;
    for (let y = 0; y <= n; y += 1) for (let x = 0; x <= n; x += 1) points.push(x, y, z);
    const at = (x: number, y: number) => first + y * (n + 1) + x;
    for (let y = 0; y < n; y += 1) {
      for (let x = 0; x < n; x += 1) {
        const square = [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]];
        for (const [a, b, c] of square as [number, number, number][]) triangles.push(...(flip ? [a, c, b] : [a, b, c]));
      }
    }
  }
  return { points_mm: Float32Array.from(points), triangles: Uint32Array.from(triangles) };
}

test("a brush paints faces within its radius that look to the same side", () => {
  const canvas = new Canvas(sheets(20));
  const faces = canvas.under([10, 10, 0], 2 * (20 * 10 + 10), 4);
  assert(faces.every((face) => face < 800), "none of the sheet behind");
  // Two triangles to a mm²: the area of a circle, but for its rim.
  assert(Math.abs(canvas.area(faces) - Math.PI * 16) < 2, `${canvas.area(faces)} mm²`);
  assert.deepEqual(canvas.under([10, 10, 0], 7, 1e-6), [7], "at least the face itself");
});

test("painted faces are a surface of their own, and are read back as they were", async () => {
  const surface = sheets(3);
  const part = new Canvas(surface).part([0, 1]);
  assert.deepEqual([part.points_mm.length, [...part.triangles]], [12, [0, 1, 2, 1, 3, 2]]);
  const read = readPly(await plyOf(part).arrayBuffer());
  assert.deepEqual([read.points_mm, read.triangles], [part.points_mm, part.triangles]);
});

test("nodes that lie on painted faces without being painted are counted", () => {
  const canvas = new Canvas(sheets(4));
  // The four corners of a square of the front have four nodes behind them.
  assert.equal(canvas.strangers(new Set([0, 1]), 0.01), 4);
  assert.equal(canvas.strangers(new Set([0, 1]), 1e-4), 0);
});

test("the distance to a triangle is that to its inside, an edge or a corner", () => {
  const [a, b, c] = [[0, 0, 0], [2, 0, 0], [0, 2, 0]] as [[number, number, number], [number, number, number], [number, number, number]];
  for (const [point, expected] of [[[0.5, 0.5, 3], 3], [[1, -2, 0], 2], [[-3, -4, 0], 5], [[5, 0, 4], 5], [[0, 4, 0], 2], [[2, 2, 0], Math.SQRT2], [[2.5, 1.5, 0], Math.SQRT2]] as const) {
    assert(Math.abs(distance([...point], a, b, c) - expected) < 1e-12, `${point}`);
  }
});

test("a coarser surface has about as many triangles as asked for, over the same nodes", () => {
  const { points_mm, triangles } = sheets(100);
  const few = coarse(points_mm, triangles.slice(0, triangles.length / 2), 2000)!;
  assert(few.length / 3 > 800 && few.length / 3 < 2300, `${few.length / 3} triangles`);
  const area = new Canvas({ points_mm, triangles: few }).area(Array.from({ length: few.length / 3 }, (_, face) => face));
  assert(area > 9000 && area <= 10_000 + 1e-6, `${area} mm² of 10000`);
  assert.equal(coarse(points_mm, triangles, 1e6), undefined);
});

const CASE = {
  units: "mm", volume: "v", segments: [], fixed: [], skin: { node_set: "skin" },
  materials: { "*": { young_modulus_kpa: 15, poisson_ratio: 0.45 }, muscle: { young_modulus_kpa: 30, density_g_per_cm3: 1.06, fibre: { array: "fibre", young_modulus_kpa: 90 } } },
} as unknown as Documents["CaseDocument"];
const selection = { surface: "s", within_mm: 0.01 };

test("a painted set is a part of the case like any other, and stays when roles change", () => {
  const painted = withPainted(CASE, [{ name: "cheek", role: "region", selection }, { name: "brow", role: "skin", selection }, { name: "jaw", role: "segment", selection }]);
  assert.deepEqual(painted.skin_regions, { cheek: selection });
  assert.deepEqual(painted.skin, { any: [{ node_set: "skin" }, selection] });
  assert.deepEqual(painted.segments, [{ name: "jaw", nodes: selection }]);
  const roles = { ...rolesOf(painted, ["skin", "chin"]), chin: "skin" as const };
  assert.deepEqual(withRoles(painted, roles).skin, { any: [{ node_set: "skin" }, { node_set: "chin" }, selection] });
});

test("a preset takes the place of constants, and leaves density and the course of fibres", () => {
  const made = withPresets(CASE, { muscle: "muscle_active_chabanas_2003" });
  assert.deepEqual(made.materials?.muscle, { preset: "muscle_active_chabanas_2003", density_g_per_cm3: 1.06, fibre: { array: "fibre" } });
  assert.deepEqual(made.materials?.["*"], CASE.materials?.["*"]);
});

test("angles are those of the rotation that they make", () => {
  for (const told of [[0, 0, 0], [12, -7, 33], [-80, 40, -170]] as [number, number, number][]) {
    const flat = rotation(told).flatMap((row) => [...row, 0]);
    assert(angles(flat).every((angle, at) => Math.abs(angle - told[at]!) < 1e-9), `${told}`);
  }
});

test("scales have round numbers, boxes the quartiles of a cohort", () => {
  assert.deepEqual(steps(0, 1.55), [0, 0.5, 1, 1.5, 2]);
  assert.deepEqual(steps(-3.1, 4), [-4, -2, 0, 2, 4]);
  assert.deepEqual(boxOf([4, 1, 3, 2]), [1, 1, 2, 3, 4]);
});

test("what is seen is written as GLB that is read as it was, with bands of a map and bones where they are", async () => {
  const skin = { ...sheets(3), name: "skin", colour: [233, 196, 172] as [number, number, number] };
  const normals = new Float32Array(skin.points_mm.length).map((_, at) => (at % 3 === 2 ? 1 : 0));
  const values = Float32Array.from({ length: skin.points_mm.length / 3 }, (_, node) => node / 10);
  const bone = { ...sheets(2), name: "jaw", colour: [0, 0, 0] as [number, number, number], normals: normals.slice(0, sheets(2).points_mm.length), matrix: [1, 0, 0, 5, 0, 1, 0, -6, 0, 0, 1, 7, 0, 0, 0, 1] };
  const colours = Array.from(values, (value) => bandOf(value, 2, "length"));
  // LPS: left is x, up is z, the front is -y.
  const file = await writeGlb([{ ...skin, normals, colours, values: { name: "_DISPLACEMENT", of: values } }, bone], [[1, 0, 0], [0, 0, 1], [0, -1, 0]], { notice: "not a medical device" }).arrayBuffer();
  const read = readGlb(file);
  assert.deepEqual([read.points_mm, read.triangles, read.values._DISPLACEMENT], [skin.points_mm, skin.triangles, values]);
  const { nodes, asset } = JSON.parse(new TextDecoder().decode(new Uint8Array(file, 20, new DataView(file).getUint32(12, true))));
  assert.equal(asset.extras.notice, "not a medical device");
  assert.deepEqual(nodes[1].matrix.slice(12), [5, -6, 7, 1], "column by column");
  assert.deepEqual(nodes[2].matrix, [0.001, 0, 0, 0, 0, 0, -0.001, 0, 0, 0.001, 0, 0, 0, 0, 0, 1]);
  // Linear light of the darkest band, 79 18 123.
  const darkest = [...read.values.COLOR_0!.slice(-3)];
  assert(darkest.every((value, channel) => Math.abs(value - [0.0782, 0.006, 0.1981][channel]!) < 1e-3), darkest.join());
});
