// What the page computes by itself: sums of columns, words of movements, plans in addresses, colours, files.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Response, type Documents, type Triple } from "../../../clients/typescript/src/facies.js";
import { bands, share, ticks } from "../../src/colours.js";
import { inAxes, inWords, motion, movement, rotation, still } from "../../src/frame.js";
import { section } from "../../src/outline.js";
import { atRest, document, fromDocument, History, pivotsOf, planState, read, readPivots, written } from "../../src/plan.js";
import { readPly } from "../../src/ply.js";
import { coefficients, lengths, SkinSum, thirdOrder } from "../../src/response.js";

const NODES = 7;
const CENTRES: Triple[] = [[1, 2, 3], [-4, 5, -6]];
/** Numbers that look like chance and are the same in every run. */
function numbers(count: number): number[] {
  let state = 1;
  return Array.from({ length: count }, () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647 - 0.5;
  });
}
function* triplesOf(count: number): Generator<[number, number, number]> {
  for (let j = 0; j < count; j++) for (let k = j; k < count; k++) for (let l = k; l < count; l++) yield [j, k, l];
}
const linear = Float32Array.from(numbers(24 * 3 * NODES));
const pairs = (24 * 25) / 2;
const second = {
  columns: Int16Array.from(numbers(pairs * 3 * NODES), (value) => value * 60000),
  scale_mm: numbers(pairs).map((value) => Math.abs(value) * 1e-5),
};
const plan = {
  maxilla: { translation_mm: [1, -4, 2] as Triple, rotation_deg: [3, -2, 5] as Triple, pivot_mm: [7, 1, 0] as Triple },
  mandible: { translation_mm: [0, 6, 2] as Triple, rotation_deg: [-4, 0, 1] as Triple, pivot_mm: [0, 0, 9] as Triple },
};
/** The client's own sum, which is held to the service. */
function bySlowSum(order: 1 | 2, movements: Record<string, object>): Float32Array {
  const segments = Object.keys(plan).map((name, at) => ({ name, centre_mm: CENTRES[at] }));
  const node_ids = Array.from({ length: NODES }, (_, at) => at);
  const description = { segments, node_ids, ...(order === 2 ? { second_order: { scale_mm: second.scale_mm } } : {}) };
  const rest = { points_mm: new Float32Array(), triangles: new Uint32Array(), values: {}, extras: {} };
  return new Response("", "", description as unknown as Documents["ResponseDescription"], linear, rest,
    order === 2 ? second.columns : undefined).displacement(movements);
}
const twelve = (name: keyof typeof plan, at: number) => coefficients({ ...plan[name], centre_mm: CENTRES[at]! });
const apart = (a: Float32Array, b: Float32Array) => a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at]!)), 0);

for (const order of [1, 2] as const) {
  test(`a sum of order ${order} that is kept up to date is the client's`, () => {
    const sum = new SkinSum({ nodes: NODES, segments: 2, inner: [], linear, ...(order === 2 ? { second } : {}) });
    sum.move(0, twelve("maxilla", 0).map((value) => 2 * value));
    sum.move(1, twelve("mandible", 1));
    sum.move(0, twelve("maxilla", 0));
    const expected = bySlowSum(order, plan);
    assert(Math.max(...expected) > 1, "something moves");
    assert(apart(sum.displacement_mm, expected) < 2e-5);
    sum.move(0, new Array<number>(12).fill(0));
    assert(apart(sum.displacement_mm, bySlowSum(order, { mandible: plan.mandible })) < 2e-5);
  });
}

