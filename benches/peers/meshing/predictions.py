"""The prediction of one plan on our mesh and on those of its peers: predictions.py FACIES SCAN PLAN OUTPUT

`facies mesh` makes the mesh, without nodes at one place, and its node sets; Gmsh and TetGen fill its surface, which they keep, so that
each node of the surface keeps its sets. `facies predict` then solves on each. Each line: tetrahedra, iterations of the
solver, processor seconds of the prediction, and how far the skin lies off that on our mesh: mean, p95 and largest in mm. The last line
is our mesh at half the edge against the same, at the nearest nodes of the skin: the discretisation error.
Writes OUTPUT/predictions.md.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import peers
import surfaces
import vtu

HERE = Path(__file__).parent
CELL = 4.0
HEAD = "| mesh | tetrahedra | iterations | processor s | skin off ours: mean, p95, largest mm |\n| --- | --- | --- | --- | --- |"


def main():
    program, scan, plan, output = sys.argv[1], sys.argv[2], sys.argv[3], Path(sys.argv[4])
    output.mkdir(parents=True, exist_ok=True)
    lines = [HEAD]
    ours = meshed(program, scan, plan, output / "ours", CELL)
    nodes, cells, sets = vtu.read(ours / "volume.vtu")
    peers.write_surface(output / "surface.npz", nodes, cells)
    known = None
    for name in ("ours", "gmsh-hxt", "gmsh-delaunay", "tetgen"):
        folder = ours if name == "ours" else filled(name, output, nodes, sets)
        if isinstance(folder, str):
            lines.append(f"| {name} | {folder} | | | |")
            continue
        row, skin = predicted(program, folder)
        known = known or skin
        lines.append(f"| {name} | {row} | {off(skin, known)} |")
        print(lines[-1], flush=True)
    finer = meshed(program, scan, plan, output / "finer", CELL / 2)
    row, skin = predicted(program, finer)
    lines.append(f"| ours at half the edge | {row} | {off(skin, known)} |")
    (output / "predictions.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def run(command):
    begin = peers.timed(command, 3000, None)
    assert begin[2] is None, begin[2]
    return begin[0]


def meshed(program, scan, plan, folder, edge):
    """Uniform cells, as the peers make them."""
    folder.mkdir(parents=True, exist_ok=True)
    spec = folder / "spec.json"
    spec.write_text(json.dumps({"size": {"finest_mm": edge, "coarsening": 1.0}, "coincident_nodes": False}))
    run([program, "mesh", "--scan", scan, "--plan", plan, "--mesh-spec", spec, "--out", folder])
    return folder


def filled(name, output, nodes, sets):
    """A folder with the case on the mesh of a peer, or why there is none."""
    mesh = output / f"{name}.npz"
    mesh.unlink(missing_ok=True)
    told = peers.timed([sys.executable, HERE / "mesher.py", name, output / "surface.npz", mesh, str(CELL)], 900, None)[2]
    if told or not mesh.exists():
        return f"refused: {told or 'no mesh'}"
    found = np.load(mesh)
    if not len(found["cells"]):
        return "no cells"
    folder = output / name
    folder.mkdir(exist_ok=True)
    distance, same = cKDTree(nodes).query(found["nodes"])
    carried = {key: np.where(distance < 1e-6, values[same], False) for key, values in sets.items()}
    write(folder / "volume.vtu", found["nodes"], found["cells"], carried)
    case = json.loads((output / "ours" / "case.json").read_text())
    for bone in case["case"].get("bones", []):
        bone["mesh"] = str((output / "ours" / bone["mesh"]).resolve())
    (folder / "case.json").write_text(json.dumps(case))
    return folder


def write(path, nodes, cells, sets):
    """Text arrays."""
    array = lambda name, kind, values, more="": (
        f'<DataArray type="{kind}" Name="{name}" format="ascii"{more}>\n'
        + "\n".join(" ".join(map(repr, row)) if isinstance(row, list) else repr(row) for row in values.tolist())
        + "\n</DataArray>\n"
    )
    three = ' NumberOfComponents="3"'
    text = (
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(nodes)}" NumberOfCells="{len(cells)}">\n<PointData>\n'
        + "".join(array(f"set_{key}", "UInt8", values.astype(int)) for key, values in sets.items())
        + "</PointData>\n<Points>\n" + array("Points", "Float64", nodes, three) + "</Points>\n<Cells>\n"
        + array("connectivity", "Int64", cells.astype(int))
        + array("offsets", "Int64", 4 * np.arange(1, len(cells) + 1))
        + array("types", "UInt8", np.full(len(cells), 10))
        + "</Cells>\n</Piece></UnstructuredGrid></VTKFile>\n"
    )
    path.write_text(text)


def predicted(program, folder):
    """What a table says of a prediction, and the nodes of the skin with their displacements."""
    case = json.loads((folder / "case.json").read_text())
    case["spec"] = {"method": "fem_linear"}
    (folder / "case.json").write_text(json.dumps(case))
    out = folder / "out"
    seconds = run([program, "predict", "--case", folder / "case.json", "--out", out])
    result = json.loads((out / "result.json").read_text())
    found = vtu.arrays(out / "skin.vtp")
    skin = found["Points"].reshape(-1, 3), found["displacement_mm"].reshape(-1, 3)
    cells = result["provenance"]["mesh"]["cells"]
    return f"{cells} | {result['provenance']['solver']['iterations']} | {seconds:.1f}", skin


def off(skin, known):
    (points, moved), (at, wanted) = skin, known
    distance, nearest = cKDTree(points).query(at)
    near = distance < CELL / 2
    difference = np.linalg.norm(moved[nearest[near]] - wanted[near], axis=1)
    return "{:.3f}, {:.3f}, {:.2f}".format(difference.mean(), np.quantile(difference, 0.95), difference.max())


if __name__ == "__main__":
    main()
