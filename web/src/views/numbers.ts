// The numbers of a result: parts of the skin and landmarks with what is estimated of their errors, measures of the head, provenance.
import type { Documents, Triple, Warning } from "../api.js";
import { button, make, table, type Cell } from "../dom.js";
import { count, figure, fixed, mm, signed } from "../figures.js";
import { inWords, type FrameName } from "../frame.js";
import type { Words } from "../words/en.js";
import { names } from "./places.js";

type Results = Documents["ResultDocument"];
/** What a table needs beside the numbers: how a row is shown in the view, and what is warned of. */
export interface Shown {
  words: Words;
  warnings: Warning[];
  show: (name: string) => (() => void) | undefined;
}

/** The name of a row, which shows it in the view, with a sign where a warning names it. */
function rowName({ words, warnings, show }: Shown, name: string): Cell {
  const shown = show(name);
  const about = warnings.filter(({ detail }) => names(detail, name)).map(({ detail }) => detail);
  if (shown === undefined && about.length === 0) return name;
  const sign = about.length > 0 && make("span", { className: "sign", role: "img", title: about.join(" "), aria: { label: `${words.warnings}: ${about.join(" ")}` } }, " ⚠");
  return make("span", {}, shown === undefined ? name : button(name, shown, { className: "link", title: words.showPlace(name) }), sign);
}

const mean = (values?: { mean: number } | null) => (values === undefined || values === null ? "–" : mm(values.mean));

export function regions(shown: Shown, { statistics, numerical_error_mm: errors, nonlinearity_mm: nonlinear }: Results): HTMLElement {
  const { words } = shown;
  const row = (name: Cell, region: Documents["DisplacementDocument"] | undefined, error?: { mean: number } | null, model?: { mean: number } | null) =>
    [name, ...(region === undefined ? ["–", "–", "–"] : [region.area.mean, region.area.p95, region.area.max].map(mm)), mean(error), mean(model)];
  const rows = Object.entries(statistics?.regions ?? {}).map(([name, region]) =>
    row(rowName(shown, name), region, errors?.regions?.[name], nonlinear?.regions?.[name]));
  return table(`${words.displacement}, mm`, [words.region, words.mean, words.p95, words.max, words.error, words.nonlinear],
    [row(words.whole, statistics?.skin, errors, nonlinear?.skin), ...rows]);
}

export function landmarks(shown: Shown, { statistics, numerical_error_mm: errors }: Results, frame: FrameName): HTMLElement {
  const { words } = shown;
  const rows = Object.entries(statistics?.landmarks ?? {}).map(([name, moved]) => {
    const error = errors?.landmarks?.[name];
    return [rowName(shown, name), ...inWords(moved as Triple, frame).map((value) => signed(value)), error === undefined ? "–" : mm(error)];
  });
  const heads = frame === "unspecified" ? [words.axes.forward, words.axes.up, words.axes.left] : [words.forward, words.up, words.left];
  return table(`${words.displacement}, mm`, [words.landmark, ...heads, words.error], rows);
}

/** Measures of the head before, as planned of bone, and as predicted of skin. */
export function cephalometry(words: Words, measures: Documents["MeasureDocument"][]): HTMLElement {
  const number = (value: number | null | undefined) => (value === undefined || value === null ? "–" : fixed(value, 1));
  const unit = (name: string) => ({ deg: "°", mm: "mm" })[name] ?? "";
  // A reproduction has what was performed, a prediction what is predicted.
  const columns = ([["planned", words.planned], ["performed", words.performed], ["predicted", words.predicted]] as const)
    .filter(([member]) => member !== "performed" || measures.some((one) => typeof one.performed === "number"));
  const hasNorms = measures.some(({ norm }) => (norm ?? undefined) !== undefined);
  const norm = (of: Documents["MeasureDocument"]["norm"]) => (of === undefined || of === null ? "–" : make("span", { title: of.source }, `${fixed(of.mean, 1)} ± ${fixed(of.sd, 1)}`));
  return table(words.cephalometry, [words.measure, words.before, ...columns.map(([, label]) => label), ...(hasNorms ? [words.norm] : [])], measures.map((one) =>
    [make("span", { title: one.source }, `${one.name.replaceAll("_", " ")}${unit(one.unit) === "" ? "" : `, ${unit(one.unit)}`}`), number(one.before), ...columns.map(([member]) => number(one[member])), ...(hasNorms ? [norm(one.norm)] : [])]));
}

/** How tissue at finite strain came to rest, where it had to be led there. */
function restFacts(words: Words, newton: Documents["NewtonDocument"] | null | undefined): [string, string][] {
  if (newton === undefined || newton === null) return [];
  const parts = (newton.parts ?? []).map(({ share, steps }) => words.partOf(figure(100 * share, 1), steps)).join(", ");
  const keeping = newton.cells_with_bulk ?? 0;
  return [[words.inParts, parts], [words.keepBulk, keeping === 0 ? "" : words.cellsWithBulk(count(keeping), figure(newton.bulk_in_cells, 1))],
    [words.isAtRest, newton.is_stable === undefined || newton.is_stable === null ? words.notKnown : newton.is_stable ? words.yes : words.no]];
}

export function provenance(words: Words, stated: Documents["ProvenanceDocument"] | undefined): HTMLElement {
  const facts: [string, string][] = stated === undefined ? [] : [
    [words.solvedBy, stated.method ?? ""], ["", stated.why ?? ""], ...restFacts(words, stated.solver?.newton),
    [words.took, `${stated.timing?.total_s === undefined ? "–" : fixed(stated.timing.total_s, 1)} ${words.seconds}`],
    [words.nodes, String(stated.mesh?.nodes ?? "")], ["facies", stated.engine.version], [words.hash, stated.spec_hash.slice(0, 16)],
    ["", stated.statement ?? words.notice],
  ];
  return make("dl", { className: "facts" }, ...facts.filter(([, value]) => value !== "").flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
}
