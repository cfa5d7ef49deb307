// Columns of a response are what its description names, and what is not known is refused by its name.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Documents, Triple } from "../../../clients/typescript/src/facies.js";
import { innerFactors, readColumns } from "../../src/columns.js";
import { coefficients, SkinSum } from "../../src/response.js";
import { partner } from "../../src/views/inner.js";

type Description = Documents["ResponseDescription"];
const NODES = 5;
const COUNT = 24 + 3;
/** Column c moves component n of the skin by c + n / 100 mm. */
const column = (c: number) => Float32Array.from({ length: 3 * NODES }, (_, n) => c + n / 100);
const linear = () => Float32Array.from(Array.from({ length: COUNT }, (_, c) => [...column(c)]).flat()).buffer;

/** Of a case with two segments, growth of everything and of fat, and a muscle; `changes` stand over it. */
function described(changes: object = {}): Description {
  return {
    segments: [{ name: "maxilla", centre_mm: [0, 0, 0] }, { name: "mandible", centre_mm: [0, 0, 0] }],
    node_ids: Array.from({ length: NODES }, (_, at) => at),
    inner_columns: [{ kind: "growth", name: "*" }, { kind: "growth", name: "fat" }, { kind: "muscle", name: "zygomaticus_left" }],
    columns: { file: "", layout: "f32 little-endian [column][node][xyz], mm", count: COUNT, bytes: 0, sha256: "" },
    ...changes,
  } as unknown as Description;
}
const still: Triple = [0, 0, 0];

test("a column of a muscle is not one of a segment", () => {
  const sum = new SkinSum(readColumns(described(), linear()));
  assert.equal(sum.displacement_mm.length, 3 * NODES);
  sum.move(1, coefficients({ translation_mm: [2, 0, 0], rotation_deg: still, pivot_mm: still, centre_mm: still }));
  // t_x of the second segment is column 12 + 3.
  assert.deepEqual([...sum.displacement_mm], [...column(15).map((value) => 2 * value)]);
  sum.pull([0, 0, 10]);
  assert.deepEqual([...sum.displacement_mm], [...column(15).map((value, n) => Math.fround(2 * value) + Math.fround(10 * column(26)[n]!))].map(Math.fround));
  sum.move(1, new Array<number>(12).fill(0));
  sum.pull([0, 0, 0]);
  assert(sum.displacement_mm.every((value) => value === 0));
});

test("amounts are taken by name and not by place", () => {
  const { inner } = readColumns(described(), linear());
  assert.deepEqual(innerFactors(inner, { growth: {}, muscle: { zygomaticus_left: 7 } }), [0, 0, 7]);
  const turned = [...inner].reverse();
  assert.deepEqual(innerFactors(turned, { growth: {}, muscle: { zygomaticus_left: 7 } }), [7, 0, 0]);
  const strain = (volume: number) => Math.cbrt(1 + volume) - 1;
  assert.deepEqual(innerFactors(inner, { growth: { "*": 0.1, fat: -0.2 }, muscle: {} }), [strain(0.1), strain(-0.2) - strain(0.1), 0]);
  assert.deepEqual(innerFactors(inner, { growth: { fat: -0.2 }, muscle: {} }), [0, strain(-0.2), 0]);
  assert.throws(() => innerFactors(inner, { growth: {}, muscle: { risorius: 1 } }), /no column of muscle risorius/);
});

test("what is not known of a response is refused by its name", () => {
  const refused = (changes: object, words: RegExp, bytes = linear()) => assert.throws(() => readColumns(described(changes), bytes), words);
  refused({ inner_columns: [{ kind: "gravity", name: "down" }] }, /column of gravity down, which this page does not know/);
  refused({ inner_columns: [] }, /has 27 columns, of which its description names 24/);
  refused({ inner_columns: undefined }, /has 27 columns/);
  refused({ node_ids: [0, 1] }, /1620 bytes of columns, expected 648/);
  refused({}, /bytes of columns/, linear().slice(4));
  refused({ columns: { ...described().columns, layout: "f16 [node][column]" } }, /laid out as "f16 \[node\]\[column\]"/);
  refused({ inner_columns: [..."ab"].map(() => ({ kind: "muscle", name: "a" })).concat({ kind: "growth", name: "b" }) }, /two columns of muscle a/);
});

test("a second order that is said to have muscles is refused", () => {
  const second_order = { columns: { file: "", layout: "i16 little-endian [column][node][xyz], in units", count: 300, bytes: 0, sha256: "" }, scale_mm: new Array(300).fill(1), third_order_mm: [] };
  const bytes = new Int16Array(300 * 3 * NODES).buffer;
  assert.throws(() => readColumns(described({ second_order }), linear(), bytes), /second order and columns of growth \*/);
  const without = described({ second_order, inner_columns: [], columns: { ...described().columns, count: 24 } });
  assert.equal(readColumns(without, linear().slice(0, 24 * 12 * NODES), bytes).second?.columns.length, 300 * 3 * NODES);
  assert.throws(() => readColumns(without, linear().slice(0, 24 * 12 * NODES), bytes.slice(2)), /bytes of columns/);
});

test("the muscle of the other side is found by its name", () => {
  const names = ["zygomaticus_left", "zygomaticus_right", "masseter_left", "orbicularis"];
  assert.deepEqual(names.map((name) => partner(name, names)), ["zygomaticus_right", "zygomaticus_left", undefined, undefined]);
});
