// Materials of the literature for the regions of a case, each with who stated it and what speaks against it.
import type { CaseDocument, Documents } from "../api.js";
import { refusal, type App } from "../app.js";
import { make, select, table } from "../dom.js";
import { figure } from "../figures.js";

type Preset = Documents["PresetDocument"];
type Material = NonNullable<CaseDocument["materials"]>[string];
/** The names of presets by region. */
export type Presets = Record<string, string>;

const regionsOf = ({ materials, regions }: CaseDocument): string[] =>
  [...new Set([...Object.keys(materials ?? {}), ...Object.values(regions?.names ?? {})])];

const hasCourse = ({ fibre }: { fibre?: Material["fibre"] } = {}) => (fibre?.direction ?? fibre?.array ?? undefined) !== undefined;

/** The material of a region as the case states it, with what it takes from `*`. */
const stated = ({ materials }: CaseDocument, region: string): Material | undefined => materials?.[region] ?? materials?.["*"];

/** A preset for each region, or what the case says; `changed` is told of all that are chosen. The list comes when it is opened. */
export function materialChoices(app: App, document: CaseDocument, changed: (chosen: Presets) => void): HTMLElement {
  const { words, service } = app;
  const chosen: Presets = {};
  const body = make("div", { className: "stack" });
  const element = make("details", { className: "materials" }, make("summary", {}, words.materials), body);
  const draw = ({ presets, measured, measured_in }: Documents["MaterialList"]) => {
    const row = (region: string) => {
      const about = make("div", { className: "fine" });
      const choose = (name: string) => {
        const preset = presets.find((one) => one.name === name);
        if (preset === undefined) delete chosen[region]; else chosen[region] = name;
        about.replaceChildren(...(preset === undefined ? [] : aboutPreset(app, preset)));
        changed({ ...chosen });
      };
      // Fibres without a course would be refused.
      const usable = presets.filter(({ needs_course }) => !needs_course || hasCourse(stated(document, region)));
      const now = stated(document, region);
      const own = now?.preset ?? (now?.young_modulus_kpa === undefined ? words.asStated : `${words.asStated}: ${figure(now.young_modulus_kpa!)} kPa, ν ${figure(now.poisson_ratio ?? 0, 3)}`);
      return make("div", { data: { region } }, select(region === "*" ? words.otherRegions : region, [["", own], ...usable.map(({ name, tissue }) => [name, `${tissue} · ${name.replaceAll("_", " ")}`] as const)], "", choose), about);
    };
    const moduli = table(`${words.measuredModuli}, kPa`, [words.tissue, "E", words.source], measured.map((one) => [one.tissue, one.from_kpa === one.to_kpa ? figure(one.from_kpa) : `${figure(one.from_kpa)} – ${figure(one.to_kpa)}`, one.source]));
    body.replaceChildren(make("p", { className: "fine" }, words.materialsHint), ...regionsOf(document).map(row),
      make("details", {}, make("summary", {}, words.measuredModuli), moduli, make("p", { className: "fine" }, `${measured_in.authors} ${measured_in.year}, ${measured_in.place}`)));
  };
  element.addEventListener("toggle", () => {
    if (!element.open || body.childElementCount > 0) return;
    body.replaceChildren(make("p", { className: "loading" }, words.loading));
    service.get<Documents["MaterialList"]>("/v1/materials").then(draw, (error: unknown) => body.replaceChildren(refusal(error, words)));
  });
  return element;
}

function aboutPreset({ words }: App, { material, state, source, doubt }: Preset): HTMLElement[] {
  const numbers = [material.young_modulus_kpa === undefined || material.young_modulus_kpa === null ? "" : `E ${figure(material.young_modulus_kpa)} kPa`,
    material.poisson_ratio === undefined || material.poisson_ratio === null ? "" : `ν ${figure(material.poisson_ratio, 4)}`, material.law?.kind.replaceAll("_", " ") ?? ""].filter((part) => part !== "").join(", ");
  return [make("p", {}, `${numbers === "" ? "" : `${numbers}: `}${state} (${source.authors} ${source.year}, ${source.place})`),
    ...(typeof doubt === "string" ? [make("p", { className: "warned" }, `${words.doubt}: ${doubt}`)] : [])];
}

/** Presets as a spec states them: fibres keep the course that the case states. */
export function inSpec(chosen: Presets): Record<string, object> | undefined {
  const entries = Object.entries(chosen).map(([region, preset]) => [region, { preset }] as const);
  return entries.length === 0 ? undefined : Object.fromEntries(entries);
}

/** The document with these materials; of a region that had another there stay its density and the course of its fibres. */
export function withPresets(document: CaseDocument, chosen: Presets): CaseDocument {
  if (Object.keys(chosen).length === 0) return document;
  const changed = Object.entries(chosen).map(([region, preset]) => {
    const { density_g_per_cm3, fibre } = stated(document, region) ?? {};
    const { direction, array } = fibre ?? {};
    const course = direction ? { direction } : array ? { array } : undefined;
    return [region, { preset, ...(density_g_per_cm3 === undefined ? {} : { density_g_per_cm3 }), ...(course === undefined ? {} : { fibre: course }) }] as const;
  });
  return { ...document, materials: { ...document.materials, ...Object.fromEntries(changed) } } as CaseDocument;
}
