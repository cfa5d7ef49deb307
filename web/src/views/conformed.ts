// A template on a patient: what is left of landmarks and surfaces, what the repair of cells moved, and muscles that went with it.
import type { Documents } from "../api.js";
import { rowChart } from "../charts.js";
import { card, make, table } from "../dom.js";
import { count, figure, mm } from "../figures.js";
import type { Words } from "../words/en.js";

type Conformation = Documents["ConformationDocument"];

export function conformedFacts(words: Words, found: Conformation): HTMLElement[] {
  const marks = Object.entries(found.landmarks_mm).sort(([, a], [, b]) => b - a);
  const longest = marks.slice(0, MOST_MARKS).map(([name, value]) => ({ name, value }));
  const muscles = (found.muscles ?? []).map((one) => [one.name, one.lines, ...lengths(one), volume(one.template_volume_ml), volume(one.volume_ml), one.beside_other_map === undefined || one.beside_other_map === null ? "–" : mm(one.beside_other_map.mean_mm)]);
  return [
    card(words.leftOver, surfaces(words, found)),
    ...(marks.length === 0 ? [] : [card(words.landmarks, rowChart(words.landmarks, "mm", longest), table(`${words.leftOver}, mm`, [words.landmark, "mm"], marks.map(([name, value]) => [name, mm(value)])))]),
    card(words.repair, repair(words, found)),
    ...(muscles.length === 0 ? [] : [card(words.muscles, table(`${words.muscles}, mm`, ["", words.lines, words.onTemplate, words.onPatient, words.widening, words.mlOnTemplate, words.mlOnPatient, words.otherMap], muscles))]),
  ];
}
const MOST_MARKS = 20;

const lengths = (one: Documents["MappedMuscleDocument"]) => (one.lines === 0 ? ["–", "–", "–"] : [mm(one.template_length_mm), mm(one.length_mm), figure(one.widening)]);
const volume = (ml: number | undefined) => (ml === undefined ? "–" : figure(ml, 2));

function surfaces(words: Words, { skin, bone, share_with_partner: share }: Conformation): HTMLElement {
  const row = (name: string, left: Documents["LeftDocument"] | null | undefined) =>
    (left === undefined || left === null ? [] : [[name, mm(left.mean_mm), mm(left.rms_mm), mm(left.p95_mm), mm(left.max_mm), left.points]]);
  const rows = [...row(words.skin, skin), ...row(words.bone, bone)];
  return make("div", {}, rows.length === 0 ? make("p", {}, words.byLandmarksAlone) : table(`${words.leftOver}, mm`, ["", words.mean, words.residual, words.p95, words.max, words.points], rows),
    share !== undefined && share !== null && make("p", { className: "fine" }, words.withPartner(figure(100 * share, 1))));
}

function repair(words: Words, { before_repair: before, after_repair: after, repair: done }: Conformation): HTMLElement {
  const row = (name: string, one: Documents["CellsDocument"]) => [name, count(one.cells), one.inverted, one.undecided, figure(one.smallest_scaled_jacobian, 3)];
  return make("div", {}, table(words.repair, ["", words.cells, words.inverted, words.undecided, words.quality], [row(words.before, before), row(words.after, after)]),
    make("p", {}, words.nodesMoved(count(done.nodes_moved), mm(done.mean_move_mm), mm(done.largest_move_mm))),
    done.unproven.length > 0 && make("p", { className: "warned" }, words.unproven(done.unproven.length)));
}
