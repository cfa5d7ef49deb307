// Results of kinds that have no view of their own, as lists and tables of their numbers by the names that the service gives them.
import { make, table, type Cell } from "../dom.js";
import { figure } from "../figures.js";
import type { Words } from "../words/en.js";

type Value = unknown;
type Members = Record<string, Value>;

const MOST_ROWS = 40;
const MOST_COLUMNS = 8;
const MOST_DEPTH = 3;
const UNITS = ["mm", "deg", "kpa", "mn", "s", "mb", "ml"];

/** A member as people read it: `largest_error_mm` is "largest error, mm". */
export function called(member: string): string {
  const words = member.split("_");
  const unit = words.length > 1 && UNITS.includes(words.at(-1)!) ? words.pop()! : undefined;
  return words.join(" ") + (unit === undefined ? "" : `, ${unit}`);
}

const isScalar = (value: Value): value is string | number | boolean => ["string", "number", "boolean"].includes(typeof value);
const isMembers = (value: Value): value is Members => typeof value === "object" && value !== null && !Array.isArray(value);

/** A short value as people read it. */
export function shown(value: Value): string {
  if (typeof value === "number") return Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(2) : figure(value, 3);
  if (Array.isArray(value) && value.every(isScalar)) return value.slice(0, 12).map(shown).join(", ") + (value.length > 12 ? ", …" : "");
  return isScalar(value) ? String(value) : "–";
}
/** A scalar, or a list of them. */
export const isShort = (value: Value) => isScalar(value) || (Array.isArray(value) && value.every(isScalar));

/** Rows of the same kind as a table; what is too much is counted. */
function rows(words: Words, name: string, list: Members[]): HTMLElement {
  const columns = [...new Set(list.flatMap((one) => Object.keys(one).filter((member) => isShort(one[member]))))].slice(0, MOST_COLUMNS);
  const cells = list.slice(0, MOST_ROWS).map((one): Cell[] => columns.map((member) => shown(one[member])));
  return make("div", {}, table(called(name), columns.map(called), cells),
    list.length > MOST_ROWS && make("p", { className: "fine" }, words.furtherRows(list.length - MOST_ROWS)));
}

/** All that a document says, but for members that are left out by name. */
export function anything(words: Words, name: string, members: Members, without: string[] = [], depth = 0): HTMLElement {
  const entries = Object.entries(members).filter(([member, value]) => !without.includes(member) && value !== null && value !== undefined && !(Array.isArray(value) && value.length === 0));
  const short = entries.filter(([, value]) => isShort(value));
  const parts = entries.filter(([, value]) => !isShort(value)).map(([member, value]) => {
    if (Array.isArray(value)) return rows(words, member, value.filter(isMembers));
    return isMembers(value) && depth < MOST_DEPTH ? anything(words, member, value, without, depth + 1) : undefined;
  });
  return make("section", { className: depth === 0 ? "card said" : "said" }, depth === 0 ? make("h2", {}, name) : make("h3", {}, called(name)),
    short.length > 0 && make("dl", { className: "facts" }, ...short.flatMap(([member, value]) => [make("dt", {}, called(member)), make("dd", {}, typeof value === "boolean" ? (value ? words.yes : words.no) : shown(value))])),
    ...parts);
}
