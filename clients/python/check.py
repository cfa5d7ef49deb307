"""What `facies` promises, against a service: arrays that agree with each other, progress, exceptions with codes."""

import http.server
import json
import os
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from facies import Facies, JobFailed, Refused, rigid
from facies_client import connect

HEAD = "examples/head/case.json"
MOVEMENT: dict[str, list[float]] = {"translation_mm": [0, 4, 1], "rotation_deg": [3, -2, 1], "pivot_mm": [0, 10, 20]}
PLAN = {"segments": [{"name": "mandible", **MOVEMENT}]}

service = Facies(os.environ["FACIES_ADDRESS"], os.environ.get("FACIES_API_KEY"))
head = service.case(HEAD)

events: list[dict[str, Any]] = []
# A response and inverse planning are of linear elements.
prediction = service.predict(head, PLAN, progress=events.append, method="fem_linear")
statistics = prediction.results["statistics"]["skin"]
lengths = np.linalg.norm(prediction.displacement_mm, axis=1)
assert prediction.displacement_mm.shape == prediction.rest_mm.shape, prediction.displacement_mm.shape
assert prediction.skin.triangles.max() + 1 == len(lengths), "every vertex belongs to a triangle"
assert abs(lengths.max() - statistics["area"]["max"]) < 1e-5, (lengths.max(), statistics["area"])
assert [event["number"] for event in events] == list(range(1, len(events) + 1)), events
assert events[-1]["status"] == "successful" and events[-1]["progress"] == 100, events[-1]

response = service.response(head)
assert len(response.node_ids) == len(response.rest.points_mm) == response.columns.shape[1]
assert np.abs(response.rest.points_mm - prediction.rest_mm).max() < 1e-3, "vertices stand in the order of the nodes"
here = response.displacement_mm({"mandible": rigid(**MOVEMENT)})
there = service.apply(response, PLAN)
apart = np.abs(here - there.displacement_mm).max()
assert apart < 1e-4, apart
assert there.within_linear_range and (there.nonlinearity_estimate_mm or 0) > 0 and there.warnings == [], there
far = service.apply(response, {"segments": [{"name": "mandible", "translation_mm": [0, -30, 0]}]})
unseen = ["numerical-error-large", "cells-inverted", "bones-overlap", "bone-in-tissue", "bone-through-skin"]
unseen += ["large-rotation", "large-strain", "tissue-may-buckle", "skin-outruns-plan", "sliding-off-wall"]
unseen += ["landmark-far", "landmarks-crowded", "landmarks-swapped", "skin-overlaps"]
assert not far.within_linear_range and far.document["not_measured"] == unseen, far.document["not_measured"]
assert [warning["code"] for warning in far.warnings] == ["outside-linear-range"] and "mm" in far.warnings[0]["detail"], far


def refused_here(deed: Callable[[], object], said: str) -> None:
    """What the service would refuse, or what is no number, is no displacement here either."""
    try:
        deed()
    except ValueError as error:
        assert said in str(error), error
        return
    sys.exit(f"let through: {said}")


try:
    service.apply(response, {"segments": [{"name": "mandible", "rotation_deg": [5, 0, 0]}]})
    sys.exit("a rotation about nothing was let through")
except Refused as refused:
    refused_here(lambda: rigid(rotation_deg=[5, 0, 0]), refused.errors[0]["detail"])
wrong: Any
for wrong in (["1", 0, 0], [0, float("nan"), 0], [1, 0], 1, "123", [True, 0, 0]):
    refused_here(lambda: rigid(translation_mm=wrong), f"`translation_mm`: {wrong!r} ")
refused_here(lambda: rigid(rotation_deg=[0, 0, float("inf")], pivot_mm=[0, 0, 0]), "`rotation_deg`: ")
mirror, transposed = np.diag([-1, 1, 1, 1]), rigid([1, 0, 0]).T
for wrong in ({"translation_mm": [1, 0, 0]}, np.eye(3), np.full((4, 4), np.nan), mirror, transposed, 2 * np.eye(4)):
    refused_here(lambda: response.displacement_mm({"mandible": wrong}), "`mandible`: ")
assert np.abs(here - prediction.displacement_mm).max() < 1e-3, "the response says what the prediction says"

