// What is known of how far answers may be trusted: of a plan on a response, and of a result.
import type { Documents, Warning } from "../api.js";
import { mm } from "../figures.js";
import type { Words } from "../words/en.js";
import type { TrustLine } from "./trust.js";

/** Means above this are to be heeded, in mm: that of which the service calls a response trustworthy. */
const HEEDED_MM = 0.5;

const warned = (words: Words, count: number): TrustLine =>
  ({ name: words.warnings, value: count === 0 ? words.none : String(count), trusted: count === 0 ? "good" : "heed" });

/** Of a plan on a response; `apart` is how far the page is from the service, and `most` how far it may be, in mm. */
export function appliedLines(words: Words, answer: Documents["AppliedDocument"], { apart, most }: { apart: number; most: number }): TrustLine[] {
  const left = answer.nonlinearity_estimate_mm ?? undefined;
  const second = answer.second_order_mm ?? undefined;
  const leftOut: TrustLine = left === undefined
    ? { name: words.leftOutName, value: words.notKnown, trusted: "unknown", why: words.leftOutUnknown }
    : { name: words.leftOutName, value: words.leftOut(mm(left)), trusted: answer.within_linear_range ? "good" : "heed",
      ...(answer.within_linear_range ? {} : { why: words.outside }) };
  return [
    { name: words.method, value: answer.order === 2 ? words.methodOrder2 : words.methodOrder1, trusted: "good",
      ...(second === undefined ? {} : { why: words.secondAdds(mm(second)) }) },
    leftOut,
    { name: words.numericalError, value: words.notKnown, trusted: "unknown", why: words.errorWithPredict },
    { name: words.sameAsService, value: (apart <= most ? words.agrees : words.disagrees)(apart.toExponential(0)), trusted: apart <= most ? "good" : "heed" },
    warned(words, answer.warnings.length),
  ];
}

type Lengths = { mean: number; p95: number };

function measured(words: Words, name: string, lengths: Lengths | null | undefined, unknown: string | null | undefined): TrustLine {
  if (lengths === null || lengths === undefined) return { name, value: words.notKnown, trusted: "unknown", ...(unknown ? { why: unknown } : {}) };
  return { name, value: words.meanAnd95(mm(lengths.mean), mm(lengths.p95)), trusted: lengths.mean <= HEEDED_MM ? "good" : "heed" };
}

/** Of a result. */
export function resultLines(words: Words, results: Documents["ResultDocument"], warnings: Warning[]): TrustLine[] {
  const { provenance, nonlinearity_mm, nonlinearity_unknown, numerical_error_mm, numerical_error_unknown, adequacy } = results;
  const model = [provenance?.method, provenance?.model].filter((part) => part !== undefined && part !== null);
  const lines: TrustLine[] = [
    { name: words.solvedBy, value: [...new Set(model)].join(" · ") || words.notKnown, trusted: "good", ...(provenance?.why ? { why: provenance.why } : {}) },
  ];
  const finite = /nonlinear|finite/.test(model.join(" "));
  if (finite && (nonlinearity_mm ?? undefined) === undefined) lines.push({ name: words.leftOutName, value: words.nothingOfThat, trusted: "good", why: words.finiteStrain });
  else lines.push(measured(words, words.leftOutName, nonlinearity_mm?.skin, nonlinearity_unknown));
  const error = measured(words, words.numericalError, numerical_error_mm, numerical_error_unknown);
  lines.push(numerical_error_mm?.corrected === true ? { ...error, why: words.correctedHere } : error);
  if (adequacy !== undefined && adequacy !== null) {
    lines.push({ name: words.accepted, value: `${mm(adequacy.accepted_mm)} mm: ${adequacy.met ? words.met : words.notMet}`, trusted: adequacy.met ? "good" : "heed" });
  }
  return [...lines, warned(words, warnings.length)];
}
