#!/usr/bin/env python3
"""Posts a study of validation cases to a facies service and fails where it found a regression.

The study is a document as for `facies study --spec`: its cases are files beside it, with a case and a plan.
Meshes and cases that the service has already are not sent again, and rows that it has solved before are not solved again.
Needs Python and nothing else.

    facies_gate.py study.json --baseline-tag main

is the first run and every later one: where no study has the tag yet, this one gets it and is the baseline of those that
follow. With `--tag` later ones get a tag as well, and a later run is compared with the newest that has it. A study gets these
tags when its outcome is `pass` and not before, so that none that is worse is ever a baseline.

Exit codes, those of `facies study`: 0 pass, 1 worse or failed, 2 refused input or an error of the gate itself, 3 the service
is out of reach, 4 incomplete, 5 no baseline. White space around FACIES_ADDRESS and FACIES_API_KEY is not part of them.
No redirect is followed, and nothing printed or written has the key.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import html
import http.client
import json
import math
import os
import pathlib
import re
import sys
import time
import traceback
import urllib.error
import urllib.parse
import urllib.request

EXIT_CODES = {"pass": 0, "worse": 1, "incomplete": 4, "no-baseline": 5}
FAILED, REFUSED, OUT_OF_REACH = 1, 2, 3
# No job has this id: a baseline that is asked for and not there is the service's to judge.
NO_JOB = "00000000-0000-7000-8000-000000000000"
JOB = re.compile("[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")
# The longest silence of an answer; one that comes slowly may take the patience more.
ANSWER_S = 90.0
# Of what answers and is no facies service, so many characters are told.
TOLD = 200
# Rows whose reasons are printed, and the longest silence while a study is solved.
LINES, SILENCE_S = 20, 60.0
# Of the spec of a case file: what names the job and its files. All else decides numbers, and a study states that itself.
OF_FILES = ("kind", "case", "outputs", "range_mm", "keep", "tags")


class Stop(Exception):
    """The gate ends here, with an exit code and a sentence for each mistake."""

    def __init__(self, code: int, *why: str) -> None:
        super().__init__(*why)
        self.code = code


class NoRedirect(urllib.request.HTTPRedirectHandler):
    """A redirect is an error as others are: the service sends none, and the key is not for anybody else."""

    def http_error_302(self, req, fp, code, msg, headers):
        return None

    http_error_301 = http_error_303 = http_error_307 = http_error_308 = http_error_302


class Answer(dict):
    """An object of an answer; a service that leaves out what facies says is none."""

    def __init__(self, asked: str, members: dict) -> None:
        super().__init__(members)
        self.asked = asked

    def __missing__(self, name: object):
        raise Stop(OUT_OF_REACH, f"{self.asked} without {name!r}")


class Service:
    """The service at an address; busy and silent moments are waited out."""

    def __init__(self, address: str, key: str | None, patience_s: float) -> None:
        self.address = checked(address)
        self.patience_s = patience_s
        self.headers = authorization(key)
        self.opener = urllib.request.build_opener(NoRedirect)

    def ask(self, method: str, path: str, body: bytes | None = None, **headers: str):
        """The body and the headers of the answer."""
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        request = urllib.request.Request(
            self.address + path, data=body, method=method, headers={**self.headers, **headers})
        until = time.monotonic() + self.patience_s
        usual = 1.0
        while True:
            pause, usual = usual, min(2 * usual, 20.0)
            try:
                with self.opener.open(request, timeout=ANSWER_S) as answer:
                    return whole(answer, self.patience_s + ANSWER_S), answer.headers
            except urllib.error.HTTPError as error:
                why = f"{method} {path.partition('?')[0]}: {error.code}"
                if 300 <= error.code < 400:
                    why = f"{why} is a redirect, which is not followed: FACIES_ADDRESS has to be that of the service itself"
                    raise Stop(REFUSED, why) from error
                why = f"{why} {in_words(text_of(error, self.patience_s + ANSWER_S))}"
                if error.code < 500 and error.code != 429:
                    raise Stop(REFUSED, why) from error
                # In seconds, as the service sends it.
                told = error.headers.get("Retry-After") or ""
                pause = max(float(told), 1.0) if told.isdecimal() else pause
            except (OSError, http.client.HTTPException) as error:
                why = f"{method} {path}: {error}"
            if time.monotonic() + pause > until:
                raise Stop(OUT_OF_REACH, why)
            time.sleep(pause)

    def document(self, method: str, path: str, body: object = None, **headers: str):
        """The JSON of the answer to JSON, or to the bytes of a file."""
        data = body if body is None or isinstance(body, bytes) else json.dumps(body).encode()
        if data is not None:
            headers["Content_Type"] = "application/octet-stream" if data is body else "application/json"
        answer, _ = self.ask(method, path, data, **headers)
        asked = f"{self.address} is no facies service: {method} {path.partition('?')[0]} is answered"
        found = None
        # A number of thousands of digits is a `ValueError`, too.
        with contextlib.suppress(ValueError, RecursionError):
            found = json.loads(answer, object_hook=lambda members: Answer(asked, members))
        # An id goes into addresses, and into a file from which a pipeline reads its outputs line by line.
        if not isinstance(found, dict) or not re.fullmatch("[0-9A-Za-z_-]*", str(found.get("id", ""))):
            raise Stop(OUT_OF_REACH, f"{asked} with {told_of(answer.decode(errors='replace'))!r}")
        return found


def whole(answer, seconds: float) -> bytes:
    """The body of an answer, which may come slowly, but not for longer than that."""
    until = time.monotonic() + seconds
    content = bytearray()
    while piece := answer.read1(1 << 16):
        content += piece
        if time.monotonic() > until:
            raise TimeoutError(f"the answer is not whole after {seconds:.0f} s")
    # By pieces, the end of the connection is taken for that of the body.
    stated = answer.headers.get("Content-Length") or ""
    if stated.isdecimal() and len(content) < int(stated):
        raise http.client.IncompleteRead(bytes(content), int(stated) - len(content))
    return bytes(content)


def text_of(error: urllib.error.HTTPError, seconds: float) -> str:
    """The body of a refusal; of one that breaks off, its status."""
    try:
        return whole(error, seconds).decode(errors="replace")
    except (OSError, http.client.HTTPException):
        return error.reason


def told_of(text: str) -> str:
    """The beginning of a text; the key is taken out before the cut, which would leave a part of it."""
    return shown(text)[:TOLD]


def shown(text: object) -> str:
    """A text as one line of a log: without the key and with escaped control characters."""
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode()
                   for letter in without_key(str(text)))


def without_key(text: str) -> str:
    """A text with *** in place of the key, also as JSON, XML and addresses have it."""
    key = os.environ.get("FACIES_API_KEY", "").strip()
    forms = {key, html.escape(key), json.dumps(key)[1:-1], urllib.parse.quote(key, safe="")} - {""}
    for form in sorted(forms, key=len, reverse=True):
        text = text.replace(form, "***")
    return text


def in_words(text: str) -> str:
    """What the service says of a mistake; of anything else the beginning."""
    try:
        problem = json.loads(text)
        mistakes = [f"{own['pointer']}: {own['detail']} ({own['code']})" for own in problem.get("errors", [])]
        return "; ".join(mistakes) or f"{problem['detail']} ({problem.get('code', problem['type'])})"
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return told_of(text)


@contextlib.contextmanager
def of_file(path: pathlib.Path):
    """What is refused of a file is told with its name."""
    try:
        yield
    except Stop as stop:
        raise Stop(stop.code, f"{path}: {stop}") from stop


def checked(address: str) -> str:
    """An address as it is used; one that no request can reach is refused before any is tried."""
    address = address.strip()
    if not address:
        raise Stop(REFUSED, "FACIES_ADDRESS is not set")
    try:
        parts = urllib.parse.urlsplit(address)
        said = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
        # `urlsplit` drops control characters, and a request would be refused for them.
        said = said and all(letter.isprintable() and letter != " " for letter in address)
    except ValueError:
        said = False
    if "@" in address.partition("://")[2].partition("/")[0]:
        raise Stop(REFUSED, "FACIES_ADDRESS has a user or a password in it, and a service asks for neither; a key is in FACIES_API_KEY")
    if not said:
        meant = f"http://{address}" if "://" not in address else "http://127.0.0.1:8080"
        raise Stop(REFUSED, f"FACIES_ADDRESS is {address!r}: write it with http:// or https://, as in {meant}")
    if "?" in address or "#" in address:
        raise Stop(REFUSED, f"FACIES_ADDRESS is {address!r}: leave out `?` or `#` and what follows it")
    if not parts.path.isascii():
        raise Stop(REFUSED, f"FACIES_ADDRESS is {address!r}: in its path, write letters beyond ASCII as % and two digits")
    try:
        # As a request looks it up.
        (parts.hostname or "").encode("idna")
    except UnicodeError:
        raise Stop(REFUSED, f"FACIES_ADDRESS is {address!r}: {parts.hostname!r} is no name of a host") from None
    return address.rstrip("/")


def authorization(key: str | None) -> dict[str, str]:
    """The header with a key; one that cannot be in a header is refused and not shown."""
    key = (key or "").strip()
    if not key:
        return {}
    if not all("!" <= letter <= "~" for letter in key):
        why = "FACIES_API_KEY is no key: within it is white space, a control character or one beyond ASCII"
        raise Stop(REFUSED, f"{why}; the secret has to be the key alone, on one line")
    return {"Authorization": f"Bearer {key}"}


def read(path: pathlib.Path) -> dict:
    """The object of a JSON file."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise Stop(REFUSED, f"{path}: {error}") from error
    return as_type(dict, document, f"{path}: the document")


