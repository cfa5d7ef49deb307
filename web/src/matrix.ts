// Movements of bone as matrices.
import type { Triple } from "./api.js";
import { movement, rotation, type FrameName, type Motion } from "./frame.js";

/** Row by row: x' = R (x - pivot) + pivot + translation. */
export function matrix(motion: Motion, pivot_mm: Triple, frame: FrameName): number[] {
  const { translation_mm, rotation_deg } = movement(motion, frame);
  const rows = rotation(rotation_deg).flatMap((row, i) => {
    const turned = row.reduce((sum, value, j) => sum + value * pivot_mm[j]!, 0);
    return [...row, pivot_mm[i]! + translation_mm[i]! - turned];
  });
  return [...rows, 0, 0, 0, 1];
}
