// A page with sliders on the columns of a response: segments move, the skin follows within a frame, and the service is asked what
// that leaves out.
import { directions, meaning, type Direction } from "./directions.js";
import { Facies, type Applied, type Documents, type Movement, type Response, type Triple } from "./facies.js";
import { COLOURS, RANGE_MM, View } from "./view.js";

const MOST = { translation_mm: 10, rotation_deg: 10 } as const;
type Moved = { translation_mm: Triple; rotation_deg: Triple; pivot_mm: Triple };

const find = <T extends Element>(selector: string) => document.querySelector<T>(selector)!;
const form = find<HTMLFormElement>("form");
const field = (name: string) => form.elements.namedItem(name) as HTMLInputElement;
const say = (text: string) => { find("#said").textContent = text; };

field("case").value = new URLSearchParams(location.search).get("case") ?? "";
field("address").value = location.origin.startsWith("http") ? location.origin : "http://127.0.0.1:8080";

/** A slider for one number of a movement. */
function slider(direction: Direction, moved: Moved): HTMLLabelElement {
  const { member, axis, sign, words: [low, high] } = direction;
  const limits = { type: "range", min: `${-MOST[member]}`, max: `${MOST[member]}`, step: "0.1", value: "0" };
  const input = Object.assign(document.createElement("input"), limits);
  const shown = Object.assign(document.createElement("output"), { value: meaning(direction, 0) });
  const label = document.createElement("label");
  label.append(`${low} / ${high}`, shown, input);
  // Before what the whole group does.
  input.addEventListener("input", () => {
    moved[member][axis] = sign * input.valueAsNumber;
    shown.value = meaning(direction, input.valueAsNumber);
  });
  return label;
}

/** The sliders of a segment. */
function sliders(name: string, moved: Moved, all: Direction[]): HTMLFieldSetElement {
  const group = document.createElement("fieldset");
  const legend = Object.assign(document.createElement("legend"), { textContent: name });
  group.append(legend, ...all.map((direction) => slider(direction, moved)));
  return group;
}

/** Which colour is how many mm. */
function showLegend(): void {
  const colour = (rgb: readonly number[]) => `rgb(${rgb.map((share) => `${100 * share}%`).join(" ")})`;
  find<HTMLElement>("#legend .ramp").style.background = `linear-gradient(to right, ${COLOURS.map(colour).join(", ")})`;
  find("#legend .words :last-child").textContent = `moves ${RANGE_MM} mm or more`;
  find<HTMLElement>("#legend").hidden = false;
}

/** What the service says of a plan: its linearisation error, and its warnings. */
function showEstimate(applied?: Applied): void {
  const shown = find<HTMLElement>("#estimate");
  const warnings = applied?.warnings.map(({ code, detail }) => `\n${code}: ${detail}`) ?? [];
  shown.classList.toggle("doubtful", warnings.length > 0 || applied?.within_linear_range === false);
  const left = applied?.nonlinearity_estimate_mm ?? undefined;
  const said = left === undefined ? "The linearisation error is unknown." : `Estimated linearisation error: about ${left.toFixed(2)} mm, mean over the skin.`;
  shown.textContent = applied === undefined ? "" : `${said}${warnings.join("")}`;
}

/** The movements of the sliders as a plan of the service. */
function planOf(movements: Record<string, Movement>): Documents["PlanDocument"] {
  return { segments: Object.entries(movements).map(([name, movement]) => ({ name, ...movement })) };
}

function largest(displacement: Float32Array): number {
  let most = 0;
  for (let at = 0; at < displacement.length; at += 3) {
    most = Math.max(most, Math.hypot(displacement[at]!, displacement[at + 1]!, displacement[at + 2]!));
  }
  return most;
}

/** Sliders for the segments of a response, which move its skin. */
function plan(facies: Facies, response: Response): void {
  const view = new View(find<HTMLCanvasElement>("canvas"), response.rest);
  const movements: Record<string, Moved> = {};
  let displacement = response.displacement(movements);
  // Answers to plans that were left meanwhile are passed over.
  let moves = 0;
  const changed = () => {
    moves += 1;
    showEstimate();
    const started = performance.now();
    displacement = response.displacement(movements);
    view.show(displacement);
    const took = performance.now() - started;
    say(`The skin moves ${largest(displacement).toFixed(2)} mm at most; ${took.toFixed(1)} ms`);
    find<HTMLTextAreaElement>("#plan").value = JSON.stringify(planOf(movements), null, 1);
  };
  const asked = () => told(async () => {
    const of = moves;
    const applied = largest(displacement) > 0 ? await facies.apply(response, planOf(movements)) : undefined;
    if (of === moves) showEstimate(applied);
  });
  const all = directions(response.description.frame);
  const build = () => find("#segments").replaceChildren(...response.description.segments.map(({ name, centre_mm }) => {
    movements[name] = { translation_mm: [0, 0, 0], rotation_deg: [0, 0, 0], pivot_mm: centre_mm as Triple };
    return sliders(name, movements[name], all);
  }));
  const segments = find<HTMLElement>("#segments");
  segments.oninput = changed;
  segments.onchange = () => void asked();
  const reset = form.elements.namedItem("reset") as HTMLButtonElement;
  reset.disabled = false;
  reset.onclick = () => {
    build();
    changed();
  };
  showLegend();
  reset.click();
}

/** Does something, and says what went wrong. */
async function told(deed: () => Promise<void>): Promise<void> {
  try {
    await deed();
  } catch (error) {
    say(String(error));
  }
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  void told(async () => {
    const facies = new Facies(field("address").value, field("key").value || undefined);
    const progress = (event: Documents["JobEvent"]) => say(`${event.phase ?? event.status}: ${event.progress} %`);
    plan(facies, await facies.response(field("case").value.trim(), { progress }));
  });
});