for member, value in {"frame": "RAS", "units": "m", "fixed": ["skull"], "skin": "skin"}.items():
    stated: Any = {member: value}
    try:
        service.predict(head, PLAN, **stated)
        sys.exit(f"`{member}` was ignored beside a case")
    except TypeError as error:
        assert f"`{member}`" in str(error), error
growing = service.response(head, growth=["*"])
assert np.abs(growing.displacement_mm({}, growth={"*": 0.1})).max() > 0.1
no_number: Any
for no_number in (float("nan"), float("inf"), True, "3", None, [1]):
    refused_here(lambda: growing.displacement_mm({}, growth={"*": no_number}), f"`growth/*`: {no_number!r} ")
    refused_here(lambda: growing.displacement_mm({}, activations={"lip": no_number}), f"`activations/lip`: {no_number!r} ")

found = service.optimise(head, [{"nodes": {"node_set": "chin"}, "displacement_mm": [None, 4, None]}],
                         {"mandible": {"translation_mm": [[0, 0], [-10, 10], [-5, 5]]}})
again = service.predict(head, found.plan, method="fem_linear")
assert np.abs(found.displacement_mm - again.displacement_mm).max() < 1e-3, "the plan gives the skin that is told"
compared = service.compare(found, again)
assert compared.both["max"] < 1e-3 and compared.warnings == [], compared

told: list[dict[str, Any]] = []
mesh = service.predict("examples/head/face.vtu", {"segments": [{"name": "mandible", "translation_mm": [0, 4, 1]}]},
                       fixed=["skull", "rim"], skin="skin", progress=told.append)
assert mesh.displacement_mm.shape == prediction.displacement_mm.shape
size = Path("examples/head/face.vtu").stat().st_size
sent = [event for event in told if event.get("phase") == "upload"]
assert sent[-1] == {"phase": "upload", "file": "face.vtu", "sent_bytes": size, "total_bytes": size, "progress": 100}, sent
with tempfile.TemporaryDirectory() as folder:
    volume = Path(folder, "ras.vtu")
    volume.write_bytes(Path("examples/head/face.vtu").read_bytes().replace(b"SPACE=LPS", b"SPACE=RAS"))
    ras = service.predict(volume, {"segments": [{"name": "mandible", "translation_mm": [0, 4, 1]}]},
                          fixed=["skull", "rim"], skin="skin", frame="RAS", method="fem_linear")
    assert service.compare(ras, ras).both["max"] < 1e-3, "a predicted skin has its own frame"
    marked = Path(folder, "skin.vtp")
    marked.write_bytes(service.file(ras.job, "skin.vtp"))
    assert service.compare(ras, marked).both["max"] < 1e-3, "and so has a file with a mark"
    for stated in ({"frame": "LPS"}, {"frame": ""}):
        try:
            service.compare(ras, marked, **stated)
            sys.exit(f"{stated} was not taken at its word")
        except Refused:
            pass
try:
    service.compare(ras, ras, frame="LPS")
    sys.exit("`frame` was ignored beside a prediction")
except TypeError as error:
    assert "`frame`" in str(error), error
shares: list[int] = []
service.upload(b"solid x\n" + b" " * (5 << 20) + b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 50 0 0\nvertex 0 50 0\n"
               b"endloop\nendfacet\nendsolid x\n", progress=lambda event: shares.append(event["progress"]))
assert shares == sorted(shares) and len(shares) == 6 and shares[-1] == 100, shares

# A CT of two balls, cut by a plane: the file is sent, meshed and predicted on.
grid = np.stack(np.meshgrid(*[np.arange(30) * 4.0 + 2] * 3, indexing="ij"), axis=-1)


def ball(centre: list[float], radius: float) -> Any:
    return np.clip((radius - np.linalg.norm(grid - centre, axis=-1)) / 4 + 0.5, 0, 1)


values = (-1000 + 1040 * ball([60, 60, 60], 50) + 1160 * ball([60, 55, 60], 30)).astype("<i2")
header = ("NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 30 30 30\n"
          "space directions: (4,0,0) (0,4,0) (0,0,4)\nendian: little\nencoding: raw\nspace origin: (2,2,2)\n\n")
osteotomy = {"cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
             "segments": [{"name": "jaw", "below": ["middle"]}]}