test("what the second order leaves out grows with the cube, and is shared out as the second order is", () => {
  const still = new Array<number>(12).fill(0);
  const samples = [[1e-3, 2e-3, 3e-3, 0.4, 0.5, 0.6], [1e-3, 1e-3, 1e-3, 1, 1, 1]];
  const along = coefficients({ translation_mm: [0, 2, 0], rotation_deg: [0, 0, 0], pivot_mm: [0, 0, 0], centre_mm: [1, 2, 3] });
  assert(Math.abs(thirdOrder(samples, [...along, ...still]) - 8 * 2e-3) < 1e-12);
  const about = coefficients({ translation_mm: [0, 0, 0], rotation_deg: [0, 0, 30], pivot_mm: [1, 2, 3], centre_mm: [1, 2, 3] });
  assert(Math.abs(thirdOrder(samples, [...about, ...still]) - 0.6 * (Math.PI / 6) ** 3) < 1e-12);
  // Probes that see the cross terms of the first two directions alone, of the same length as their cubes.
  const oblique = coefficients({ translation_mm: [1, 1, 0], rotation_deg: [0, 0, 0], pivot_mm: [1, 2, 3], centre_mm: [1, 2, 3] });
  const triples = [...triplesOf(12)];
  const coupling = triples.map((triple) => [triple.every((one) => one < 2) ? 1 : 0]);
  const together = thirdOrder(samples, [...oblique, ...still], coupling) / thirdOrder(samples, [...oblique, ...still]);
  assert(Math.abs(together - 4 / 2 ** 1.5) < 1e-12, `${together}`);
  const sum = new SkinSum({ nodes: NODES, segments: 2, inner: [], linear, second });
  sum.move(0, twelve("maxilla", 0));
  sum.move(1, twelve("mandible", 1));
  const [left, added, first] = [sum.leftOut_mm(samples), lengths(sum.second_mm!), lengths(bySlowSum(1, plan))];
  const moving = [...first.keys()].filter((node) => first[node]! >= 0.1 * Math.max(...first));
  const mean = moving.reduce((all, node) => all + left[node]!, 0) / moving.length;
  const told = thirdOrder(samples, [...twelve("maxilla", 0), ...twelve("mandible", 1)]);
  assert(told > 0 && Math.abs(mean / told - 1) < 1e-5, `${mean} of ${told}`);
  assert(left.every((one, node) => Math.abs(one / added[node]! - left[0]! / added[0]!) < 1e-5));
  assert.deepEqual([...new SkinSum({ nodes: NODES, segments: 2, inner: [], linear }).leftOut_mm(samples)], new Array(NODES).fill(0));
});

test("forward is to the front, up is up and left is left in either frame", () => {
  const words = { ...still(), forward: 6, up: 2, left: 1 };
  assert.deepEqual(movement(words, "LPS").translation_mm, [1, -6, 2]);
  assert.deepEqual(movement(words, "RAS").translation_mm, [-1, 6, 2]);
  assert.deepEqual(inWords([1, -6, 2], "LPS"), [6, 2, 1]);
  assert.deepEqual(inAxes([6, null, 1], "LPS"), [1, -6, null]);
});

test("pitch lifts the front, roll lifts the left side, yaw turns the front to the left", () => {
  for (const frame of ["LPS", "RAS"] as const) {
    const moved = (word: "pitch" | "roll" | "yaw", of: Triple) => {
      const { rotation_deg } = movement({ ...still(), [word]: 10 }, frame);
      const point = inAxes(of, frame);
      const turned = rotation(rotation_deg).map((row) => row.reduce((sum, value, at) => sum + value * point[at]!, 0));
      return inWords(turned as Triple, frame);
    };
    const [, front] = moved("pitch", [1, 0, 0]);
    const [, leftSide] = moved("roll", [0, 0, 1]);
    const [, , toTheLeft] = moved("yaw", [1, 0, 0]);
    for (const value of [front, leftSide, toTheLeft]) assert(Math.abs(value! - Math.sin(Math.PI / 18)) < 1e-12, `${frame} ${value}`);
  }
});

