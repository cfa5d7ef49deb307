// What is seen as one binary glTF file: skin, bones where they are, colours of a map, and where it comes from.
//
// Source: glTF 2.0 specification, Khronos Group, sections 3.2 (asset), 3.6 (buffers and accessors), 3.7 (geometry) and 4.4 (GLB).
import type { Rgb } from "./palette.js";

/** A surface in mm in the frame of the case, or beside a row-major 4x4 matrix that brings it there. */
export interface Part {
  name: string;
  points_mm: Float32Array;
  triangles: Uint32Array;
  normals: Float32Array;
  matrix?: number[];
  colour: Rgb;
  /** Of each node, in the place of `colour`. */
  colours?: Rgb[];
  /** A number of each node under a name that begins with `_`. */
  values?: { name: string; of: ArrayLike<number> };
}

const MAGIC = 0x46546c67;
const CHUNKS = { json: 0x4e4f534a, binary: 0x004e4942 };
const FLOAT = 5126;
const UNSIGNED_INT = 5125;
const TARGETS = { attributes: 34962, indices: 34963 };
const SPACE = 0x20;
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** Colours are those of a screen; glTF multiplies with light. */
const linear = (value: number): number => (value <= 10.31475 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4);

/** `axes` are the rows that turn the frame of the case to the patient's left, up and front, as glTF has x, y and z; `extras` is what is said of
 * all. Lengths of glTF are metres: the node over all parts scales them. */
export function writeGlb(parts: Part[], axes: readonly (readonly number[])[], extras: Record<string, unknown>): Blob {
  const buffers = new Buffers();
  const meshes = parts.map((part, material) => ({ name: part.name, primitives: [{ ...buffers.primitive(part), material }] }));
  const nodes = parts.map(({ name, matrix }, mesh) => ({ name, mesh, ...(matrix === undefined ? {} : { matrix: columns(matrix) }) }));
  const [x, y, z] = axes.map((axis) => axis.map((value) => value / 1000)) as [number[], number[], number[]];
  const head = { name: "head", children: parts.map((_, at) => at), matrix: columns([...x, 0, ...y, 0, ...z, 0, 0, 0, 0, 1]) };
  const materials = parts.map(({ colour, colours }) => ({
    doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [...(colours === undefined ? colour.map(linear) : [1, 1, 1]), 1], metallicFactor: 0, roughnessFactor: 0.9 } }));
  const text = JSON.stringify({
    asset: { version: "2.0", generator: "facies", extras }, scene: 0, scenes: [{ nodes: [nodes.length] }], nodes: [...nodes, head], meshes, materials,
    accessors: buffers.accessors, bufferViews: buffers.views, buffers: [{ byteLength: buffers.length }],
    // As in files of the service: points are in the frame of the case already.
    extras: { ...extras, matrix4x4_to_case_row_major: IDENTITY },
  });
  const json = new TextEncoder().encode(text);
  const filled = new Uint8Array(Math.ceil(json.length / 4) * 4).fill(SPACE);
  filled.set(json);
  const whole = 12 + 8 + filled.length + 8 + buffers.length;
  return new Blob([
    Uint32Array.of(MAGIC, 2, whole), Uint32Array.of(filled.length, CHUNKS.json), filled, Uint32Array.of(buffers.length, CHUNKS.binary), ...buffers.content,
  ], { type: "model/gltf-binary" });
}

/** glTF has matrices column by column. */
const columns = (rows: number[]): number[] => rows.map((_, at) => rows[4 * (at % 4) + Math.floor(at / 4)]!);

class Buffers {
  readonly content: (Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>)[] = [];
  readonly views: object[] = [];
  readonly accessors: object[] = [];
  length = 0;

  primitive({ points_mm, triangles, normals, colours, values }: Part): object {
    const attributes: Record<string, number> = { POSITION: this.add(points_mm, 3, extent(points_mm)), NORMAL: this.add(normals, 3) };
    if (colours !== undefined) attributes.COLOR_0 = this.add(Float32Array.from(colours.flatMap((colour) => colour.map(linear))), 3);
    if (values !== undefined) attributes[values.name] = this.add(Float32Array.from(values.of), 1);
    return { attributes, indices: this.add(triangles, 1) };
  }

  private add(numbers: Float32Array | Uint32Array, components: 1 | 3, more: object = {}): number {
    const isIndex = numbers instanceof Uint32Array;
    this.views.push({ buffer: 0, byteOffset: this.length, byteLength: numbers.byteLength, target: isIndex ? TARGETS.indices : TARGETS.attributes });
    this.accessors.push({ bufferView: this.views.length - 1, componentType: isIndex ? UNSIGNED_INT : FLOAT, count: numbers.length / components, type: components === 1 ? "SCALAR" : "VEC3", ...more });
    this.content.push(numbers.slice());
    this.length += numbers.byteLength;
    return this.accessors.length - 1;
  }
}

function extent(points: Float32Array): { min: number[]; max: number[] } {
  const [min, max] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  points.forEach((value, at) => {
    min[at % 3] = Math.min(min[at % 3]!, value);
    max[at % 3] = Math.max(max[at % 3]!, value);
  });
  return { min, max };
}