jaw = {"frame": "LPS", "segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}]}
with tempfile.TemporaryDirectory() as folder:
    ct = Path(folder, "ct.nrrd")
    ct.write_bytes(header.encode() + values.tobytes(order="F"))
    cut = service.predict(ct, jaw | {"osteotomy": osteotomy})
    largest = np.linalg.norm(cut.displacement_mm, axis=1).max()
    assert 2 < largest < 4, largest
    small = {"kind": "mesh", "scan": ct, "frame": "LPS", "osteotomy": osteotomy, "size": {"tetrahedra": 20000}}
    told = []
    meshed = service.case({"meshing": small}, progress=told.append)
    assert [segment["name"] for segment in meshed.document["segments"]] == ["jaw"], meshed.document
    assert told[0].get("phase") == "upload" and told[-1]["status"] == "successful", told
    assert service.predict(meshed, jaw).results["statistics"]["skin"]["area"]["max"] > 2
    try:
        service.case({"meshing": small | {"thresholds_hu": {"skin": 2000, "bone": 3000}}})
        sys.exit("a scan without bone was cut")
    except JobFailed as failed:
        assert failed.code == "segment-not-found", failed

soft = {"*": {"young_modulus_kpa": 5, "poisson_ratio": 0.4}}
with tempfile.TemporaryDirectory() as folder:
    file = json.loads(Path(HEAD).read_text())
    for mesh_of in [file["case"], *file["case"]["bones"]]:
        name = "volume" if "volume" in mesh_of else "mesh"
        mesh_of[name] = str(Path(HEAD).parent.resolve() / mesh_of[name])
    file["spec"] = {"kind": "predict", "materials": soft, "outputs": ["skin.vtp"]}
    own = Path(folder, "case.json")
    own.write_text(json.dumps(file))
    of_file = service.predict(own, PLAN)
stated = service.predict(head, PLAN, materials=soft)
assert of_file.results["provenance"]["spec_hash"] == stated.results["provenance"]["spec_hash"], "the spec of a file counts"
assert stated.results["provenance"]["spec_hash"] != prediction.results["provenance"]["spec_hash"]

# A key from a file that ends in a line break; one that no header can have is not shown.
key = os.environ.get("FACIES_API_KEY")
assert Facies(os.environ["FACIES_ADDRESS"], key and f" {key}\r\n").ask("GET", "/v1/cases").is_success
assert connect(os.environ["FACIES_ADDRESS"], key and f"{key}\n").get_httpx_client().get("/v1/cases").is_success
for piece in ("\n", " ", "\x1b", "\u00e9"):
    for made in (Facies, connect):
        try:
            made(os.environ["FACIES_ADDRESS"], f"fcs_secret{piece}more")
            sys.exit(f"let through: a key with {piece!r}")
        except ValueError as error:
            assert "secret" not in str(error) and "more" not in str(error), error



class Between(http.server.BaseHTTPRequestHandler):
    """Between us and a service: it redirects, or is busy and tells nothing of use."""

    asked: list[str] = []

    def do_GET(self) -> None:
        word = self.path[1:]
        self.asked.append(word)
        self.send_response(503 if word in ("0", "soon") else 307)
        self.send_header("Retry-After", word)
        self.send_header("Location", "/leak")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing."""


# What redirects gets no second request, and what is busy is not asked again at once.
with http.server.HTTPServer(("127.0.0.1", 0), Between) as between:
    threading.Thread(target=between.serve_forever).start()
    impatient = Facies(f"http://127.0.0.1:{between.server_port}", "key", patience_s=1.5)
    for word, requests in {"moved": 1, "0": 2, "soon": 2}.items():
        Between.asked.clear()
        try:
            impatient.ask("GET", f"/{word}")
            sys.exit(f"no refusal: {word}")
        except Refused:
            assert Between.asked == [word] * requests, Between.asked
    impatient.close()
    between.shutdown()

try:
    service.predict(head, {"segments": [{"name": "mandibel", "translation_mm": [0, 4, 1]}]})
    sys.exit("an unknown segment was let through")
except Refused as refused:
    assert (refused.code, refused.pointer) == ("unknown-segment", "/plan/segments/0/name"), refused
    assert "mandibel" in refused.detail, refused
try:
    service.predict(head, PLAN, budget={"wall_s": 0.001}, element="quadratic")
    sys.exit("a job ended within a millisecond")
except JobFailed as failed:
    assert failed.code == "budget-exceeded", failed
print(f"{len(lengths)} vertices, {len(events)} events, {apart:.1e} mm from the answer of apply")
