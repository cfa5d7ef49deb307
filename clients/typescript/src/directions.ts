// Movements in a surgeon's words: which way a segment goes along the axes of a frame, or turns about them. Left and right are
// the patient's.
import type { components } from "./rest.js";

export interface Direction {
  member: "translation_mm" | "rotation_deg";
  axis: 0 | 1 | 2;
  /** What a number on the slider is multiplied with in the plan. */
  sign: 1 | -1;
  /** What a negative and a positive number on the slider mean. */
  words: readonly [string, string];
}

/** LPS counts towards left, back and up. */
const LPS: readonly Direction[] = [
  { member: "translation_mm", axis: 1, sign: -1, words: ["back", "forward"] },
  { member: "translation_mm", axis: 2, sign: 1, words: ["down", "up"] },
  { member: "translation_mm", axis: 0, sign: 1, words: ["to the right", "to the left"] },
  { member: "rotation_deg", axis: 0, sign: -1, words: ["front down", "front up"] },
  { member: "rotation_deg", axis: 1, sign: 1, words: ["right side down", "left side down"] },
  { member: "rotation_deg", axis: 2, sign: 1, words: ["front to the right", "front to the left"] },
];

/** The six directions of a frame. RAS is LPS turned by 180 degrees about z; of an unspecified frame nobody can tell more
 * than the axes. */
export function directions(frame: components["schemas"]["FrameName"]): Direction[] {
  return LPS.map((direction) => {
    const { member, axis } = direction;
    if (frame === "unspecified") {
      const way = member === "translation_mm" ? "along" : "about";
      return { member, axis, sign: 1, words: [`${way} -${"xyz"[axis]}`, `${way} +${"xyz"[axis]}`] };
    }
    return frame === "RAS" && axis !== 2 ? { ...direction, sign: direction.sign === 1 ? -1 : 1 } : direction;
  });
}

/** What a number on the slider means, as `4 mm forward`. */
export function meaning({ member, words }: Direction, value: number): string {
  const amount = `${Math.abs(value)}${member === "translation_mm" ? " mm" : "°"}`;
  return value === 0 ? amount : `${amount} ${value < 0 ? words[0] : words[1]}`;
}
