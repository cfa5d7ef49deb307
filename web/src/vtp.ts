// Surfaces and values at their points from VTK XML files (VTP) as the service writes them: base64, zlib, 64-bit heads.
//
// Source: VTK file formats, Kitware, "XML file formats": a head of the number of blocks, their size, that of the last one and the
// compressed sizes, then the blocks.

export interface VtpSurface {
  points_mm: Float32Array;
  triangles: Uint32Array;
  /** Values at the points by the names of their arrays; xyz of vectors. */
  values: Record<string, Float32Array>;
}

const HEAD_NUMBER = 8;

function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

async function inflated(content: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer> {
  return new Response(new Blob([content]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

/** The bytes of an array. */
async function decoded(text: string): Promise<ArrayBuffer> {
  const count = Number(new DataView(bytesOf(text.slice(0, 12)).buffer).getBigUint64(0, true));
  const letters = 4 * Math.ceil(((3 + count) * HEAD_NUMBER) / 3);
  const head = new DataView(bytesOf(text.slice(0, letters)).buffer);
  const body = bytesOf(text.slice(letters));
  const blocks: ArrayBuffer[] = [];
  let at = 0;
  for (let block = 0; block < count; block += 1) {
    const size = Number(head.getBigUint64((3 + block) * HEAD_NUMBER, true));
    blocks.push(await inflated(body.slice(at, at + size)));
    at += size;
  }
  return new Blob(blocks).arrayBuffer();
}

const READ: Record<string, (content: ArrayBuffer) => ArrayLike<number>> = {
  Float64: (content) => new Float64Array(content),
  Float32: (content) => new Float32Array(content),
  Int32: (content) => new Int32Array(content),
  UInt32: (content) => new Uint32Array(content),
  Int64: (content) => Array.from(new BigInt64Array(content), Number),
  UInt8: (content) => new Uint8Array(content),
};

async function numbers(array: string): Promise<ArrayLike<number>> {
  const [, attributes = "", text = ""] = /^([^>]*)>([^<]*)/.exec(array) ?? [];
  const read = READ[/type="(\w+)"/.exec(attributes)?.[1] ?? ""];
  if (read === undefined || !attributes.includes('format="binary"')) throw new Error("an array of the file is not read here");
  return text.trim() === "" ? [] : read(await decoded(text.trim()));
}

/** The arrays of a part of the file, each from behind its `<DataArray`. */
function arrays(text: string, part: string): string[] {
  const [, inner = ""] = new RegExp(`<${part}[ >]([\\s\\S]*?)</${part}>`).exec(text) ?? [];
  return inner.split("<DataArray").slice(1);
}

const named = (array: string): string => /Name="([^"]*)"/.exec(array)?.[1] ?? "";

/** Values at the points of a volume or a surface by the names of their arrays, of those that are `wanted`. */
export async function pointArrays(content: ArrayBuffer, wanted: (name: string) => boolean): Promise<Record<string, Float32Array>> {
  const text = new TextDecoder().decode(content);
  if (!text.includes('header_type="UInt64"') || !text.includes("vtkZLibDataCompressor")) throw new Error("no VTK file of the service");
  const values: Record<string, Float32Array> = {};
  for (const array of arrays(text, "PointData")) if (wanted(named(array))) values[named(array)] = Float32Array.from(await numbers(array));
  return values;
}

/** Values of a file of skin by the names that `skin.glb` has for them: `displacement_mm` is `_DISPLACEMENT_MM`. */
export const asInGlb = (surface: VtpSurface): VtpSurface =>
  ({ ...surface, values: Object.fromEntries(Object.entries(surface.values).map(([name, values]) => [`_${name.toUpperCase()}`, values])) });

export async function readVtp(content: ArrayBuffer): Promise<VtpSurface> {
  const text = new TextDecoder().decode(content);
  if (!text.includes('header_type="UInt64"') || !text.includes("vtkZLibDataCompressor")) throw new Error("no VTP file of the service");
  const [points] = arrays(text, "Points");
  const connectivity = arrays(text, "Polys").find((array) => named(array) === "connectivity");
  if (points === undefined || connectivity === undefined) throw new Error("a VTP file without a surface");
  const values = await pointArrays(content, () => true);
  return { points_mm: Float32Array.from(await numbers(points)), triangles: Uint32Array.from(await numbers(connectivity)), values };
}
