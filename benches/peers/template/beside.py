"""The generic face brought to the head of a CT, beside the tetrahedral mesh of the same head: beside.py FACIES SCAN STL_FOLDER OUTPUT

Both are moved by the plan in examples/head_ct, with landmarks that were picked once (landmarks.json there). Prints, for each way to make the
prediction on the template, how far the movement of the skin is from that on the tetrahedral mesh: at points spread over its skin, where
both skins lie within 2 mm of each other. Writes OUTPUT/skins.npz for picture.py.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent.parent / "meshing"))

import surfaces
import vtu

EXAMPLE = Path(__file__).parents[3] / "examples" / "head_ct"
# The skins of the two are the same place within so much, in mm.
SAME = 2.0
# Nodes of the template on bone belong to the segment of the scan that is nearer than this, in mm.
ON_SEGMENT = 6.0
MOVED = 0.5
PICTURED = "its muscles, segments of the scan"
ONE_TISSUE = {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}}
HEAD = (
    "| template | mean, 95 % that its mesh leaves out; and its being linear | difference, mean, median, 95 %, largest mm | "
    "where the skin moves by more than .5 mm: share of it, mean difference, mean movement of both |\n| --- | --- | --- | --- |"
)


def main():
    facies, scan, stl, output = sys.argv[1:]
    output = Path(output)
    run = lambda *words: subprocess.run([facies, *map(str, words)], check=True, capture_output=True, text=True)
    plan = json.loads((EXAMPLE / "plan.json").read_text())
    run("mesh", "--scan", scan, "--plan", EXAMPLE / "plan.json", "--out", output / "head")
    planned(output / "head", plan, lambda case: case.update(materials=ONE_TISSUE))
    known = prediction(run, output / "head", output / "head-moved")
    points, of = surfaces.sampled(known.rest, known.triangles, 40_000)
    print(f"tetrahedral mesh: {known.told()}")
    kept = {"known_rest": known.rest, "known_triangles": known.triangles, "known_moved": known.moved}
    run("face", "--lips", "open", "--out", output / "face")
    conformed = output / "conformed"
    told = run("conform", "--spec", conformation(output / "face", stl), "--out", conformed).stdout
    print("\n".join(line for line in told.splitlines() if line.startswith(("skin", "bone", "landmarks", "cells"))))
    print(HEAD)
    bones = [corners(output / "head" / f"bone-{number}.vtp") for number in (1, 2)]
    with_sets(conformed / "volume.vtu", segments(vtu.arrays(conformed / "volume.vtu"), bones))
    for name, change in ways().items():
        planned(conformed, plan, change)
        skin = prediction(run, conformed, output / "template-moved")
        print(row(name, skin, difference(known, skin, points, of)), flush=True)
        if name == PICTURED:
            kept |= {"template_rest": skin.rest, "template_triangles": skin.triangles, "template_moved": skin.moved}
            np.savez(output / "skins.npz", **kept)
            parts = by_part(known, skin, points, of)
    print(f"{PICTURED}, by parts of the skin, mm: {parts}")


def ways():
    """What a prediction on the template takes of the template, and what of the scan."""

    def of_scan(case):
        case["segments"] = [{"name": name, "nodes": {"node_set": f"scan_{name}"}} for name in ("maxilla", "mandible")]
        case["fixed"] = [{"node_set": "scan_skull"}, {"node_set": "rim"}]

    def plain(case):
        case.update(materials=ONE_TISSUE, muscles=[])

    return {
        "with its muscles": lambda case: None,
        "one tissue, as the tetrahedra": plain,
        "its muscles, segments of the scan": of_scan,
        "one tissue, segments of the scan": lambda case: (plain(case), of_scan(case)),
    }


def conformation(face, stl):
    """The spec of the template with the picked landmarks."""
    spec = json.loads((face / "conform.json").read_text())
    spec["patient"] = {part: f"{Path(stl).resolve()}/headsq_quarter_{part}.stl" for part in ("skin", "bone")}
    case = json.loads((face / "case.json").read_text())["case"]
    picked = json.loads((EXAMPLE / "landmarks.json").read_text())
    spec["landmarks"] = {
        name: {"template_mm": case["landmarks"][name], "patient_mm": place} for name, place in picked.items()
    }
    (face / "ct.json").write_text(json.dumps(spec))
    return face / "ct.json"


def planned(folder, plan, change):
    """The case of a folder with the plan without its cuts, as planned.json beside it."""
    document = json.loads((folder / "case.json").read_text())
    case = document["case"]
    case["frame"] = "LPS"
    change(case)
    plan = {"frame": "LPS", "segments": plan["segments"]}
    (folder / "planned.json").write_text(json.dumps({"case": case, "plan": plan}))


class Skin:
    """A predicted skin at rest, how its points move, and what the prediction says that it leaves out."""

    def __init__(self, folder):
        found = vtu.arrays(folder / "skin.vtp")
        self.moved = found["displacement_mm"].reshape(-1, 3)
        self.rest = found["Points"].reshape(-1, 3) - self.moved
        self.triangles = triangles(found)
        self.parts = {name[4:]: values > 0 for name, values in found.items() if name.startswith("set_")}
        self.result = json.loads((folder / "result.json").read_text())

    def told(self):
        mesh, linear = self.result["numerical_error_mm"], self.result["nonlinearity_mm"]["skin"]
        return f"{mesh['mean']:.2f}, {mesh['p95']:.2f}; {linear['mean']:.2f}, {linear['p95']:.2f}"


def prediction(run, case, output):
    run("predict", "--case", case / "planned.json", "--method", "fem_linear", "--out", output)
    return Skin(output)


def triangles(found):
    """Polygons as fans."""
    ends = found["offsets"]
    begins = np.concatenate([[0], ends[:-1]])
    corners = found["connectivity"]
    fans = [(corners[b], corners[b + k], corners[b + k + 1]) for b, e in zip(begins, ends) for k in range(1, e - b - 1)]
    return np.array(fans)


def corners(path):
    found = vtu.arrays(path)
    return found["Points"].reshape(-1, 3), triangles(found)


def segments(found, bones):
    """Nodes of the template on bone by the segment of the scan that they lie on; all others stay."""
    nodes = found["Points"].reshape(-1, 3)
    on_bone = np.flatnonzero(found["set_maxilla"] | found["set_mandible"] | found["set_skull"])
    distances = np.array([surfaces.Search(*bone).distances(nodes[on_bone])[0] for bone in bones])
    nearest, distance = distances.argmin(axis=0), distances.min(axis=0)
    own = np.where(distance < ON_SEGMENT, nearest, 2)
    return {name: on_bone[own == number] for number, name in enumerate(("maxilla", "mandible", "skull"))}


def with_sets(path, found):
    """The sets as arrays of the points of a file."""
    text = path.read_text()
    count = len(vtu.arrays(path)["Points"]) // 3
    for name, nodes in found.items():
        values = np.zeros(count, int)
        values[nodes] = 1
        array = f'<DataArray type="UInt8" Name="set_scan_{name}" format="ascii">{" ".join(map(str, values))}</DataArray>'
        text = text.replace("</PointData>", f"{array}\n</PointData>")
    path.write_text(text)


def by_part(known, skin, points, of):
    """The mean difference on each part of the template's skin."""
    same, there = common(skin, points)
    ours, other = difference(known, skin, points, of)
    off = np.linalg.norm(ours - other, axis=1)
    inside = {name: nodes[skin.triangles[there[same]]].all(axis=1) for name, nodes in skin.parts.items()}
    return ", ".join(f"{name} {off[own].mean():.2f}" for name, own in sorted(inside.items()))


