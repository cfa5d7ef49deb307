// Painting on a surface: faces under a brush, and the painted faces as a surface of their own.
import type { Triple } from "../../clients/typescript/src/facies.js";

interface Surface {
  points_mm: Float32Array;
  triangles: Uint32Array;
}

/** The faces of a surface by their middles and normals, so that a brush finds those that it touches. */
export class Canvas {
  private readonly middles: Float32Array;
  private readonly normals: Float32Array;

  constructor(readonly surface: Surface) {
    const { points_mm: points, triangles } = surface;
    this.middles = new Float32Array(triangles.length);
    this.normals = new Float32Array(triangles.length);
    for (let at = 0; at < triangles.length; at += 3) {
      const [a, b, c] = [0, 1, 2].map((corner) => 3 * triangles[at + corner]!) as Triple;
      const u = [0, 1, 2].map((axis) => points[b + axis]! - points[a + axis]!) as Triple;
      const v = [0, 1, 2].map((axis) => points[c + axis]! - points[a + axis]!) as Triple;
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      for (let axis = 0; axis < 3; axis += 1) {
        this.middles[at + axis] = (points[a + axis]! + points[b + axis]! + points[c + axis]!) / 3;
        this.normals[at + axis] = normal[axis]!;
      }
    }
  }

  /** Faces whose middle is within a radius of a point, and which look to the side to which the face there does. */
  under(point_mm: Triple, face: number, radius_mm: number): number[] {
    const { middles, normals } = this;
    const [x, y, z] = point_mm;
    const squared = radius_mm * radius_mm;
    const found: number[] = [];
    for (let at = 0; at < middles.length; at += 3) {
      const [dx, dy, dz] = [middles[at]! - x, middles[at + 1]! - y, middles[at + 2]! - z];
      if (dx * dx + dy * dy + dz * dz > squared) continue;
      const facing = normals[at]! * normals[3 * face]! + normals[at + 1]! * normals[3 * face + 1]! + normals[at + 2]! * normals[3 * face + 2]!;
      if (facing > 0) found.push(at / 3);
    }
    if (!found.includes(face)) found.push(face);
    return found;
  }

  /** Some faces as a surface of its own, in mm, with the points that they have. */
  part(faces: Iterable<number>): Surface {
    const { points_mm, triangles } = this.surface;
    const places = new Map<number, number>();
    const corners: number[] = [];
    for (const face of faces) {
      for (let corner = 0; corner < 3; corner += 1) {
        const node = triangles[3 * face + corner]!;
        if (!places.has(node)) places.set(node, places.size);
        corners.push(places.get(node)!);
      }
    }
    const points = Float32Array.from([...places.keys()].flatMap((node) => [points_mm[3 * node]!, points_mm[3 * node + 1]!, points_mm[3 * node + 2]!]));
    return { points_mm: points, triangles: Uint32Array.from(corners) };
  }

  /** In mm². */
  area(faces: Iterable<number>): number {
    let sum = 0;
    for (const face of faces) sum += Math.hypot(this.normals[3 * face]!, this.normals[3 * face + 1]!, this.normals[3 * face + 2]!) / 2;
    return sum;
  }

  /** Points of faces that are not painted and lie on those that are, such as the other lip of a closed mouth: whoever selects by
   * distance takes them too. */
  strangers(faces: ReadonlySet<number>, within_mm: number): number {
    const { points_mm, triangles } = this.surface;
    const own = new Set<number>();
    for (const face of faces) for (let corner = 0; corner < 3; corner += 1) own.add(triangles[3 * face + corner]!);
    const corner = (face: number, at: number) => [0, 1, 2].map((axis) => points_mm[3 * triangles[3 * face + at]! + axis]!) as Triple;
    const painted = [...faces].map((face) => [corner(face, 0), corner(face, 1), corner(face, 2)] as const);
    const boxes = painted.map((corners) => [0, 1, 2].map((axis) => [Math.min(...corners.map((one) => one[axis]!)) - within_mm, Math.max(...corners.map((one) => one[axis]!)) + within_mm] as const));
    const whole = [0, 1, 2].map((axis) => [boxes.reduce((low, box) => Math.min(low, box[axis]![0]), Infinity), boxes.reduce((high, box) => Math.max(high, box[axis]![1]), -Infinity)] as const);
    const inside = (point: Triple, box: (readonly [number, number])[]) => point.every((value, axis) => value >= box[axis]![0] && value <= box[axis]![1]);
    let count = 0;
    for (let node = 0; node < points_mm.length / 3; node += 1) {
      if (own.has(node)) continue;
      const point: Triple = [points_mm[3 * node]!, points_mm[3 * node + 1]!, points_mm[3 * node + 2]!];
      if (inside(point, whole) && painted.some((corners, at) => inside(point, boxes[at]!) && distance(point, ...corners) <= within_mm)) count += 1;
    }
    return count;
  }
}

const minus = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** From a point to a triangle. Source: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5. */
export function distance(point: Triple, a: Triple, b: Triple, c: Triple): number {
  const [ab, ac, ap, bp, cp] = [minus(b, a), minus(c, a), minus(point, a), minus(point, b), minus(point, c)];
  const [d1, d2, d3, d4, d5, d6] = [dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp)];
  const at = (s: number, t: number) => Math.hypot(...ap.map((value, axis) => value - s * ab[axis]! - t * ac[axis]!));
  if (d1 <= 0 && d2 <= 0) return at(0, 0);
  if (d3 >= 0 && d4 <= d3) return at(1, 0);
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return at(d1 / (d1 - d3), 0);
  if (d6 >= 0 && d5 <= d6) return at(0, 1);
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 / (d2 - d6));
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const along = (d4 - d3) / (d4 - d3 + (d5 - d6));
    return at(1 - along, along);
  }
  const sum = va + vb + vc;
  return at(vb / sum, vc / sum);
}

/** Binary PLY of a surface. Source: G. Turk, The PLY Polygon File Format, 1994. */
export function plyOf({ points_mm, triangles }: Surface): Blob {
  const head = ["ply", "format binary_little_endian 1.0", `element vertex ${points_mm.length / 3}`, "property float x", "property float y", "property float z",
    `element face ${triangles.length / 3}`, "property list uchar int vertex_indices", "end_header", ""].join("\n");
  const body = new DataView(new ArrayBuffer(4 * points_mm.length + 13 * (triangles.length / 3)));
  points_mm.forEach((value, at) => body.setFloat32(4 * at, value, true));
  const first = 4 * points_mm.length;
  for (let face = 0; face < triangles.length / 3; face += 1) {
    body.setUint8(first + 13 * face, 3);
    for (let corner = 0; corner < 3; corner += 1) body.setInt32(first + 13 * face + 1 + 4 * corner, triangles[3 * face + corner]!, true);
  }
  return new Blob([head, body.buffer]);
}
