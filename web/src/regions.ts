// Lengths over parts of the skin, each node counted by the area around it, as the service does it.
import type { Triple } from "../../clients/typescript/src/facies.js";

export interface Lengths {
  mean: number;
  p95: number;
  max: number;
}

/** A cumulative weight this share below its target has reached it: sums of many weights are rounded. */
const ROUNDING = 1e-12;

/** A third of each triangle for each of its nodes, in mm². */
export function nodeAreas(points_mm: Float32Array, triangles: Uint32Array): Float64Array {
  const areas = new Float64Array(points_mm.length / 3);
  for (let at = 0; at < triangles.length; at += 3) {
    const corners = [0, 1, 2].map((next) => triangles[at + next]!);
    const [a, b, c] = corners.map((node) => [0, 1, 2].map((axis) => points_mm[3 * node + axis]!)) as [Triple, Triple, Triple];
    const [u, v] = [b, c].map((corner) => corner.map((value, axis) => value - a[axis]!)) as [Triple, Triple];
    const area = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
    for (const node of corners) areas[node]! += area / 3;
  }
  return areas;
}

/** Of the nodes of a part, or of all; the 95th percentile is the smallest value that so much of the area lies at or below. Undefined
 * where no area is. */
export function lengthsOver(values: ArrayLike<number>, areas: ArrayLike<number>, inside?: ArrayLike<number>): Lengths | undefined {
  const nodes = Array.from({ length: values.length }, (_, node) => node).filter((node) => (inside === undefined || inside[node] !== 0) && areas[node]! > 0);
  const total = nodes.reduce((sum, node) => sum + areas[node]!, 0);
  if (total === 0) return undefined;
  nodes.sort((one, other) => values[one]! - values[other]!);
  let below = 0;
  const p95 = nodes.find((node) => (below += areas[node]!) >= 0.95 * total * (1 - ROUNDING)) ?? nodes.at(-1)!;
  return { mean: nodes.reduce((sum, node) => sum + areas[node]! * values[node]!, 0) / total, p95: values[p95]!, max: values[nodes.at(-1)!]! };
}
