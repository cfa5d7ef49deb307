// How far a predicted skin is from a real one.
import type { Documents } from "../api.js";
import type { App } from "../app.js";
import { make, svg, table } from "../dom.js";
import { fixed, mm } from "../figures.js";
import { INK, SERIES } from "../palette.js";
import type { Words } from "../words/en.js";

const percent = (share: number) => `${fixed(100 * share, 1)} %`;

export function comparisonFacts({ words }: App, comparison: Documents["ComparisonDocument"]): HTMLElement {
  const row = (name: string, one: Documents["DistanceDocument"]) => [name, mm(one.mean), mm(one.p95), mm(one.max),
    ...[one.share_below_1_mm, one.share_below_2_mm, one.share_below_3_mm].map((share) => fixed(100 * share, 1))];
  const regions = Object.entries(comparison.regions ?? {}).map(([name, region]) => row(name, region.both));
  const { method, rotation_deg, displacement_mm, rms_mm } = comparison.alignment;
  const registered = method === "none" ? words.alignNone
    : `${method}, ${words.turned} ${mm(rotation_deg)}°, ${words.shifted} ${mm(Math.hypot(...displacement_mm))} mm`
      + (rms_mm === undefined || rms_mm === null ? "" : `, ${words.residual} ${mm(rms_mm)} mm`);
  return make("div", {},
    table(`${words.histogram}, mm`, ["", words.mean, words.p95, words.max, "% < 1 mm", "% < 2 mm", "% < 3 mm"],
      [row(words.whole, comparison.both), ...regions]),
    make("p", {}, `${words.registration}: ${registered}`));
}

const REACH_MM = 3;
const BARS = 24;

/** Of the area, by bars. */
function sharesOf(distances: ArrayLike<number>, areas: ArrayLike<number>): number[] {
  const shares = new Array<number>(BARS).fill(0);
  let total = 0;
  for (let node = 0; node < distances.length; node += 1) {
    const within = Math.min(Math.max(distances[node]!, -REACH_MM), REACH_MM * 0.9999);
    shares[Math.floor(((within + REACH_MM) / (2 * REACH_MM)) * BARS)]! += areas[node]!;
    total += areas[node]!;
  }
  return shares.map((share) => share / Math.max(total, 1e-12));
}

/** Which share of the skin lies how far inside or outside, from -3 to 3 mm; what is beyond stands in the last bars. A node counts by the
 * area around it: a mesh is finer in some places than in others. */
export function histogram(words: Words, distances: ArrayLike<number>, areas: ArrayLike<number>): SVGElement {
  const shares = sharesOf(distances, areas);
  const most = Math.max(...shares);
  const drawing = svg("svg", { viewBox: "0 0 240 96", role: "img", "aria-label": words.histogram, class: "drawing" });
  shares.forEach((share, at) => {
    const height = (70 * share) / most;
    const bar = svg("rect", { x: String(at * 10 + 1), y: String(76 - height), width: "8", height: String(height), fill: SERIES[0]! });
    const from = -REACH_MM + (2 * REACH_MM * at) / BARS;
    bar.append(svg("title", {}, `${mm(from)} … ${mm(from + (2 * REACH_MM) / BARS)} mm: ${percent(share)}`));
    drawing.append(bar);
  });
  for (const value of [-3, -2, -1, 0, 1, 2, 3]) {
    const text = svg("text", { x: String(value === 3 ? 238 : 120 + value * 38), y: "90", "font-size": "9", "text-anchor": value === 3 ? "end" : "middle", fill: INK }, value === 3 ? "3 mm" : String(value));
    drawing.append(text);
  }
  return drawing;
}
