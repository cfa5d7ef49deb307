// Cuts through bone in a surgeon's words, and the document of an osteotomy that they are (docs/cuts.md).
//
// A cut is a plane through a point. Its normal is up or forward, turned as a segment is turned: by pitch, and by roll where it is up, by yaw
// where it is forward.
import type { Documents, Triple } from "../../clients/typescript/src/facies.js";
import { inAxes, inWords, type FrameName } from "./frame.js";

export type Facing = "up" | "forward";
export interface Cut {
  name: string;
  facing: Facing;
  /** In the frame of the scan. */
  point_mm: Triple;
  /** In degrees: pitch, then roll or yaw. */
  angles: [number, number];
  kerf_mm: number;
}
/** What is cut loose, or where teeth touch. */
export type Operation = "lefort" | "rami" | "occlusal";
export interface Seeds {
  maxilla: Triple[];
  mandible: Triple[];
}

const DEGREE = Math.PI / 180;
/** Numbers of documents, in mm. */
const rounded = (value: number, digits = 2) => Number(value.toFixed(digits)) || 0;

/** Forward, up and left. */
type InWords = Triple;

/** Of unit length, in the frame of the scan. */
export function normalOf({ facing, angles: [pitch, second] }: Pick<Cut, "facing" | "angles">, frame: FrameName): Triple {
  const [p, s] = [pitch * DEGREE, second * DEGREE];
  const words: InWords = facing === "up" ? [-Math.sin(p), Math.cos(p) * Math.cos(s), -Math.cos(p) * Math.sin(s)]
    : [Math.cos(p) * Math.cos(s), Math.sin(p), Math.cos(p) * Math.sin(s)];
  return inAxes(words, frame);
}

/** The angles of a normal, which is turned round where it faces the other way. */
export function anglesOf(normal: Triple, facing: Facing, frame: FrameName): [number, number] {
  const length = Math.hypot(...normal);
  let [forward, up, left] = inWords(normal, frame).map((value) => value / length) as InWords;
  if ((facing === "up" ? up : forward) < 0) [forward, up, left] = [-forward, -up, -left];
  const [pitch, second] = facing === "up" ? [Math.asin(-forward), Math.atan2(-left, up)] : [Math.asin(up), Math.atan2(left, forward)];
  return [rounded(pitch / DEGREE, 1), rounded(second / DEGREE, 1)];
}

/** The plane through three points, facing up or forward; undefined where they lie on a line. */
export function throughPoints([a, b, c]: [Triple, Triple, Triple], facing: Facing, frame: FrameName): Pick<Cut, "point_mm" | "angles"> | undefined {
  const [u, v] = [b, c].map((point) => point.map((value, axis) => value - a[axis]!)) as [Triple, Triple];
  const normal: Triple = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  if (Math.hypot(...normal) < 1e-6 * Math.hypot(...u) * Math.hypot(...v) || Math.hypot(...normal) === 0) return undefined;
  const point_mm = a.map((value, axis) => rounded((value + b[axis]! + c[axis]!) / 3, 1)) as Triple;
  return { point_mm, angles: anglesOf(normal, facing, frame) };
}

interface Planned {
  cut: string;
  facing: Facing;
  /** Where it begins: shares of the box around the bone, from back to front, from below to above, from the right to the left. */
  at: InWords;
  angles: [number, number];
}

/** As in `examples/head_ct/plan.json`: a Le Fort I with its cut at the pterygoid plates, both rami with one above the molars. */
const PLANNED: Record<Operation, Planned[]> = {
  lefort: [
    { cut: "le-fort-1", facing: "up", at: [0.75, 0.5, 0.5], angles: [-13.3, 0] },
    { cut: "pterygomaxillary", facing: "forward", at: [0.6, 0.48, 0.5], angles: [0, 0] },
  ],
  rami: [
    { cut: "ramus-right", facing: "forward", at: [0.55, 0.25, 0.3], angles: [8, 17.5] },
    { cut: "ramus-left", facing: "forward", at: [0.55, 0.25, 0.7], angles: [8, -17.5] },
    { cut: "ramus-horizontal", facing: "up", at: [0.55, 0.36, 0.5], angles: [-13.5, 0] },
  ],
  occlusal: [{ cut: "occlusal", facing: "up", at: [0.75, 0.38, 0.5], angles: [0, 0] }],
};

/** The cuts of an operation where they begin, in the box around the bone. */
export function planned(operation: Operation, [low, high]: [Triple, Triple], frame: FrameName): Cut[] {
  const [one, other] = [low, high].map((corner) => inWords(corner, frame)) as [InWords, InWords];
  return PLANNED[operation].map(({ cut, facing, at, angles }) => {
    const words = at.map((share, axis) => {
      const [from, to] = [Math.min(one[axis]!, other[axis]!), Math.max(one[axis]!, other[axis]!)];
      return rounded(from + share * (to - from), 1);
    }) as InWords;
    return { name: cut, facing, point_mm: inAxes(words, frame), angles, kerf_mm: 0 };
  });
}

/** As a meshing takes it; undefined where nothing is cut loose. */
export function osteotomy(operations: ReadonlySet<Operation>, cuts: Cut[], seeds: Seeds, frame: FrameName): Documents["OsteotomyDocument"] | undefined {
  const has = (operation: Operation) => operations.has(operation);
  const seeded = (name: keyof Seeds) => (seeds[name].length === 0 ? {} : { seeds_mm: seeds[name] });
  const occlusal = has("occlusal") ? ["occlusal"] : [];
  const segments = [
    ...(has("lefort") ? [{ name: "maxilla", below: ["le-fort-1"], above: ["pterygomaxillary", ...occlusal], ...seeded("maxilla") }] : []),
    ...(has("rami") ? [{ name: "mandible", below: ["ramus-horizontal", ...occlusal], above: ["ramus-right", "ramus-left"], ...seeded("mandible") }] : []),
  ];
  if (segments.length === 0) return undefined;
  const used = new Set(segments.flatMap(({ below, above }) => [...below, ...above]));
  return {
    cuts: cuts.filter(({ name }) => used.has(name)).map((cut) => ({
      name: cut.name, point_mm: cut.point_mm, normal: normalOf(cut, frame).map((value) => rounded(value, 4)) as Triple,
      ...(cut.kerf_mm === 0 ? {} : { kerf_mm: cut.kerf_mm }),
    })),
    segments,
  };
}