def as_type(kind: type, value: object, what: str):
    """A value of a type that JSON has; another one is refused by its place."""
    words = {dict: "an object", list: "an array", str: "a string"}
    if not isinstance(value, kind):
        raise Stop(REFUSED, f"{what} is {json.dumps(value)[:60]} and has to be {words[kind]}")
    return value


def refuse_spec(path: pathlib.Path, file: dict) -> None:
    """A study computes each way that it names itself; a case file that says another one is not passed over."""
    spec = as_type(dict, file.get("spec", {}), f"{path}: /spec")
    if unused := ", ".join(f"`{name}`" for name in spec if name in OF_FILES and name != "kind"):
        say(f"{path}: {unused} of its `spec` is not used: a study writes a report")
    stated = ", ".join(f"`{name}`" for name in spec if name not in OF_FILES)
    if stated:
        why = (f"{path}: its `spec` states {stated}, and a study states itself how cases are computed: say so in an entry of "
               "`methods` or in `materials` of the study")
        raise Stop(REFUSED, why)


def mesh_places(document: object, bones: set[str]):
    """Every member of a case or a plan that names a mesh, as the object and the key."""
    if isinstance(document, list):
        for entry in document:
            yield from mesh_places(entry, bones)
    elif isinstance(document, dict):
        for key, value in document.items():
            if key in ("volume", "mesh", "image", "surface") and isinstance(value, str):
                # A selection may name a bone instead.
                if key != "surface" or value not in bones:
                    yield document, key
            else:
                yield from mesh_places(value, bones)


