// Sliders of what acts inside the tissue: muscles that pull, regions that gain or lose volume.
import type { Inner, InnerColumn, InnerKind } from "../columns.js";
import { make } from "../dom.js";
import { figure } from "../figures.js";
import type { Words } from "../words/en.js";

interface Scale {
  unit: string;
  /** Shown for one of the plan's. */
  factor: number;
  /** Of the slider, then of the number field, as they are shown. */
  slider: [number, number];
  field: [number, number];
  step: number;
}
const SCALES: Record<InnerKind, Scale> = {
  muscle: { unit: "kPa", factor: 1, slider: [0, 50], field: [0, 10_000], step: 0.5 },
  growth: { unit: "%", factor: 100, slider: [-20, 20], field: [-50, 100], step: 0.5 },
};
const SIDES: [string, string][] = [["left", "right"], ["Left", "Right"], ["links", "rechts"]];

export interface InnerSliders {
  element: HTMLElement;
  /** Shows amounts that came from elsewhere. */
  show: (inner: Inner) => void;
}
export interface Told {
  moving: (kind: InnerKind, name: string, value: number) => void;
  /** Once at the end of a step. */
  moved: () => void;
}

/** The muscle of the other side, where there is one. */
export function partner(name: string, names: string[]): string | undefined {
  const others = SIDES.flatMap(([a, b]) => [[a, b], [b, a]]).filter(([from]) => name.includes(from!));
  return others.map(([from, to]) => name.replace(from!, to!)).find((other) => names.includes(other));
}

/** What both sides of a muscle are called together. */
const sideless = (name: string): string => SIDES.flat().reduce((rest, side) => rest.replace(side, ""), name).replace(/[_ ]+/g, " ").trim();

export const called = (name: string, words: Words): string => (name === "*" ? words.allTissue : name.replaceAll("_", " "));

/** Amounts in a line. */
export function toldInner(inner: Inner, words: Words): string[] {
  return (["muscle", "growth"] as const).flatMap((kind) => Object.entries(inner[kind]).map(([name, value]) =>
    `${called(name, words)} ${figure(value * SCALES[kind].factor, 1)} ${SCALES[kind].unit}`));
}

/** One line for each column of a kind; `together` says whether the other side follows. */
function lines(words: Words, kind: InnerKind, names: string[], together: () => boolean, told: Told) {
  const { unit, factor, slider: [low, high], field: [least, most], step } = SCALES[kind];
  const shown = new Map<string, (value: number) => void>();
  const values = new Map<string, number>();
  const elements = names.map((name) => {
    const label = called(name, words);
    const aria = { label: `${label}, ${unit}` };
    const slider = make("input", { type: "range", min: String(low), max: String(high), step: String(step), value: "0", aria, data: { inner: name } });
    const field = make("input", { type: "number", min: String(least), max: String(most), step: String(step), value: "0", aria, data: { inner: name } });
    const show = (value: number) => { values.set(name, value); slider.value = String(value * factor); field.value = String(Number((value * factor).toFixed(4))); };
    const set = (value: number) => {
      const within = Math.min(Math.max(value, least), most) / factor;
      const other = together() ? partner(name, names) : undefined;
      for (const one of other === undefined ? [name] : [name, other]) {
        values.set(one, within);
        told.moving(kind, one, within);
        if (one !== name) shown.get(one)!(within);
      }
    };
    slider.addEventListener("input", () => { field.value = slider.value; set(slider.valueAsNumber); });
    field.addEventListener("input", () => { if (Number.isFinite(field.valueAsNumber)) { slider.value = field.value; set(field.valueAsNumber); } });
    for (const input of [slider, field]) input.addEventListener("change", told.moved);
    shown.set(name, show);
    const other = partner(name, names);
    // Both sides alike have one line, that of the first.
    const second = other !== undefined && names.indexOf(other) < names.indexOf(name);
    return make("div", { className: `movement pull${second ? " second" : ""}` },
      make("span", { className: "word" }, make("span", { className: "alone" }, label), make("span", { className: "pair" }, other === undefined ? label : sideless(name))),
      slider, field, make("span", { className: "unit" }, unit));
  });
  /** The second of each two sides takes the amount of the first. */
  const alike = () => names.forEach((name, at) => {
    const other = partner(name, names);
    const value = values.get(name) ?? 0;
    if (other === undefined || names.indexOf(other) < at || values.get(other) === value) return;
    told.moving(kind, other, value);
    shown.get(other)!(value);
  });
  return { elements, shown, alike };
}

/** Undefined where the response has no such columns. */
export function innerSliders(words: Words, columns: InnerColumn[], inner: Inner, told: Told): InnerSliders | undefined {
  if (columns.length === 0) return undefined;
  const both = make("input", { type: "checkbox", checked: true });
  const parts = (["muscle", "growth"] as const).map((kind) => {
    const names = columns.filter((column) => column.kind === kind).map(({ name }) => name);
    return { kind, names, ...lines(words, kind, names, () => kind === "muscle" && both.checked, told) };
  });
  const element = make("div", {}, ...parts.filter(({ names }) => names.length > 0).map(({ kind, names, elements }) => {
    const paired = kind === "muscle" && names.some((name) => partner(name, names) !== undefined);
    return make("details", { className: "segment", open: true }, make("summary", {}, kind === "muscle" ? words.muscles : words.growth),
      make("p", { className: "fine" }, kind === "muscle" ? words.musclesHint : words.growthHint),
      paired && make("label", { className: "check" }, both, ` ${words.bothSides}`), ...elements);
  }));
  const arrange = () => element.classList.toggle("together", both.checked);
  both.addEventListener("change", () => {
    arrange();
    if (!both.checked) return;
    for (const { kind, alike } of parts) if (kind === "muscle") alike();
    told.moved();
  });
  const show = (given: Inner) => {
    for (const { kind, shown, names } of parts) {
      for (const [name, set] of shown) set(given[kind][name] ?? 0);
      const differs = names.some((name) => { const other = partner(name, names); return other !== undefined && given[kind][name] !== given[kind][other]; });
      // Sides that are not alike are shown as what they are.
      if (kind === "muscle" && differs) both.checked = false;
    }
    arrange();
  };
  show(inner);
  return { element, show };
}
