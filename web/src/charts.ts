// Charts of results as SVG: lines by a number, and rows of boxes, dots and bars over one scale. Every mark says its numbers.
import { svg } from "./dom.js";
import { figure } from "./figures.js";
import { FAINT_INK, GRID, INK, SERIES } from "./palette.js";

/** Beside colours and names. */
const DASHES = ["none", "6 3", "2 3", "8 3 2 3", "4 2"];

/** Round numbers between two ends, at most so many steps. */
export function steps(low: number, high: number, most = 6): number[] {
  const wide = Math.max(high - low, 1e-9) / most;
  const power = 10 ** Math.floor(Math.log10(wide));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= wide * (1 - 1e-9))!;
  const first = Math.floor(low / step + 1e-9);
  const last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, at) => Number(((first + at) * step).toPrecision(12)));
}

/** Places from above to below that are at least so far apart, in the order that they had. */
function spread(places: number[], least: number): number[] {
  const order = places.map((_, at) => at).sort((a, b) => places[a]! - places[b]!);
  const moved = [...places];
  order.forEach((at, rank) => { if (rank > 0) moved[at] = Math.max(moved[at]!, moved[order[rank - 1]!]! + least); });
  return moved;
}

const said = (text: string) => svg("title", {}, text);
const number = (x: number, y: number, text: string, anchor: string) =>
  svg("text", { x, y, "font-size": 10, "text-anchor": anchor, fill: INK }, text);

export interface Series {
  name: string;
  points: [number, number][];
}
export interface Level {
  name: string;
  value: number;
}
interface LineChart {
  label: string;
  across: string;
  up: string;
  series: Series[];
  /** Values that do not depend on what is across. */
  levels: Level[];
}

/** In a narrow place letters would be too small. */
export const isNarrow = (): boolean => matchMedia("(max-width: 760px)").matches;
const TALL = 270;
const BOX = { left: 40, top: 20, bottom: 34 };

/** Lines over a number, from 0 up, each with its name at its end. */
export function lineChart({ label, across, up, series, levels }: LineChart, narrow = isNarrow()): SVGElement {
  const [wide, right] = narrow ? [340, 116] : [520, 164];
  const points = series.flatMap((one) => one.points);
  const rows = steps(0, Math.max(...points.map(([, y]) => y), ...levels.map(({ value }) => value), 1e-3));
  const [first, last] = [Math.min(...points.map(([x]) => x)), Math.max(...points.map(([x]) => x))];
  const x = (value: number) => BOX.left + ((wide - BOX.left - right) * (value - first)) / Math.max(last - first, 1e-9);
  const y = (value: number) => TALL - BOX.bottom - ((TALL - BOX.top - BOX.bottom) * value) / rows.at(-1)!;
  const end = wide - right;
  const grid = rows.flatMap((value) => [svg("path", { d: `M${BOX.left} ${y(value)}H${end}`, stroke: GRID }), number(BOX.left - 5, y(value) + 3.5, figure(value, 3), "end")]);
  const columns = [...new Set(series.flatMap((one) => one.points.map(([value]) => value)))].sort((a, b) => a - b);
  let free = -Infinity;
  const ticks = columns.filter((value) => { const is = x(value) - free >= 18; if (is) free = x(value); return is; })
    .map((value) => number(x(value), TALL - BOX.bottom + 14, figure(value), "middle"));
  const lines = series.map(({ name, points: own }, at) => svg("g", {}, said(`${name}: ${own.map(([a, b]) => `${figure(a)}: ${figure(b, 3)}`).join(", ")}`),
    svg("path", { d: `M${own.map(([a, b]) => `${x(a).toFixed(1)} ${y(b).toFixed(1)}`).join("L")}`, fill: "none", stroke: colour(at), "stroke-width": 2, "stroke-dasharray": DASHES[at % DASHES.length]! }),
    ...own.map(([a, b]) => svg("circle", { cx: x(a).toFixed(1), cy: y(b).toFixed(1), r: 2.6, fill: colour(at) }))));
  const flat = levels.map(({ name, value }) => svg("path", { d: `M${BOX.left} ${y(value)}H${end}`, stroke: FAINT_INK, "stroke-dasharray": "1 3", "stroke-width": 1.5 }, said(`${name}: ${figure(value, 3)}`)));
  const names = [...series.map(({ name, points: own }, at) => ({ name, at: y(own.at(-1)?.[1] ?? 0), stroke: colour(at), dashes: DASHES[at % DASHES.length]! })),
    ...levels.map(({ name, value }) => ({ name, at: y(value), stroke: FAINT_INK, dashes: "1 3" }))];
  const places = spread(names.map(({ at }) => at), 12);
  // Letters are dark, as light colours are not read; a stretch of the line says whose they are.
  const labels = names.flatMap(({ name, stroke, dashes }, at) => [
    svg("path", { d: `M${end + 6} ${places[at]!}h14`, stroke, "stroke-width": 2, "stroke-dasharray": dashes }),
    svg("text", { x: end + 24, y: places[at]! + 3.5, "font-size": 11, fill: INK }, name)]);
  return svg("svg", { viewBox: `0 0 ${wide} ${Math.max(TALL, ...places.map((place) => place + 10))}`, role: "img", "aria-label": label, class: "drawing" },
    ...grid, ...ticks, ...flat, ...lines, ...labels, number(end, TALL - 5, across, "end"), number(4, 11, up, "start"));
}

