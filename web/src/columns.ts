// What the columns of a response are of, as its description names them: twelve for each segment, then one for each region that
// grows and each muscle that pulls (docs/clients.md, docs/growth-and-muscles.md). What is not named here is refused: a column taken for
// another would draw a wrong skin.
import type { Documents } from "../../clients/typescript/src/facies.js";

export const PER_SEGMENT = 12;
const BYTES = { f32: 4, i16: 2 } as const;
const LINEAR = "f32 little-endian [column][node][xyz]";
const SECOND = "i16 little-endian [column][node][xyz]";

/** Growth of a region as a share of its volume, or the stress of a muscle in kPa. */
export const INNER_KINDS = ["growth", "muscle"] as const;
export type InnerKind = (typeof INNER_KINDS)[number];
export interface InnerColumn {
  kind: InnerKind;
  name: string;
}
/** Amounts by name; what is not named is 0. */
export type Inner = Record<InnerKind, Record<string, number>>;

/** The columns as the service hands them over: [column][node][xyz] in mm, of second order in units of `scale_mm`. */
export interface Columns {
  nodes: number;
  segments: number;
  /** Of the columns behind those of the segments, in their order. */
  inner: InnerColumn[];
  linear: Float32Array;
  second?: { columns: Int16Array; scale_mm: number[] };
}

type Described = Pick<Documents["ResponseDescription"], "segments" | "node_ids" | "columns" | "inner_columns" | "second_order">;

/** Reads the columns by what the description says of them; throws where it says what is not known here, or its numbers do not fit. */
export function readColumns(description: Described, linear: ArrayBuffer, second?: ArrayBuffer): Columns {
  const { segments, node_ids, columns, second_order } = description;
  const inner = (description.inner_columns ?? []).map(known);
  const names = [...segments.map(({ name }) => `segment ${name}`), ...inner.map(({ kind, name }) => `${kind} ${name}`)];
  const twice = names.find((name, at) => names.indexOf(name) !== at);
  if (twice !== undefined) throw new RangeError(`the response has two columns of ${twice}`);
  const moving = PER_SEGMENT * segments.length;
  const size = { nodes: node_ids.length, bytes: BYTES.f32, count: moving + inner.length };
  fits(columns, LINEAR, size, linear);
  const read: Columns = { nodes: node_ids.length, segments: segments.length, inner, linear: new Float32Array(linear) };
  if (second === undefined || second_order === undefined) return read;
  if (inner.length > 0) throw new RangeError(`the response has a second order and columns of ${inner[0]!.kind} ${inner[0]!.name}, which is not known here`);
  const pairs = (moving * (moving + 1)) / 2;
  fits(second_order.columns, SECOND, { ...size, bytes: BYTES.i16, count: pairs }, second);
  if (second_order.scale_mm.length !== pairs) throw new RangeError(`the response has ${second_order.scale_mm.length} scales for ${pairs} columns of second order`);
  return { ...read, second: { columns: new Int16Array(second), scale_mm: second_order.scale_mm } };
}

function known({ kind, name }: { kind: string; name: string }): InnerColumn {
  const found = INNER_KINDS.find((one) => one === kind);
  if (found === undefined) throw new RangeError(`the response has a column of ${kind} ${name}, which this page does not know`);
  return { kind: found, name };
}

interface Size {
  count: number;
  nodes: number;
  bytes: number;
}

function fits(stated: Documents["ColumnsDocument"], layout: string, { count, nodes, bytes }: Size, content: ArrayBuffer): void {
  if (!stated.layout.startsWith(layout)) throw new RangeError(`columns are laid out as "${stated.layout}", which this page does not know`);
  if (stated.count !== count) throw new RangeError(`the response has ${stated.count} columns, of which its description names ${count}`);
  const wanted = count * 3 * nodes * bytes;
  if (content.byteLength !== wanted) throw new RangeError(`${content.byteLength} bytes of columns, expected ${wanted}`);
}

/** What a length gains where a volume gains this share. */
const linearStrain = (volumeChange: number): number => Math.cbrt(1 + volumeChange) - 1;

/** The factor of each inner column for amounts by name: kPa of a muscle; of a region (1 + share)^(1/3) - 1, beside growth of all tissue
 * (`*`) what it grows more than that. Throws by the name of what has no column. */
export function innerFactors(columns: InnerColumn[], inner: Inner): number[] {
  for (const kind of INNER_KINDS) {
    for (const [name, value] of Object.entries(inner[kind])) {
      const there = columns.some((column) => column.kind === kind && column.name === name);
      if (!there && value !== 0) throw new RangeError(`the response has no column of ${kind} ${name}`);
    }
  }
  const everywhere = linearStrain(inner.growth["*"] ?? 0);
  return columns.map(({ kind, name }) => {
    const amount = inner[kind][name] ?? 0;
    if (kind === "muscle" || amount === 0) return amount;
    return name === "*" ? everywhere : linearStrain(amount) - everywhere;
  });
}
