// A typed client of a facies service. `rest.ts` is made from the OpenAPI description of the service; this
// file adds what a description cannot say: how to connect, that a refusal is an exception, how to wait.
import createClient, { type Client } from "openapi-fetch";
import type { components, paths } from "./rest.js";
import { Unreachable } from "./errors.js";
import { heard, Patience } from "./patience.js";
import { authorization, Secrets } from "./sending.js";

export { Unreachable } from "./errors.js";
export type Documents = components["schemas"];
/** What `data` and `error` are read as; files are asked for with `parseAs`. */
type Media = "application/json" | "application/problem+json";
export type Facies = Client<paths, Media>;

/** What no exception shows of clients that `connect` made. */
const secrets = new WeakMap<Facies, Secrets>();

/** For the header Prefer: the longest that one request waits for a job. */
export const WAIT = "wait=30";

/** The service refused a request; `problem` says why. */
export class Refused extends Error {
  constructor(readonly problem: Documents["ProblemDocument"]) {
    const places = (problem.errors ?? []).map((error) => `\n  ${error.pointer}: ${error.detail}`);
    super(`${problem.status} ${problem.code}: ${problem.detail}${places.join("")}`);
  }
}

/** A job ended without results; `job.error` says why. */
export class JobFailed extends Error {
  constructor(readonly job: Documents["StatusInfo"]) {
    super(`job ${job.id} is ${job.status}: ${job.error?.detail ?? job.message}`);
  }
}

/** A client of the service at `address`, with the key of the service where it asks for one. */
export function connect(address: string, key?: string): Facies {
  const facies = createClient<paths, Media>({
    baseUrl: address,
    headers: authorization(key),
    // The service sends no redirect, and the key is for no other one.
    redirect: "error",
    // A file is sent as it is.
    bodySerializer: (body) => ((body as unknown) instanceof Blob ? body : JSON.stringify(body)),
  });
  secrets.set(facies, new Secrets(address, key));
  return facies;
}

/** What the service answered; throws `Refused` where it is a refusal. */
export async function answered<T>(
  answer: Promise<{ data?: T; error?: Documents["ProblemDocument"]; response?: Response }>,
): Promise<T> {
  const { data, error, response } = await answer;
  if (error?.code !== undefined) throw new Refused(error);
  if (response?.ok === false) {
    const said = typeof error === "string" ? error : JSON.stringify(error) ?? "";
    const detail = `${response.url} answered ${said.slice(0, 200)}`;
    throw new Refused({ type: "", title: "", status: response.status, code: "not-of-the-service", detail });
  }
  return data as T;
}

/** Waits until a job has ended well; throws `JobFailed` where it did not, and `Unreachable` with its id where the service gives no
 * answer for `patience_s`. */
export async function ended(
  facies: Facies,
  job: Documents["StatusInfo"],
  patience_s = 60,
): Promise<Documents["StatusInfo"]> {
  const patience = new Patience();
  while (job.status === "accepted" || job.status === "running") {
    const params = { path: { id: job.id }, header: { Prefer: WAIT } };
    try {
      job = await heard((signal) => answered(facies.GET("/v1/jobs/{id}", { params, signal })));
      patience.renew();
    } catch (error) {
      // Of `fetch`.
      if (!(error instanceof TypeError)) throw error;
      if (!await patience.pause(patience_s)) throw new Unreachable("GET", `/v1/jobs/${job.id}`, secrets.get(facies)?.hiddenIn(error) ?? error);
    }
  }
  if (job.status !== "successful") throw new JobFailed(job);
  return job;
}