test("words and numbers of a plan are the same plan", () => {
  for (const frame of ["LPS", "RAS", "unspecified"] as const) {
    const words = { forward: 1, up: -2, left: 3, pitch: 4, roll: -5, yaw: 6 };
    const { translation_mm, rotation_deg } = movement(words, frame);
    assert.deepEqual(motion(translation_mm, rotation_deg, frame), words);
    const pivots = { jaw: [1, 2, 3] as Triple, chin: [0, 0, 0] as Triple };
    const rest = atRest(["jaw", "chin"]);
    const whole = { segments: { ...rest.segments, jaw: words }, inner: { growth: { "*": -0.05 }, muscle: { "zygomaticus left": 10 } } };
    assert.deepEqual(fromDocument(document(whole, pivots, frame), pivots, frame), whole);
    assert.equal(fromDocument(document(whole, pivots, frame), { jaw: [9, 9, 9] }, frame), undefined);
  }
});

test("a plan in the other frame turns about the same point", () => {
  const stated = { frame: "RAS", segments: [{ name: "jaw", translation_mm: [1, 6, 2], rotation_deg: [3, 0, 0], pivot_mm: [4, 5, 6] }] } as unknown as Documents["PlanDocument"];
  assert.deepEqual(pivotsOf(stated, "LPS"), { jaw: [-4, -5, 6] });
  const words = fromDocument(stated, { jaw: [-4, -5, 6] }, "LPS");
  assert.deepEqual(words?.segments.jaw, { ...still(), forward: 6, up: 2, left: -1, pitch: 3 });
  assert.equal(fromDocument(stated, { jaw: [4, 5, 6] }, "LPS"), undefined);
  // The same numbers in the frame of the case.
  assert.deepEqual((document(words!, { jaw: [-4, -5, 6] }, "LPS").segments as object[])[0],
    { name: "jaw", translation_mm: [-1, -6, 2], rotation_deg: [-3, 0, 0], pivot_mm: [-4, -5, 6] });
});

test("a plan that does more than sliders show is not taken for one that does less", () => {
  const pivots = { jaw: [0, 0, 0] as Triple };
  assert.notEqual(fromDocument({ segments: [] }, pivots, "LPS"), undefined);
  for (const more of [{ loads: [{}] }, { prescribed: [{}] }, { osteotomy: {} }]) {
    assert.equal(fromDocument({ segments: [], ...more } as unknown as Documents["PlanDocument"], pivots, "LPS"), undefined, JSON.stringify(more));
  }
});

test("a plan is read from an address as it was written, and nothing else is", () => {
  const names = ["left jaw;2", "b"];
  const words = atRest(names);
  words.segments["left jaw;2"] = { ...still(), forward: -1.5, yaw: 2 };
  words.inner = { growth: { "*": -0.05 }, muscle: { "a, b;c": 12.5 } };
  const pivots = { "left jaw;2": [1.5, -2, 3] as Triple, b: [0, 0, 0] as Triple };
  const state = new URLSearchParams(written(words, pivots) as Record<string, string>);
  assert.deepEqual(read(planState(state), names), words);
  assert.deepEqual(readPivots(written(words, pivots)), { "left jaw;2": [1.5, -2, 3] });
  const nothing = { growth: undefined, muscle: undefined };
  assert.deepEqual(readPivots({ p: "a,1,0,0,0,0,0;b,0,0,0,1,0,0,x,1,2", ...nothing }), {});
  assert.deepEqual(read({ p: "nobody,1,2;b,x,NaN,%", growth: ";x", muscle: "y,Infinity" }, ["b"]), atRest(["b"]));
});

test("what is taken back can be done again, until something else is done", () => {
  const history = new History(0);
  history.note(1);
  history.note(1);
  history.note(2);
  assert.equal(history.undo(), 1);
  assert.equal(history.redo(), 2);
  assert.equal(history.undo(), 1);
  history.note(3);
  assert.equal(history.redo(), undefined);
  assert.deepEqual([history.undo(), history.undo(), history.undo()], [1, 0, undefined]);
});

