// Colours of maps: they grow darker with the value, so that they survive printing and colour blindness, and what does not move
// stays light.
//
// Those of the pictures and reports of the service: magma from its light end for lengths (S. van der Walt and N. Smith, matplotlib 1.5,
// 2015, CC0), and blue to orange with light greys between for signed distances (C. Brewer, colorbrewer2.org: safe for colour blindness
// and print). Maps are in bands, so that a colour is a number between two lines of the legend.

export type Rgb = [number, number, number];
export type Scheme = "length" | "signed";

/** At equal distances; between them linear. */
const LENGTH: Rgb[] = [
  [252, 253, 191], [254, 194, 135], [251, 135, 97], [229, 80, 100], [181, 54, 122], [129, 37, 129], [79, 18, 123],
];
/** The two in the middle are nearly one: a distance of nothing has no side. */
const SIGNED: Rgb[] = [
  [5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [230, 235, 238],
  [240, 236, 230], [253, 200, 134], [241, 148, 60], [196, 91, 12], [127, 48, 4],
];
const SCHEMES: Record<Scheme, Rgb[]> = { length: LENGTH, signed: SIGNED };
export const BANDS = 10;

/** The colour at a place between 0 and 1. */
function at(scheme: Scheme, place: number): Rgb {
  const stops = SCHEMES[scheme];
  const along = Math.min(Math.max(place, 0), 1) * (stops.length - 1);
  const [low, high] = [stops[Math.floor(along)]!, stops[Math.ceil(along)]!];
  return low.map((value, channel) => Math.round(value + (along % 1) * (high[channel]! - value))) as Rgb;
}

/** The colours of the bands, lowest first. */
export function bands(scheme: Scheme): Rgb[] {
  return Array.from({ length: BANDS }, (_, band) => at(scheme, band / (BANDS - 1)));
}

/** Where a value lies between 0 and 1; a range is from 0, or for signed values from its negative. */
export function share(value: number, range: number, scheme: Scheme): number {
  return scheme === "length" ? value / range : (value / range + 1) / 2;
}

/** The values at the lines between bands, from first to last. */
export function ticks(range: number, scheme: Scheme): number[] {
  const first = scheme === "length" ? 0 : -range;
  return Array.from({ length: BANDS + 1 }, (_, tick) => first + ((range - first) * tick) / BANDS);
}

export const css = ([red, green, blue]: Rgb): string => `rgb(${red}, ${green}, ${blue})`;
