// Plans that are stored with a case: told in words, loaded, compared, removed.
import { Refused, type Documents } from "../api.js";
import { refusal, type App } from "../app.js";
import { button, make } from "../dom.js";
import { when } from "../figures.js";
import type { Opened } from "../loading.js";
import type { Plan } from "../plan.js";
import { tail } from "./called.js";

type Stored = Documents["PlanView"];
interface Planner {
  now: () => Documents["PlanDocument"];
  /** As far as sliders can show it. */
  read: (stored: Stored["plan"]) => Plan | undefined;
  load: (plan: Plan) => void;
  /** A plan in a line. */
  called: (plan: Plan) => string;
  /** How far another plan is from this one, in words; nothing takes the comparison away. */
  compare: (plan: Plan | undefined) => string;
}

export async function savedPlans(app: App, opened: Opened, planner: Planner): Promise<HTMLElement> {
  const { service, words } = app;
  const path = `/v1/cases/${opened.id}/plans`;
  const list = make("ul", { className: "plans" });
  const said = make("div", { role: "status" });
  const tell = (error: unknown) => said.replaceChildren(refusal(error, words));
  const draw = async () => {
    const plans = await service.list<Stored>(path);
    list.replaceChildren(...(plans.length === 0 ? [make("li", { className: "fine" }, words.noPlans)] : plans.map(row)));
  };
  const row = (stored: Stored) => {
    const plan = planner.read(stored.plan);
    const remove = () => service.ask("DELETE", `${path}/${stored.id}`, undefined, { "If-Match": "*" }).then(draw, tell);
    const compare = button(words.compareWith, () => {
      const on = compare.getAttribute("aria-pressed") !== "true";
      for (const other of list.querySelectorAll("[aria-pressed]")) other.setAttribute("aria-pressed", "false");
      compare.setAttribute("aria-pressed", String(on));
      said.textContent = planner.compare(on ? plan : undefined);
    }, { aria: { pressed: "false" } });
    const name = plan === undefined ? tail(stored.id) : planner.called(plan);
    const usable = plan === undefined ? [make("span", { className: "fine" }, words.otherPlan)]
      : [button(words.load, () => planner.load(plan)), compare];
    return make("li", {}, make("span", { className: "name" }, name),
      make("span", { className: "fine" }, when(stored.created)), ...usable,
      button("×", () => void remove(), { aria: { label: `${words.remove} ${name}` } }));
  };
  const keep = button(words.savePlan, () => void service.post(path, planner.now()).then(draw).catch(tell));
  await draw().catch((error: unknown) => { if (error instanceof Refused) tell(error); else throw error; });
  return make("div", {}, keep, list, said);
}
