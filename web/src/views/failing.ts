// The rows that keep a study from passing, each with what it has and what it may have.
import type { Documents } from "../api.js";
import { make, table } from "../dom.js";
import { figure } from "../figures.js";
import type { Words } from "../words/en.js";
import { called } from "./anything.js";

const MOST_ROWS = 100;

/** The cells of a failing row; a row without numbers has its reason alone. */
export function failingCells(words: Words, row: Documents["FailingRowDocument"]): string[] {
  const number = (value: number | null | undefined) => (value === null || value === undefined ? "–" : figure(value, 3));
  const exceeded = row.measure === null || row.measure === undefined ? row.reason : called(row.measure);
  return [row.label, row.scene, row.plan, row.material, String(row.level), exceeded, number(row.value), number(row.limit)];
}

/** Nothing where every row passes, and in reports of earlier programs. */
export function failingRows(words: Words, { failing = [] }: Documents["VerdictDocument"]): HTMLElement | undefined {
  if (failing.length === 0) return undefined;
  const head = [words.variant, words.scene, words.plan, words.material, words.level, words.measure, words.valueHad, words.mostAllowed];
  return make("div", {}, table(words.failingRows, head, failing.slice(0, MOST_ROWS).map((row) => failingCells(words, row))),
    failing.length > MOST_ROWS && make("p", { className: "fine" }, words.furtherRows(failing.length - MOST_ROWS)));
}
