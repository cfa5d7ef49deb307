"""Runs the scripts of the GitHub action and of the GitLab job, as these files say, against a service.

FACIES_ADDRESS and FACIES_API_KEY say which. Fails where an exit code or an output is not the promised one.
"""

import contextlib
import html
import http.server
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import types
import xml.etree.ElementTree
from unittest import mock

import yaml

import facies_gate

HERE = pathlib.Path(__file__).resolve().parent
CLIENTS = HERE.parent
BLOCK = CLIENTS.parent / "examples" / "block" / "block.vtu"
STUDY = HERE / "study" / "study.json"


def shell(script: str, environment: dict[str, str], folder: pathlib.Path) -> int:
    told = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", script], cwd=folder, timeout=120, check=False,
        env={**os.environ, **environment}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if told.returncode not in (0, 1, 2, 3, 4, 5):
        print(told.stderr)
    return told.returncode


def told_by(folder: pathlib.Path, *arguments: str) -> str:
    """What the gate prints."""
    command = [sys.executable, str(HERE / "facies_gate.py"), *arguments]
    return subprocess.run(command, cwd=folder, timeout=120, check=False, stdout=subprocess.PIPE, text=True).stdout


def action(folder: pathlib.Path, **inputs: str) -> tuple[int, dict[str, str]]:
    """Runs the action with inputs; its exit code and its outputs."""
    document = yaml.safe_load((CLIENTS / "github-action" / "action.yml").read_text())
    defaults = {name: entry.get("default", "") for name, entry in document["inputs"].items()}
    given = {**defaults, "address": os.environ["FACIES_ADDRESS"], "key": os.environ["FACIES_API_KEY"],
             **{name.replace("_", "-"): value for name, value in inputs.items()}}
    step = document["runs"]["steps"][0]
    filled = {name: re.sub(r"\$\{\{ inputs\.([a-z-]+) \}\}", lambda found: given[found[1]], text)
              for name, text in step["env"].items()}
    outputs = folder / "outputs"
    outputs.write_text("")
    runner = {"GITHUB_ACTION_PATH": str(CLIENTS / "github-action"), "GITHUB_OUTPUT": str(outputs)}
    code = shell(step["run"], {**filled, **runner}, folder)
    return code, dict(line.split("=", 1) for line in outputs.read_text().splitlines())


def gitlab(folder: pathlib.Path, **variables: str) -> int:
    """Runs the script of the GitLab job with variables."""
    job = yaml.safe_load((CLIENTS / "gitlab" / "facies-gate.yml").read_text())[".facies-gate"]
    runner = {"CI_COMMIT_REF_SLUG": "a-branch", "FACIES_SOURCE": str(CLIENTS.parent)}
    filled = {**job["variables"], **runner, **variables}
    values = {name: os.path.expandvars(value.replace("$CI_COMMIT_REF_SLUG", "a-branch"))
              for name, value in filled.items()}
    return shell("\n".join(job["script"]), values, folder)


def expect(what: str, found: object, wanted: object) -> None:
    if found != wanted:
        sys.exit(f"{what}: {found!r} instead of {wanted!r}")
    print(f"   {what}: {found}")


def failures(report: pathlib.Path) -> int:
    """Test cases of the report that did not pass."""
    root = xml.etree.ElementTree.parse(report).getroot()
    return len(root.findall(".//failure")) + len(root.findall(".//error"))


def changed(folder: pathlib.Path, name: str, **members: object) -> str:
    """The study with other members, in a file from which its cases are found."""
    study = json.loads(STUDY.read_text())
    for scene in study["scenes"]:
        if isinstance(scene, dict):
            scene["case"] = str((STUDY.parent / scene["case"]).resolve())
    path = folder / f"{name}.json"
    path.write_text(json.dumps({**study, **members}))
    return str(path)


def documented(folder: pathlib.Path) -> None:
    """The study and the pipelines of docs/clients.md as they stand there, on the first day and of a branch."""
    text = (CLIENTS.parent / "docs" / "clients.md").read_text()
    place = folder / "validation"
    shutil.copytree(CLIENTS.parent / "examples" / "head", place / "head")
    (place / "study.json").write_text(re.findall(r"```json\n(.*?)```", text, re.DOTALL)[0])
    github, ours = [yaml.safe_load(block) for block in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)]
    inputs = {name.replace("-", "_"): value.replace("${{ github.ref_name }}", "a-branch")
              for name, value in github[0]["with"].items() if name not in ("address", "key")}
    expect("the documented action on the first day", action(folder, **inputs)[0], 0)
    expect("and on the second", action(folder, **inputs)[0], 0)
    variables = {**ours["validation"]["variables"], "BASELINE_TAG": "another trunk"}
    # The submodule.
    (folder / variables["FACIES_SOURCE"]).symlink_to(CLIENTS.parent)
    expect("the documented job of GitLab on the first day", gitlab(folder, **variables), 0)


