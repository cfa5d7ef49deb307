// A head beside its controls: standard views, looks, colours with their legend, pictures.
import { refusal, type App } from "./app.js";
import { bandOf, bands, BANDS, css, ticks, type Rgb, type Scheme } from "./colours.js";
import { button, choice, make, save, select } from "./dom.js";
import { figure } from "./figures.js";
import { VIEWS } from "./geometry.js";
import { writeGlb } from "./glb.js";
import { INK, PAPER } from "./palette.js";
import { note, read } from "./route.js";
import { Scene, SEEN, type SkinLook, type Turned } from "./scene.js";

/** A map that may colour the skin. */
export interface SkinMap {
  name: string;
  label: string;
  scheme: Scheme;
  /** Of its values; absent: mm. */
  unit?: string;
  /** The range that is chosen unless the address says otherwise, in that unit: the same for every plan. */
  range_mm: number;
  /** Of values that are places in this list, and no amounts. */
  kinds?: { name: string; colour: Rgb }[];
  /** The value of each node of the skin. */
  values: () => ArrayLike<number> | undefined;
}

const RANGES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20];
const SHOWN = "map";
/** A camera that was turned by hand, in the address beside the standard view that it was turned from. */
const CAMERA = "camera";
/** It is written once it has stood for so long, in ms: browsers count how often an address changes. */
const STOOD = 200;

export class Workbench {
  readonly scene: Scene;
  private readonly viewport = make("div", { className: "viewport" });
  private readonly screen = make("div", { className: "screen" });
  readonly panel = make("div", { className: "panel" });
  /** Over head and panel: what the answer may be trusted with. */
  readonly strip = make("div", { className: "strip" });
  /** Over the head, below: what it is about. */
  readonly caption = make("p", { className: "caption" });
  private readonly legend = make("figure", { className: "legend", hidden: true });
  private readonly colours = make("div", { className: "row" });
  private readonly views = make("div", { className: "row views", role: "group" });
  private readonly sides = make("div", { className: "halves", hidden: true });
  /** Where what is seen comes from, for saved pictures. */
  provenance = "";
  private maps: SkinMap[] = [];
  private map: SkinMap | undefined;
  private range_mm = 10;
  private turning: ReturnType<typeof setTimeout> | undefined;
  private readonly keys = (event: KeyboardEvent) => this.pressed(event);

  constructor(private readonly app: App, crumbs: HTMLElement) {
    const { words } = app;
    this.scene = new Scene(this.screen, words.headLabel);
    this.scene.turned = () => {
      clearTimeout(this.turning);
      this.turning = setTimeout(() => note({ [CAMERA]: this.scene.turnedTo.join(",") }), STOOD);
    };
    // Colours come with the skin, and have their room before.
    this.colours.append(select(words.map, [["", words.plain]], "", () => {}));
    this.screen.append(this.sides, this.legend, this.caption);
    this.viewport.append(this.tools(), this.screen);
    app.stage.replaceChildren(make("div", { className: "bench" }, crumbs, this.strip, this.viewport, this.panel));
    app.stage.classList.add("wide");
    addEventListener("keydown", this.keys);
  }

  /** Further keys of a view. */
  canvasKeys(pressed: (event: KeyboardEvent) => void): void {
    this.app.stage.addEventListener("keydown", pressed);
  }

  /** A part of the panel under a heading. */
  section(title: string, ...children: (Node | string | undefined | false)[]): HTMLElement {
    const section = make("section", {}, make("h2", {}, title), ...children);
    // A table that is called as its section is needs no second heading.
    for (const caption of section.querySelectorAll("caption")) caption.classList.toggle("hidden", caption.textContent === title);
    this.panel.append(section);
    return section;
  }

  /** What went wrong, in the place of what was waited for. */
  refuse(error: unknown): void {
    for (const wait of this.panel.querySelectorAll(".wait")) wait.remove();
    this.strip.replaceChildren();
    this.panel.append(refusal(error, this.app.words));
  }

  /** What the left and the right half show, or that there is one. */
  halves(names: [string, string] | undefined): void {
    this.sides.hidden = names === undefined;
    this.sides.replaceChildren(...(names ?? []).map((name) => make("span", {}, make("b", { title: name }, name))));
  }

