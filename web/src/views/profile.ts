// The lateral profile: outlines of the skin in the sagittal plane before and after, to scale.
import type { Triple } from "../api.js";
import { css } from "../colours.js";
import { svg } from "../dom.js";
import { inWords, type FrameName } from "../frame.js";
import { section } from "../outline.js";
import { INK, OUTLINE } from "../palette.js";
import type { Shape } from "../scene.js";
import type { Words } from "../words/en.js";

/** The middle of the head from left to right. */
function middle(points: Float32Array): number {
  let [low, high] = [Infinity, -Infinity];
  for (let at = 0; at < points.length; at += 3) {
    low = Math.min(low, points[at]!);
    high = Math.max(high, points[at]!);
  }
  return (low + high) / 2;
}

/** Seen from the patient's right: the face looks to the right. */
export function profile(words: Words, frame: FrameName, before: Shape, after: Shape): SVGElement {
  const at = middle(before.points_mm);
  const flat = (point: number[]) => {
    const [forward, up] = inWords(point as Triple, frame === "unspecified" ? "LPS" : frame);
    return [forward, -up] as const;
  };
  const pieces = [before, after].map((shape) => section(shape.points_mm, shape.triangles, [1, 0, 0], at + 1e-4)
    .map((piece) => [flat(piece.slice(0, 3)), flat(piece.slice(3))] as const));
  const all = pieces.flat(2);
  const [left, top] = [0, 1].map((axis) => all.reduce((least, point) => Math.min(least, point[axis]!), Infinity)) as [number, number];
  const [right, bottom] = [0, 1].map((axis) => all.reduce((most, point) => Math.max(most, point[axis]!), -Infinity)) as [number, number];
  const drawing = svg("svg", {
    viewBox: `${left - 5} ${top - 5} ${right - left + 10} ${bottom - top + 18}`, role: "img", "aria-label": words.profileHint, class: "drawing profile",
  });
  const path = (lines: (typeof pieces)[number]) => lines.map(([a, b]) => `M${a[0].toFixed(2)} ${a[1].toFixed(2)}L${b[0].toFixed(2)} ${b[1].toFixed(2)}`).join("");
  // Pieces are short: dashes would begin anew in each, so that what was before is thin and light instead.
  drawing.append(
    svg("path", { d: path(pieces[0] ?? []), fill: "none", stroke: css(OUTLINE), "stroke-width": "0.7" }),
    svg("path", { d: path(pieces[1] ?? []), fill: "none", stroke: INK, "stroke-width": "1.1" }),
    svg("path", { d: `M${left} ${bottom + 6}h20m0 -1.500v3m-20 0v-3`, fill: "none", stroke: INK, "stroke-width": "0.6" }));
  const scale = svg("text", { x: String(left + 22), y: String(bottom + 8), "font-size": "6", fill: INK }, "20 mm");
  drawing.append(scale);
  return drawing;
}