class Cases:
    """Files become meshes and cases of the service, each once."""

    def __init__(self, service: Service) -> None:
        self.service = service
        # Of the case that was read last.
        self.units: dict[str, str] = {}

    def truth(self, truth: object, folder: pathlib.Path) -> None:
        """Puts ids in place of files of the scan that a study is compared with."""
        for document, key in mesh_places(truth, set()):
            path = folder / document[key]
            if path.is_file():
                with of_file(path):
                    document[key] = self.mesh(path, self.units)

    def scenes(self, scenes: list, folder: pathlib.Path, has_plans: bool) -> list:
        """The scenes of a study, those that are files as cases of the service. What is refused of all of them is told together."""
        found, mistakes = [], []
        for scene in scenes:
            try:
                found.append(self.scene(scene, folder, has_plans) if isinstance(scene, dict) else scene)
            except Stop as stop:
                if stop.code != REFUSED:
                    raise
                mistakes.append(str(stop))
        if mistakes:
            raise Stop(REFUSED, *dict.fromkeys(mistakes))
        return found

    def scene(self, scene: dict, folder: pathlib.Path, has_plans: bool) -> dict:
        """The scene of a study with the id of its case in place of the file's path, and the plan of the file unless the study
        states plans for its cases."""
        if "case" not in scene:
            raise Stop(REFUSED, f"the scene {json.dumps(scene)[:60]} of the study names no `case`, a file beside the study")
        path = folder / as_type(str, scene["case"], "`case` of a scene of the study")
        file = read(path)
        refuse_spec(path, file)
        case = as_type(dict, file.get("case"), f"{path}: /case")
        plan = as_type(dict, file.get("plan", {}), f"{path}: /plan")
        bones = {bone.get("name") for bone in as_type(list, case.get("bones", []), f"{path}: /case/bones")
                 if isinstance(bone, dict)}
        units = {name: as_type(str, case.get(name, usual), f"{path}: /case/{name}")
                 for name, usual in (("units", "mm"), ("frame", "unspecified"))}
        self.units = units
        for document, key in [*mesh_places(case, bones), *mesh_places(plan, bones)]:
            mesh = path.parent / document[key]
            with of_file(mesh):
                document[key] = self.mesh(mesh, units)
        own = {} if has_plans else {"plans": [plan]}
        with of_file(path):
            return {**own, "name": path.stem, **scene, "case": self.case(case)}

    def mesh(self, path: pathlib.Path, units: dict[str, str]) -> str:
        """The id of a mesh. The service knows bytes that it has."""
        try:
            content = path.read_bytes()
        except OSError as error:
            raise Stop(REFUSED, str(error)) from error
        query = urllib.parse.urlencode(units)
        return self.service.document("POST", f"/v1/meshes?{query}", content)["id"]

    def case(self, case: dict) -> str:
        """The id of a case, found again by a tag that its content makes."""
        content = json.dumps(case, sort_keys=True).encode()
        tag = f"gate-{hashlib.sha256(content).hexdigest()[:24]}"
        known = self.service.document("GET", f"/v1/cases?limit=1&tag={tag}")["items"]
        if known:
            return known[0]["id"]
        tagged = {**case, "tags": [*as_type(list, case.get("tags", []), "`tags` of a case"), tag]}
        return self.service.document("POST", "/v1/cases", tagged)["id"]


