// Surfaces as three.js has them, and how far they reach as they are seen.
import { BufferAttribute, BufferGeometry, Vector3, type Matrix4 } from "three";
import type { Triple } from "./api.js";
import { normals } from "./normals.js";

export interface Shape {
  points_mm: Float32Array;
  triangles: Uint32Array;
}

export function geometryOf({ points_mm, triangles }: Shape): BufferGeometry {
  const geometry = new BufferGeometry();
  const normal = new Float32Array(points_mm.length);
  normals(points_mm, triangles, normal);
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute("position", new BufferAttribute(points_mm.slice(), 3));
  geometry.setAttribute("normal", new BufferAttribute(normal, 3));
  return geometry;
}

/** Where the camera stands, seen from the head: patient's left, up, front. */
export const VIEWS: Record<string, Triple> = {
  "1": [0, 0, 1], "2": [-1, 0, 0], "3": [1, 0, 0], "4": [-0.7, 0.05, 0.72], "5": [0.7, 0.05, 0.72], "6": [0, -0.75, 0.66],
};

export interface Seen {
  /** The middle of what is seen. */
  target: Vector3;
  /** How far that reaches to either side, and up and down. */
  reach: { across: number; tall: number };
}
interface Span {
  middle: number;
  reach: number;
}

/** What is seen of points from a direction, `turned` being the axes of the case as they are drawn. */
export function seenFrom(points: Float32Array, turned: Matrix4, centre: Vector3, from: Vector3): Seen {
  const right = new Vector3(0, 1, 0).cross(from).normalize();
  const up = from.clone().cross(right);
  const axes = [right, up].map((axis) => axis.clone().transformDirection(turned.clone().transpose()));
  const [across, tall] = axes.map(({ x, y, z }) => {
    let [low, high] = [Infinity, -Infinity];
    for (let at = 0; at < points.length; at += 3) {
      const along = points[at]! * x + points[at + 1]! * y + points[at + 2]! * z;
      low = Math.min(low, along);
      high = Math.max(high, along);
    }
    return { middle: (low + high) / 2, reach: (high - low) / 2 };
  }) as [Span, Span];
  const target = new Vector3().addScaledVector(right, across.middle).addScaledVector(up, tall.middle).addScaledVector(from, centre.dot(from));
  return { target, reach: { across: across.reach, tall: tall.reach } };
}
