// What every view is handed: the service, the words, and where it may draw.
import { FaciesError, JobFailed, Refused, Unreachable, type Service, type Warning } from "./api.js";
import { button, find, make } from "./dom.js";
import type { Route } from "./route.js";
import { called, isShort, shown } from "./views/anything.js";
import type { Words } from "./words/en.js";

export interface App {
  service: Service;
  words: Words;
  stage: HTMLElement;
  route: Route;
}

/** Ends what a view began. */
export type Leave = () => void;
export type View = (app: App) => Promise<Leave>;

/** Tells those who do not see the page. */
export function announce(text: string): void {
  find("#said").textContent = text;
}

/** What went wrong, in a sentence. */
export function detailOf(error: unknown, words: Words): string {
  if (error instanceof Refused) return error.problem.detail;
  if (error instanceof JobFailed) return error.job.error?.detail ?? error.job.message;
  return error instanceof Unreachable ? words.unreachable : String(error instanceof Error ? error.message : error);
}

/** The same with its code, and a way to try again. */
export function refusal(error: unknown, words: Words, again?: () => void): HTMLElement {
  const known = error instanceof FaciesError;
  const lost = error instanceof Unreachable;
  const detail = detailOf(error, words);
  const places = error instanceof Refused ? error.problem.errors ?? [] : [];
  announce(detail);
  return make("div", { className: "refusal", role: "alert" },
    make("strong", {}, error instanceof JobFailed ? words.jobFailed : lost ? words.lost : error instanceof Refused && error.problem.status === 404 ? words.notThere : words.refused), " ", detail,
    places.length > 1 && make("ul", {}, ...places.map((place) => make("li", {}, make("code", {}, place.pointer), ` ${place.detail}`))),
    known && !lost && make("a", { href: `/errors#${error.code}`, className: "code" }, error.code),
    again !== undefined && button(words.tryAgain, again));
}

/** What a warning speaks of, and how it is shown. */
export interface Place {
  label: string;
  show: () => void;
}

/** Warnings in words, each with its code and what it names in the view: what it is of in the language of the page, then the sentence of the
 * service, which is English. */
export function warnings(list: Warning[] | undefined, words: Words, places: (warning: Warning) => Place[] = () => []): HTMLElement {
  if (list === undefined || list.length === 0) return make("p", { className: "fine" }, words.noWarnings);
  return make("ul", { className: "warnings" }, ...list.map((warning) =>
    make("li", {}, warningName(warning, words), make("span", { lang: "en" }, warning.detail), " ", numbersOf(warning), make("a", { href: `/errors#${warning.code}`, className: "code" }, warning.code),
      ...places(warning).map(({ label, show }) => button(words.showPlace(label), show, { className: "place" })))));
}

/** What a warning counted or measured, by the names of the service. */
export const warningNumbers = ({ code: _code, detail: _detail, ...numbers }: Warning): string =>
  Object.entries(numbers as Record<string, unknown>).filter(([, value]) => isShort(value)).map(([name, value]) => `${called(name)}: ${shown(value)}`).join(" · ");

function numbersOf(warning: Warning): HTMLElement | false {
  const numbers = warningNumbers(warning);
  return numbers !== "" && make("span", { className: "numbers", lang: "en" }, numbers, " ");
}

/** Of a code that the page does not know the sentence alone stands. */
function warningName({ code }: Warning, words: Words): HTMLElement | false {
  const name = words.warningNames[code];
  return name !== undefined && make("strong", {}, `${name.charAt(0).toUpperCase()}${name.slice(1)}: `);
}

/** Solving ends here in per cent of a job. */
const SOLVED = 90;
/** Unbalanced forces beside all, above which nothing is solved yet. */
const UNBALANCED = 1e-3;

/** How far a job is in per cent; undefined where that cannot be said: at finite strain one solution follows another, and the first of
 * them has filled the space of all. */
export function shareOf({ phase, progress, residual }: { phase?: string; progress: number; residual?: number }): number | undefined {
  return phase === "solve" && progress >= SOLVED && residual !== undefined && residual > UNBALANCED ? undefined : progress;
}

/** A line that tells how far something is, with a way to stop it. */
export class ProgressLine {
  readonly element: HTMLElement;
  private readonly bar = make("progress", { max: 100, value: 0 });
  private readonly text = make("span");
  /** What became of stopping it. */
  private readonly said = make("div");

  constructor(private readonly words: Words, label: string, stop?: { text: string; clicked: () => Promise<unknown> }) {
    this.bar.setAttribute("aria-label", label);
    this.element = make("div", { className: "progress" }, make("span", {}, label), this.bar, this.text,
      stop !== undefined && button(stop.text, () => { stop.clicked().catch((error: unknown) => this.said.replaceChildren(refusal(error, words))); }), this.said);
  }

  tell(event: { status: string; phase?: string; progress: number; iteration?: number; residual?: number }): void {
    const { words } = this;
    const share = shareOf(event);
    if (share === undefined) this.bar.removeAttribute("value"); else this.bar.value = share;
    const phase = event.phase === undefined || event.phase === "" ? words.statuses[event.status] ?? event.status : words.phases[event.phase] ?? event.phase;
    const step = event.phase === "solve" && event.iteration !== undefined ? words.step(event.iteration) : "";
    this.text.textContent = [phase, step, share === undefined ? "" : `${share} %`].filter((part) => part !== "").join(" · ");
  }
}