def silence() -> None:
    """While one row is solved for long, a line each minute."""
    job = {"id": "1", "status": "running", "progress": 5, "phase": "solve"}
    polls = iter([job] * 10 + [{**job, "status": "successful"}])
    service = types.SimpleNamespace(document=lambda *_, **__: next(polls))
    seconds = iter(range(0, 1000, 20))
    lines: list[str] = []
    with mock.patch.multiple(facies_gate, say=lines.append, time=types.SimpleNamespace(monotonic=lambda: next(seconds))):
        facies_gate.finished(service, job, 900.0)
    expect("lines in 220 s of one row", len(lines), 4)


def red_stays_red(folder: pathlib.Path) -> None:
    """A study that is worse than its baseline does not become the baseline, however often it is run."""
    def of_element(element: str) -> str:
        way = {"label": "ours", "method": "fem_linear", "element": element}
        return changed(folder, element, plans=["patch 4 mm"], methods=[way], elements=[], tags=["trunk"])

    def outcome(element: str) -> tuple[int, str]:
        code, found = action(folder, study=of_element(element), tag="trunk", baseline_tag="trunk")
        return code, found.get("outcome", "")

    expect("a first run with --tag as --baseline-tag", outcome("stabilised"), (0, "pass"))
    for often in ("once", "twice", "thrice"):
        expect(f"one that is worse, {often}", outcome("plain"), (1, "worse"))
    expect("and the first again", outcome("stabilised"), (0, "pass"))


def broken(folder: pathlib.Path) -> None:
    """Documents and addresses that are wrong: one line and an exit code, and no time spent on them."""
    usual = {"units": "mm", "volume": "block.vtu"}
    studies = {
        "no JSON": "{", "an array": "[]", "text that is not UTF-8": b"\xff", "nested": "[" * 100000,
        "scenes that are none": {"scenes": {}}, "a scene without a case": {"scenes": [{}]},
        "a case that is a number": {"scenes": [{"case": 3}]}, "a case that is not there": {"scenes": [{"case": "none"}]},
        "tags that are a word": {"scenes": [], "tags": "main"},
    }
    files = {
        "a case file that is an array": [], "one without a case": {}, "a case that is an array": {"case": []},
        "bones that are an object": {"case": {**usual, "bones": {}}}, "bones that are words": {"case": {**usual, "bones": ["x"]}},
        "units that are a number": {"case": {**usual, "units": 3}}, "a plan that is an array": {"case": usual, "plan": []},
        "tags of a case that are a word": {"case": {"tags": "x"}}, "a mesh that is not there": {"case": usual},
        "a spec of its own": {"case": usual, "spec": {"kind": "predict", "method": "dvs", "tags": []}},
    }
    for number, (what, file) in enumerate(files.items()):
        (folder / f"case-{number}.json").write_text(json.dumps(file))
        studies[what] = {"scenes": [{"case": f"case-{number}.json"}]}
    for what, study in studies.items():
        path = folder / "broken.json"
        text = study if isinstance(study, str | bytes) else json.dumps(study)
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        refused(what, folder, [str(path)], 2)
    (told, _) = refused("which is named", folder, [str(path)], 2)
    expect("by its member", "`method`" in told and "tags" not in told, True)
    case = folder / "case-of-a-bone.json"
    case.write_text(json.dumps({"case": {**usual, "volume": str(BLOCK), "segments": [{"name": "jaw"}]}}))
    (folder / "of-a-bone.json").write_text(json.dumps({"scenes": [{"case": case.name}]}))
    (told, _) = refused("a segment without nodes", folder, ["of-a-bone.json"], 2)
    expect("of its file, in words", "case-of-a-bone.json: POST /v1/cases: 422 /segments/0/nodes: missing field" in told and "{" not in told, True)
    (folder / "contact.json").write_text(json.dumps({"case": usual, "spec": {"contact": "none"}}))
    (folder / "two-mistakes.json").write_text(json.dumps({"scenes": [{"case": "case-of-a-bone.json"}, {"case": "contact.json"}]}))
    (told, _) = refused("two files with a mistake each", folder, ["two-mistakes.json"], 2, lines=2)
    expect("both told", "case-of-a-bone.json: " in told and "contact.json: its `spec` states `contact`" in told, True)
    refused("a report that cannot be written", folder, [str(STUDY), "--report", str(folder)], 2)
    for address in ("localhost:8080", "127.0.0.1:8080", "ftp://localhost", "http://", "http://localhost:x", "http://local\nhost:8080", " ", ""):
        told, took_s = refused(f"the address {address!r}", folder, [str(STUDY)], 2, FACIES_ADDRESS=address)
        expect("refused at once", took_s < 5.0 and "FACIES_ADDRESS" in told, True)


