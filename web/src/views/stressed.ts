// Stress in the tissue by region, as a result has it.
import type { Documents } from "../api.js";
import { rowChart, type Row } from "../charts.js";
import { make, table } from "../dom.js";
import { figure } from "../figures.js";
import type { Words } from "../words/en.js";

export function stressFacts(words: Words, { regions, strain }: Documents["StressDocument"]): HTMLElement {
  const all = Object.entries(regions);
  const kpa = (value: number | null | undefined) => (value === null || value === undefined ? "–" : figure(value, 2));
  // Beside bone that is moved the largest value says how fine the mesh is: a box ends at the 95th percentile.
  const rows = all.map(([name, { von_mises_kpa: one }]): Row => ({ name, box: [one.min ?? one.median, one.p25 ?? one.median, one.median, one.p75 ?? one.p90, one.p95] }));
  return make("div", {}, rowChart(`${words.vonMises}, kPa`, "kPa", rows, true), make("p", { className: "fine" }, words.stressBoxHint),
    table(`${words.vonMises}, kPa`, [words.region, words.mean, words.median, words.p95, words.max], all.map(([name, { von_mises_kpa: one }]) => [name, ...[one.mean, one.median, one.p95, one.max].map(kpa)])),
    table(`${words.pressure}, kPa`, [words.region, words.mean, "min", words.median, words.p95, words.max], all.map(([name, { pressure_kpa: one }]) => [name, ...[one.mean, one.min, one.median, one.p95, one.max].map(kpa)])),
    make("p", { className: "fine" }, words.stressHint(strain)));
}