def baseline_of(service: Service, arguments: argparse.Namespace) -> str | None:
    """The study to compare with: as given, or the newest successful one with the tag."""
    if arguments.baseline:
        return arguments.baseline
    if not arguments.baseline_tag:
        return None
    query = urllib.parse.urlencode(
        {"kind": "study", "status": "successful", "tag": arguments.baseline_tag, "limit": 1})
    found = service.document("GET", f"/v1/jobs?{query}")["items"]
    if found:
        return found[0]["id"]
    if arguments.tag in ("", arguments.baseline_tag):
        arguments.tag = arguments.baseline_tag
        say(f"{no_study(arguments)}: this one gets it if it passes, and is the baseline of later ones")
        return None
    say(f"{no_study(arguments)}: run once without --tag, or with --tag {arguments.baseline_tag}")
    return NO_JOB


def no_study(arguments: argparse.Namespace) -> str:
    """Why there is no baseline."""
    return f"no successful study has the tag {arguments.baseline_tag!r} of --baseline-tag"


def finished(service: Service, job: dict, seconds: float) -> dict:
    """The job once it has ended; where it is meanwhile is printed when it changes, and after a minute of silence."""
    begun = time.monotonic()
    told, told_at = "", begun
    while job["status"] in ("accepted", "running"):
        now = time.monotonic()
        if now > begun + seconds:
            raise Stop(OUT_OF_REACH, f"job {job['id']} is {job['status']} after {seconds:.0f} s")
        where = progress(job)
        if where != told:
            say(where)
            told, told_at = where, now
        elif now >= told_at + SILENCE_S:
            say(f"{where}, after {now - begun:.0f} s")
            told_at = now
        job = service.document("GET", f"/v1/jobs/{job['id']}", Prefer="wait=5")
    return job


def progress(job: dict) -> str:
    """Where a job is, in one line."""
    if job["status"] == "accepted":
        return f"waits, {job['queue_position']} before it" if "queue_position" in job else "waits"
    parts = f", part {job['iteration'] + 1} (rows and truths)" if "iteration" in job else ""
    return f"{job['progress']:3d} % {job.get('phase', '')}{parts}"


