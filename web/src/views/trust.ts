// What an answer may be trusted with: model, what it leaves out, the error of its mesh, warnings, in one strip above the head.
import { make } from "../dom.js";
import type { Words } from "../words/en.js";

/** How a line is to be taken: as it should be, to be heeded, or not known. */
export type Trusted = "good" | "heed" | "unknown";
export interface TrustLine {
  name: string;
  value: string;
  trusted: Trusted;
  /** Why, in a sentence. */
  why?: string;
}

const SIGNS: Record<Trusted, string> = { good: "✓", heed: "!", unknown: "?" };

/** A sign stands before each, so that none is told by its colour alone; what there is to explain is behind the last. */
export function drawTrust(into: HTMLElement, words: Words, lines: TrustLine[]): void {
  const chips = lines.map(({ name, value, trusted }) => make("li", { className: `trust ${trusted}` },
    make("span", { className: "sign", role: "img", aria: { label: words.trusted[trusted] } }, SIGNS[trusted]),
    make("span", { className: "name" }, `${name} `), make("strong", {}, value)));
  const open = into.querySelector("details")?.open ?? false;
  const reasons = lines.filter(({ why }) => why !== undefined).map(({ name, why }) => make("p", {}, make("strong", {}, `${name}: `), why));
  into.classList.remove("waiting");
  into.setAttribute("role", "group");
  into.setAttribute("aria-label", words.trust);
  into.replaceChildren(make("ul", {}, ...chips),
    reasons.length > 0 && make("details", { open }, make("summary", {}, words.why), ...reasons) || "");
}

/** Keeps the room of lines that come later, so that nothing jumps then. */
export function reserveTrust(into: HTMLElement, words: Words, lines: TrustLine[]): void {
  drawTrust(into, words, lines);
  into.classList.add("waiting");
}
