"""Refusals of the service, and its absence, as exceptions with their code."""

from __future__ import annotations

from typing import Any


class FaciesError(Exception):
    """Something went wrong; `code` is a word of docs/errors.md, or `unreachable`."""

    def __init__(self, code: str, detail: str) -> None:
        super().__init__(f"{code}: {detail}")
        self.code = code
        self.detail = detail


class Refused(FaciesError):
    """A request was refused. `errors` tells each mistake of a document by `pointer`, `code` and `detail`;
    `pointer` is the place of the first."""

    def __init__(self, problem: dict[str, Any]) -> None:
        self.problem = problem
        self.status = int(problem["status"])
        self.errors: list[dict[str, Any]] = problem.get("errors", [])
        self.pointer: str | None = self.errors[0]["pointer"] if self.errors else None
        # Of a single one the sentence tells the place already.
        several = self.errors if len(self.errors) > 1 else []
        places = "".join(f"\n  {error['pointer']}: {error['detail']}" for error in several)
        super().__init__(problem["code"], problem["detail"] + places)


class Unreachable(FaciesError):
    """A request got no answer. `job` is the id of the job that it was about, which the service goes on with; `None` where it was about
    none, or the answer would have told its id. What httpx said is the `__cause__`."""

    def __init__(self, request: str, why: str, job: str | None = None) -> None:
        super().__init__("unreachable", f"no answer to {request}: {why}")
        self.job = job


class JobFailed(FaciesError):
    """A job ended without results; `job` is its last state."""

    def __init__(self, job: dict[str, Any]) -> None:
        self.job = job
        error = job.get("error", {})
        super().__init__(error.get("type", job["status"]), error.get("detail", job["message"]))
