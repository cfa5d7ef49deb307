// A page with sliders on the columns of a response: segments move, and the skin follows within a frame.
import { Facies, type Documents, type Movement, type Response, type Triple } from "./facies.js";
import { View } from "./view.js";

const MOST = { translation_mm: 10, rotation_deg: 10 } as const;
const AXES = ["x", "y", "z"] as const;
type Moved = { translation_mm: Triple; rotation_deg: Triple; pivot_mm: Triple };

const find = <T extends Element>(selector: string) => document.querySelector<T>(selector)!;
const form = find<HTMLFormElement>("form");
const field = (name: string) => form.elements.namedItem(name) as HTMLInputElement;
const say = (text: string) => { find("#said").textContent = text; };

field("case").value = new URLSearchParams(location.search).get("case") ?? "";
field("address").value = location.origin.startsWith("http") ? location.origin : "http://127.0.0.1:8080";

/** A slider for each number of a movement; `changed` is called when one is moved. */
function sliders(name: string, moved: Moved, changed: () => void): HTMLFieldSetElement {
  const group = document.createElement("fieldset");
  group.append(Object.assign(document.createElement("legend"), { textContent: name }));
  for (const kind of ["translation_mm", "rotation_deg"] as const) {
    AXES.forEach((axis, at) => {
      const limits = { type: "range", min: `${-MOST[kind]}`, max: `${MOST[kind]}`, step: "0.1", value: "0" };
      const slider = Object.assign(document.createElement("input"), limits);
      const shown = Object.assign(document.createElement("output"), { value: "0" });
      const label = document.createElement("label");
      label.append(`${kind} ${axis}`, shown, slider);
      slider.addEventListener("input", () => {
        moved[kind][at] = slider.valueAsNumber;
        shown.value = slider.value;
        changed();
      });
      group.append(label);
    });
  }
  return group;
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
  const changed = () => {
    const started = performance.now();
    displacement = response.displacement(movements);
    view.show(displacement);
    const took = performance.now() - started;
    say(`The skin moves ${largest(displacement).toFixed(2)} mm at most; ${took.toFixed(1)} ms`);
    find<HTMLTextAreaElement>("#plan").value = JSON.stringify(planOf(movements), null, 1);
  };
  const groups = response.description.segments.map(({ name, centre_mm }) => {
    movements[name] = { translation_mm: [0, 0, 0], rotation_deg: [0, 0, 0], pivot_mm: centre_mm as Triple };
    return sliders(name, movements[name], changed);
  });
  find("#segments").replaceChildren(...groups);
  const button = form.elements.namedItem("apply") as HTMLButtonElement;
  button.disabled = false;
  button.onclick = () => told(async () => {
    const answer = await facies.apply(response, planOf(movements));
    const apart = largest(answer.displacement_mm.map((value, at) => value - displacement[at]!));
    say(`The service says the same to ${apart.toExponential(1)} mm`);
  });
  changed();
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
