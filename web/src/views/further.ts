// What else may be asked of a prediction: stress in the tissue, materials of the literature, a correction by what was learned.
import type { CaseDocument, Job } from "../api.js";
import { refusal, type App } from "../app.js";
import { make, select } from "../dom.js";
import { when } from "../figures.js";
import { tail } from "./called.js";
import { inSpec, materialChoices, type Presets } from "./materials.js";

/** Members of a spec; `outputs` come beside the usual ones. */
interface Asked {
  outputs: string[];
  stress?: true;
  materials?: Record<string, object>;
  correction?: { model: string };
}

export class Further {
  readonly element: HTMLElement;
  private stress = false;
  private presets: Presets = {};
  private model = "";

  /** `corrected` is told that a model is chosen. */
  constructor(private readonly app: App, document: CaseDocument, private readonly corrected: () => void) {
    const { words } = app;
    const box = make("input", { type: "checkbox" });
    box.addEventListener("change", () => { this.stress = box.checked; });
    const models = make("details", {}, make("summary", {}, words.correction), make("div", { className: "stack" }));
    models.addEventListener("toggle", () => void this.list(models.querySelector("div")!));
    this.element = make("div", { className: "stack wide" }, make("label", { className: "check" }, box, make("span", {}, words.withStress)),
      materialChoices(app, document, (presets) => { this.presets = presets; }), models);
  }

  get asked(): Asked {
    const materials = inSpec(this.presets);
    return {
      outputs: this.stress ? ["volume.vtu"] : [], ...(this.stress ? { stress: true } : {}),
      ...(materials === undefined ? {} : { materials }), ...(this.model === "" ? {} : { correction: { model: this.model } }),
    };
  }

  /** The models that there are, once they are asked for. */
  private async list(into: HTMLElement): Promise<void> {
    const { service, words } = this.app;
    if (into.childElementCount > 0) return;
    try {
      const jobs = await service.list<Job>("/v1/jobs?kind=learn&status=successful", 50);
      const label = ({ id, created, results }: Job) => `${results?.learning?.method ?? ""} · ${when(created)}${results?.learning?.helps === false ? ` · ${words.learningHarms}` : ""} · ${tail(id)}`;
      const choose = (model: string) => { this.model = model; if (model !== "") this.corrected(); };
      into.replaceChildren(make("p", { className: "fine" }, words.correctionHint),
        jobs.length === 0 ? make("p", {}, words.noModels) : select(words.model, [["", words.none], ...jobs.map((job) => [job.id, label(job)] as const)], "", choose));
    } catch (error) {
      into.replaceChildren(refusal(error, words));
    }
  }
}
