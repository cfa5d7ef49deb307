#!/usr/bin/env python3
"""Writes cases of the shared data for `facies study --case`.

FACIES_SHARED=... benches/cases/make.py FOLDER [LENGTH_MM]

One file for each of: the subject face with the jaw moved, the same with jaw and nose moved, the template face with the
jaw moved, and the shell of 100 k tetrahedra with its standard load and materials (a) to (d). Faces move forward by
LENGTH_MM, 4 by default. Mesh paths lead from FOLDER to the data, which stays where it is.
"""

import json
import math
import os
import sys
from pathlib import Path


def tissue(young_modulus_kpa, poisson_ratio):
    return {"young_modulus_kpa": young_modulus_kpa, "poisson_ratio": poisson_ratio}


def node_set(name):
    return {"node_set": name}


def face(mesh, jaw, fixed, further, forward):
    """A face whose jaw, and whose further segments, move by the vector `forward`."""
    segments = {"mandible": jaw, **further}
    case = {
        "units": "mm",
        "volume": mesh,
        "skin": node_set("outer_skin"),
        "segments": [{"name": name, "nodes": node_set(nodes)} for name, nodes in segments.items()],
        "fixed": [node_set(fixed)],
        "materials": {"*": tissue(15, 0.49)},
    }
    moved = [{"name": name, "translation_mm": forward} for name in segments]
    return {"case": case, "plan": {"segments": moved}}


def shell(mesh, materials):
    """The standard load: two patches turn by 3 degrees and move by 8 mm; the inside and the rim are held."""

    def tag(value):
        return {"array": "tag", "value": value}

    length = 8 / math.hypot(7, 4)
    case = {
        "units": "mm",
        "volume": mesh,
        "regions": {"array": "band", "names": {"1": "stiff"}},
        "skin": tag(5),
        "segments": [{"name": "maxilla", "nodes": tag(2)}, {"name": "mandible", "nodes": tag(3)}],
        "fixed": [tag(1), tag(4)],
        "materials": materials,
    }
    plan = {
        "segments": [
            {
                "name": "maxilla",
                "translation_mm": [0, 7 * length, -4 * length],
                "rotation_deg": [3, 0, 0],
                "pivot_mm": [0, 50, -10],
            },
            {
                "name": "mandible",
                "translation_mm": [0, -7 * length, 4 * length],
                "rotation_deg": [0, 0, 3],
                "pivot_mm": [0, 40, -50],
            },
        ]
    }
    return {"case": case, "plan": plan}


def cases(path, length):
    subject, template = path("face/subject_face.vtu"), path("face/template_face.vtu")
    of_subject = (subject, "jaw_attached", "skull_fixed_orig")
    yield "subject_jaw", face(*of_subject, {}, [-length, 0, 0])
    yield "subject_jaw_and_nose", face(*of_subject, {"nose": "nose_fixed"}, [-length, 0, 0])
    of_template = (template, "mandible_fixed", "skull_nose_fixed")
    yield "template_jaw", face(*of_template, {}, [0, length, 0])
    bands = {"*": tissue(3, 0.46), "stiff": tissue(790, 0.43)}
    of_letter = {"a": {"*": tissue(15, 0.46)}, "b": bands, "c": {"*": tissue(15, 0.49)}, "d": {"*": tissue(15, 0.499)}}
    for letter, materials in of_letter.items():
        yield f"shell_100k_{letter}", shell(path("shell/100k.vtu"), materials)


def main(folder, length="4"):
    folder = Path(folder)
    data = Path(os.environ.get("FACIES_SHARED", "../shared")) / "data"
    folder.mkdir(parents=True, exist_ok=True)

    def path(file):
        return os.path.relpath(data / file, folder)

    for name, documents in cases(path, float(length)):
        (folder / f"{name}.json").write_text(json.dumps(documents, indent=1) + "\n")
        print(folder / f"{name}.json")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
