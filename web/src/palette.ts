// The colours of what is drawn, which are those of the pictures, charts and reports of the service (tests/conventions/palette.rs). Those of
// the document around it are in public/assets/palette.css.
export type Rgb = [number, number, number];

export const INK: string = "#22262b";
export const FAINT_INK: string = "#5b636d";
export const GRID: string = "#d9dce1";
export const PAPER = "#ffffff";
export const ACCENT: string = "#0b5c7a";
/** What is pointed out on the skin. */
export const POINTED = "#d55e00";

/** Series of charts: M. Okabe and K. Ito, Color universal design, 2008, without yellow, which is faint on white. */
export const SERIES: string[] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#333333"];

export const SKIN: Rgb = [233, 196, 172];
/** The outline of what was, on skin and on maps: dark on light bands, and none of their colours. */
export const OUTLINE: Rgb = [0, 107, 60];
export const BONE = "#efe6d2";
export const MOVING_BONE = "#d8c48f";

/** Magma from its light end (S. van der Walt and N. Smith, matplotlib 1.5, 2015, CC0), at equal distances; between them linear. */
export const SEQUENCE: Rgb[] = [
  [252, 253, 191], [254, 194, 135], [251, 135, 97], [229, 80, 100], [181, 54, 122], [129, 37, 129], [79, 18, 123],
];
/** Blue to orange with light greys between (C. Brewer, colorbrewer2.org: safe for colour blindness and print). The two in the middle are
 * nearly one: a distance of nothing has no side. */
export const SIGNED: Rgb[] = [
  [5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [230, 235, 238],
  [240, 236, 230], [253, 200, 134], [241, 148, 60], [196, 91, 12], [127, 48, 4],
];

/** What holds nodes: segments in order, and the others by class. */
export const SEGMENTS: Rgb[] = [[230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178]];
export const FIXED: Rgb = [60, 60, 64];
export const SLIDING: Rgb = [204, 121, 167];
export const FREE: Rgb = [222, 212, 203];

/** As three.js takes it. */
export const hex = (colour: string): number => Number.parseInt(colour.slice(1), 16);
export const hexOf = ([red, green, blue]: Rgb): number => (red << 16) | (green << 8) | blue;
