// Methods against each other over the same subjects: boxes, statistics, and tests of every two.
import type { Documents } from "../api.js";
import { boxOf, rowChart, type Row } from "../charts.js";
import { card, make, table } from "../dom.js";
import { mm, probability } from "../figures.js";
import type { Words } from "../words/en.js";

type Cohort = Documents["CohortResultDocument"];

export function groupFacts(words: Words, { groups, pairs, statistic, distance }: Cohort): HTMLElement[] {
  const called = `${statistic}, ${distance.replaceAll("_", " ")}, mm`;
  const row = ({ name, rows }: Documents["CohortGroupDocument"]): Row => {
    const dots = rows.map(({ subject, distances }) => ({ name: subject, value: distances[statistic] }));
    return { name, dots, box: boxOf(dots.map(({ value }) => value)) };
  };
  const over = groups.map(({ name, over_subjects: one, rows }) => [name, rows.length, mm(one.mean), mm(one.sd), mm(one.median), mm(one.p95), mm(one.max)]);
  const subjects = (groups[0]?.rows ?? []).map(({ subject }, at) => [subject, ...groups.map(({ rows }) => (rows[at] === undefined ? "–" : mm(rows[at]!.distances[statistic])))]);
  const tests = pairs.map((one) => [`${one.first} – ${one.second}`, mm(one.median_difference_mm), probability(one.p), probability(one.smallest_p), one.differing, one.is_exact ? words.yes : words.no]);
  return [
    card(words.methods, rowChart(called, "mm", groups.map(row)), make("p", { className: "fine" }, words.boxHint), table(called, [words.method, words.subjects, words.mean, words.sd, words.median, words.p95, words.max], over)),
    card(words.everyTwo, table("Wilcoxon", [words.method, words.medianDifference, "p", words.smallestP, words.differing, words.exact], tests), make("p", { className: "fine" }, words.smallestHint)),
    card(words.subjects, table(called, [words.subjects, ...groups.map(({ name }) => name)], subjects)),
  ];
}
