// Normals of a triangulated surface at its nodes, weighted by the areas of their triangles.

export function normals(points: Float32Array, triangles: Uint32Array, into: Float32Array): void {
  into.fill(0);
  for (let at = 0; at < triangles.length; at += 3) {
    const a = 3 * triangles[at]!;
    const b = 3 * triangles[at + 1]!;
    const c = 3 * triangles[at + 2]!;
    const ux = points[b]! - points[a]!;
    const uy = points[b + 1]! - points[a + 1]!;
    const uz = points[b + 2]! - points[a + 2]!;
    const vx = points[c]! - points[a]!;
    const vy = points[c + 1]! - points[a + 1]!;
    const vz = points[c + 2]! - points[a + 2]!;
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    into[a]! += x; into[a + 1]! += y; into[a + 2]! += z;
    into[b]! += x; into[b + 1]! += y; into[b + 2]! += z;
    into[c]! += x; into[c + 1]! += y; into[c + 2]! += z;
  }
  for (let node = 0; node < into.length; node += 3) {
    const x = into[node]!;
    const y = into[node + 1]!;
    const z = into[node + 2]!;
    const length = Math.sqrt(x * x + y * y + z * z) || 1;
    into[node]! /= length; into[node + 1]! /= length; into[node + 2]! /= length;
  }
}
