// What cases, jobs and plans are called: by their names, by what they move, and by the ends of their ids, which begin with their time.
import type { Documents, Job } from "../api.js";
import type { FrameName } from "../frame.js";
import { fromDocument, pivotsOf } from "../plan.js";
import { when } from "../figures.js";
import type { Words } from "../words/en.js";
import { kindOf } from "./kinds.js";
import { told } from "./movements.js";

/** The end of an id tells it from those that were made at the same time. */
export const tail = (id: string): string => `…${id.slice(-6)}`;

/** A stored plan by its name, or by the end of its id. */
export const planName = ({ id, plan }: Documents["PlanView"]): string => plan.name ?? tail(id);

/** A name where there is room for few letters: its beginning. */
export const short = (name: string, letters = 26): string => (name.length > letters ? `${name.slice(0, letters - 1).trimEnd()}…` : name);

/** A plan of the service in a line; segments alone where it moves them in a way that six numbers do not say. */
export function planInWords(words: Words, plan: Documents["PlanDocument"], frame: FrameName): string {
  const shown = fromDocument(plan, pivotsOf(plan, frame), frame);
  return shown === undefined ? (plan.segments ?? []).map(({ name }) => name).join(", ") : told(shown, words, plan.frame ?? frame);
}

/** What a job is of, as far as its result says; empty where it does not. */
export function aboutJob(words: Words, { results, error }: Job): string {
  const plan = results?.optimisation?.plan ?? results?.provenance?.plan ?? undefined;
  if (plan !== undefined) return [plan.name ?? "", planInWords(words, plan, results?.provenance?.frame ?? "unspecified")].filter((part) => part !== "").join(": ");
  if (results?.learning) return results.learning.method;
  return error === undefined || error === null ? (results?.cohort?.groups ?? []).map(({ name }) => name).join(", ") : "";
}

/** A job in a menu. */
export function jobInWords(words: Words, job: Job): string {
  return [kindOf(words, job.kind), aboutJob(words, job), when(job.created), tail(job.id)].filter((part) => part !== "").join(" · ");
}
