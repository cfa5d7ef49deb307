// Sliders and number fields for the six movements of a segment.
import type { Triple } from "../api.js";
import { make } from "../dom.js";
import { figure, mm } from "../figures.js";
import { ROTATIONS, TRANSLATIONS, type FrameName, type Motion, type MotionName } from "../frame.js";
import type { Plan } from "../plan.js";
import { toldInner } from "./inner.js";
import type { Words } from "../words/en.js";

const MOST_MM = 15;
const MOST_DEG = 15;

export interface Movements {
  element: HTMLElement;
  /** Shows a movement that came from elsewhere. */
  show: (motion: Motion) => void;
}

/** `moving` is told of every step, `moved` once at its end. */
export function movements(
  words: Words, name: string, frame: FrameName, motion: Motion, moving: (word: MotionName, value: number) => void, moved: () => void,
): Movements {
  const shown = new Map<MotionName, (value: number) => void>();
  const line = (word: MotionName, unit: string, most: number) => {
    const label = frame === "unspecified" ? words.axes[word] : words[word];
    const why = frame === "unspecified" ? label : words[`${word}Why`];
    const limits = { min: String(-most), max: String(most), step: "0.1" };
    const aria = (what: string) => ({ label: `${name}: ${label}, ${what} (${why})` });
    const slider = make("input", { type: "range", ...limits, value: String(motion[word]), aria: aria(unit), data: { word } });
    const number = make("input", { type: "number", step: "0.1", value: String(motion[word]), aria: aria(unit), data: { word } });
    slider.addEventListener("input", () => { number.value = slider.value; moving(word, slider.valueAsNumber); });
    number.addEventListener("input", () => {
      if (!Number.isFinite(number.valueAsNumber)) return;
      slider.value = number.value;
      moving(word, number.valueAsNumber);
    });
    for (const input of [slider, number]) input.addEventListener("change", moved);
    // A double click on the word sets it to rest.
    const caption = make("span", { className: "word", title: why }, label);
    caption.addEventListener("dblclick", () => { slider.value = number.value = "0"; moving(word, 0); moved(); });
    shown.set(word, (value) => { slider.value = String(value); number.value = String(Number(value.toFixed(4))); });
    return make("div", { className: "movement" }, caption, slider, number, make("span", { className: "unit" }, unit));
  };
  const element = make("div", { className: "movements" },
    ...TRANSLATIONS.map((word) => line(word, "mm", MOST_MM)), ...ROTATIONS.map((word) => line(word, "°", MOST_DEG)));
  const show = (given: Motion) => { for (const [word, set] of shown) set(given[word]); };
  return { element, show };
}

/** A movement as the sliders call it, within a sentence. */
export const wordFor = (words: Words, word: MotionName, frame: FrameName): string => (frame === "unspecified" ? words.axes[word] : words[word].toLowerCase());
const unitOf = (word: MotionName) => ((TRANSLATIONS as readonly string[]).includes(word) ? " mm" : "°");

/** Which way a number of a movement goes, and how far: of an unspecified frame the axis, and the number as it is. */
export function wayFor(words: Words, word: MotionName, value: number, frame: FrameName): { way: string; far: number } {
  return frame === "unspecified" ? { way: words.axes[word], far: value } : { way: words.ways[word][value < 0 ? 1 : 0], far: Math.abs(value) };
}

/** Forward, up and left in mm, each by the way that it goes. */
export const inWays = (words: Words, vector: Triple, frame: FrameName): string => TRANSLATIONS.map((word, at) => {
  const { way, far } = wayFor(words, word, Math.abs(vector[at]!) < 0.005 ? 0 : vector[at]!, frame);
  return `${way} ${mm(far)}`;
}).join(", ");

/** A plan in a line. */
export function told(plan: Plan, words: Words, frame: FrameName): string {
  const parts = Object.entries(plan.segments).map(([name, motion]) => {
    const moved = Object.entries(motion).filter(([, value]) => value !== 0);
    const text = moved.map(([word, value]) => {
      const { way, far } = wayFor(words, word as MotionName, value, frame);
      return `${way} ${figure(far)}${unitOf(word as MotionName)}`;
    }).join(", ");
    return text === "" ? "" : `${name} ${text}`;
  });
  return [...parts.filter((part) => part !== ""), ...toldInner(plan.inner, words)].join("; ") || words.atRest;
}
