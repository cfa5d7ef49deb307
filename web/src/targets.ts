// Targets of inverse planning, and what the bounds of segments forbid of them.
import type { Triple } from "../../clients/typescript/src/facies.js";
import { ROTATIONS, TRANSLATIONS, type MotionName } from "./frame.js";

/** Where a point is wanted: forward, up and left of where it is, in mm; null is free. */
export interface Target {
  label: string;
  /** Of the case; without one it is the point of the skin at `at_mm`. */
  landmark?: string;
  at_mm: Triple;
  by: [number | null, number | null, number | null];
  sigma_mm: number;
}
/** How far a segment may go to either side along or about each word; 0 holds it. */
export type Bounds = Record<string, Record<MotionName, number>>;

/** A target that is to go further one way than any segment may; `at` is the place of the word. */
interface Beyond {
  target: Target;
  at: number;
  wanted: number;
  allowed: number;
}

/** Which targets the bounds forbid. Where a segment may turn, it may take a point further than its own movement: nothing is said then. */
export function beyondBounds(targets: Target[], bounds: Bounds): Beyond[] {
  const all = Object.values(bounds);
  if (all.some((bound) => ROTATIONS.some((word) => bound[word] > 0))) return [];
  return targets.flatMap((target) => TRANSLATIONS.flatMap((word, at) => {
    const wanted = target.by[at] ?? 0;
    const allowed = Math.max(0, ...all.map((bound) => bound[word]));
    return Math.abs(wanted) > allowed ? [{ target, at, wanted, allowed }] : [];
  }));
}
