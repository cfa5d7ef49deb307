// The second order of a response: built in the background once the linear one stands, and taken in its place when it is ready. The response
// that is there may be of other materials than the case states: it is held against that of the case, with the same job or the next.
import { JobFailed, type Job } from "../api.js";
import { announce, detailOf, refusal, type App } from "../app.js";
import { PER_SEGMENT, type Columns } from "../columns.js";
import { button, make } from "../dom.js";
import { buildResponse, loadedResponse, type LoadedResponse, type Opened } from "../loading.js";
import { regionsOf } from "../tissue.js";

/** Columns above this are built and fetched when somebody asks for them, not by themselves, in bytes. */
const MOST_BYTES = 64e6;
const BYTES_A_NODE = 6;
/** What is solved twice may differ by so much, in mm: beyond that it is of another model. */
const SAME_MM = 1e-3;
/** Cases whose second order somebody has stopped, for as long as the tab is there. */
const STOPPED = "facies-second-stopped";

/** Whether a response is what the case states; unknown until the service has said so. */
export type OfCase = "same" | "other" | "unknown";

interface Planner {
  /** The response with its second order is there. */
  ready: (loaded: LoadedResponse) => void;
  /** Whether the response is that of the case is known, or not. */
  judged: (ofCase: OfCase) => void;
  /** Growth of tissue is wanted, with its progress in this element. */
  grow: (into: HTMLElement) => void;
}

export class SecondOrder {
  readonly element = make("div", { className: "order" });
  private readonly said = make("div", {});
  private turn = 0;
  /** Jobs whose responses are known to be of the case. */
  private readonly ofCase = new Set<string>();

  constructor(private readonly app: App, private readonly opened: Opened, private readonly planner: Planner) {}

  /** Says what order the response is of, and begins what it lacks. */
  show(loaded: LoadedResponse): void {
    const { app: { words } } = this;
    const { columns } = loaded;
    const turn = (this.turn += 1);
    const second = columns.second !== undefined;
    const inside = columns.inner.length > 0;
    const bytes = secondBytes(columns);
    this.said.replaceChildren();
    const add = button(words.second, () => { this.stopped(false); add.remove(); void this.build(loaded, this.turn, true); }, { title: words.secondWhy });
    const grow = second || columns.inner.some(({ kind }) => kind === "growth") ? undefined
      : button(words.addGrowth, () => { this.turn += 1; this.said.replaceChildren(); this.planner.grow(this.said); }, { title: words.addGrowthWhy });
    const asks = !second && !inside && (bytes > MOST_BYTES || this.isStopped);
    this.element.replaceChildren(
      make("div", { className: "row" }, make("span", { className: "badge" }, second ? words.order2 : words.order1), asks && add, grow),
      make("p", { className: "fine" }, second ? words.secondThere : inside ? words.secondNotInside : words.leftOutNowhere),
      asks && bytes > MOST_BYTES ? make("p", { className: "fine" }, words.secondLarge((bytes / 1e6).toFixed(0))) : "",
      this.said);
    const isKnown = this.ofCase.has(loaded.description.job ?? "");
    this.planner.judged(isKnown ? "same" : "unknown");
    if (!second && !inside && !asks) void this.build(loaded, turn);
    else if (!isKnown) void this.hold(loaded, turn);
  }

  /** Nobody waits for it any more; the service goes on, and who comes again finds it. */
  leave(): void {
    this.turn += 1;
  }

