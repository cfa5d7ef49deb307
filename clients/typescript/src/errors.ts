// Refusals of the service as exceptions with their code.
import type { components } from "./rest.js";

type Documents = components["schemas"];

/** Something that the service says went wrong; `code` is a word of docs/errors.md. */
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
