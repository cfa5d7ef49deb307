// A plan response: the columns of which the skin of every plan is a sum.
//
// u = sum over segments s of C[12 s + 4 i + j] (R - I)_ij + C[12 s + 4 i + 3] t_i, where the segment moves as
// x' = x + (R - I)(x - centre) + t. A response of order 2 adds, over pairs k <= l of these numbers a of all segments,
// a_k a_l scale_mm[p] S[p].
import type { components } from "./rest.js";
import type { Surface } from "./surface.js";

export type Triple = [number, number, number];
/** A movement as a plan says it: rotations about x, then y, then z, through the pivot, then the translation. */
export interface Movement {
  translation_mm?: Triple;
  rotation_deg?: Triple;
  pivot_mm?: Triple;
}

const MEMBERS = ["translation_mm", "rotation_deg", "pivot_mm"] as const;
const COLUMNS_PER_SEGMENT = 12;
const AXES = [0, 1, 2] as const;

/** What a page or a file may hold in the place of three numbers, as one reads it. */
function shown(value: unknown): string {
  if (Array.isArray(value)) return `[${value.map(shown).join(", ")}]`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

function isTriple(value: unknown): value is Triple {
  return Array.isArray(value) && value.length === 3 && value.every(Number.isFinite);
}

/** A movement with all its members, in numbers; what the service would refuse is refused here, by the name of the member. */
function checked(name: string, movement: Movement): Required<Movement> {
  const refuse = (member: string, why: string): never => { throw new RangeError(`/${name}${member}: ${why}`); };
  if (typeof movement !== "object" || movement === null) refuse("", `${shown(movement)} is no movement`);
  for (const [member, value] of Object.entries(movement)) {
    if (!MEMBERS.some((known) => known === member)) refuse(`/${member}`, `unknown, there are ${MEMBERS.join(", ")}`);
    if (value !== undefined && !isTriple(value)) refuse(`/${member}`, `${shown(value)} is not three finite numbers`);
  }
  const { translation_mm = [0, 0, 0], rotation_deg = [0, 0, 0], pivot_mm } = movement;
  if (pivot_mm === undefined && rotation_deg.some((angle) => angle !== 0)) {
    refuse("/pivot_mm", "`pivot_mm` is required where a rotation is not 0");
  }
  return { translation_mm, rotation_deg, pivot_mm: pivot_mm ?? [0, 0, 0] };
}

/** Rows of Rz Ry Rx. */
function rotation(degrees: Triple): [Triple, Triple, Triple] {
  const [a, b, c] = degrees.map((angle) => (angle * Math.PI) / 180) as Triple;
  const [sa, ca, sb, cb, sc, cc] = [a, b, c].flatMap((angle) => [Math.sin(angle), Math.cos(angle)]) as
    [number, number, number, number, number, number];
  return [
    [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
    [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
    [-sb, cb * sa, cb * ca],
  ];
}

/** Adds a factor times one of several columns of the same length. */
function add(total: Float32Array, factor: number, columns: Float32Array | Int16Array, column: number): void {
  if (factor === 0) return;
  const first = column * total.length;
  for (let number = 0; number < total.length; number += 1) total[number]! += factor * columns[first + number]!;
}

/** The columns of a case, in mm; nodes and vertices of `rest` stand in the order of `description.node_ids`. */
export class Response {
  constructor(
    readonly caseId: string,
    readonly job: string,
    readonly description: components["schemas"]["ResponseDescription"],
    /** [column][node][xyz] */
    readonly columns: Float32Array,
    readonly rest: Surface,
    /** Of a response of order 2: [pair][node][xyz] in units of `description.second_order.scale_mm`. */
    readonly secondOrder?: Int16Array,
  ) {}

  /** How far each node of the skin goes, xyz for each in mm, where segments move so and others stay. Without asking
   * the service, whose `apply` also refuses plans beyond the limits and estimates the linearisation error. Throws a
   * `RangeError` where a rotation has no pivot, a member is unknown, or something is not three finite numbers. */
  displacement(movements: Record<string, Movement>): Float32Array {
    const numbers = this.description.node_ids.length * 3;
    const total = new Float32Array(numbers);
    const factors = new Array<number>(COLUMNS_PER_SEGMENT * this.description.segments.length).fill(0);
    for (const [name, movement] of Object.entries(movements)) {
      const first = COLUMNS_PER_SEGMENT * this.segment(name);
      this.coefficients(name, movement).forEach((factor, at) => { factors[first + at] = factor; });
    }
    factors.forEach((factor, column) => add(total, factor, this.columns, column));
    const { secondOrder, description: { second_order: described } } = this;
    if (secondOrder === undefined || described === undefined) return total;
    let pair = 0;
    factors.forEach((factor, k) => {
      for (const other of factors.slice(k)) {
        add(total, factor * other * described.scale_mm[pair]!, secondOrder, pair);
        pair += 1;
      }
    });
    return total;
  }

  /** What its twelve columns are multiplied with. */
  private coefficients(name: string, movement: Movement): number[] {
    const { translation_mm, rotation_deg, pivot_mm } = checked(name, movement);
    const centre = this.description.segments[this.segment(name)]!.centre_mm;
    return rotation(rotation_deg).flatMap((row, i) => {
      const turn = AXES.map((j) => row[j] - (i === j ? 1 : 0));
      const shift = AXES.reduce<number>((sum, j) => sum + turn[j]! * (centre[j]! - pivot_mm[j]), translation_mm[i]!);
      return [...turn, shift];
    });
  }

  private segment(name: string): number {
    const names = this.description.segments.map((segment) => segment.name);
    const index = names.indexOf(name);
    if (index < 0) throw new RangeError(`the response moves ${names.join(", ")}, not ${name}`);
    return index;
  }
}
