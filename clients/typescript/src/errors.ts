// Refusals of the service, and its absence, as exceptions with their code.
import type { components } from "./rest.js";

type Documents = components["schemas"];

/** Something went wrong; `code` is a word of docs/errors.md, or `unreachable`. */
export class FaciesError extends Error {
  constructor(readonly code: string, detail: string) {
    super(`${code}: ${detail}`);
  }
}

/** A request was refused; `problem.errors` tells each mistake of a document, `pointer` the place of the first. */
export class Refused extends FaciesError {
  readonly pointer: string | undefined;

  constructor(readonly problem: Documents["ProblemDocument"]) {
    // Of a single one the sentence tells the place already.
    const several = (problem.errors?.length ?? 0) > 1 ? problem.errors! : [];
    const places = several.map((error) => `\n  ${error.pointer}: ${error.detail}`);
    super(problem.code, problem.detail + places.join(""));
    this.pointer = problem.errors?.[0]?.pointer;
  }
}

/** A request got no answer. `job` is the id of the job that it was about, which the service goes on with; `undefined` where it was about
 * none, or the answer would have told its id. What `fetch` said is the `cause`. */
export class Unreachable extends FaciesError {
  readonly job: string | undefined;

  constructor(method: string, path: string, cause?: unknown) {
    const why = cause === undefined ? "the stream ended" : cause instanceof Error ? cause.message : String(cause);
    super("unreachable", `no answer to ${method} ${path}: ${why}`);
    this.cause = cause;
    this.job = /^\/v1\/jobs\/([^/?]+)/.exec(path)?.[1];
  }
}

/** What was given as a key is none; it is not shown. */
export class NoKey extends Error {
  constructor() {
    super("the key has white space within it, a control character or one beyond ASCII, as no key has");
  }
}

/** A job ended without results; `job` is its last state. */
export class JobFailed extends FaciesError {
  constructor(readonly job: Documents["StatusInfo"]) {
    super(job.error?.type ?? job.status, job.error?.detail ?? job.message);
  }
}