  /** Turns to the view of the address as it is now. */
  start(): void {
    const { state } = read(location.hash);
    this.viewed(state.get("view") ?? "4");
    this.scene.view(state.get("view") ?? "4");
    const turned = (state.get(CAMERA) ?? "").split(",").map(Number);
    if (turned.length === 6 && turned.every(Number.isFinite) && turned[2]! > 0) this.scene.turnTo(turned as Turned);
    this.setLook((state.get("look") ?? "solid") as SkinLook);
  }

  /** `usual` is the one that is shown where the address names none. */
  offer(maps: SkinMap[], usual = ""): void {
    const { words, route } = this.app;
    this.maps = maps;
    const wanted = new URLSearchParams(location.hash.split("?")[1] ?? "").get(SHOWN) ?? route.state.get(SHOWN) ?? usual;
    const options = [["", words.plain] as const, ...maps.map(({ name, label }) => [name, label] as const)];
    this.colours.replaceChildren(select(words.map, options, wanted, (name) => this.choose(name)));
    this.choose(wanted);
  }

  /** Colours the skin anew, after its values have changed. */
  repaint(): void {
    const { map, scene } = this;
    const values = map?.values();
    if (map?.kinds !== undefined && values !== undefined) scene.tint(values, map.kinds.map(({ colour }) => colour));
    else scene.paint(values, this.range_mm, map?.scheme);
  }

  /** Skin and legend, where kinds have changed too. */
  redraw(): void {
    this.repaint();
    this.drawLegend();
  }

  leave(): void {
    clearTimeout(this.turning);
    removeEventListener("keydown", this.keys);
    this.app.stage.classList.remove("wide");
    this.scene.leave();
  }

  private choose(name: string): void {
    const before = this.map?.name;
    this.map = this.maps.find((map) => map.name === name);
    // The same map of other values keeps the range that was chosen for it.
    if (before !== undefined && before === name) { this.setRange(this.range_mm); return; }
    const stated = Number(new URLSearchParams(location.hash.split("?")[1] ?? "").get("range"));
    this.setRange(this.map?.name === this.app.route.state.get(SHOWN) && RANGES.includes(stated) ? stated : this.map?.range_mm ?? 10);
    note({ [SHOWN]: name });
  }

  private setRange(range_mm: number): void {
    this.range_mm = range_mm;
    note({ range: this.map === undefined || range_mm === this.map.range_mm ? undefined : String(range_mm) });
    this.repaint();
    this.drawLegend();
  }

  private drawLegend(): void {
    const { map, legend, app: { words } } = this;
    legend.hidden = map === undefined;
    if (map === undefined) return;
    const swatch = (colour: Rgb) => {
      const one = make("span", { className: "swatch" });
      one.style.backgroundColor = css(colour);
      return one;
    };
    if (map.kinds !== undefined) {
      legend.replaceChildren(make("figcaption", {}, map.label), make("ul", {}, ...map.kinds.map(({ name, colour }) => make("li", {}, swatch(colour), name))));
      return;
    }
    const swatches = bands(map.scheme).map(swatch);
    const numbers = ticks(this.range_mm, map.scheme).filter((_, at) => at % 2 === 0).map((value) => make("span", {}, figure(value)));
    legend.replaceChildren(
      make("figcaption", {}, `${map.label}, ${map.unit ?? "mm"}`),
      make("div", { className: "bands", aria: { hidden: "true" } }, ...swatches),
      make("div", { className: "ticks" }, ...numbers),
      select(words.range, RANGES.map((range) => [String(range), `${range} ${map.unit ?? "mm"}`] as const), String(this.range_mm),
        (value) => this.setRange(Number(value))));
  }

  private tools(): HTMLElement {
    const { words } = this.app;
    const views = Object.keys(VIEWS).map((key) =>
      button(key, () => this.setView(key), { title: words.view[key]!, data: { view: key }, aria: { label: `${key}: ${words.view[key]}`, keyshortcuts: key } }));
    const look = choice(words.look, [["solid", words.solid], ["through", words.through], ["hidden", words.hidden]] as const,
      (this.app.route.state.get("look") ?? "solid") as SkinLook, (value) => this.setLook(value));
    this.views.replaceChildren(...views);
    this.views.setAttribute("aria-label", words.views);
    return make("div", { className: "tools" },
      this.views, look, this.colours,
      button(words.picture, () => void this.picture()), button(words.glb, () => this.glb(), { title: words.glbHint }));
  }

  private setView(key: string): void {
    clearTimeout(this.turning);
    this.viewed(key);
    this.scene.view(key);
    note({ view: key, [CAMERA]: undefined });
  }

