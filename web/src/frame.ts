// Anatomical directions in the frame of a case, and movements in a surgeon's words.
//
// LPS: x to the patient's left, y to the back, z up. RAS: x to the right, y to the front, z up. A plan turns about fixed axes,
// R = Rz Ry Rx. Pitch lifts the front, roll lifts the left side, yaw turns the front to the left. Where the frame of a case is not
// specified the six numbers are those of its axes.
import type { Documents, Triple } from "../../clients/typescript/src/facies.js";

export type FrameName = Documents["FrameName"];
/** Translations in mm, rotations in degrees. */
export interface Motion {
  forward: number;
  up: number;
  left: number;
  pitch: number;
  roll: number;
  yaw: number;
}

export const TRANSLATIONS = ["forward", "up", "left"] as const;
export const ROTATIONS = ["pitch", "roll", "yaw"] as const;
export const MOTIONS = [...TRANSLATIONS, ...ROTATIONS] as const;
export type MotionName = (typeof MOTIONS)[number];

/** Which axis of the case each word follows, and which way. */
interface Axis {
  axis: 0 | 1 | 2;
  sign: 1 | -1;
}
type Axes = Record<MotionName, Axis>;

const axes = (left: 1 | -1, forward: 1 | -1, turn: 1 | -1): Axes => ({
  left: { axis: 0, sign: left },
  forward: { axis: 1, sign: forward },
  up: { axis: 2, sign: 1 },
  pitch: { axis: 0, sign: turn },
  roll: { axis: 1, sign: turn },
  yaw: { axis: 2, sign: 1 },
});
const AXES: Record<FrameName, Axes> = {
  LPS: axes(1, -1, -1),
  RAS: axes(-1, 1, 1),
  unspecified: axes(1, 1, 1),
};

export const still = (): Motion => ({ forward: 0, up: 0, left: 0, pitch: 0, roll: 0, yaw: 0 });
export const isStill = (motion: Motion): boolean => MOTIONS.every((name) => motion[name] === 0);

/** The three angles of a rotation R = Rz Ry Rx in degrees, that about y in [-90, 90]; of a row-major 4x4 matrix. */
export function angles(matrix: ArrayLike<number>): Triple {
  const degrees = 180 / Math.PI;
  const [a, b, c, d, e] = [0, 4, 8, 9, 10].map((at) => matrix[at]!) as [number, number, number, number, number];
  return [Math.atan2(d, e) * degrees, Math.asin(Math.min(Math.max(-c, -1), 1)) * degrees, Math.atan2(b, a) * degrees];
}

/** As a plan says it, in the frame of the case. */
export function movement(motion: Motion, frame: FrameName): { translation_mm: Triple; rotation_deg: Triple } {
  const translation_mm: Triple = [0, 0, 0];
  const rotation_deg: Triple = [0, 0, 0];
  // No negative zeros: they would stand in plans.
  for (const name of TRANSLATIONS) translation_mm[AXES[frame][name].axis] = AXES[frame][name].sign * motion[name] || 0;
  for (const name of ROTATIONS) rotation_deg[AXES[frame][name].axis] = AXES[frame][name].sign * motion[name] || 0;
  return { translation_mm, rotation_deg };
}

/** The words of a plan's numbers: the inverse of `movement`. */
export function motion(translation_mm: Triple, rotation_deg: Triple, frame: FrameName): Motion {
  const found = still();
  for (const name of TRANSLATIONS) found[name] = AXES[frame][name].sign * translation_mm[AXES[frame][name].axis] || 0;
  for (const name of ROTATIONS) found[name] = AXES[frame][name].sign * rotation_deg[AXES[frame][name].axis] || 0;
  return found;
}

/** The word that a parameter of inverse planning, such as `translation_mm.y`, follows, and which way. */
export function wordOf(parameter: string, frame: FrameName): { word: MotionName; sign: 1 | -1 } {
  const axis = "xyz".indexOf(parameter.at(-1)!);
  const word = (parameter.startsWith("rotation") ? ROTATIONS : TRANSLATIONS).find((one) => AXES[frame][one].axis === axis)!;
  return { word, sign: AXES[frame][word].sign };
}

/** A vector of the case as forward, up and left. */
export function inWords(vector: Triple, frame: FrameName): Triple {
  return TRANSLATIONS.map((name) => AXES[frame][name].sign * vector[AXES[frame][name].axis] || 0) as Triple;
}

/** A vector that says forward, up and left in the axes of the case; null stays null. */
export function inAxes<T extends number | null>(words: [T, T, T], frame: FrameName): [T, T, T] {
  const found = [...words] as [T, T, T];
  TRANSLATIONS.forEach((name, at) => {
    const { axis, sign } = AXES[frame][name];
    const value = words[at]!;
    found[axis] = (value === null ? null : sign * value || 0) as T;
  });
  return found;
}

/** Rows of the rotation that turns the case so that x is the patient's left, y up and z to the front, as it is drawn. */
export function drawn(frame: FrameName): [Triple, Triple, Triple] {
  return frame === "RAS" ? [[-1, 0, 0], [0, 0, 1], [0, 1, 0]] : [[1, 0, 0], [0, 0, 1], [0, -1, 0]];
}

/** Rows of Rz Ry Rx. */
export function rotation(degrees: Triple): [Triple, Triple, Triple] {
  const [a, b, c] = degrees.map((angle) => (angle * Math.PI) / 180) as Triple;
  const [sa, ca, sb, cb, sc, cc] = [Math.sin(a), Math.cos(a), Math.sin(b), Math.cos(b), Math.sin(c), Math.cos(c)];
  return [
    [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
    [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
    [-sb, cb * sa, cb * ca],
  ];
}
