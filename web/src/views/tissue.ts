// What tissue lost or gained and what its constants are, looked for with a movement: which of them, and between which values.
import type { CaseDocument } from "../api.js";
import { make } from "../dom.js";
import { regionsOf, TISSUE, TISSUE_SCALES, usualEnds, type TissueBounds, type TissueName } from "../tissue.js";
import type { Words } from "../words/en.js";
import { called } from "./inner.js";

/** `changed` is told of each change, made in `bounds` itself. */
export function tissueFields(words: Words, document: CaseDocument, bounds: TissueBounds, changed: () => void): HTMLElement {
  const line = (region: string, name: TissueName) => {
    const { factor, unit } = TISSUE_SCALES[name];
    const label = words.tissueNumbers[name] + (unit === "" ? "" : `, ${unit}`);
    const whole = `${called(region, words)}: ${label}`;
    const is = make("input", { type: "checkbox", checked: bounds[region]?.[name] !== undefined, aria: { label: whole } });
    const ends = (bounds[region]?.[name] ?? usualEnds(name, document, region)).map((value, at) => make("input", {
      type: "number", step: "any", value: String(Number((value * factor).toFixed(4))), aria: { label: `${whole}, ${at === 0 ? words.from : words.to}` } }));
    const note = () => {
      const [from, to] = ends.map((end) => end.valueAsNumber / factor) as [number, number];
      for (const end of ends) end.disabled = !is.checked;
      const { [name]: _, ...others } = bounds[region] ?? {};
      bounds[region] = is.checked && Number.isFinite(from) && Number.isFinite(to) ? { ...others, [name]: [from, to] } : others;
      if (Object.keys(bounds[region]).length === 0) delete bounds[region];
    };
    note();
    for (const input of [is, ...ends]) input.addEventListener("input", () => { note(); changed(); });
    return make("div", { className: "between" }, make("label", { className: "check" }, is, ` ${label}`), ends[0], "…", ends[1]);
  };
  return make("div", {}, ...regionsOf(document).map((region) => make("details", { className: "segment", open: bounds[region] !== undefined, data: { region } },
    make("summary", {}, called(region, words)), ...TISSUE.map((name) => line(region, name)))));
}
