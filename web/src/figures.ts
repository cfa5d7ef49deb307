// Numbers as people read them.

/** A number as short as it is told apart. */
export function figure(value: number, digits = 2): string {
  return String(Number(value.toFixed(digits)));
}

/** A length in mm, with two digits. */
export const mm = (value: number): string => value.toFixed(2);

/** A component, with its sign; none where it would be of nothing. */
export const signed = (value: number): string => (Math.abs(value) < 0.005 ? "0.00" : `${value > 0 ? "+" : ""}${mm(value)}`);

/** A time as the language of the page writes it. */
export function when(time: string): string {
  return new Date(time).toLocaleString(document.documentElement.lang, { dateStyle: "medium", timeStyle: "short" });
}

/** A probability; nothing where there is none. */
export const probability = (p: number | null | undefined): string => (p === null || p === undefined ? "–" : p < 0.001 ? p.toExponential(1) : figure(p, 3));