const colour = (at: number) => SERIES[at % SERIES.length]!;

/** What stands in a row: each as far as it is there. */
export interface Row {
  name: string;
  /** Smallest, quartiles, largest. */
  box?: [number, number, number, number, number];
  dots?: { name: string; value: number }[];
  /** A bar from 0. */
  value?: number;
  /** To either side of the value. */
  error?: number;
}

const ROW = 24;

/** Where rows have their names and their scale. */
interface Across {
  names: number;
  letters: number;
  x: (value: number) => number;
}

/** Rows over one scale that has 0 in it. */
export function rowChart(label: string, unit: string, rows: Row[], narrow = isNarrow()): SVGElement {
  const [wide, names, letters] = narrow ? [340, 124, 18] : [520, 160, 24];
  const all = rows.flatMap(({ box = [], dots = [], value = 0, error = 0 }) => [...box, ...dots.map((dot) => dot.value), value - error, value + error]);
  const scale = steps(Math.min(0, ...all), Math.max(0, ...all, 1e-6), narrow ? 4 : 6);
  const [low, high] = [scale[0]!, scale.at(-1)!];
  const x = (value: number) => names + ((wide - names - 14) * (value - low)) / (high - low);
  const bottom = 6 + ROW * rows.length;
  const grid = scale.flatMap((value) => [svg("path", { d: `M${x(value)} 4V${bottom}`, stroke: value === 0 ? FAINT_INK : GRID }), number(x(value), bottom + 13, figure(value, 3), "middle")]);
  return svg("svg", { viewBox: `0 0 ${wide} ${bottom + 20}`, role: "img", "aria-label": label, class: "drawing" },
    ...grid, number(names - 8, bottom + 13, unit, "end"), ...rows.map((row, at) => drawRow(row, 6 + ROW * (at + 0.5), { names, letters, x })));
}

function drawRow({ name, box, dots = [], value, error }: Row, y: number, { names, letters, x }: Across): SVGElement {
  const parts: SVGElement[] = [svg("text", { x: names - 8, y: y + 3.5, "font-size": 11, "text-anchor": "end", fill: INK }, shortened(name, letters), said(name))];
  if (value !== undefined) {
    const [from, to] = [Math.min(x(0), x(value)), Math.max(x(0), x(value))];
    parts.push(svg("rect", { x: from, y: y - 6, width: Math.max(to - from, 1), height: 12, fill: SERIES[0]! }, said(`${name}: ${figure(value)}${error === undefined ? "" : ` ± ${figure(error)}`}`)));
  }
  if (value !== undefined && error !== undefined) {
    parts.push(svg("path", { d: `M${x(value - error)} ${y}H${x(value + error)}M${x(value - error)} ${y - 4}v8M${x(value + error)} ${y - 4}v8`, stroke: SERIES[1]!, "stroke-width": 2, fill: "none" }));
  }
  if (box !== undefined) {
    const [least, lower, median, upper, most] = box;
    parts.push(svg("path", { d: `M${x(least)} ${y}H${x(lower)}M${x(upper)} ${y}H${x(most)}`, stroke: SERIES[0]! }),
      svg("rect", { x: x(lower), y: y - 7, width: Math.max(x(upper) - x(lower), 1), height: 14, fill: SERIES[0]!, "fill-opacity": 0.2, stroke: SERIES[0]! }, said(`${name}: ${box.map((one) => figure(one)).join(", ")}`)),
      svg("path", { d: `M${x(median)} ${y - 7}v14`, stroke: SERIES[0]!, "stroke-width": 2.5 }));
  }
  parts.push(...dots.map((dot) => svg("circle", { cx: x(dot.value).toFixed(1), cy: y, r: 2.8, fill: SERIES[1]!, "fill-opacity": 0.65 }, said(`${name}, ${dot.name}: ${figure(dot.value)}`))));
  return svg("g", {}, ...parts);
}

const shortened = (name: string, letters: number) => (name.length > letters ? `${name.slice(0, letters - 1)}…` : name);

/** Smallest, quartiles and largest of some numbers: the smallest whose share reaches a quarter, half, three quarters. */
export function boxOf(values: number[]): [number, number, number, number, number] {
  const sorted = [...values].sort((a, b) => a - b);
  const at = (share: number) => sorted[Math.max(Math.ceil(share * sorted.length) - 1, 0)] ?? 0;
  return [at(0), at(0.25), at(0.5), at(0.75), at(1)];
}
