// Elements of the page, made in one call each.

type Child = Node | string | undefined | false;
type Attributes<Name extends keyof HTMLElementTagNameMap> = Omit<Partial<HTMLElementTagNameMap[Name]>, "style" | "dataset"> & {
  aria?: Record<string, string>;
  data?: Record<string, string>;
  role?: string;
};

/** An element with its properties and what it holds; nothing is ever parsed as HTML. */
export function make<Name extends keyof HTMLElementTagNameMap>(
  name: Name, attributes?: Attributes<Name>, ...children: Child[]
): HTMLElementTagNameMap[Name] {
  const { aria = {}, data = {}, role, ...properties } = attributes ?? ({} as Attributes<Name>);
  const element = Object.assign(document.createElement(name), properties);
  if (role !== undefined) element.setAttribute("role", role);
  for (const [key, value] of Object.entries(aria)) element.setAttribute(`aria-${key}`, value);
  Object.assign(element.dataset, data);
  element.append(...children.filter((child): child is Node | string => child !== undefined && child !== false));
  return element as HTMLElementTagNameMap[Name];
}

const SVG = "http://www.w3.org/2000/svg";

/** A part of a drawing with its attributes and what it holds. */
export function svg(name: string, attributes: Record<string, string | number>, ...children: (SVGElement | string)[]): SVGElement {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}

export const find = <T extends Element = HTMLElement>(selector: string): T => document.querySelector<T>(selector)!;

export function button(text: string, clicked: () => void, attributes: Attributes<"button"> = {}): HTMLButtonElement {
  const element = make("button", { type: "button", ...attributes }, text);
  element.addEventListener("click", clicked);
  return element;
}

/** What may be wider than its place, to be scrolled by keys too. */
export function scrolling(label: string, ...children: Child[]): HTMLElement {
  return make("div", { className: "scroll", tabIndex: 0, role: "region", aria: { label } }, ...children);
}

/** A part of a result under a heading. */
export function card(title: string, ...children: Child[]): HTMLElement {
  return make("section", { className: "card said" }, make("h2", {}, title), ...children);
}

export type Cell = string | number | Node;

/** A table with a head; numbers stand to the right. */
export function table(caption: string, head: string[], rows: Cell[][]): HTMLElement {
  const held = (value: Cell) => (value instanceof Node ? value : String(value));
  const cell = (value: Cell, at: number) => (at === 0
    ? make("th", { scope: "row" }, held(value))
    : make("td", {}, held(value)));
  return scrolling(caption, make("table", {},
    make("caption", {}, caption),
    make("thead", {}, make("tr", {}, ...head.map((text) => make("th", { scope: "col" }, text)))),
    make("tbody", {}, ...rows.map((row) => make("tr", {}, ...row.map(cell))))));
}

/** A choice of one of several, as buttons side by side. */
export function choice<Value extends string>(
  label: string, options: readonly (readonly [Value, string])[], chosen: Value, changed: (value: Value) => void,
): HTMLFieldSetElement {
  const name = `choice-${Math.random().toString(36).slice(2)}`;
  const items = options.map(([value, text]) => {
    const input = make("input", { type: "radio", name, value, checked: value === chosen });
    input.addEventListener("change", () => changed(value));
    return make("label", {}, input, make("span", {}, text));
  });
  return make("fieldset", { className: "choice" }, make("legend", {}, label), make("span", { className: "row" }, ...items));
}

export function select(
  label: string, options: readonly (readonly [string, string])[], chosen: string, changed: (value: string) => void,
): HTMLLabelElement {
  const input = make("select", {}, ...options.map(([value, text]) => make("option", { value, selected: value === chosen }, text)));
  input.addEventListener("change", () => changed(input.value));
  return make("label", { className: "field" }, make("span", {}, label), input);
}

/** Hands a file to the person. */
export function save(content: Blob, name: string): void {
  const address = URL.createObjectURL(content);
  make("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
