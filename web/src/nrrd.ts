// Bone of a scan as a surface to look at: NRRD as the service writes it, its voxels in blocks, and the surface between blocks with bone and without.
//
// Source: S. Gibson, Constrained elastic surface nets, 1998: a point for each cube of blocks that the surface goes through, in the middle of
// the edges that it crosses.
import type { Triple } from "../../clients/typescript/src/facies.js";
import type { Shape } from "./geometry.js";

interface Scan {
  size: Triple;
  /** From a voxel to the next along each axis, in mm. */
  steps: [Triple, Triple, Triple];
  origin_mm: Triple;
  space: string;
  values: ArrayLike<number>;
}

const READ: Record<string, (content: ArrayBuffer) => ArrayLike<number>> = {
  short: (content) => new Int16Array(content), "unsigned short": (content) => new Uint16Array(content), uchar: (content) => new Uint8Array(content),
  int: (content) => new Int32Array(content), float: (content) => new Float32Array(content), double: (content) => new Float64Array(content),
};
const END = "\n\n";
const triples = (text: string): Triple[] => [...text.matchAll(/\(([^)]*)\)/g)].map(([, inner]) => inner!.split(",").map(Number) as Triple);

export async function readNrrd(content: ArrayBuffer): Promise<Scan> {
  const start = new TextDecoder("latin1").decode(new Uint8Array(content, 0, Math.min(content.byteLength, 65536)));
  const length = start.indexOf(END);
  const fields = Object.fromEntries([...start.slice(0, length + 1).matchAll(/^([a-z ]+): (.*)$/gm)].map(([, name, value]) => [name!, value!]));
  const read = READ[fields.type ?? ""];
  const size = (fields.sizes ?? "").split(" ").map(Number) as Triple;
  const steps = triples(fields["space directions"] ?? "") as [Triple, Triple, Triple];
  const [origin_mm] = triples(fields["space origin"] ?? "");
  if (length < 0 || read === undefined || steps.length !== 3 || size.length !== 3 || origin_mm === undefined || fields.encoding !== "gzip") throw new Error("no NRRD file of a scan that is read here");
  const bytes = await new Response(new Blob([content.slice(length + END.length)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  return { size, steps, origin_mm, space: fields.space ?? "", values: read(bytes) };
}

/** About so many blocks along the longest side: enough to find a jaw, few enough to turn. */
const BLOCKS = 110;
const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [corner & 1, (corner >> 1) & 1, corner >> 2] as Triple);
const EDGES: [number, number][] = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

interface Blocks {
  size: Triple;
  /** Voxels along the side of one. */
  of: number;
  /** The largest value of each. */
  most: Float32Array;
}

function blocks({ size, values }: Scan): Blocks {
  const of = Math.max(Math.ceil(Math.max(...size) / BLOCKS), 1);
  const coarse = size.map((count) => Math.ceil(count / of)) as Triple;
  const most = new Float32Array(coarse[0] * coarse[1] * coarse[2]).fill(-Infinity);
  let at = 0;
  for (let z = 0; z < size[2]; z += 1) {
    for (let y = 0; y < size[1]; y += 1) {
      const row = (Math.floor(z / of) * coarse[1] + Math.floor(y / of)) * coarse[0];
      for (let x = 0; x < size[0]; x += 1, at += 1) {
        const block = row + Math.floor(x / of);
        if (values[at]! > most[block]!) most[block] = values[at]!;
      }
    }
  }
  return { size: coarse, of, most };
}

/** The surface of what is at or above a value, in mm in the frame of the file. */
export function surfaceAt(scan: Scan, threshold: number): Shape {
  const { size: [nx, ny, nz], of, most } = blocks(scan);
  const value = (x: number, y: number, z: number) => (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz ? -Infinity : most[(z * ny + y) * nx + x]!);
  const inside = (x: number, y: number, z: number) => value(x, y, z) >= threshold;
  const points: number[] = [];
  const known = new Map<number, number>();
  const key = (x: number, y: number, z: number) => ((z + 1) * (ny + 2) + y + 1) * (nx + 2) + x + 1;
  /** The point of the cube whose lowest block this is. */
  const point = (x: number, y: number, z: number) => {
    const is = known.get(key(x, y, z));
    if (is !== undefined) return is;
    const within = CORNERS.map(([i, j, k]) => inside(x + i, y + j, z + k));
    const crossed = EDGES.filter(([a, b]) => within[a] !== within[b]).map(([a, b]) => CORNERS[a]!.map((one, axis) => (one + CORNERS[b]![axis]!) / 2));
    // Blocks begin at the first voxel, and the middle of one is half a block from there.
    const [i, j, k] = [x, y, z].map((first, axis) => (first + crossed.reduce((sum, place) => sum + place[axis]!, 0) / crossed.length + 0.5) * of - 0.5) as Triple;
    for (let axis = 0; axis < 3; axis += 1) points.push(scan.origin_mm[axis]! + i * scan.steps[0][axis]! + j * scan.steps[1][axis]! + k * scan.steps[2][axis]!);
    known.set(key(x, y, z), points.length / 3 - 1);
    return points.length / 3 - 1;
  };
  const triangles: number[] = [];
  for (let z = -1; z < nz; z += 1) {
    for (let y = -1; y < ny; y += 1) {
      for (let x = -1; x < nx; x += 1) {
        const here = inside(x, y, z);
        for (const [i, j, k] of [[1, 0, 0], [0, 1, 0], [0, 0, 1]] as Triple[]) {
          if (here === inside(x + i, y + j, z + k)) continue;
          // The four cubes around the edge.
          const [u, v] = i === 1 ? [[0, 1, 0], [0, 0, 1]] : j === 1 ? [[0, 0, 1], [1, 0, 0]] : [[1, 0, 0], [0, 1, 0]];
          const around = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([a, b]) => point(x - a! * u![0]! - b! * v![0]!, y - a! * u![1]! - b! * v![1]!, z - a! * u![2]! - b! * v![2]!)) as [number, number, number, number];
          const [a, b, c, d] = here ? around : [...around].reverse() as typeof around;
          triangles.push(a, b, c, a, c, d);
        }
      }
    }
  }
  return { points_mm: new Float32Array(points), triangles: new Uint32Array(triangles) };
}