  private async build(linear: LoadedResponse, turn: number, asked = false): Promise<void> {
    const { app, opened: { id } } = this;
    const { words } = app;
    const isLeft = () => turn !== this.turn;
    try {
      const job = await buildResponse(app, id, { order: 2 }, this.said, {
        label: words.secondBuilding, isLeft, stop: (running) => { this.stopped(true); return app.service.ask("DELETE", `/v1/jobs/${running}`); },
      });
      if (job === undefined || isLeft()) return;
      const loaded = await loadedResponse(app, id, job);
      if (isLeft()) return;
      // What the response that is there was built with, materials above all, its description does not say.
      if (!asked && !isSameModel(linear, loaded)) { this.other(loaded); return; }
      this.take(loaded);
      announce(words.secondReady);
    } catch (error) {
      if (isLeft()) return;
      if (error instanceof JobFailed && error.job.status === "dismissed") { this.show(linear); return; }
      const again = () => { this.said.replaceChildren(); void this.build(linear, this.turn, true); };
      // What nobody asked for is no fault of theirs, as where a key may only read.
      this.said.replaceChildren(...(asked ? [refusal(error, words, again)]
        : [make("p", { className: "fine" }, words.secondNot(detailOf(error, words))), button(words.tryAgain, again)]));
    }
  }

  /** The response that there is beside that of the case, built alike: it is there already where somebody planned on the case before. */
  private async hold(shown: LoadedResponse, turn: number): Promise<void> {
    const { app, app: { words }, opened, said } = this;
    const isLeft = () => turn !== this.turn;
    try {
      const job = await buildResponse(app, opened.id, likeThis(shown.columns, regionsOf(opened.document)), said, {
        label: words.responseOfCase, isLeft, stop: (running) => app.service.ask("DELETE", `/v1/jobs/${running}`),
      });
      if (job === undefined || isLeft()) return;
      const loaded = job === shown.description.job ? shown : await loadedResponse(app, opened.id, job);
      if (isLeft()) return;
      if (!isSameModel(shown, loaded)) { this.other(loaded); return; }
      this.ofCase.add(shown.description.job ?? "");
      this.planner.judged("same");
    } catch (error) {
      // Nobody asked for it: the strip says that it is not known.
      if (!isLeft()) said.replaceChildren(make("p", { className: "fine" }, words.responseNotHeld(detailOf(error, words))));
    }
  }

  /** What is shown is not of the case, whose response is there now. */
  private other(ofCase: LoadedResponse): void {
    const { words } = this.app;
    this.planner.judged("other");
    this.said.replaceChildren(make("p", { className: "warned" }, words.responseOther, " ", button(words.takeResponse, () => this.take(ofCase))));
  }

  private take(loaded: LoadedResponse): void {
    this.ofCase.add(loaded.description.job ?? "");
    this.planner.ready(loaded);
  }

  private get isStopped(): boolean {
    return (sessionStorage.getItem(STOPPED) ?? "").split(" ").includes(this.opened.id);
  }

  private stopped(isStopped: boolean): void {
    const others = (sessionStorage.getItem(STOPPED) ?? "").split(" ").filter((one) => one !== "" && one !== this.opened.id);
    sessionStorage.setItem(STOPPED, [...others, ...(isStopped ? [this.opened.id] : [])].join(" "));
  }
}

function secondBytes({ nodes, segments }: Columns): number {
  const numbers = PER_SEGMENT * segments;
  return (numbers * (numbers + 1)) / 2 * nodes * BYTES_A_NODE;
}

/** What a response of the case has to have to be held against another. */
export function likeThis({ second, inner }: Pick<Columns, "second" | "inner">, regions: string[]): { order?: 2; growth?: string[] } {
  if (second !== undefined) return { order: 2 };
  return inner.some(({ kind }) => kind === "growth") ? { growth: regions } : {};
}

/** A response by its segments and its columns. */
type Model = { description: { segments: { name: string }[] }; columns: Pick<Columns, "nodes" | "segments" | "linear"> };

/** Whether two responses move the same nodes of the same segments alike, whatever growth and muscles they have beside. */
export function isSameModel(one: Model, other: Model): boolean {
  const names = ({ description }: Model) => description.segments.map(({ name }) => name).join("\n");
  const [a, b] = [one.columns, other.columns];
  const numbers = 3 * a.nodes * PER_SEGMENT * a.segments;
  return names(one) === names(other) && a.nodes === b.nodes
    && a.linear.subarray(0, numbers).every((value, at) => Math.abs(value - b.linear[at]!) < SAME_MM * Math.max(1, Math.abs(value)));
}
