// What every view is handed: the service, the words, and where it may draw.
import { FaciesError, JobFailed, Refused, type Service, type Warning } from "./api.js";
import { button, find, make } from "./dom.js";
import type { Route } from "./route.js";
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

/** What went wrong, in words and with its code. */
export function refusal(error: unknown, words: Words, again?: () => void): HTMLElement {
  const known = error instanceof FaciesError;
  const lost = error instanceof TypeError;
  const detail = error instanceof Refused ? error.problem.detail
    : error instanceof JobFailed ? error.job.error?.detail ?? error.job.message
    : lost ? words.unreachable : String(error instanceof Error ? error.message : error);
  const places = error instanceof Refused ? error.problem.errors ?? [] : [];
  announce(detail);
  return make("div", { className: "refusal", role: "alert" },
    make("strong", {}, error instanceof JobFailed ? words.jobFailed : lost ? words.lost : words.refused), " ", detail,
    places.length > 1 && make("ul", {}, ...places.map((place) => make("li", {}, make("code", {}, place.pointer), ` ${place.detail}`))),
    known && make("a", { href: `/errors#${error.code}`, className: "code" }, error.code),
    again !== undefined && button(words.tryAgain, again));
}

/** What a warning speaks of, and how it is shown. */
export interface Place {
  label: string;
  show: () => void;
}

/** Warnings in words, each with its code and what it names in the view. */
export function warnings(list: Warning[] | undefined, words: Words, places: (warning: Warning) => Place[] = () => []): HTMLElement {
  if (list === undefined || list.length === 0) return make("p", { className: "fine" }, words.noWarnings);
  return make("ul", { className: "warnings" }, ...list.map((warning) =>
    make("li", {}, warning.detail, " ", make("a", { href: `/errors#${warning.code}`, className: "code" }, warning.code),
      ...places(warning).map(({ label, show }) => button(words.showPlace(label), show, { className: "place" })))));
}

/** A line that tells how far something is, with a way to stop it. */
export class ProgressLine {
  readonly element: HTMLElement;
  private readonly bar = make("progress", { max: 100, value: 0 });
  private readonly text = make("span");

  constructor(label: string, stop?: { text: string; clicked: () => void }) {
    this.bar.setAttribute("aria-label", label);
    this.element = make("div", { className: "progress" }, make("span", {}, label), this.bar, this.text,
      stop !== undefined && button(stop.text, stop.clicked));
  }

  tell(event: { status: string; phase?: string; progress: number; iteration?: number; residual?: number }): void {
    this.bar.value = event.progress;
    const solving = event.iteration !== undefined && event.residual !== undefined && event.phase === "solve"
      ? ` · ${event.iteration} · ${event.residual.toExponential(1)}` : "";
    this.text.textContent = `${event.phase ?? event.status} · ${event.progress} %${solving}`;
  }
}
