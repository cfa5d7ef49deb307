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

const PARTS = ";";
const NUMBERS = ",";
const numbersOf = (text: string[]): (number | null)[] => text.map((one) => (one === "" || !Number.isFinite(Number(one)) ? null : Number(one)));

/** Of a component of a target in mm, where nothing else is stated. */
export const USUAL_SIGMA_MM = 1;

/** Targets as they stand in addresses: a landmark by its name, a point by its place, then forward, up and left; nothing is free. Last its
 * standard deviation where that is another one than usual. */
export function writeTargets(targets: Target[]): string {
  const place = ({ landmark, at_mm }: Target) => (landmark === undefined ? at_mm.map((one) => `@${one.toFixed(3)}`).join("") : encodeURIComponent(landmark));
  const sigma = ({ sigma_mm }: Target) => (sigma_mm === USUAL_SIGMA_MM ? [] : [sigma_mm]);
  return targets.map((target) => [place(target), ...target.by.map((one) => one ?? ""), ...sigma(target)].join(NUMBERS)).join(PARTS);
}

/** Those of an address; what is no target, or names a landmark that the case has not, is left out. */
export function readTargets(text: string, landmarks: Record<string, Triple>, point: (number: number) => string): Target[] {
  let points = 0;
  return text.split(PARTS).flatMap((part): Target[] => {
    const [place = "", ...rest] = part.split(NUMBERS);
    if (rest.length !== 3 && rest.length !== 4) return [];
    const [forward, up, left, sigma] = numbersOf(rest);
    const by = [forward, up, left] as Target["by"];
    const sigma_mm = sigma !== undefined && sigma !== null && sigma > 0 ? sigma : USUAL_SIGMA_MM;
    if (place.startsWith("@")) {
      const at_mm = place.slice(1).split("@").map(Number);
      if (at_mm.length !== 3 || !at_mm.every(Number.isFinite)) return [];
      points += 1;
      return [{ label: point(points), at_mm: at_mm as Triple, by, sigma_mm }];
    }
    const landmark = decodeURIComponent(place);
    const at_mm = landmarks[landmark];
    return at_mm === undefined ? [] : [{ label: landmark, landmark, at_mm, by, sigma_mm }];
  });
}

const WORDS = [...TRANSLATIONS, ...ROTATIONS];
/** Bounds that are not those to begin with. */
export function writeBounds(bounds: Bounds, start: Bounds): string {
  const line = (name: string) => WORDS.map((word) => bounds[name]![word]).join(NUMBERS);
  const changed = Object.keys(bounds).filter((name) => WORDS.some((word) => bounds[name]![word] !== start[name]![word]));
  return changed.map((name) => `${encodeURIComponent(name)}${NUMBERS}${line(name)}`).join(PARTS);
}

/** The bounds to begin with, but for those of an address. */
export function readBounds(text: string, start: Bounds): Bounds {
  const read = structuredClone(start);
  for (const part of text.split(PARTS)) {
    const [name = "", ...rest] = part.split(NUMBERS);
    const bound = read[decodeURIComponent(name)];
    const values = numbersOf(rest);
    if (bound === undefined || values.length !== WORDS.length) continue;
    WORDS.forEach((word, at) => { bound[word] = Math.abs(values[at] ?? 0); });
  }
  return read;
}
