// The second order of a response: built in the background once the linear one stands, and taken in its place when it is ready.
import { JobFailed, type Job } from "../api.js";
import { announce, detailOf, refusal, type App } from "../app.js";
import { PER_SEGMENT, type Columns } from "../columns.js";
import { button, make } from "../dom.js";
import { buildResponse, loadedResponse, type LoadedResponse } from "../loading.js";

/** Columns above this are built and fetched when somebody asks for them, not by themselves, in bytes. */
const MOST_BYTES = 64e6;
const BYTES_A_NODE = 6;
/** What is solved twice may differ by so much, in mm: beyond that it is of another model. */
const SAME_MM = 1e-3;
/** Cases whose second order somebody has stopped, for as long as the tab is there. */
const STOPPED = "facies-second-stopped";

interface Planner {
  /** The response with its second order is there. */
  ready: (loaded: LoadedResponse) => void;
  /** Growth of tissue is wanted, with its progress in this element. */
  grow: (into: HTMLElement) => void;
}

export class SecondOrder {
  readonly element = make("div", { className: "order" });
  private readonly said = make("div", {});
  private turn = 0;

  constructor(private readonly app: App, private readonly id: string, private readonly planner: Planner) {}

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
    if (!second && !inside && !asks) void this.build(loaded, turn);
  }

  /** Nobody waits for it any more; the service goes on, and who comes again finds it. */
  leave(): void {
    this.turn += 1;
  }

  private async build(linear: LoadedResponse, turn: number, asked = false): Promise<void> {
    const { app, id } = this;
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
      if (loaded.columns.second === undefined || (!asked && !isSameModel(linear, loaded))) { this.said.replaceChildren(make("p", { className: "fine" }, words.secondOther)); return; }
      this.planner.ready(loaded);
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

  private get isStopped(): boolean {
    return (sessionStorage.getItem(STOPPED) ?? "").split(" ").includes(this.id);
  }

  private stopped(isStopped: boolean): void {
    const others = (sessionStorage.getItem(STOPPED) ?? "").split(" ").filter((one) => one !== "" && one !== this.id);
    sessionStorage.setItem(STOPPED, [...others, ...(isStopped ? [this.id] : [])].join(" "));
  }
}

function secondBytes({ nodes, segments }: Columns): number {
  const numbers = PER_SEGMENT * segments;
  return (numbers * (numbers + 1)) / 2 * nodes * BYTES_A_NODE;
}

/** Whether two responses move the same nodes of the same segments alike. */
function isSameModel(one: LoadedResponse, other: LoadedResponse): boolean {
  const names = ({ description }: LoadedResponse) => description.segments.map(({ name }) => name).join("\n");
  const [a, b] = [one.columns, other.columns];
  return names(one) === names(other) && a.nodes === b.nodes && other.columns.inner.length === 0
    && a.linear.every((value, at) => Math.abs(value - b.linear[at]!) < SAME_MM * Math.max(1, Math.abs(value)));
}
