// Growth and constants of tissue that are looked for with a plan, and the parameters of what was found.
import type { Documents } from "../../clients/typescript/src/facies.js";

/** What may be looked for in a region. */
export const TISSUE = ["volume_change", "poisson_ratio", "young_modulus_kpa"] as const;
export type TissueName = (typeof TISSUE)[number];

/** How a number of tissue is shown: so many times what the service has, in this unit, with so many digits; `part` is the unit of its part
 * in a combination that is not determined. */
export const TISSUE_SCALES: Record<TissueName, { factor: number; unit: string; digits: number; part: string }> = {
  volume_change: { factor: 100, unit: "%", digits: 2, part: "%" },
  poisson_ratio: { factor: 1, unit: "", digits: 4, part: "/100" },
  young_modulus_kpa: { factor: 1, unit: "kPa", digits: 2, part: "%" },
};

/** Between which values a number of a region may be, as the service has them; what is not there stays as it is. */
export type TissueBounds = Record<string, Partial<Record<TissueName, [number, number]>>>;

/** As they stand in an address: region, what of it, from, to. */
export function writeTissue(bounds: TissueBounds): string {
  return Object.entries(bounds).flatMap(([region, of]) => TISSUE.flatMap((name) =>
    (of[name] === undefined ? [] : [[encodeURIComponent(region), name, ...of[name]].join(",")]))).join(";");
}

/** Those of an address, of regions that there are; what is none is left out. */
export function readTissue(text: string, regions: string[]): TissueBounds {
  const bounds: TissueBounds = {};
  for (const part of text.split(";")) {
    const [place = "", stated, ...ends] = part.split(",");
    const [region, name] = [decodeURIComponent(place), TISSUE.find((one) => one === stated)];
    const [from, to] = ends.map(Number);
    if (!regions.includes(region) || name === undefined || ends.length !== 2 || !ends.every((end) => end !== "" && Number.isFinite(Number(end)))) continue;
    bounds[region] = { ...bounds[region], [name]: [from!, to!] };
  }
  return bounds;
}

/** All tissue, and each region that the case tells apart by name. */
export function regionsOf({ regions, materials }: Documents["CaseDocument"]): string[] {
  return [...new Set(["*", ...Object.values(regions?.names ?? {}), ...Object.keys(materials ?? {})])];
}

/** The ends to begin with: growth to either side, any ratio that tissue may have, and a modulus a third to three times that of the case. */
export function usualEnds(name: TissueName, { materials }: Documents["CaseDocument"], region: string): [number, number] {
  if (name === "volume_change") return [-0.3, 0.3];
  if (name === "poisson_ratio") return [0.3, 0.49];
  const stated = (materials?.[region] ?? materials?.["*"])?.young_modulus_kpa ?? 15;
  return [stated / 3, 3 * stated].map((value) => Number(value.toPrecision(2))) as [number, number];
}

/** The other number of a fit that it is bound to most closely, or nothing where there is no other. */
export function closest(correlation: number[][], at: number): { at: number; correlation: number } | undefined {
  const others = (correlation[at] ?? []).map((value, other) => ({ at: other, correlation: value })).filter((one) => one.at !== at);
  return others.sort((one, other) => Math.abs(other.correlation) - Math.abs(one.correlation))[0];
}
