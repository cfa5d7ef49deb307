// Colours of maps: they grow darker with the value, so that they survive printing and colour blindness, and what does not move
// stays light.
// Maps are in bands, so that a colour is a number between two lines of the legend.
import { SEQUENCE, SIGNED, type Rgb } from "./palette.js";

export type { Rgb };
export type Scheme = "length" | "signed";

const SCHEMES: Record<Scheme, Rgb[]> = { length: SEQUENCE, signed: SIGNED };
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

/** The colour of the band in which a value lies. */
export function bandOf(value: number, range: number, scheme: Scheme): Rgb {
  const band = Math.min(Math.max(Math.floor(share(value, range, scheme) * BANDS), 0), BANDS - 1);
  return at(scheme, band / (BANDS - 1));
}

/** The values at the lines between bands, from first to last. */
export function ticks(range: number, scheme: Scheme): number[] {
  const first = scheme === "length" ? 0 : -range;
  return Array.from({ length: BANDS + 1 }, (_, tick) => first + ((range - first) * tick) / BANDS);
}

export const css = ([red, green, blue]: Rgb): string => `rgb(${red}, ${green}, ${blue})`;