def keys(folder: pathlib.Path) -> None:
    """A key with white space around it is the key; what no header can have is refused, and nothing shows a key."""
    key = os.environ["FACIES_API_KEY"]
    expect("a study with a key that ends in a line break", action(folder, study=str(STUDY), key=f" {key}\r\n")[0], 0)
    for what, wrong in {"a line break": "\n", "a space": " ", "a control character": "\x1b", "a letter beyond ASCII": "\u00e9"}.items():
        told, _ = refused(f"{what} within the key", folder, [str(STUDY)], 2, FACIES_API_KEY=f"fcs_secret{wrong}more_of_it")
        expect("by its variable alone", ("FACIES_API_KEY" in told, "secret" in told.partition(";")[0], "more_of_it" in told), (True, False, False))
    for option in ("--tag", "--baseline-tag"):
        told, _ = refused(f"two {option}", folder, [str(STUDY), option, "a", option, "b"], 2, lines=5)
        expect("by its name", f"{option} stands more than once" in told, True)
    told = io.StringIO()
    with (mock.patch.object(facies_gate, "run", side_effect=ValueError(f"Invalid header value b'Bearer {key}'")),
          mock.patch.object(sys, "argv", ["facies_gate.py", str(STUDY)]), contextlib.redirect_stderr(told)):
        code = facies_gate.main()
    lines = told.getvalue().splitlines()
    expect("an error of the gate itself", (code, len(lines), "ValueError" in lines[0], key in lines[0]), (2, 1, True, False))


KEY = "fcs_a&key-that\"nobody-is-to-see"


class Odd(http.server.BaseHTTPRequestHandler):
    """A server that is none of facies, in the way that the path begins with."""

    answers = {"html": b"<html>", "array": b"[]", "empty": b"", "object": b"{}", "null": b"null", "number": b"1" * 5000, "bytes": b"\xff\xfe",
               "nested": b"[" * 100000, "lines": b'{"id": "1\\noutcome=pass"}', "id": b'{"id": "1", "items": [{"id": "5"}]}'}

    def do_GET(self) -> None:
        self.rfile.read(int(self.headers.get("Content-Length") or 0))
        way = self.path.split("/")[1]
        self.server.asked.append((self.command, way, self.headers.get("Authorization")))
        if way.isdecimal():
            self.send_response(int(way))
            self.send_header("Location", f"http://localhost:{self.server.server_port}/leak")
            self.send_header("Retry-After", "0")
            self.end_headers()
            self.wfile.write(b"\x1b[2J\n" + KEY.encode() + json.dumps(KEY).encode() + b"." * 1000)
        elif way == "drip":
            self.send_response(200)
            self.end_headers()
            with contextlib.suppress(OSError):
                while not self.server.over.wait(0.05):
                    self.wfile.write(b" ")
        else:
            self.send_response(200)
            self.send_header("Content-Length", "99" if way == "broken" else str(len(self.answers.get(way, b"{}"))))
            self.end_headers()
            self.wfile.write(self.answers.get(way, b"{}"))

    do_POST = do_PATCH = do_GET

    def log_message(self, *_: object) -> None:
        """Nothing."""