  /** Says which standard view it is, or was before it was turned by hand. */
  private viewed(key: string): void {
    for (const one of this.views.children) one.setAttribute("aria-pressed", String((one as HTMLElement).dataset.view === key));
  }

  private setLook(look: SkinLook): void {
    this.scene.look(look);
    note({ look: look === "solid" ? undefined : look });
  }

  private pressed(event: KeyboardEvent): void {
    const typing = event.target instanceof HTMLInputElement && event.target.type !== "range" && event.target.type !== "radio";
    const elsewhere = typing || event.target instanceof HTMLTextAreaElement || event.target instanceof HTMLSelectElement;
    if (elsewhere || event.ctrlKey || event.metaKey || event.altKey) return;
    if (VIEWS[event.key] !== undefined) this.setView(event.key);
    else if (event.target === this.scene.canvas) this.scene.turnByKey(event);
  }

  /** The surfaces that are seen, with the chosen map, what it is and what it is not. */
  private glb(): void {
    const { map, scene, range_mm, app: { words } } = this;
    const values = map?.values();
    const colours = values !== undefined && map !== undefined ? Array.from(values, (value) => map.kinds?.[value]?.colour ?? bandOf(value, range_mm, map.scheme)) : undefined;
    const parts = scene.seen().map((part) => (part.name !== SEEN.skin || map === undefined || values === undefined || colours === undefined ? part
      : { ...part, colours, values: { name: `_${map.name.toUpperCase()}`, of: values } }));
    const coloured = map === undefined || map.kinds !== undefined ? {} : { map: { label: map.label, unit: map.unit ?? "mm", range: [map.scheme === "signed" ? -range_mm : 0, range_mm] } };
    save(writeGlb(parts, scene.axes, {
      notice: words.notice, provenance: this.provenance, caption: this.caption.textContent ?? "", view: location.hash.split("?")[0], created: new Date().toISOString(), ...coloured,
    }), "facies.glb");
  }

  /** What is seen, with its legend, what it is and what it is not. */
  private async picture(): Promise<void> {
    const drawn = this.scene.drawNow();
    const legend = this.map === undefined ? 0 : 64;
    const foot = drawn.height + legend;
    const canvas = make("canvas", { width: drawn.width, height: foot + 118 });
    const pen = canvas.getContext("2d")!;
    pen.fillStyle = PAPER;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(drawn, 0, 0);
    if (this.map !== undefined) this.legendInto(pen, foot);
    pen.fillStyle = INK;
    pen.font = "20px sans-serif";
    [...this.sides.children].forEach((half, at) => { pen.fillText(half.textContent ?? "", (0.22 + 0.5 * at) * canvas.width, 40); });
    pen.fillText(this.caption.textContent ?? "", 16, foot + 50, canvas.width - 32);
    pen.font = "16px sans-serif";
    pen.fillText(`facies · ${new Date().toISOString()} · ${location.hash.split("?")[0]}`, 16, foot + 78, canvas.width - 32);
    pen.fillText([this.provenance, this.app.words.notice].filter((part) => part !== "").join(" · "), 16, foot + 106, canvas.width - 32);
    const content = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
    if (content !== null) save(content, "facies.png");
  }

  private legendInto(pen: CanvasRenderingContext2D, bottom: number): void {
    const { map } = this;
    if (map === undefined) return;
    const [left, width, height] = [16, 36, 20];
    if (map.kinds !== undefined) {
      pen.font = "18px sans-serif";
      let x = left;
      for (const { name, colour } of map.kinds) {
        pen.fillStyle = css(colour);
        pen.fillRect(x, bottom - 40, height, height);
        pen.fillStyle = INK;
        pen.fillText(name, x + 26, bottom - 24);
        x += 50 + pen.measureText(name).width;
      }
      return;
    }
    bands(map.scheme).forEach((colour, at) => {
      pen.fillStyle = css(colour);
      pen.fillRect(left + at * width, bottom - 60, width, height);
    });
    pen.fillStyle = INK;
    pen.font = "18px sans-serif";
    ticks(this.range_mm, map.scheme).forEach((value, at) => { if (at % 2 === 0) pen.fillText(figure(value), left + at * width, bottom - 18); });
    pen.fillText(`${map.label}, ${map.unit ?? "mm"}`, left + (BANDS + 1) * width, bottom - 44);
  }
}
