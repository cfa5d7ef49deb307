"""A typed client of a facies service.

`facies_client.rest` is made from the OpenAPI description of the service: a function for each operation, a
class for each document. This file adds what a description cannot say: how to connect, that a refusal is
an exception, and how to wait.
"""

from __future__ import annotations

from typing import TypeVar

import httpx

from facies.errors import Unreachable
from facies.patience import BROKEN, Patience
from facies.sending import Secrets, authorization

from .rest import Client
from .rest.api.jobs import show_job
from .rest.models import ProblemDocument, StatusInfo
from .rest.types import Unset

T = TypeVar("T")

WAIT = "wait=30"
"""For the header Prefer: the longest that one request waits for a job."""


class Refused(Exception):
    """The service refused a request; `problem` says why."""

    def __init__(self, problem: ProblemDocument) -> None:
        errors = [] if isinstance(problem.errors, Unset) else problem.errors
        places = "".join(f"\n  {error.pointer}: {error.detail}" for error in errors)
        super().__init__(f"{problem.status} {problem.code}: {problem.detail}{places}")
        self.problem = problem


class JobFailed(Exception):
    """A job ended without results; `job.error` says why."""

    def __init__(self, job: StatusInfo) -> None:
        why = "" if isinstance(job.error, Unset) else f": {job.error.detail}"
        super().__init__(f"job {job.id} is {job.status}{why}")
        self.job = job


def connect(address: str, key: str | None = None) -> Client:
    """A client of the service at `address`, with the key of the service where it asks for one."""
    # Longer than the service waits for a job.
    patience = httpx.Timeout(60)
    return Client(base_url=address, headers=authorization(key), timeout=patience, raise_on_unexpected_status=True)


def secrets_of(client: Client) -> Secrets:
    """What no exception shows of a client that `connect` made."""
    return Secrets(client._base_url, client._headers.get("Authorization", "").removeprefix("Bearer "))


def answered(answer: T | ProblemDocument | None) -> T:
    """What the service answered; raises `Refused` where it is a refusal."""
    if isinstance(answer, ProblemDocument):
        raise Refused(answer)
    assert answer is not None, "every described answer of the operation has a body"
    return answer


def present(member: T | Unset) -> T:
    """A member of a document that is there in this answer; raises `KeyError` where it is not."""
    if isinstance(member, Unset):
        raise KeyError("the answer does not have this member")
    return member


def ended(client: Client, job: StatusInfo, patience_s: float = 60.0) -> StatusInfo:
    """Waits until a job has ended well; raises `JobFailed` where it did not, and `facies.Unreachable` with its id where the service
    gives no answer for `patience_s`."""
    patience = Patience(patience_s)
    while job.status in ("accepted", "running"):
        try:
            job = answered(show_job.sync(job.id, client=client, prefer=WAIT))
            patience.renew()
        except BROKEN as error:
            if not patience.pause():
                raise Unreachable(f"GET /v1/jobs/{job.id}", secrets_of(client).why(error), str(job.id)) from error
    if job.status != "successful":
        raise JobFailed(job)
    return job