@contextlib.contextmanager
def odd_server():
    """Such a server and its address; it keeps what it is asked."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Odd)
    server.asked, server.over = [], threading.Event()
    threading.Thread(target=server.serve_forever).start()
    try:
        yield server, f"http://127.0.0.1:{server.server_port}"
    finally:
        server.over.set()
        server.shutdown()
        server.server_close()


def odd(folder: pathlib.Path) -> None:
    """Servers that are none of facies get no key from another one, show none, and are told from a wrong input; no answer of theirs is
    waited for without end."""
    with odd_server() as (server, address):
        def told_of(way: str, code: int) -> str:
            server.asked.clear()
            told, _ = refused(f"a server that answers {way}", folder, [str(STUDY), "--patience-s", "1.5"], code,
                              FACIES_ADDRESS=f"{address}/{way}", FACIES_API_KEY=KEY)
            expect("the key is asked with and not shown", ({key for _, _, key in server.asked}, "nobody-is" in told or "\x1b" in told),
                   ({f"Bearer {KEY}"}, False))
            return told

        for status in (301, 302, 303, 307, 308):
            told = told_of(str(status), 2)
            expect("told by its status, and not followed", (f"{status} is a redirect" in told, server.asked),
                   (True, [("POST", str(status), f"Bearer {KEY}")]))
        told = told_of("401", 2)
        expect("escaped, masked and cut", (r"401 \x1b[2J\n***" in told, told.count("***"), len(told) < 500), (True, 2, True))
        told_of("503", 3)
        expect("asked again after a second, not at once", len(server.asked), 2)
        for way in Odd.answers:
            expect("which is no facies service", "is no facies service" in told_of(way, 3), True)
        expect("broken off", "IncompleteRead" in told_of("broken", 3), True)
        with mock.patch.multiple(facies_gate, ANSWER_S=0.5):
            service = facies_gate.Service(f"{address}/drip", None, 0.5)
            begun = time.monotonic()
            try:
                service.ask("GET", "/")
            except facies_gate.Stop as stop:
                expect("an answer that drips", (stop.code, "not whole after 1 s" in str(stop), time.monotonic() - begun < 10.0), (3, True, True))
            else:
                sys.exit("an answer that drips has ended")
    with mock.patch.dict(os.environ, FACIES_API_KEY=KEY):
        expect("a report without the key", facies_gate.without_key(f"<a b='{html.escape(KEY)}'/>"), "<a b='***'/>")


def options(folder: pathlib.Path) -> None:
    """Options and addresses that no request can be made with are refused before any."""
    for option in ("--patience-s", "--timeout-s"):
        for number in ("nan", "inf", "-1", "0", "x"):
            told, took_s = refused(f"{option} {number}", folder, [str(STUDY), option, number], 2, lines=5)
            expect("by its name", (f"argument {option}: " in told, took_s < 5.0), (True, True))
    for baseline in ("x y", "\u00e4", "1", f"{facies_gate.NO_JOB}&a=b"):
        told, _ = refused(f"the baseline {baseline!r}", folder, [str(STUDY), "--baseline", baseline], 2, lines=5)
        expect("by its value", f"{baseline!r} is no id of a job" in told, True)
    host = os.environ["FACIES_ADDRESS"]
    for address, why in {"http://.": "no name of a host", "http://a..b/": "no name of a host", f"http://{'a' * 70}.org": "no name of a host",
                         f"{host}?x=1": "`?`", f"{host}/#f": "`#`", f"{host}/\u00f6": "letters beyond ASCII",
                         "http://me:secret@localhost": "a user or a password"}.items():
        told, took_s = refused(f"the address {address!r}", folder, [str(STUDY)], 2, FACIES_ADDRESS=address)
        expect("in words", (why in told, "FACIES_ADDRESS" in told, "secret" in told, took_s < 5.0), (True, True, False, True))
    expect("a baseline that nobody has", action(folder, study=str(STUDY), baseline=facies_gate.NO_JOB)[0], 5)


def refused(what: str, folder: pathlib.Path, arguments: list[str], code: int, lines: int = 1,
            **environment: str) -> tuple[str, float]:
    """What the gate says of mistakes, which has to be one line for each, and how long it took in seconds."""
    begun = time.monotonic()
    done = subprocess.run(
        [sys.executable, str(HERE / "facies_gate.py"), *arguments], cwd=folder, timeout=60, check=False, text=True,
        env={**os.environ, **environment}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    expect(what, (done.returncode, len(done.stderr.splitlines())), (code, lines))
    return done.stderr, time.monotonic() - begun


def skin_scan(folder: pathlib.Path, case: str) -> str:
    """The file of the skin that the service predicts for a case, as a scan after the operation."""
    service = facies_gate.Service(os.environ["FACIES_ADDRESS"], os.environ["FACIES_API_KEY"], 60)
    scene = facies_gate.Cases(service).scene({"case": case}, folder, False)
    asked = {"kind": "predict", "case": scene["case"], "plan": scene["plans"][0], "method": "fem_linear"}
    job = service.document("POST", "/v1/jobs", asked)
    facies_gate.finished(service, job, 60)
    skin, _ = service.ask("GET", f"/v1/jobs/{job['id']}/results/skin.vtp")
    (folder / "scan.vtp").write_bytes(skin)
    return "scan.vtp"


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        report = folder / "facies-report.xml"
        silence()
        documented(folder)
        code, first = action(folder, study=str(STUDY), tag="main")
        expect("a study without a baseline", (code, first["outcome"]), (0, "pass"))
        expect("failures in its test results", failures(report), 0)
        code, second = action(folder, study=str(STUDY), baseline_tag="main")
        expect("the same against itself", (code, second["outcome"]), (0, "pass"))
        expect("which sent and solved nothing anew", second["job"], first["job"])
        expect("the same in GitLab", gitlab(folder, STUDY=str(STUDY)), 0)

        code, _ = action(folder, study=str(STUDY), tag="branch", baseline_tag="nobody")
        expect("a baseline that is not there", (code, failures(report) > 0), (5, True))
        expect("which speaks of its tag", "'nobody'" in html.unescape(report.read_text()), True)
        other = changed(folder, "other", plans=["patch 1 mm"])
        code, created = action(folder, study=other, baseline_tag="new")
        expect("a first run makes its baseline", (code, created["outcome"]), (0, "pass"))
        loose = changed(folder, "loose", plans=["patch 1 mm"], thresholds={"p95_mm": 50.0})
        code, later = action(folder, study=loose, baseline_tag="new")
        expect("and a later one is held against it", (code, later["outcome"]), (0, "pass"))
        told = told_by(folder, loose, "--baseline-tag", "new")
        expect("with its rows", f"rows are those of study {created['job']}" in told, True)
        known = changed(folder, "known", plans=["patch 1 mm"], tags=["own"])
        expect("a study that is known gets a tag", action(folder, study=known, tag="late")[0], 0)
        expect("by which it is found", action(folder, study=known, tag="of later", baseline_tag="late")[0], 0)
        red_stays_red(folder)
        worse = changed(folder, "worse", thresholds={"p95_mm": 1e-9})
        expect("rows above a threshold", action(folder, study=worse)[0], 1)
        expect("with failures in the test results", failures(report) > 0, True)
        told = told_by(folder, worse)
        lines = re.findall("^worse: slab, patch 2 mm, fem_linear plain, nu 0.46, level 0: p95 error .* is above the threshold ", told, re.MULTILINE)
        expect("and in what is printed", len(lines), 1)
        row = {"scene": "s", "plan": "p", "label": "l", "material": "m", "level": 0, "reasons": ["r"]}
        expect("of the first rows", facies_gate.worse([{**row, "verdict": verdict} for verdict in ["pass", "worse", "failed"] * 20])[18:],
               ["worse: s, p, l, m, level 0: r", "failed: s, p, l, m, level 0: r", "and 20 more rows, which the report has"])
        expect("the same in GitLab", gitlab(folder, STUDY=worse, BASELINE_TAG=""), 1)
        expect("and without a baseline there", gitlab(folder, STUDY=worse, BASELINE_TAG="x"), 1)
        broken(folder)
        keys(folder)
        odd(folder)
        options(folder)
        of_study = [{"segments": [{"name": "mandible", "translation_mm": [0, step, 0]}]} for step in (1, 2)]
        case = str((STUDY.parent / "../../../examples/block/case.json").resolve())
        planned = changed(folder, "planned", scenes=[{"case": case}], plans=of_study)
        expect("plans of the study over that of a case file", action(folder, study=planned)[0], 0)
        scan = skin_scan(folder, case)
        scanned = changed(folder, "scanned", scenes=[{"case": case}], truth={"mesh": scan}, plans=[], levels=[0], elements=["stabilised"],
                          thresholds={"p95_mm": 100.0})
        expect("a scan beside the study for its truth", action(folder, study=scanned)[0], 0)
        wrong = changed(folder, "wrong", methods=["guesswork"])
        expect("a study that is refused", action(folder, study=wrong)[0], 2)
        expect("a wrong key", action(folder, study=str(STUDY), key="none-of-the-keys")[0], 2)
        away = {"FACIES_ADDRESS": "http://127.0.0.1:9"}
        script = f"python3 {HERE}/facies_gate.py {STUDY} --patience-s 1"
        expect("a service that is not there", shell(script, away, folder), 3)


main()
