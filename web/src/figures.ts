// Numbers as people read them, with the decimal sign and the groups of the language of the page.

const language = (): string => (typeof document === "undefined" ? "en" : document.documentElement.lang);
const written = (number: string): string => (language() === "de" ? number.replace(".", ",") : number);

/** A count, in groups of three digits. */
export const count = (value: number): string => value.toLocaleString(language());

/** A number as short as it is told apart. */
export function figure(value: number, digits = 2): string {
  return written(String(Number(value.toFixed(digits))));
}

/** A number with so many digits. */
export const fixed = (value: number, digits: number): string => written(value.toFixed(digits));

/** A length in mm, with two digits. */
export const mm = (value: number): string => fixed(value, 2);

/** A component, with its sign; none where it would be of nothing. */
export const signed = (value: number): string => (Math.abs(value) < 0.005 ? "0.00" : `${value > 0 ? "+" : ""}${mm(value)}`);

/** A time as the language of the page writes it. */
export function when(time: string): string {
  return new Date(time).toLocaleString(language(), { dateStyle: "medium", timeStyle: "short" });
}

/** A probability; nothing where there is none. */
export const probability = (p: number | null | undefined): string => (p === null || p === undefined ? "–" : p < 0.001 ? written(p.toExponential(1)) : figure(p, 3));
