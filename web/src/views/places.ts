// What a warning speaks of, as it can be shown: landmarks, parts of the skin, segments and bones by their names, points by their numbers.
import type { Triple, Warning } from "../api.js";
import { announce, type Place } from "../app.js";
import type { Opened } from "../loading.js";
import { hex, POINTED } from "../palette.js";
import type { Scene } from "../scene.js";
import type { Words } from "../words/en.js";

/** Nodes of the skin, as they are drawn, by the names of its parts. */
export type Parts = Record<string, ArrayLike<number>>;

const COLOUR = hex(POINTED);

/** Whether a sentence names something, not as a part of another word. */
export function names(sentence: string, name: string): boolean {
  const escaped = name.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
  return name !== "" && new RegExp(`(?<![\\p{L}\\p{N}_])${escaped}(?![\\p{L}\\p{N}_])`, "u").test(sentence);
}

function point(warning: Warning): Triple | undefined {
  const numbers = ["x_mm", "y_mm", "z_mm"].map((name) => warning[name as keyof Warning] as unknown);
  return numbers.every((value) => typeof value === "number") ? numbers as Triple : undefined;
}

/** For each warning what it names, with a way to show it in the view. */
export function placesOf(words: Words, { document }: Opened, scene: Scene, parts: () => Parts): (warning: Warning) => Place[] {
  const showing = (label: string, show: () => void): Place => ({ label, show: () => { scene.unpoint(); show(); announce(words.shownInView(label)); } });
  return (warning) => {
    const named = (list: string[]) => list.filter((name) => names(warning.detail, name));
    const at = point(warning);
    const landmarks = named(Object.keys(document.landmarks ?? {})).map((name) =>
      showing(name, () => scene.point([{ at_mm: document.landmarks![name] as Triple, colour: COLOUR }])));
    const regions = named(Object.keys(document.skin_regions ?? {})).filter((name) => parts()[name] !== undefined)
      .map((name) => showing(name, () => scene.pointNodes(parts()[name]!, COLOUR)));
    const bones = named([...new Set([...(document.segments ?? []), ...(document.bones ?? [])].map(({ name }) => name))])
      .filter((name) => scene.hasBone(name)).map((name) => showing(name, () => scene.pointBone(name, COLOUR)));
    const points = at === undefined ? [] : [showing(words.thePlace, () => scene.point([{ at_mm: at, colour: COLOUR }]))];
    return [...landmarks, ...regions, ...bones, ...points];
  };
}
