// The skin of a plan as a sum of response columns, at the rate of frames.
//
// u = sum over k of a_k C_k + sum over k <= l of a_k a_l scale_p S_p, a being the twelve numbers of each segment one after the
// other: rows of R - I, each followed by its component of t, the displacement of the segment's centre (docs/clients.md). What
// only one segment changes is kept for the others, so that a slider costs the columns of its own segment: the pairs of a segment that
// moves with one that stays are summed over the latter once, sum over k of a_k (sum over l of a_l scale_p S_p). Growth and muscles add a
// column each, behind those of all segments.
import type { Triple } from "../../clients/typescript/src/facies.js";
import { PER_SEGMENT, type Columns } from "./columns.js";
import { rotation } from "./frame.js";

/** A movement x' = R (x - pivot) + pivot + translation of a segment with its centre. */
export interface SegmentMovement {
  translation_mm: Triple;
  rotation_deg: Triple;
  pivot_mm: Triple;
  centre_mm: Triple;
}

/** What the twelve columns of a segment are multiplied with. */
export function coefficients({ translation_mm, rotation_deg, pivot_mm, centre_mm }: SegmentMovement): number[] {
  return rotation(rotation_deg).flatMap((row, i) => {
    const turn = row.map((value, j) => value - (i === j ? 1 : 0));
    const arm = turn.reduce((sum, value, j) => sum + value * (centre_mm[j]! - pivot_mm[j]!), translation_mm[i]!);
    return [...turn, arm];
  });
}

/** A factor and the column that it multiplies. */
interface Term {
  factor: number;
  first: number;
}

/** Writes the sum of factors times columns, four columns a pass. */
function sum(into: Float32Array, columns: Float32Array | Int16Array, terms: Term[]): void {
  into.fill(0);
  for (let at = 0; at < terms.length; at += 4) {
    const [a, b, c, d] = [0, 1, 2, 3].map((next) => terms[at + next] ?? { factor: 0, first: 0 }) as [Term, Term, Term, Term];
    for (let n = 0; n < into.length; n += 1) {
      into[n]! += a.factor * columns[a.first + n]! + b.factor * columns[b.first + n]!
        + c.factor * columns[c.first + n]! + d.factor * columns[d.first + n]!;
    }
  }
}

/** The displacement of the skin, kept up to date as segments move. */
export class SkinSum {
  /** xyz for each node in mm; the same array at every change. */
  readonly displacement_mm: Float32Array;
  /** What the second order adds, likewise; absent of a response of order 1. */
  readonly second_mm: Float32Array | undefined;
  private readonly factors: number[];
  private readonly linear: Float32Array[];
  /** Growth and muscles together. */
  private readonly inside: Float32Array;
  /** By the segments of a pair, the lower first. */
  private readonly pairs = new Map<string, Float32Array>();
  /** Sums over the second of two segments, twelve columns each, while it stays. */
  private readonly halves = new Map<string, Float32Array>();

  constructor(private readonly columns: Columns) {
    const { nodes, segments, second } = columns;
    this.factors = new Array<number>(PER_SEGMENT * segments).fill(0);
    const numbers = 3 * nodes;
    this.displacement_mm = new Float32Array(numbers);
    this.linear = Array.from({ length: segments }, () => new Float32Array(numbers));
    this.inside = new Float32Array(numbers);
    if (second === undefined) return;
    this.second_mm = new Float32Array(numbers);
    for (let s = 0; s < segments; s += 1) {
      for (let t = s; t < segments; t += 1) this.pairs.set(`${s} ${t}`, new Float32Array(numbers));
    }
  }

  /** Moves one segment; the others stay as they are. */
  move(segment: number, twelve: number[]): void {
    twelve.forEach((factor, at) => { this.factors[PER_SEGMENT * segment + at] = factor; });
    const { columns, displacement_mm: { length } } = this;
    const own = this.of(segment).filter((k) => this.factors[k] !== 0);
    sum(this.linear[segment]!, columns.linear, own.map((k) => ({ factor: this.factors[k]!, first: k * length })));
    for (let other = 0; other < columns.segments; other += 1) {
      this.halves.delete(`${other} ${segment}`);
      if (other === segment) this.own(segment);
      else this.cross(segment, other);
    }
    this.total();
  }

  /** Growth and muscles, by a factor for each of their columns. */
  pull(factors: number[]): void {
    const { columns: { linear, inner }, displacement_mm: { length } } = this;
    const first = this.factors.length;
    const terms = inner.map((_, at) => ({ factor: factors[at]!, first: (first + at) * length }));
    sum(this.inside, linear, terms.filter(({ factor }) => factor !== 0));
    this.total();
  }

  /** What the second order leaves out, estimated at each node in mm: the mean that samples of the third order tell of the skin that moves
   * (docs/estimates.md), shared out as the second order is. Zero of a response of order 1, which says nothing of its nodes. */
  leftOut_mm(samples: number[][], coupling?: number[][]): Float32Array {
    const { displacement_mm, second_mm, columns: { nodes } } = this;
    if (second_mm === undefined) return new Float32Array(nodes);
    const found = lengths(second_mm);
    const first = lengths(displacement_mm.map((value, at) => value - second_mm[at]!));
    const least = MOVING * first.reduce((most, one) => Math.max(most, one), 0);
    let [sum, moving] = [0, 0];
    first.forEach((one, node) => { if (one >= least) { sum += found[node]!; moving += 1; } });
    const share = sum > 0 ? (thirdOrder(samples, this.factors, coupling) * moving) / sum : 0;
    return found.map((one) => share * one);
  }

