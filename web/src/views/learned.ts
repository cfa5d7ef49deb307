// What was learned from operated cases: errors of each method beside mechanics, tests, the curve, and what theta came to.
import type { Documents } from "../api.js";
import { boxOf, lineChart, rowChart } from "../charts.js";
import { card, make, table, type Cell } from "../dom.js";
import { figure, mm, probability } from "../figures.js";
import type { Words } from "../words/en.js";

type Learning = Documents["LearningDocument"];

/** What virtual patients' skin did, a line of the chart beside mechanics, as in the one of the service. */
const HAPPENED = "what happened";
/** Columns that stand in the table alone. */
const BESIDE = ["tuned on all", "of other classes"];

const percent = (share: number | null | undefined) => (share === null || share === undefined ? "–" : `${figure(100 * share, 1)} %`);

/** In a sentence: which model is kept and whether it helps. */
export function learnedInShort(words: Words, { method, mechanical, helps, table: columns }: Learning): HTMLElement {
  const of = (name: string) => columns.find((column) => column.name === name)?.mean;
  const [own, mechanics] = [of(method), of(mechanical)];
  const numbers = own === undefined || mechanics === undefined ? "" : ` ${words.learnedErrors(mm(own), mm(mechanics))}`;
  return make("p", { className: helps ? "told" : "warned" }, make("strong", {}, method), `: ${helps ? words.learningHelps : words.learningHarms}${numbers}`);
}

export function learnedFacts(words: Words, learning: Learning): HTMLElement[] {
  const { curve, table: columns, width, method, mechanical, thetas = [] } = learning;
  const shown = columns.filter(({ name }) => !BESIDE.some((beside) => name.includes(beside)));
  const rows = shown.map(({ name, cases }) => ({ name, box: boxOf(cases.map((one) => one.mean)), dots: cases.map((one) => ({ name: one.name, value: one.mean })) }));
  const levels = columns.filter(({ name }) => name === HAPPENED || name === mechanical).map(({ name, mean }) => ({ name, value: mean }));
  const series = curve.map((one) => ({ name: one.method, points: one.points.map(({ cases, error_mm }): [number, number] => [cases, error_mm]) }));
  const wide = width === undefined || width === null ? undefined : make("p", { className: "fine" }, `${method}, ${words.width}: ${words.widthEnds[width.end] ?? width.end}${width.width === undefined || width.width === null ? "" : ` ${figure(width.width, 3)}`}`);
  return [
    card(words.learningCurve, lineChart({ label: words.learningCurve, across: words.casesLearnedFrom, up: words.meanErrorMm, series, levels }), make("p", { className: "fine" }, words.curveHint)),
    card(words.errorsOfCases, rowChart(words.errorsOfCases, "mm", rows), make("p", { className: "fine" }, words.boxHint), errors(words, learning), ...(wide === undefined ? [] : [wide])),
    card(words.validation, validation(words, learning)),
    ...(thetas.length === 0 ? [] : [card(words.theta, thetaTable(words, thetas), make("p", { className: "fine" }, words.thetaHint))]),
  ];
}

function errors(words: Words, { table: columns, method }: Learning): HTMLElement {
  const regions = [...new Set(columns.flatMap((column) => Object.keys(column.regions)))];
  const rows = columns.map((column): Cell[] => [column.name === method ? make("strong", {}, column.name) : column.name, mm(column.mean), mm(column.p95),
    ...regions.map((region) => (column.regions[region] === undefined ? "–" : mm(column.regions[region]!)))]);
  return table(`${words.meanErrorMm}, ${words.nested}`, [words.method, words.mean, words.p95, ...regions], rows);
}

function validation(words: Words, { validation: list, tests }: Learning): HTMLElement {
  const rows = list.map((one): Cell[] => {
    const test = tests.find(({ second }) => second === one.method);
    return [one.method, test === undefined ? "–" : mm(test.median_difference_mm), test === undefined ? "–" : probability(test.p), test === undefined ? "–" : probability(test.smallest_p),
      named(one.harmed), named(one.refused), percent(one.coverage)];
  });
  return make("div", {}, table(words.againstMechanics, [words.method, words.medianGain, "p", words.smallestP, words.harmed, words.refusedCases, words.coverage], rows),
    make("p", { className: "fine" }, words.coverageHint));
}

/** How many, and which when the pointer is over it. */
const named = (cases: string[]) => make("span", { title: cases.join(", ") }, String(cases.length));

function thetaTable(words: Words, thetas: Documents["ThetaDocument"][]): HTMLElement {
  return table(words.theta, [words.surgeryClass, words.patients, words.theta, words.meanErrorMm, words.spreadMm, words.determined],
    thetas.map((one) => [one.class, one.patients, figure(one.theta, 3), mm(one.error_mm), mm(one.spread_mm), one.is_determined ? words.yes : words.no]));
}