def expected(truth: dict) -> str:
    """What the truth of a scene will cost, in one line."""
    time_s = truth.get("time_s")
    takes = f", {time_s['low']:.0f} to {time_s['high']:.0f} s on one thread" if time_s else ""
    return (f"the truth of {truth['scene']} is solved on {truth['meshes']} meshes, {truth['solves']} times each, "
            f"the finest with {truth['cells']} cells{takes}")


def worse(rows: list[dict]) -> list[str]:
    """Why rows are no pass, in a line each, of the first ones."""
    bad = [row for row in rows if row["verdict"] in ("worse", "failed")]
    lines = [f"{row['verdict']}: {row['scene']}, {row['plan']}, {row['label']}, {row['material']}, level {row['level']}: "
             f"{'; '.join(row.get('reasons', []))}" for row in bad[:LINES]]
    more = len(bad) - len(lines)
    return [*lines, f"and {more} more rows, which the report has"] if more else lines


def say(words: str) -> None:
    """A line that a pipeline shows at once."""
    print(shown(words), flush=True)


def run(arguments: argparse.Namespace) -> int:
    """The exit code of the outcome."""
    address = os.environ.get("FACIES_ADDRESS", "")
    service = Service(address, os.environ.get("FACIES_API_KEY"), arguments.patience_s)
    path = pathlib.Path(arguments.study)
    study = read(path)
    cases = Cases(service)
    # Plans in full are for cases, names for scenes of the program.
    has_plans = any(isinstance(plan, dict) for plan in as_type(list, study.get("plans", []), f"{path}: /plans"))
    study["scenes"] = cases.scenes(as_type(list, study.get("scenes", []), f"{path}: /scenes"), path.parent, has_plans)
    cases.truth(study.get("truth"), path.parent)
    # Before the study is posted: it must not become its own baseline.
    baseline = baseline_of(service, arguments)
    own = as_type(list, study.get("tags", []), f"{path}: /tags")
    # Those that later runs look for wait for the outcome.
    later = [tag for tag in dict.fromkeys([arguments.tag, arguments.baseline_tag])
             if tag and (tag == arguments.tag or tag in own)]
    job = service.document(
        "POST", "/v1/jobs", {**study, "kind": "study", "tags": [tag for tag in own if tag not in later]})
    say(f"study {job['id']}" + (", known: it is not solved again" if job["deduplicated"] else ""))
    for truth in job.get("truths", []) if job["status"] in ("accepted", "running") else []:
        say(expected(truth))
    job = finished(service, job, arguments.timeout_s)
    if job["status"] != "successful":
        raise Stop(FAILED, f"job {job['id']} is {job['status']}: {in_words(json.dumps(job.get('error')))}")
    query = f"?{urllib.parse.urlencode({'baseline': baseline})}" if baseline else ""
    report = f"/v1/jobs/{job['id']}/report{query}"
    if arguments.report:
        junit, _ = service.ask("GET", report, Accept="application/xml")
        no_job = f"job {NO_JOB} is no study that has ended well"
        text = junit.decode(errors="replace").replace(no_job, html.escape(no_study(arguments), quote=True))
        try:
            pathlib.Path(arguments.report).write_text(without_key(text), encoding="utf-8")
        except OSError as error:
            raise Stop(REFUSED, f"--report {arguments.report}: {error}") from error
    found = service.document("GET", report, Accept="application/json")
    verdict = found["verdict"]
    if verdict["outcome"] not in EXIT_CODES:
        raise Stop(OUT_OF_REACH, f"{service.address} is no facies service: the outcome of job {job['id']} is {verdict['outcome']}")
    if rows_of := found.get("rows_of"):
        say(f"rows are those of study {rows_of.get('job')}, solved {rows_of['created']}, judged anew")
    for skipped in found.get("skipped", []):
        say(f"{skipped['label']} does not apply to {skipped['scene']}: {skipped['reason']}")
    if within := sum("within-truth-error" in row.get("warnings", []) for row in found["rows"]):
        have = "1 row has" if within == 1 else f"{within} rows have"
        say(f"{have} an error below the uncertainty of the reference (within-truth-error): a finer reference would distinguish them")
    for line in worse(found["rows"]):
        say(line)
    for reason in verdict["reasons"]:
        say(reason.replace(f"job {NO_JOB} is no study that has ended well", no_study(arguments)))
    worst = max((row["p95_mm"] for row in found["rows"] if isinstance(row.get("p95_mm"), (int, float))), default=None)
    largest = "" if worst is None else f", largest p95 {worst:.4g} mm"
    say(f"{verdict['rows']} row{'' if verdict['rows'] == 1 else 's'}, {verdict['worse']} worse{largest}; outcome {verdict['outcome']}")
    if verdict["outcome"] == "pass":
        put_on(service, job, later, arguments.baseline_tag)
        if baseline and baseline > job["id"] and arguments.baseline_tag in later:
            say(f"study {baseline} is newer and stays the baseline of {arguments.baseline_tag!r}")
    elif later:
        say(f"it does not get the tag {' or '.join(map(repr, later))}")
    if verdict["outcome"] == "incomplete" and baseline and arguments.baseline_tag:
        say(f"if cases were changed on purpose, run once with --tag {arguments.baseline_tag} and without --baseline-tag")
    tell(job["id"], verdict["outcome"])
    return EXIT_CODES[verdict["outcome"]]


