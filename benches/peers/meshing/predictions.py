"""The same prediction on our mesh and on those that others make of its surface: predictions.py OUTPUT FACIES

After peers.py: OUTPUT holds our mesh, ours.vtu, and NAME-ours.npz of the meshers that filled its surface, which they kept, so that
all have the same boundary and the same nodes on it. Bone below and in front is moved by 5 mm to the front, all other bone and the
cuts are held; linear, usual element. Writes OUTPUT/predictions.md: iterations, time of the solution, the estimated error of each mesh,
and how far the skin is from ours.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import vtu

MESHES = {"facies": None, "Gmsh Delaunay": "gmsh-delaunay", "Gmsh HXT": "gmsh-hxt", "TetGen": "tetgen"}
HEAD = (
    "| mesh | tetrahedra | iterations | solve s | error of its mesh, estimated mean, p95 mm | skin from ours, mean, p95, largest mm |\n"
    "| --- | --- | --- | --- | --- | --- |"
)
PLAN = {"segments": [{"name": "jaw", "translation_mm": [0, -5, 0]}]}
SPEC = {"method": "fem_linear", "outputs": ["skin.vtp"]}


def main():
    output, facies = Path(sys.argv[1]), sys.argv[2]
    nodes, cells, sets = vtu.read(output / "ours.vtu")
    held, jaw = parts(nodes, sets)
    classes = {"jaw": jaw, "held": held, "skin": sets["skin"] & ~held & ~jaw}
    ours, lines = None, [HEAD]
    for name, file in MESHES.items():
        if file is not None:
            path = output / f"{file}-ours.npz"
            if not path.exists():
                continue
            found = np.load(path)
            there, cells = found["nodes"], found["cells"]
            classes_there = carried(nodes, classes, there)
        else:
            there, classes_there = nodes, classes
        result, skin, moved = predicted(output, facies, there, cells, classes_there)
        ours = (cKDTree(skin), moved) if ours is None else ours
        lines.append(row(name, len(cells), result, difference(ours, skin, moved)))
        print(lines[-1], flush=True)
    (output / "predictions.md").write_text("\n".join(lines) + "\n")


def parts(nodes, sets):
    """Nodes of bone and cuts that are held, and those of the bone below and in front (LPS)."""
    low, high = nodes[sets["bone"]].min(axis=0), nodes[sets["bone"]].max(axis=0)
    share = (nodes - low) / (high - low)
    jaw = sets["bone"] & ~sets["cut"] & (share[:, 2] < 0.35) & (share[:, 1] < 0.5)
    return (sets["bone"] | sets["cut"]) & ~jaw, jaw


def carried(nodes, classes, there):
    """The classes of the nodes of another mesh that stand at nodes of ours."""
    distance, nearest = cKDTree(nodes).query(there)
    same = distance < 1e-6
    return {name: same & members[nearest] for name, members in classes.items()}


def predicted(output, facies, nodes, cells, classes):
    """The result, and where the skin is at rest and how it moves."""
    folder = output / "prediction"
    folder.mkdir(exist_ok=True)
    write(folder / "mesh.vtk", nodes, cells, classes)
    case = {"case": {"units": "mm", "frame": "LPS", "volume": "mesh.vtk", "skin": {"node_set": "skin"},
                     "segments": [{"name": "jaw", "nodes": {"node_set": "jaw"}}], "fixed": [{"node_set": "held"}],
                     "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}}},
            "plan": PLAN, "spec": SPEC}
    (folder / "case.json").write_text(json.dumps(case))
    subprocess.run([facies, "predict", "--case", folder / "case.json", "--out", folder / "out"], check=True, capture_output=True)
    result = json.loads((folder / "out" / "result.json").read_text())
    found = vtu.arrays(folder / "out" / "skin.vtp")
    moved = found["displacement_mm"].reshape(-1, 3)
    return result, found["Points"].reshape(-1, 3) - moved, moved


def write(path, nodes, cells, classes):
    """A legacy VTK file with an array for each set."""
    count = np.full((len(cells), 1), 4)
    with open(path, "wb") as file:
        file.write(b"# vtk DataFile Version 3.0\nmesh\nBINARY\nDATASET UNSTRUCTURED_GRID\n")
        file.write(f"POINTS {len(nodes)} double\n".encode() + nodes.astype(">f8").tobytes())
        file.write(f"\nCELLS {len(cells)} {5 * len(cells)}\n".encode() + np.hstack([count, cells]).astype(">i4").tobytes())
        file.write(f"\nCELL_TYPES {len(cells)}\n".encode() + np.full(len(cells), 10).astype(">i4").tobytes())
        file.write(f"\nPOINT_DATA {len(nodes)}\n".encode())
        for name, members in classes.items():
            file.write(f"SCALARS set_{name} int 1\nLOOKUP_TABLE default\n".encode() + members.astype(">i4").tobytes() + b"\n")


def difference(ours, skin, moved):
    """Lengths of the difference at the points that both have."""
    tree, displacement = ours
    distance, nearest = tree.query(skin)
    same = distance < 1e-4
    assert same.mean() > 0.99, same.mean()
    return np.linalg.norm(moved[same] - displacement[nearest[same]], axis=1)


def row(name, cells, result, off):
    solver, error = result["provenance"]["solver"], result["numerical_error_mm"]
    seconds = result["provenance"]["timing"]["solve_s"]
    return (f"| {name} | {cells} | {solver['iterations']} | {seconds:.2f} | {error['mean']:.3f}, {error['p95']:.3f} | "
            f"{off.mean():.4f}, {np.quantile(off, 0.95):.4f}, {off.max():.3f} |")


if __name__ == "__main__":
    main()
