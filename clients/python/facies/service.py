"""The service at an address: documents go in, arrays come out, refusals are exceptions."""

from __future__ import annotations

import json
import re
from collections.abc import Generator, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from .errors import JobFailed, Refused, Unreachable
from .patience import BROKEN, Patience
from .response import Response
from .results import Applied, Case, Comparison, Optimisation, Prediction
from .sending import Document, File, Progress, Secrets, Sending, authorization
from .surface import Surface

WAIT = {"Prefer": "wait=30"}
# Longer than the service waits for a job, or is silent in a stream.
PATIENCE_S = 60.0
SKIN = "skin.glb"
BUSY = (429, 503)
# What a proxy says of a service that it does not reach. The request may have reached it.
OF_PROXY = (502, 504)
ENDED = ("successful", "failed", "dismissed")
# Of the spec of a case file: what names the job and its files. All else says how tissue is computed.
OF_FILES = ("kind", "case", "outputs", "range_mm", "keep", "tags")


class Facies:
    """The service at `address`, with a key where it asks for one. A busy one is waited for, `patience_s` in all; so is one that is out of
    reach, as while it is started again, by requests that only read. Whatever asks raises `Unreachable` where it gets no answer."""

    def __init__(self, address: str, key: str | None = None, patience_s: float = PATIENCE_S) -> None:
        self.patience_s = patience_s
        self._http = httpx.Client(base_url=address, headers=authorization(key), timeout=PATIENCE_S)
        self._secrets = Secrets(address, key)

    def __enter__(self) -> Facies:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections."""
        self._http.close()

    def ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        """The answer to any request; raises `Refused` where it is a refusal, and `Unreachable` where there is none. One that may change
        something is sent again to a busy service alone, unless it has an `Idempotency-Key`."""
        patience = Patience(self.patience_s)
        may_repeat = method in ("GET", "HEAD") or "Idempotency-Key" in httpx.Headers(request.get("headers"))
        while True:
            try:
                answer = self._http.request(method, path, **request)
            except BROKEN as error:
                if may_repeat and patience.pause():
                    continue
                raise unreachable(method, path, error, self._secrets) from error
            if answer.is_success:
                return answer
            passes = BUSY + OF_PROXY if may_repeat else BUSY
            if answer.status_code not in passes or not patience.pause(retry_after(answer)):
                raise refusal(answer, self._secrets)

    def _document(self, method: str, path: str, **request: Any) -> Document:
        """The document that answers a request."""
        answer = self.ask(method, path, **request)
        try:
            document = answer.json()
        except (ValueError, RecursionError):
            document = None
        if not isinstance(document, dict):
            raise of_another(answer, self._secrets)
        return document

    def upload(self, mesh: File | bytes, *, units: str = "mm", frame: str = "unspecified",
               progress: Progress | None = None) -> str:
        """The id of a mesh. The same bytes are the same mesh."""
        content = Sending(mesh, progress)
        headers = {"Content-Type": "application/octet-stream", "Content-Length": str(content.total)}
        made = self._document("POST", "/v1/meshes", content=content, params={"units": units, "frame": frame}, headers=headers)
        return str(made["id"])

    def case(self, case: File | Document, *, progress: Progress | None = None) -> Case:
        """Stores a case. A file is a `case.json` of the command line, which names meshes by their paths and may say in its
        `spec` how it is computed; a document names them by their ids, or by `Path`. One with a `meshing` has a scan or
        surfaces instead, and is waited for until it is meshed; raises `JobFailed` where that fails."""
        spec: Document = {}
        if isinstance(case, dict):
            document = self._with_meshes(case, Path(), Path, progress)
        else:
            file = json.loads(Path(case).read_text(encoding="utf-8"))
            document = self._with_meshes(file.get("case", file), Path(case).parent, str, progress)
            spec = {name: value for name, value in file.get("spec", {}).items() if name not in OF_FILES}
        made = self._document("POST", "/v1/cases", json=document)
        if made.get("state") == "meshing":
            self._ended(self._document("GET", f"/v1/jobs/{made['meshing']['job']}"), progress)
            made = self._document("GET", f"/v1/cases/{made['id']}", headers=WAIT)
        return Case(made["id"], made["case"], made.get("check"), spec)

    def predict(self, case: Case | File | Document, plan: Document, *, fixed: Sequence[str] = (),
                skin: str | None = None, frame: str | None = None, units: str | None = None,
                progress: Progress | None = None, **spec: Any) -> Prediction:
        """The skin after a plan. A file that is not a `.json` is a volume mesh: `fixed` and `skin` name its node sets,
        and so do the segments of the plan; `frame` (LPS) and `units` (mm) are its own. With a plan that has an `osteotomy` the
        file is a scan, whose bone it cuts. `spec` has further members of the job, such as `method`. Raises `TypeError` where
        what is of a mesh is given without one; a plan states its frame itself."""
        is_file = isinstance(case, (str, PathLike)) and Path(case).suffix != ".json"
        stated = {"fixed": fixed or None, "skin": skin, "frame": frame, "units": units}
        strange = [f"`{name}`" for name, value in stated.items() if value is not None]
        if strange and (not is_file or "osteotomy" in plan):
            raise TypeError(f"{', '.join(strange)}: of a volume mesh alone; a case and a scan have their own, and `frame` of a plan "
                            "is a member of the plan")
        if isinstance(case, (str, PathLike)) and "osteotomy" in plan:
            case = case_of_scan(case, plan)
            plan = {name: value for name, value in plan.items() if name != "osteotomy"}
        elif isinstance(case, (str, PathLike)) and is_file:
            case = case_of_mesh(case, plan, fixed, skin) | {"frame": "LPS" if frame is None else frame,
                                                          "units": "mm" if units is None else units}
        outputs = spec.pop("outputs", ["skin.vtp", SKIN])
        stored = self._stored(case, progress)
        job = self.run({"kind": "predict", "case": stored.id, "plan": plan,
                        "outputs": sorted({*outputs, SKIN}), **stored.spec, **spec}, progress)
        return Prediction(job["id"], self._skin(job), job["results"])

    def response(self, case: Case | File | Document, *, progress: Progress | None = None, **spec: Any) -> Response:
        """The columns of a case, with which plans take milliseconds."""
        stored = self._stored(case, progress)
        id_ = stored.id
        job = self.run({"kind": "response", "case": id_, **stored.spec, **spec}, progress)
        path, which = f"/v1/cases/{id_}/response", {"job": job["id"]}

        def form(media_type: str) -> httpx.Response:
            return self.ask("GET", path, params=which, headers={"Accept": media_type})

        description = self._document("GET", path, params=which, headers={"Accept": "application/json"})
        columns = np.frombuffer(form("application/octet-stream").content, "<f4")
        columns = columns.reshape(description["columns"]["count"], -1, 3)
        rest = Surface.from_glb(form("model/gltf-binary").content)
        second = None
        if "second_order" in description:
            answer = self.ask("GET", path, params={**which, "order": 2}, headers={"Accept": "application/octet-stream"})
            second = np.frombuffer(answer.content, "<i2").reshape(description["second_order"]["columns"]["count"], -1, 3)
        return Response(id_, job["id"], description, columns, rest, second)

    def apply(self, response: Response, plan: Document) -> Applied:
        """How far each node of the skin goes as the service computes it, which refuses plans beyond its limits, and what
        it says of that: warnings, and the estimated linearisation error."""
        said = self._document("POST", f"/v1/cases/{response.case}/response/apply", json={"plan": plan},
                              params={"job": response.job}, headers={"Accept": "application/json"})
        return Applied(np.array(said.pop("displacement_mm"), dtype=np.float32), said)

    def optimise(self, case: Case | File | Document, targets: list[Document], bounds: Document, *,
                 progress: Progress | None = None, **spec: Any) -> Optimisation:
        """The plan within `bounds` that brings the skin nearest to `targets`."""
        outputs = spec.pop("outputs", ["skin.vtp", SKIN])
        stored = self._stored(case, progress)
        job = self.run({"kind": "optimise", "case": stored.id, "targets": targets, "bounds": bounds,
                        "outputs": sorted({*outputs, SKIN}), **stored.spec, **spec}, progress)
        return Optimisation(job["id"], self._skin(job), job["results"])

    def compare(self, prediction: Prediction, actual: Prediction | File, *, units: str | None = None, frame: str | None = None,
                progress: Progress | None = None, **spec: Any) -> Comparison:
        """A predicted skin against another, or against the surface in a file in `units` (mm) and `frame`: if none is stated, that
        which the file is marked with, else LPS."""
        if isinstance(actual, Prediction):
            if units is not None or frame is not None:
                raise TypeError("`units` and `frame` go with a file; a predicted skin has its own")
            mesh = self.upload(self.file(actual.job, "skin.vtp"))
        else:
            mesh = self._surface(Path(actual).read_bytes(), "mm" if units is None else units, frame)
        job = self.run({"kind": "compare", "prediction": {"job": prediction.job},
                        "actual": {"mesh": mesh}, **spec}, progress)
        return Comparison(job["id"], job["results"]["comparison"], job["results"]["warnings"])

    def file(self, job: str, name: str) -> bytes:
        """A file of a result."""
        return self.ask("GET", f"/v1/jobs/{job}/results/{name}").content

    def run(self, spec: Document, progress: Progress | None = None) -> Document:
        """The last state of a job of any kind; raises `JobFailed` where it ended without results. Where `Unreachable` names no `job`, the
        same call finds it again: equal inputs are one job."""
        waits = WAIT if progress is None else {}
        return self._ended(self._document("POST", "/v1/jobs", json=spec, headers=waits), progress)

    def _ended(self, job: Document, progress: Progress | None) -> Document:
        """The last state of a job; raises `JobFailed` where it ended without results."""
        if progress is not None:
            # Where there is no place for a stream, the job is asked for.
            for event in self._follow(job["id"]):
                progress(event)
        while job["status"] in ("accepted", "running"):
            job = self._document("GET", f"/v1/jobs/{job['id']}", headers=WAIT)
        if job["status"] != "successful":
            raise JobFailed(job)
        return job

    def events(self, job: str) -> Iterator[Document]:
        """What happens to a job until it has ended. A stream that breaks is taken up where it broke; raises `Unreachable`, or `Refused`
        where the service is busy, when nothing has come of it for `patience_s`."""
        refused = yield from self._follow(job)
        if refused is not None:
            raise refused

    def _follow(self, job: str) -> Generator[Document, None, Refused | None]:
        """The events, then the refusal of a busy service where they are not all."""
        path, last, patience = f"/v1/jobs/{job}/events", 0, Patience(self.patience_s)
        while True:
            has_ended, told, refused, broken = False, None, None, None
            headers = {"Accept": "text/event-stream", "Last-Event-ID": str(last)}
            try:
                with self._http.stream("GET", path, headers=headers) as answer:
                    if answer.status_code == 204:
                        return None
                    if not answer.is_success:
                        answer.read()
                        told, refused = retry_after(answer), refusal(answer, self._secrets)
                    for line in answer.iter_lines():
                        event = event_of(line)
                        # Not what a proxy has kept.
                        is_new = event is not None and event["number"] > last
                        # Events, and what the service sends in a silent stream.
                        if is_new or line.startswith(":"):
                            patience.renew()
                        if event is not None and is_new:
                            last, has_ended = event["number"], event["status"] in ENDED
                            yield event
            except BROKEN as error:
                has_ended, broken = False, error
            if refused is not None and refused.status not in BUSY + OF_PROXY:
                raise refused
            # After the end there is one more answer, that it was the last.
            if not has_ended and not patience.pause(told):
                if refused is not None:
                    return refused
                raise unreachable("GET", path, broken, self._secrets) from broken

    def _stored(self, case: Case | File | Document, progress: Progress | None) -> Case:
        return case if isinstance(case, Case) else self.case(case, progress=progress)

    def _surface(self, content: bytes, units: str, frame: str | None) -> str:
        """The id of a surface in a frame, or in that of its mark, else in LPS."""
        try:
            return self.upload(content, units=units, frame="LPS" if frame is None else frame)
        except Refused as refused:
            if frame is not None or refused.code != "frame-conflict":
                raise
            return self.upload(content, units=units)

    def _skin(self, job: Document) -> Surface:
        return Surface.from_glb(self.file(job["id"], SKIN))

    def _with_meshes(self, case: Document, folder: Path, kind: type[Path] | type[str],
                     progress: Progress | None) -> Document:
        """The document with the ids of meshes in place of their paths, which are of this type."""
        statement = {"units": case.get("units", "mm"), "frame": case.get("frame", "unspecified")}
        bones = {bone["name"] for bone in case.get("bones", [])}

        def known(value: Any, key: str = "", within: str = "") -> Any:
            if isinstance(value, dict):
                return {name: known(member, name, key) for name, member in value.items()}
            if isinstance(value, list):
                return [known(member) for member in value]
            # A selection may name a bone where it names a surface; `skin` and `bone` are files only as surfaces to mesh.
            is_mesh = (key in ("volume", "mesh", "image", "scan") or (key == "surface" and value not in bones)
                       or (within == "surfaces" and key in ("skin", "bone")))
            is_file = is_mesh and isinstance(value, kind)
            return self.upload(folder / Path(value), **statement, progress=progress) if is_file else value

        document: Document = known(case)
        return document


def case_of_mesh(mesh: File, plan: Document, fixed: Sequence[str], skin: str | None) -> Document:
    """A case of node sets of a volume mesh: each segment of the plan is the set of its name."""
    names = [segment["name"] for segment in plan.get("segments", [])]
    case: Document = {"volume": Path(mesh), "fixed": [{"node_set": name} for name in fixed],
                      "segments": [{"name": name, "nodes": {"node_set": name}} for name in names]}
    return case if skin is None else case | {"skin": {"node_set": skin}}


def case_of_scan(scan: File, plan: Document) -> Document:
    """A case of a scan whose bone is cut by the osteotomy of a plan, in the frame of the plan."""
    meshing: Document = {"kind": "mesh", "scan": Path(scan), "osteotomy": plan["osteotomy"]}
    return {"meshing": meshing | {name: plan[name] for name in ("frame",) if name in plan}}


def refusal(answer: httpx.Response, secrets: Secrets) -> Refused:
    """The problem of an answer, or its status where something between us and the service answered."""
    try:
        return Refused(secrets.hidden(answer.json()))
    except (ValueError, KeyError, TypeError, RecursionError):
        return of_another(answer, secrets)


def of_another(answer: httpx.Response, secrets: Secrets) -> Refused:
    """The status and the beginning of an answer of something between us and the service."""
    # Without secrets before the cut, which would leave a part of them.
    detail = f"{secrets.hidden(str(answer.request.url))} answered {secrets.hidden(answer.text)[:200]!r}"
    return Refused({"status": answer.status_code, "code": "not-of-the-service", "detail": detail})


def event_of(line: str) -> Document | None:
    """The event of a line of a stream, or `None` where it has none; raises `httpx.RemoteProtocolError` where the stream broke in it."""
    if not line.startswith("data:"):
        return None
    try:
        event: Document = json.loads(line[len("data:"):])
        event["number"], event["status"]
    except (ValueError, KeyError, TypeError):
        raise httpx.RemoteProtocolError("the stream ended within an event") from None
    return event


def unreachable(method: str, path: str, error: httpx.HTTPError | None, secrets: Secrets) -> Unreachable:
    """A request without an answer, with the job that is in its path."""
    why = "the stream ended" if error is None else secrets.why(error)
    of_job = re.match("/v1/jobs/([^/?]+)", path)
    return Unreachable(f"{method} {path}", why, of_job and of_job[1])


def retry_after(answer: httpx.Response) -> float | None:
    """The pause that an answer asks for, in seconds as the service sends it; `None` where it has no such number."""
    told = answer.headers.get("Retry-After", "")
    return float(told) if told.isdecimal() else None
