// Plans that are stored with a case, by their names: saved, opened, laid over the one that is planned on, saved again, removed.
import { Refused, type Documents } from "../api.js";
import { announce, refusal, type App } from "../app.js";
import { button, make } from "../dom.js";
import { when } from "../figures.js";
import type { Opened } from "../loading.js";
import type { Pivots, Plan } from "../plan.js";
import { address, note } from "../route.js";
import { planInWords, planName } from "./called.js";

export type Stored = Documents["PlanView"];
/** A plan as sliders show it, with the points about which its segments turn. */
export interface Readable {
  plan: Plan;
  pivots: Pivots;
}
interface Planner {
  now: () => Documents["PlanDocument"];
  /** As far as sliders can show it. */
  read: (stored: Stored["plan"]) => Readable | undefined;
  load: (readable: Readable) => void;
  /** How far another plan is from this one, in words; nothing takes the comparison away. */
  compare: (readable: Readable | undefined) => string;
}

/** The stored plan that is open, in the address. */
export const OPEN = "plan";
const MOST_LETTERS = 128;

export async function storedPlans({ service }: App, id: string): Promise<Stored[]> {
  return service.list<Stored>(`/v1/cases/${id}/plans`);
}

export class SavedPlans {
  readonly element: HTMLElement;
  private readonly path: string;
  private readonly list = make("ul", { className: "plans" });
  private readonly said = make("div", { role: "status" });
  private readonly name = make("input", { type: "text", maxLength: MOST_LETTERS });
  private readonly again = button("", () => void this.replace());
  private readonly further = make("div", { className: "row" });
  private plans: Stored[] = [];
  private open: string | undefined;

  constructor(private readonly app: App, private readonly opened: Opened, private readonly planner: Planner) {
    const { words } = app;
    this.path = `/v1/cases/${opened.id}/plans`;
    this.open = app.route.state.get(OPEN) ?? undefined;
    const form = make("form", { className: "row" }, make("label", { className: "field" }, make("span", {}, words.planName), this.name),
      make("button", { type: "submit" }, words.savePlan), this.again);
    form.addEventListener("submit", (event) => { event.preventDefault(); void this.create(); });
    this.element = make("div", {}, form, this.said, this.list, this.further);
  }

  /** Fetches the plans; opens the one of the address where that says no movements. */
  async start(isStated: boolean): Promise<void> {
    try {
      await this.draw();
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      this.tell(error);
    }
    const { open } = this;
    if (open === undefined) return;
    const stored = this.plans.find(({ id }) => id === open);
    if (stored === undefined) { this.choose(undefined); this.tell(new Error(this.app.words.planGone)); return; }
    if (isStated) this.choose(stored);
    else this.load(stored);
  }

  private tell(error: unknown): void {
    this.said.replaceChildren(refusal(error, this.app.words));
  }

  private async draw(): Promise<void> {
    const { app: { words }, opened } = this;
    this.plans = await storedPlans(this.app, opened.id);
    this.list.replaceChildren(...(this.plans.length === 0 ? [make("li", { className: "fine" }, words.noPlans)] : this.plans.map((stored) => this.row(stored))));
    this.further.replaceChildren(...(this.plans.length < 2 ? [] : [make("a", { className: "button", href: address(["case", opened.id, "plans"]) }, words.compareTwo)]));
    this.choose(this.plans.find(({ id }) => id === this.open));
  }

  /** What "save again" is of. */
  private choose(stored: Stored | undefined): void {
    const { words } = this.app;
    this.open = stored?.id;
    note({ [OPEN]: stored?.id });
    this.again.hidden = stored === undefined;
    this.again.textContent = stored === undefined ? "" : words.savePlanAgain(planName(stored));
    for (const row of this.list.querySelectorAll<HTMLElement>("[data-plan]")) {
      if (row.dataset.plan === stored?.id) row.setAttribute("aria-current", "true"); else row.removeAttribute("aria-current");
    }
    if (stored !== undefined) this.name.value = stored.plan.name ?? "";
  }

  private load(stored: Stored): void {
    const readable = this.planner.read(stored.plan);
    if (readable === undefined) { this.tell(new Error(this.app.words.otherPlan)); return; }
    this.planner.load(readable);
    this.choose(stored);
    this.said.textContent = this.app.words.planOpened(planName(stored));
  }

  private row(stored: Stored): HTMLElement {
    const { app: { words }, planner, opened } = this;
    const readable = planner.read(stored.plan);
    const name = planName(stored);
    const compare = button(words.compareWith, () => {
      const on = compare.getAttribute("aria-pressed") !== "true";
      for (const other of this.list.querySelectorAll("[aria-pressed]")) other.setAttribute("aria-pressed", "false");
      compare.setAttribute("aria-pressed", String(on));
      this.said.textContent = planner.compare(on ? readable : undefined);
    }, { aria: { pressed: "false", label: `${words.compareWith} ${name}` } });
    const usable = readable === undefined ? [make("span", { className: "fine" }, words.otherPlan)]
      : [button(words.load, () => this.load(stored), { aria: { label: `${words.load} ${name}` } }), compare];
    return make("li", { data: { plan: stored.id } }, make("strong", { className: "name" }, name),
      make("span", { className: "fine name" }, `${planInWords(words, stored.plan, opened.frame)} · ${when(stored.updated)}`), ...usable,
      button("×", () => void this.remove(stored), { aria: { label: `${words.remove} ${name}` } }));
  }

  /** The plan as it is, by the name that stands in the field. */
  private document(): Documents["PlanDocument"] {
    const name = this.name.value.trim();
    return { ...(name === "" ? {} : { name }), ...this.planner.now() };
  }

  private async create(): Promise<void> {
    await this.change(() => this.app.service.post<Stored>(this.path, this.document()));
  }

  /** The stored plan that is open becomes this one, unless somebody else changed it meanwhile. */
  private async replace(): Promise<void> {
    const stored = this.plans.find(({ id }) => id === this.open);
    if (stored === undefined) return;
    const headers = { "Content-Type": "application/json", Accept: "application/json", "If-Match": `"${stored.version}"` };
    const body = JSON.stringify({ ...(stored.plan.name === undefined ? {} : { name: stored.plan.name }), ...this.document() });
    await this.change(async () => (await this.app.service.ask("PUT", `${this.path}/${stored.id}`, body, headers)).json() as Promise<Stored>);
  }

  private async change(send: () => Promise<Stored>): Promise<void> {
    try {
      const kept = await send();
      this.open = kept.id;
      await this.draw();
      this.said.textContent = this.app.words.planSaved(planName(kept));
    } catch (error) {
      this.tell(error);
    }
  }

  private async remove(stored: Stored): Promise<void> {
    try {
      await this.app.service.ask("DELETE", `${this.path}/${stored.id}`, undefined, { "If-Match": `"${stored.version}"` });
      this.planner.compare(undefined);
      await this.draw();
      announce(this.said.textContent = this.app.words.planRemoved(planName(stored)));
    } catch (error) {
      this.tell(error);
    }
  }
}