  /** The columns of a segment. */
  private of(segment: number): number[] {
    return Array.from({ length: PER_SEGMENT }, (_, at) => PER_SEGMENT * segment + at);
  }

  /** The pairs of a segment with itself. */
  private own(segment: number): void {
    const { columns: { second }, factors } = this;
    const into = this.pairs.get(`${segment} ${segment}`);
    if (second === undefined || into === undefined) return;
    const columns = this.of(segment);
    const terms = columns.flatMap((k) => columns.filter((l) => k <= l).map((l) => this.term(k, l, factors[k]! * factors[l]!)));
    sum(into, second.columns, terms.filter(({ factor }) => factor !== 0));
  }

  /** The pairs of a segment that moves with one that stays. */
  private cross(moving: number, staying: number): void {
    const { factors, displacement_mm: { length } } = this;
    const into = this.pairs.get(`${Math.min(moving, staying)} ${Math.max(moving, staying)}`);
    if (into === undefined) return;
    const half = this.half(moving, staying);
    const terms = this.of(moving).map((k, at) => ({ factor: factors[k]!, first: at * length }));
    sum(into, half, terms.filter(({ factor }) => factor !== 0));
  }

  private half(moving: number, staying: number): Float32Array {
    const { columns: { second }, factors, displacement_mm: { length }, halves } = this;
    const key = `${moving} ${staying}`;
    const known = halves.get(key);
    if (known !== undefined || second === undefined) return known ?? new Float32Array();
    const made = new Float32Array(PER_SEGMENT * length);
    const others = this.of(staying).filter((l) => factors[l] !== 0);
    this.of(moving).forEach((k, at) => {
      const terms = others.map((l) => this.term(k, l, factors[l]!));
      sum(made.subarray(at * length, (at + 1) * length), second.columns, terms);
    });
    halves.set(key, made);
    return made;
  }

  /** What the column of a pair is multiplied with, and where it begins. */
  private term(k: number, l: number, factor: number): Term {
    const p = place(Math.min(k, l), Math.max(k, l), this.factors.length);
    return { factor: factor * this.columns.second!.scale_mm[p]!, first: p * this.displacement_mm.length };
  }

  private total(): void {
    const { displacement_mm, second_mm, linear, inside, columns } = this;
    if (second_mm !== undefined) add(second_mm, [...this.pairs.values()]);
    const inner = columns.inner.length === 0 ? [] : [inside];
    add(displacement_mm, [...linear, ...inner, ...(second_mm === undefined ? [] : [second_mm])]);
  }
}

/** Skin moves that moves more than this share of what moves farthest. */
const MOVING = 0.1;

/** The mean length over the skin that moves of the third order, in mm, from its samples for 1 mm along x, y, z and 1 rad about them: a cubic
 * term that is put together as if it were the same in every direction, times what probes of every three directions say against that. */
export function thirdOrder(samples: number[][], factors: number[], coupling: number[][] = []): number {
  const numbers = samples.flatMap((_, segment) => rigidNumbers(factors.slice(PER_SEGMENT * segment, PER_SEGMENT * (segment + 1))));
  const alone = (lengths: number[]) => lengths.reduce((sum, one, at) => sum + numbers[at]! ** 2 * Math.cbrt(one) ** 2, 0) ** 1.5;
  const single: number[] = [];
  const together: number[] = [];
  let place = 0;
  for (let j = 0; j < numbers.length && coupling.length > 0; j++) {
    for (let k = j; k < numbers.length; k++) {
      for (let l = k; l < numbers.length; l++) {
        const probed = coupling[place++] ?? [];
        if (j === l) single[j] = Math.hypot(...probed);
        probed.forEach((one, at) => { together[at] = (together[at] ?? 0) + numbers[j]! * numbers[k]! * numbers[l]! * one; });
      }
    }
  }
  const probed = alone(single);
  return alone(samples.flat()) * (probed > 0 ? Math.hypot(...together) / probed : 1);
}

/** The translation of the centre in mm and the rotation vector in radians, of the twelve numbers of a segment. */
function rigidNumbers(twelve: number[]): number[] {
  const at = (row: number, column: number) => twelve[4 * row + column]!;
  const twice = [at(2, 1) - at(1, 2), at(0, 2) - at(2, 0), at(1, 0) - at(0, 1)];
  const sine = Math.hypot(...twice) / 2;
  const angle = Math.atan2(sine, (at(0, 0) + at(1, 1) + at(2, 2)) / 2 + 1);
  const turned = sine > 1e-9 ? twice.map((one) => (one * angle) / (2 * sine)) : new Array<number>(3).fill(angle / Math.sqrt(3));
  return [at(0, 3), at(1, 3), at(2, 3), ...turned];
}

/** The place of a pair k <= l of n in the order (0,0), (0,1), ..., (0,n-1), (1,1), ... */
function place(k: number, l: number, n: number): number {
  return k * n - (k * (k - 1)) / 2 + (l - k);
}

function add(into: Float32Array, parts: Float32Array[]): void {
  into.fill(0);
  for (const part of parts) for (let n = 0; n < into.length; n += 1) into[n]! += part[n]!;
}

/** The length of each vector of xyz. */
export function lengths(vectors: Float32Array): Float32Array {
  const found = new Float32Array(vectors.length / 3);
  for (let node = 0; node < found.length; node += 1) {
    const x = vectors[3 * node]!;
    const y = vectors[3 * node + 1]!;
    const z = vectors[3 * node + 2]!;
    found[node] = Math.sqrt(x * x + y * y + z * z);
  }
  return found;
}
