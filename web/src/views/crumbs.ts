// Where a person is within a case, and where they may go from there.
import { make } from "../dom.js";
import { address } from "../route.js";
import type { Words } from "../words/en.js";

export type Tab = "overview" | "plan" | "plans" | "inverse" | "result" | "comparison";

export function crumbs(words: Words, id: string | undefined, name: string, tab: Tab): HTMLElement {
  const tabs: [Tab, string[]][] = id === undefined ? [] : [
    ["overview", ["case", id]], ["plan", ["case", id, "plan"]], ["plans", ["case", id, "plans"]], ["inverse", ["case", id, "inverse"]], ["comparison", ["case", id, "compare"]],
  ];
  const links = tabs.map(([of, path]) => {
    const link = make("a", { href: address(path) }, words[of]);
    if (of === tab) link.setAttribute("aria-current", "page");
    return link;
  });
  const here = tab === "result" ? [make("a", { href: location.hash, ariaCurrent: "page" }, words.result)] : [];
  return make("div", { className: "crumbs" }, make("h1", {}, name), make("nav", { ariaLabel: name }, ...links, ...here));
}
