// What is known of how far answers may be trusted: of a plan on a response, and of a result.
import type { Documents, Warning } from "../api.js";
import { figure, fixed, mm } from "../figures.js";
import type { Words } from "../words/en.js";
import type { OfCase } from "./second.js";
import type { TrustLine } from "./trust.js";

/** Means above this are to be heeded, in mm: what the program aims at, above which it warns of the mesh (`numerical-error-large`). */
const AIM_MM = 0.1;

/** Warnings of what the lines of the strip say: where one stands, its line is not as it should be. */
const TOPICS = {
  model: ["another-equilibrium", "bulk-in-all-cells", "built-in-poisson-ratio", "conditions-ignored", "exponent-bounded", "fibres-ignored", "law-at-rest", "materials-ignored", "other-response", "volume-not-kept"],
  leftOut: ["cells-inverted", "large-rotation", "large-strain", "outside-linear-range", "outside-second-order-range", "pressure-turned", "pressure-unsettled", "sliding-normal-turned", "solved-loosely", "tissue-may-buckle", "verification-differs"],
  mesh: ["locking", "membrane-wrinkles", "not-corrected", "numerical-error-large", "thin-stiff-layer"],
  accepted: ["tolerance-not-met"],
};

/** The line as a warning of its topic, or a mean above the aim, makes it, with the reason. */
function heeded(words: Words, line: TrustLine, topic: keyof typeof TOPICS, warnings: Warning[], mean_mm = 0): TrustLine {
  const said = warnings.filter(({ code }) => TOPICS[topic].includes(code)).map(({ detail }) => detail);
  const why = [...(line.why === undefined ? [] : [line.why]), ...(mean_mm > AIM_MM ? [words.aboveAim(String(AIM_MM))] : []), ...said].join(" ");
  return said.length > 0 || mean_mm > AIM_MM ? { ...line, trusted: "heed", why } : line;
}

const warned = (words: Words, count: number): TrustLine =>
  ({ name: words.warnings, value: count === 0 ? words.none : String(count), trusted: count === 0 ? "good" : "heed" });

/** What the answer leaves out, as far as that is estimated: a mean over the skin. */
export function leftOutLine(words: Words, answer: Documents["AppliedDocument"]): TrustLine {
  const left = answer.nonlinearity_estimate_mm ?? undefined;
  if (left === undefined) return { name: words.leftOutName, value: words.notKnown, trusted: "unknown", why: words.leftOutUnknown };
  const line: TrustLine = { name: words.leftOutName, value: words.leftOut(mm(left)), trusted: answer.within_linear_range ? "good" : "heed",
    ...(answer.within_linear_range ? {} : { why: words.outside }) };
  return heeded(words, line, "leftOut", answer.warnings, left);
}

/** The model of a response that is not that of the case, or not known to be, is not as it should be. */
function stated(words: Words, line: TrustLine, ofCase: OfCase): TrustLine {
  if (ofCase === "same") return line;
  const reason = ofCase === "other" ? words.responseOther : words.responseUnknown;
  const why = [line.why, reason].filter((part) => part !== undefined).join(" ");
  return ofCase === "other" ? { ...line, value: `${line.value}, ${words.notOfCase}`, trusted: "heed", why } : { ...line, trusted: line.trusted === "heed" ? "heed" : "unknown", why };
}

/** Of a plan on a response; `apart` is how far the page is from the service, and `most` how far it may be, in mm. */
export function appliedLines(
  words: Words, answer: Documents["AppliedDocument"], { apart, most, ofCase = "same" }: { apart: number; most: number; ofCase?: OfCase },
): TrustLine[] {
  const second = answer.second_order_mm ?? undefined;
  const model: TrustLine = { name: words.method, value: answer.order === 2 ? words.methodOrder2 : words.methodOrder1, trusted: "good",
    ...(second === undefined ? {} : { why: words.secondAdds(mm(second)) }) };
  return [
    stated(words, heeded(words, model, "model", answer.warnings), ofCase),
    leftOutLine(words, answer),
    { name: words.numericalError, value: words.notKnown, trusted: "unknown", why: words.errorWithPredict },
    { name: words.sameAsService, value: apart <= most ? words.agrees(figure(most, 4)) : words.disagrees(fixed(apart, 4)), trusted: apart <= most ? "good" : "heed" },
    warned(words, answer.warnings.length),
  ];
}

type Lengths = { mean: number; p95: number };

function measured(words: Words, name: string, lengths: Lengths | null | undefined, unknown: string | null | undefined): TrustLine {
  if (lengths === null || lengths === undefined) return { name, value: words.notKnown, trusted: "unknown", ...(unknown ? { why: unknown } : {}) };
  return { name, value: words.meanAnd95(mm(lengths.mean), mm(lengths.p95)), trusted: "good" };
}

/** Of a result. */
export function resultLines(words: Words, results: Documents["ResultDocument"], warnings: Warning[]): TrustLine[] {
  const { provenance, nonlinearity_mm, nonlinearity_unknown, numerical_error_mm, numerical_error_unknown, adequacy } = results;
  const model = [provenance?.method, provenance?.model].filter((part) => part !== undefined && part !== null);
  const parts = provenance?.solver?.newton?.parts ?? [];
  const why = [provenance?.why ?? "", parts.length > 0 ? words.madeInParts(parts.length) : ""].filter((part) => part !== "").join(" ");
  const solved: TrustLine = { name: words.solvedBy, value: [...new Set(model)].join(" · ") || words.notKnown, trusted: "good", ...(why === "" ? {} : { why }) };
  const lines: TrustLine[] = [heeded(words, solved, "model", warnings)];
  const finite = /nonlinear|finite/.test(model.join(" "));
  if (finite && (nonlinearity_mm ?? undefined) === undefined) lines.push(heeded(words, { name: words.leftOutName, value: words.nothingOfThat, trusted: "good", why: words.finiteStrain }, "leftOut", warnings));
  else lines.push(heeded(words, measured(words, words.leftOutName, nonlinearity_mm?.skin, nonlinearity_unknown), "leftOut", warnings, nonlinearity_mm?.skin.mean));
  const error = measured(words, words.numericalError, numerical_error_mm, numerical_error_unknown);
  const added = numerical_error_mm?.corrected === true ? { why: words.correctedHere } : {};
  lines.push(heeded(words, { ...error, ...added }, "mesh", warnings, numerical_error_mm?.mean));
  if (adequacy !== undefined && adequacy !== null) {
    lines.push(heeded(words, { name: words.accepted, value: `${mm(adequacy.accepted_mm)} mm: ${adequacy.met ? words.met : words.notMet}`, trusted: adequacy.met ? "good" : "heed" }, "accepted", warnings));
  }
  return [...lines, warned(words, warnings.length)];
}
