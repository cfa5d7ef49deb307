"""Meshers side by side in one run: peers.py SCAN STL_FOLDER BENCH OUTPUT [--slow SECONDS]

Ours meshes the scan (cubes of 4 mm, copies of nodes apart); Gmsh and TetGen fill its surface, which they keep. All meshers but
ours are then handed the two STL of the same head as they are; fTetWild, which takes minutes, only with `--slow` and for so many seconds.
Each runs in a process of its own; processor seconds are those of the process, reading and writing included.
Writes OUTPUT/meshers.md.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import distances
import surfaces
import vtu

HERE = Path(__file__).parent
CELL = 4.0
HEAD = (
    "| mesher | input | result | processor s | wall s | smallest, 0.1 %, 1 %, largest angle | volume cm³ | "
    "mesh to surface p95 mm | surface to mesh p95 mm |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
)


def main():
    options = arguments()
    output = Path(options.output)
    output.mkdir(parents=True, exist_ok=True)
    lines = [HEAD]
    for line in rows(options, output):
        lines.append(line)
        print(line, flush=True)
        (output / "meshers.md").write_text("\n".join(lines) + "\n")


def rows(options, output):
    environment = dict(os.environ, RAYON_NUM_THREADS="2")
    bench = [options.bench, "uniform-4", "--scan", options.scan, "--vtu", str(output), "--parted"]
    seconds, wall, told = timed(bench, 600, environment)
    assert told is None, told
    # The next mesh of ours has the same name.
    ours = (output / "uniform-4.vtu").replace(output / "ours.vtu")
    nodes, cells, sets = vtu.read(ours)
    known = distances.Reference(options.scan)
    yield row("facies", "scan", seconds, wall, nodes, cells, Against(known, sets["cut"], nodes, cells))
    write_surface(output / "ours.npz", nodes, cells)
    for name in ("gmsh-hxt", "gmsh-hxt-two-threads", "gmsh-delaunay", "tetgen"):
        yield peer(name, "our surface", output / "ours.npz", output, 600, None)
    skin, bone = (read_stl(Path(options.stl) / f"headsq_quarter_{part}.stl") for part in ("skin", "bone"))
    write_stl_pair(output / "stl.npz", skin, bone)
    stl = AgainstTriangles(np.vstack([skin, bone]))
    yield from ours_from_stl(options, output, environment, stl)
    for name in ("gmsh-hxt", "gmsh-delaunay", "tetgen"):
        yield peer(name, "two STL", output / "stl.npz", output, 600, stl)
    if options.slow:
        yield peer("ftetwild", "two STL", output / "stl.npz", output, options.slow, stl)


def ours_from_stl(options, output, environment, stl):
    files = [str(Path(options.stl) / f"headsq_quarter_{part}.stl") for part in ("skin", "bone")]
    bench = [options.bench, "uniform-4", "--surfaces", *files, "--vtu", str(output)]
    seconds, wall, told = timed(bench, 600, environment)
    if told:
        yield refused("facies", "two STL", told, seconds, wall)
        return
    nodes, cells, _ = vtu.read(output / "uniform-4.vtu")
    yield row("facies", "two STL", seconds, wall, nodes, cells, stl)


def peer(name, given, surface, output, limit, against):
    mesh = output / f"{name}-{surface.stem}.npz"
    mesh.unlink(missing_ok=True)
    seconds, wall, told = timed([sys.executable, HERE / "mesher.py", name, surface, mesh, str(CELL)], limit, None)
    if told or not mesh.exists():
        return refused(name, given, told or "no mesh", seconds, wall)
    found = np.load(mesh)
    if not len(found["cells"]):
        return refused(name, given, "no cells", seconds, wall)
    return row(name, given, seconds, wall, found["nodes"], found["cells"], against)


def refused(name, given, told, seconds, wall):
    return f"| {name} | {given} | {told} | {seconds:.1f} | {wall:.1f} | | | | |"


def row(name, given, seconds, wall, nodes, cells, against):
    angles = np.sort(surfaces.angles(nodes, cells).ravel())
    least = [angles[int(part * len(angles))] for part in (0, 0.001, 0.01)]
    angles = ", ".join(f"{angle:.1f}" for angle in least) + f", {angles[-1]:.0f}"
    there, back = against(nodes, cells) if against else ("as given", "as given")
    volume = surfaces.volume(nodes, cells) / 1e3
    return f"| {name} | {given} | {len(cells)} | {seconds:.1f} | {wall:.1f} | {angles} | {volume:.1f} | {there} | {back} |"


class Against:
    """Distances to the iso-surfaces of the scan, where tissue is thicker than a cell; not at the ends of the scan."""

    def __init__(self, known, cut, nodes, cells):
        self.known, self.cut = known, cut

    def __call__(self, nodes, cells):
        faces, _ = surfaces.boundary(cells)
        faces = faces[~self.cut[faces].any(axis=1)]
        points, _ = surfaces.sampled(nodes, faces, distances.SAMPLES)
        there = np.min([search.distances(points)[0] for search in self.known.search.values()], axis=0)
        search = surfaces.Search(nodes, faces)
        points = np.vstack(list(self.known.points.values()))
        thick = np.concatenate(list(self.known.thick.values())) >= CELL
        back, _ = search.distances(points[thick])
        return tuple(f"{np.quantile(d, 0.95):.2f}" for d in (there, back))


class AgainstTriangles:
    """Distances to triangles as they are, all of them: also those that bound no tissue."""

    def __init__(self, corners):
        self.points = corners.reshape(-1, 3)
        self.triangles = np.arange(len(self.points)).reshape(-1, 3)
        self.search = surfaces.Search(self.points, self.triangles)
        self.samples, _ = surfaces.sampled(self.points, self.triangles, distances.SAMPLES)

    def __call__(self, nodes, cells):
        faces, _ = surfaces.boundary(cells)
        points, _ = surfaces.sampled(nodes, faces, distances.SAMPLES)
        there, _ = self.search.distances(points)
        back, _ = surfaces.Search(nodes, faces).distances(self.samples)
        return tuple(f"{np.quantile(d, 0.95):.2f}" for d in (there, back))


def timed(command, limit, environment):
    """Processor seconds, wall seconds, and what a command said that failed."""
    begin, before = time.monotonic(), os.times()
    try:
        done = subprocess.run([str(c) for c in command], env=environment, timeout=limit, capture_output=True, text=True)
        words = (done.stderr.strip() or done.stdout.strip()).splitlines()
        told = None if done.returncode == 0 else (words[-1][:100] if words else f"status {done.returncode}")
    except subprocess.TimeoutExpired:
        told = f"stopped after {limit} s"
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    return seconds, time.monotonic() - begin, told


def write_surface(path, nodes, cells):
    """The boundary of a mesh, and a point in each void."""
    faces, _ = surfaces.boundary(cells)
    used, triangles = np.unique(faces, return_inverse=True)
    points, triangles = nodes[used], triangles.reshape(-1, 3)
    np.savez(path, points=points, triangles=triangles, holes=voids(points, triangles))


def voids(points, triangles):
    """A point in each: beside its largest triangle."""
    found = []
    for shell in surfaces.shells(points, triangles):
        if surfaces.enclosed(points, shell) < 0:
            a, b, c = (points[shell[:, corner]] for corner in range(3))
            normals = np.cross(b - a, c - a)
            sizes = np.linalg.norm(normals, axis=1)
            largest = np.argmax(sizes)
            found.append((a + b + c)[largest] / 3 + 0.02 * normals[largest] / sizes[largest])
    return np.array(found).reshape(-1, 3)


def read_stl(path):
    data = open(path, "rb").read()
    count = int.from_bytes(data[80:84], "little")
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(data, kind, count, 84)["corners"].astype(float)


def write_stl_pair(path, skin, bone):
    """Both as one surface; the bone, whose inside is no tissue, reversed."""
    corners = np.vstack([skin, bone[:, ::-1]]).reshape(-1, 3)
    points, triangles = np.unique(corners, axis=0, return_inverse=True)
    np.savez(path, points=points, triangles=triangles.reshape(-1, 3), holes=np.zeros((0, 3)))


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("scan")
    parser.add_argument("stl")
    parser.add_argument("bench")
    parser.add_argument("output")
    parser.add_argument("--slow", type=float)
    return parser.parse_args()


if __name__ == "__main__":
    main()
