// A coarser picture of a surface over the same nodes, for while it moves: nodes in a cell of a grid become one of them.
//
// Source: J. Rossignac, P. Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993 (vertex clustering).

const ROUNDS = 4;

/** Triangles over some of the nodes, not many more than `most`; undefined where there are no more. Of each cell stays the node that is nearest to
 * the middle of those in it. */
export function coarse(points_mm: Float32Array, triangles: Uint32Array, most: number): Uint32Array | undefined {
  const count = triangles.length / 3;
  if (count <= most) return undefined;
  // Nodes of a surface thin out with the square of the cell.
  let cell = 1.1 * meanEdge(points_mm, triangles) * Math.sqrt(count / most);
  let found = clustered(points_mm, triangles, cell);
  for (let round = 1; round < ROUNDS && Math.abs(found.length / 3 / most - 0.9) > 0.2; round += 1) {
    cell *= Math.sqrt(found.length / 3 / most);
    found = clustered(points_mm, triangles, cell);
  }
  return found;
}

function meanEdge(points: Float32Array, triangles: Uint32Array): number {
  let sum = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b] = [3 * triangles[at]!, 3 * triangles[at + 1]!];
    sum += Math.hypot(points[a]! - points[b]!, points[a + 1]! - points[b + 1]!, points[a + 2]! - points[b + 2]!);
  }
  return sum / (triangles.length / 3);
}

function clustered(points: Float32Array, triangles: Uint32Array, cell: number): Uint32Array {
  const kept = representatives(points, cell);
  const found = new Uint32Array(triangles.length);
  let length = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [kept[triangles[at]!]!, kept[triangles[at + 1]!]!, kept[triangles[at + 2]!]!];
    if (a === b || b === c || c === a) continue;
    found[length] = a;
    found[length + 1] = b;
    found[length + 2] = c;
    length += 3;
  }
  return found.slice(0, length);
}

/** For each node the one that stands for its cell. */
function representatives(points: Float32Array, cell: number): Uint32Array {
  const nodes = points.length / 3;
  const of = new Uint32Array(nodes);
  const cells = new Map<number, number>();
  const place = (value: number) => Math.floor(value / cell) + 0x8000;
  for (let node = 0; node < nodes; node += 1) {
    const key = (place(points[3 * node]!) * 0x10000 + place(points[3 * node + 1]!)) * 0x10000 + place(points[3 * node + 2]!);
    let number = cells.get(key);
    if (number === undefined) { number = cells.size; cells.set(key, number); }
    of[node] = number;
  }
  const middles = new Float64Array(4 * cells.size);
  for (let node = 0; node < nodes; node += 1) {
    const at = 4 * of[node]!;
    for (let axis = 0; axis < 3; axis += 1) middles[at + axis]! += points[3 * node + axis]!;
    middles[at + 3]! += 1;
  }
  const nearest = new Uint32Array(cells.size);
  const least = new Float64Array(cells.size).fill(Infinity);
  for (let node = 0; node < nodes; node += 1) {
    const own = of[node]!;
    let away = 0;
    for (let axis = 0; axis < 3; axis += 1) away += (points[3 * node + axis]! - middles[4 * own + axis]! / middles[4 * own + 3]!) ** 2;
    if (away < least[own]!) { least[own] = away; nearest[own] = node; }
  }
  return of.map((own) => nearest[own]!);
}
