// Triangulated surfaces from binary PLY as the service writes it: points, a number for each, triangles.
//
// Source: G. Turk, The PLY Polygon File Format, 1994.

export interface PlySurface {
  /** xyz for each point, in mm. */
  points_mm: Float32Array;
  triangles: Uint32Array;
  /** Of each point its node in the volume mesh, where the file says it. */
  node_ids?: Uint32Array;
  /** Which way the axes point, where the file says so. */
  space: string | undefined;
}

const BYTES: Record<string, number> = { char: 1, uchar: 1, short: 2, ushort: 2, int: 4, uint: 4, float: 4, double: 8 };
const END = "end_header\n";

interface Head {
  vertices: number;
  faces: number;
  vertexBytes: number;
  /** Bytes of a coordinate. */
  coordinate: number;
  /** Where in a point the number of its node begins. */
  node: number | undefined;
  space: string | undefined;
}

function head(text: string): Head {
  const count = (name: string) => Number(new RegExp(`element ${name} (\\d+)`).exec(text)?.[1] ?? 0);
  const types = [...text.matchAll(/^property (\w+) (\w+)$/gm)];
  const vertexBytes = types.reduce((sum, [, type]) => sum + (BYTES[type!] ?? 0), 0);
  const coordinate = BYTES[types[0]?.[1] ?? ""] ?? 0;
  const plain = types.slice(0, 3).map(([, , name]) => name).join("") === "xyz";
  if (!text.includes("format binary_little_endian") || !plain || coordinate < 4) {
    throw new Error("no binary PLY file with points");
  }
  return {
    node: types[3]?.[1] === "int" && types[3]?.[2] === "node_id" ? 3 * coordinate : undefined,
    vertices: count("vertex"), faces: count("face"), vertexBytes, coordinate,
    space: /^comment SPACE=(\w+)$/m.exec(text)?.[1],
  };
}

export function readPly(content: ArrayBuffer): PlySurface {
  const start = new TextDecoder("latin1").decode(new Uint8Array(content, 0, Math.min(content.byteLength, 65536)));
  const length = start.indexOf(END) + END.length;
  const { vertices, faces, vertexBytes, coordinate, node, space } = head(start.slice(0, length));
  const view = new DataView(content, length);
  const number = (at: number) => (coordinate === 8 ? view.getFloat64(at, true) : view.getFloat32(at, true));
  const points_mm = Float32Array.from({ length: 3 * vertices }, (_, at) =>
    number(Math.floor(at / 3) * vertexBytes + (at % 3) * coordinate));
  // Triangles only: a byte that says 3, and three numbers.
  const first = vertices * vertexBytes;
  const triangles = Uint32Array.from({ length: 3 * faces }, (_, at) =>
    view.getInt32(first + Math.floor(at / 3) * 13 + 1 + 4 * (at % 3), true));
  const node_ids = node === undefined ? undefined : Uint32Array.from({ length: vertices }, (_, at) => view.getInt32(at * vertexBytes + node, true));
  return { points_mm, triangles, space, ...(node_ids === undefined ? {} : { node_ids }) };
}

/** The points of a surface in the frame of a case: files are in LPS or in that of the case. */
export function inFrame(surface: PlySurface, frame: string): Float32Array {
  const turned = surface.space !== undefined && frame !== "unspecified" && surface.space !== frame;
  return turned ? surface.points_mm.map((value, at) => (at % 3 === 2 ? value : -value)) : surface.points_mm;
}
