// The page: its head and foot, and the view that its address names.
import "./style.css";
import { asCurl, NoKey, Refused, Service } from "./api.js";
import { announce, refusal, type App, type Leave, type View } from "./app.js";
import { button, find, make, select } from "./dom.js";
import { read } from "./route.js";
import { cases } from "./views/cases.js";
import { jobs, studies } from "./views/jobs.js";
import { keyForm } from "./views/key.js";
import { de } from "./words/de.js";
import { en, type Words } from "./words/en.js";

const LANGUAGES: Record<string, Words> = { en, de };
const LANGUAGE = "facies-language";
const THEME = "facies-theme";

/** Views that draw in three dimensions come when they are asked for. */
const later = (name: "casePage" | "planPage" | "resultPage" | "inversePage" | "comparePage" | "plansPage"): View => async (app) =>
  (await import("./views/three.js"))[name](app);
const VIEWS: Record<string, View> = {
  cases, jobs, studies,
  "case": later("casePage"), "case plan": later("planPage"), "case plans": later("plansPage"), "case inverse": later("inversePage"),
  "case compare": later("comparePage"), "job": later("resultPage"),
};

const language = () => sessionStorage.getItem(LANGUAGE) ?? (navigator.language.startsWith("de") ? "de" : "en");
let leave: Leave = () => {};
let opened = 0;
let service = new Service();

function viewOf(path: string[]): View {
  const [first = "cases", , third] = path;
  return VIEWS[third === undefined ? first : `${first} ${third}`] ?? cases;
}

async function open(isFollowed = false): Promise<void> {
  const turn = (opened += 1);
  leave();
  leave = () => {};
  const words = LANGUAGES[language()] ?? en;
  const stage = make("main", { id: "stage", tabIndex: -1 });
  find("#stage").replaceWith(stage);
  // Who followed a link by keys goes on in the view that it leads to.
  if (isFollowed) stage.focus({ preventScroll: true });
  const app: App = { service, words, stage, route: read(location.hash) };
  shell(app);
  stage.append(make("p", { className: "loading" }, words.loading));
  try {
    const left = await viewOf(app.route.path)(app);
    // Another one was opened meanwhile.
    if (turn !== opened) { left(); return; }
    leave = left;
    const named = called(stage);
    document.title = [...named, "facies"].join(" · ");
    if (isFollowed) announce(named.join(", "));
  } catch (error) {
    if (turn === opened) failed(app, error);
  }
}

/** What a view is of, and which it is, for the tab and for those who do not see it. */
function called(stage: HTMLElement): string[] {
  const texts = ["h1", ".crumbs [aria-current]"].map((one) => stage.querySelector(one)?.textContent ?? "");
  return texts.filter((text) => text !== "");
}

function failed(app: App, error: unknown): void {
  const wantsKey = error instanceof NoKey || (error instanceof Refused && error.problem.status === 401);
  if (wantsKey) Service.forget();
  const asked = (key: string) => {
    Service.keep(key);
    service = new Service();
    void open();
  };
  app.stage.replaceChildren(wantsKey ? keyForm(app.words, asked) : refusal(error, app.words, () => void open()));
  if (error instanceof Refused && error.problem.status === 404) app.stage.append(make("a", { className: "button", href: "#/cases" }, app.words.toCases));
}

function shell(app: App): void {
  const { words, route } = app;
  document.documentElement.lang = language();
  document.documentElement.dataset.theme = sessionStorage.getItem(THEME) ?? "";
  find("#notice").textContent = words.notice;
  const link = (name: string, text: string) => {
    const element = make("a", { href: `#/${name}` }, text);
    if ((route.path[0] ?? "cases") === name) element.setAttribute("aria-current", "page");
    return element;
  };
  find("#nav").replaceChildren(link("cases", words.cases), link("jobs", words.jobs), link("studies", words.studies));
  find("#settings").replaceChildren(
    select(words.language, [["en", "English"], ["de", "Deutsch"]], language(), (value) => set(LANGUAGE, value)),
    select(words.appearance, [["", words.asSystem], ["light", words.light], ["dark", words.dark]],
      sessionStorage.getItem(THEME) ?? "", (value) => set(THEME, value)));
  calls(app);
}

function set(name: string, value: string): void {
  sessionStorage.setItem(name, value);
  void open();
}

/** What was asked of the service, each to be copied. */
function calls({ service: { calls: list }, service: asked, words }: App): void {
  const drawer = find("#calls");
  const toggle = find<HTMLButtonElement>("#calls-button");
  toggle.textContent = words.calls;
  // Beyond https and localhost browsers have none.
  const clipboard = navigator.clipboard as Clipboard | undefined;
  const row = (call: (typeof list)[number]) => {
    const line = make("code", { tabIndex: 0 }, asCurl(call));
    line.addEventListener("focus", () => getSelection()?.selectAllChildren(line));
    const copy: HTMLButtonElement = button(words.copyAsCurl, () => {
      clipboard?.writeText(asCurl(call)).then(() => { copy.textContent = words.copied; }, () => { copy.textContent = words.notCopied; });
    });
    return make("li", {}, line, clipboard !== undefined && copy);
  };
  const rows = make("ol", {});
  const draw = () => {
    if (drawer.hidden) return;
    rows.replaceChildren(...list.map(row));
    drawer.replaceChildren(make("h2", {}, words.calls), clipboard === undefined ? make("p", { className: "warned" }, words.noClipboard) : "", rows);
  };
  // Those that are there stay: one of them may be chosen.
  asked.noted = (call) => {
    if (drawer.hidden) return;
    rows.prepend(row(call));
    while (rows.childElementCount > list.length) rows.lastElementChild!.remove();
  };
  toggle.onclick = () => {
    drawer.hidden = !drawer.hidden;
    toggle.setAttribute("aria-expanded", String(!drawer.hidden));
    draw();
    if (!drawer.hidden) drawer.scrollIntoView({ block: "end" });
  };
  draw();
}

addEventListener("hashchange", () => void open(true));
void open();