def common(skin, points):
    """Which points lie within 2 mm of a skin, and the triangle that is nearest to each."""
    distance, there = surfaces.Search(skin.rest, skin.triangles).distances(points)
    return distance < SAME, there


def difference(known, skin, points, of):
    """At points of the one skin within 2 mm of the other, how both move there."""
    same, there = common(skin, points)
    ours = interpolated(known.rest, known.moved, known.triangles[of[same]], points[same])
    other = interpolated(skin.rest, skin.moved, skin.triangles[there[same]], points[same])
    return ours, other


def interpolated(rest, moved, corners, points):
    """The linear function of a triangle's corners at the points of its plane that are nearest."""
    a, b, c = (rest[corners[:, k]] for k in range(3))
    u, v, w = b - a, c - a, points - a
    dot = lambda x, y: np.einsum("ij,ij->i", x, y)
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    determinant = np.maximum(uu * vv - uv * uv, 1e-12)
    s, t = (vv * uw - uv * vw) / determinant, (uu * vw - uv * uw) / determinant
    s, t = np.clip(s, 0, 1)[:, None], np.clip(t, 0, 1)[:, None]
    return (1 - s - t) * moved[corners[:, 0]] + s * moved[corners[:, 1]] + t * moved[corners[:, 2]]


def row(name, skin, moved):
    ours, other = moved
    off = np.linalg.norm(ours - other, axis=1)
    length = lambda x: np.linalg.norm(x, axis=1)
    moves = length(ours) > MOVED
    return (
        f"| {name} | {skin.told()} | {off.mean():.2f}, {np.median(off):.2f}, {np.quantile(off, 0.95):.2f}, {off.max():.2f} | "
        f"{100 * moves.mean():.0f} %, {off[moves].mean():.2f}, {length(ours)[moves].mean():.2f} and {length(other)[moves].mean():.2f} |"
    )


if __name__ == "__main__":
    main()
