// Triangulated surfaces from the binary glTF of the service.
//
// Source: glTF 2.0 specification, Khronos Group, sections 3.6 (buffers and accessors) and 4.4 (GLB).

const HEADER_BYTES = 12;
const CHUNK_HEADER_BYTES = 8;
const MAGIC = 0x46546c67;
const UNSIGNED_INT = 5125;
const COMPONENTS: Record<string, number> = { SCALAR: 1, VEC3: 3 };

interface Gltf {
  accessors: { bufferView: number; componentType: number; count: number; type: string }[];
  bufferViews: { byteOffset?: number }[];
  meshes: [{ primitives: [{ attributes: Record<string, number>; indices: number }] }];
  extras: { matrix4x4_to_case_row_major: number[] } & Record<string, unknown>;
}

/** Points in mm in the frame of the case, triangles, and values at the points by the names of their attributes. */
export interface Surface {
  /** xyz for each point. */
  points_mm: Float32Array;
  triangles: Uint32Array;
  values: Record<string, Float32Array>;
  extras: Record<string, unknown>;
}

/** The surface of a file that the service wrote. */
export function readGlb(content: ArrayBuffer): Surface {
  const head = new DataView(content);
  if (content.byteLength < HEADER_BYTES || head.getUint32(0, true) !== MAGIC || head.getUint32(8, true) !== content.byteLength) {
    throw new Error(`no whole GLB file in ${content.byteLength} bytes`);
  }
  const begin = HEADER_BYTES + CHUNK_HEADER_BYTES;
  const text = head.getUint32(HEADER_BYTES, true);
  const gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(content, begin, text))) as Gltf;
  const binary = begin + text + CHUNK_HEADER_BYTES;
  const array = (index: number) => {
    const accessor = gltf.accessors[index]!;
    const offset = binary + (gltf.bufferViews[accessor.bufferView]!.byteOffset ?? 0);
    const length = accessor.count * COMPONENTS[accessor.type]!;
    // Every typed array of a browser or of Node is little-endian, as glTF is.
    return accessor.componentType === UNSIGNED_INT
      ? new Uint32Array(content, offset, length) : new Float32Array(content, offset, length);
  };
  const { attributes, indices } = gltf.meshes[0].primitives[0];
  const { POSITION, ...others } = Object.fromEntries(
    Object.entries(attributes).map(([name, index]) => [name, array(index) as Float32Array]));
  const points_mm = moved(POSITION!, gltf.extras.matrix4x4_to_case_row_major);
  return { points_mm, triangles: array(indices) as Uint32Array, values: others, extras: gltf.extras };
}

/** The points after a row-major 4x4 matrix. */
function moved(points: Float32Array, matrix: number[]): Float32Array {
  return points.map((_, at) => {
    const [node, row] = [at - (at % 3), 4 * (at % 3)];
    const sum = (total: number, axis: number) => total + matrix[row + axis]! * points[node + axis]!;
    return [0, 1, 2].reduce(sum, matrix[row + 3]!);
  });
}