test("colours of lengths grow darker with the value, those of signs darker to either side", () => {
  const light = (scheme: "length" | "signed") => bands(scheme).map(([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b);
  const length = light("length");
  assert(length.every((value, at) => at === 0 || value < length[at - 1]! - 5), `${length}`);
  const signed = light("signed");
  for (let at = 1; at < 5; at += 1) assert(signed[at]! > signed[at - 1]! && signed[9 - at]! > signed[10 - at]!, `${signed}`);
  assert.deepEqual([share(5, 10, "length"), share(0, 2, "signed"), share(-2, 2, "signed")], [0.5, 0.5, 0]);
  assert.deepEqual([ticks(10, "length")[1], ticks(2, "signed")[0], ticks(2, "signed")[10]], [1, -2, 2]);
});

test("a surface is read from binary PLY", () => {
  const text = "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS\nelement vertex 3\nproperty double x\nproperty double y\n"
    + "property double z\nproperty int node_id\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const body = new DataView(new ArrayBuffer(3 * 28 + 13));
  [0, 1, 2].forEach((node) => [0, 1, 2].forEach((axis) => body.setFloat64(28 * node + 8 * axis, 10 * node + axis, true)));
  body.setInt32(2 * 28 + 24, 7, true);
  body.setUint8(84, 3);
  [2, 1, 0].forEach((node, at) => body.setInt32(85 + 4 * at, node, true));
  const bytes = new Uint8Array([...new TextEncoder().encode(text), ...new Uint8Array(body.buffer)]);
  const surface = readPly(bytes.buffer);
  assert.deepEqual([...surface.points_mm], [0, 1, 2, 10, 11, 12, 20, 21, 22]);
  assert.deepEqual([...surface.triangles], [2, 1, 0]);
  assert.equal(surface.space, "LPS");
  assert.deepEqual([...surface.node_ids!], [0, 0, 7]);
  assert.throws(() => readPly(new TextEncoder().encode("solid\nend_header\n").buffer), /no binary PLY/);
});

test("a triangle is cut where it crosses the plane", () => {
  const pieces = section([-1, 0, 0, 1, 0, 0, 1, 2, 0], [0, 1, 2], [1, 0, 0], 0);
  assert.deepEqual(pieces, [[0, 0, 0, 0, 1, 0]]);
  assert.deepEqual(section([1, 0, 0, 2, 0, 0, 1, 2, 0], [0, 1, 2], [1, 0, 0], 0), []);
});

test("a step of a slider is summed in far less than a frame takes", (context) => {
  const count = 14_000;
  const chance = numbers(1000);
  const filled = <T extends Float32Array | Int16Array>(array: T, scale: number): T => {
    for (let at = 0; at < array.length; at += 1) array[at] = scale * chance[at % chance.length]!;
    return array;
  };
  const columns = filled(new Float32Array(24 * 3 * count), 1);
  const size = { nodes: count, segments: 2, inner: [] };
  const pairColumns = { columns: filled(new Int16Array(pairs * 3 * count), 60000), scale_mm: second.scale_mm };
  const median_ms = (of: SkinSum) => {
    const took = Array.from({ length: 15 }, (_, step) => {
      const begin = process.cpuUsage();
      of.move(1, twelve("mandible", 1).map((value) => value * (1 + step / 10)));
      const { user, system } = process.cpuUsage(begin);
      return (user + system) / 1000;
    });
    return took.sort((a, b) => a - b)[7]!;
  };
  const turning = [new SkinSum({ ...size, linear: columns }), new SkinSum({ ...size, linear: columns, second: pairColumns })];
  const took = turning.map((one) => { one.move(0, twelve("maxilla", 0)); return median_ms(one); });
  context.diagnostic(`${count} nodes, two segments turning, processor time of a step: linear ${took[0]!.toFixed(1)} ms, second order ${took[1]!.toFixed(1)} ms`);
  assert(took[0]! < 16 && took[1]! < 60, `${took}`);
});