def put_on(service: Service, job: dict, tags: list[str], baseline_tag: str) -> None:
    """Puts tags on a study that has not got them. One too many takes the place of the oldest, which is not to be that of the baseline."""
    missing = [tag for tag in tags if tag not in job["tags"]]
    if missing:
        kept = [tag for tag in job["tags"] if tag == baseline_tag]
        service.document("PATCH", f"/v1/jobs/{job['id']}", {"tags": {"add": kept + missing}})
        say(f"it gets the tag {' and '.join(map(repr, missing))}")


def tell(job: str, outcome: str) -> None:
    """Outputs for later steps, where a pipeline reads them from a file."""
    if place := os.environ.get("GITHUB_OUTPUT"):
        with open(place, "a", encoding="utf-8") as outputs:
            outputs.write(f"job={job}\noutcome={outcome}\n")


def seconds(text: str) -> float:
    """A duration, more than none and not without end."""
    number = float(text)
    if not (math.isfinite(number) and number > 0.0):
        raise argparse.ArgumentTypeError(f"{text} has to be above 0 and finite")
    return number


def job_id(text: str) -> str:
    """The id of a job, or nothing."""
    if text and not JOB.fullmatch(text):
        raise argparse.ArgumentTypeError(f"{text!r} is no id of a job, which is as {NO_JOB}")
    return text


class Once(argparse.Action):
    """An option that may stand once: of several values the last would be taken without a word."""

    stands = False

    def __call__(self, parser, namespace, values, option_string=None) -> None:
        if self.stands:
            parser.error(f"{option_string} stands more than once")
        self.stands = True
        setattr(namespace, self.dest, values)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.register("action", None, Once)
    parser.add_argument("study", help="a study document; its cases are files beside it")
    parser.add_argument("--baseline", type=job_id, default="", help="the job of the study to compare with")
    parser.add_argument("--baseline-tag", default="",
                        help="compare with the newest successful study of this tag; the first gets it")
    parser.add_argument("--tag", default="", help="a tag for this study, if it passes")
    parser.add_argument("--report", default="", help="a file for the test results (JUnit)")
    parser.add_argument("--timeout-s", type=seconds, default=3600.0,
                        help="how long to wait for the study, in seconds")
    parser.add_argument("--patience-s", type=seconds, default=120.0,
                        help="how long to repeat a request to a service that is busy or silent")
    try:
        return run(parser.parse_args())
    except Stop as stop:
        for why in stop.args:
            print(shown(why), file=sys.stderr)
        return stop.code
    except Exception as error:  # 1 is the exit code of a prediction that is worse.
        print(unexpected(error), file=sys.stderr)
        return REFUSED


def unexpected(error: Exception) -> str:
    """An error of the gate itself in one line: its type and the line of this file, since its text may quote a key."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == __file__]
    return f"the gate has an error: {type(error).__name__} at line {lines[-1] if lines else 0} of {pathlib.Path(__file__).name}"


if __name__ == "__main__":
    sys.exit(main())
