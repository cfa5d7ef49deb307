// The outline of a surface in the sagittal plane, for the lateral profile.

/** Pieces of the line in which triangles cross the plane where the coordinate `axis` is `at`: two points of xyz each. */
export function section(points: ArrayLike<number>, triangles: ArrayLike<number>, axis: 0 | 1 | 2, at: number): number[][] {
  const pieces: number[][] = [];
  for (let first = 0; first < triangles.length; first += 3) {
    const crossed: number[] = [];
    for (let edge = 0; edge < 3; edge += 1) {
      const [a, b] = [3 * triangles[first + edge]!, 3 * triangles[first + ((edge + 1) % 3)]!];
      const [from, to] = [points[a + axis]! - at, points[b + axis]! - at];
      if (from < 0 === to < 0) continue;
      const share = from / (from - to);
      for (let xyz = 0; xyz < 3; xyz += 1) crossed.push(points[a + xyz]! + share * (points[b + xyz]! - points[a + xyz]!));
    }
    if (crossed.length === 6) pieces.push(crossed);
  }
  return pieces;
}
