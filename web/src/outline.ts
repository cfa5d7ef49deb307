// The outline of a surface in a plane: the lateral profile, and where a saw goes through bone.
import type { Triple } from "../../clients/typescript/src/facies.js";

/** Pieces of the line in which triangles cross the plane of points whose product with the normal is `at`: two points of xyz each. */
export function section(points: ArrayLike<number>, triangles: ArrayLike<number>, [nx, ny, nz]: Triple, at: number): number[][] {
  const above = (first: number) => points[first]! * nx + points[first + 1]! * ny + points[first + 2]! * nz - at;
  const pieces: number[][] = [];
  for (let first = 0; first < triangles.length; first += 3) {
    const crossed: number[] = [];
    for (let edge = 0; edge < 3; edge += 1) {
      const [a, b] = [3 * triangles[first + edge]!, 3 * triangles[first + ((edge + 1) % 3)]!];
      const [from, to] = [above(a), above(b)];
      if (from < 0 === to < 0) continue;
      const share = from / (from - to);
      for (let xyz = 0; xyz < 3; xyz += 1) crossed.push(points[a + xyz]! + share * (points[b + xyz]! - points[a + xyz]!));
    }
    if (crossed.length === 6) pieces.push(crossed);
  }
  return pieces;
}
