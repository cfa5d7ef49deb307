"""Distances of meshes and the tissue of a CT, both ways, and volumes: distances.py SCAN MESH.vtu …

Each row: mesh to surface and surface to mesh, for skin (airways included) and bone, p50 / p95 / largest in mm, and p95 in parts of
the local cell, which is the mean edge of the cells there over .911, the mean edge of a lattice with cubes of edge one.
Surface to mesh counts where tissue is thicker than the local cell.
"""

import sys

import numpy as np

import reference
import surfaces
import vtu
from tissue import Tissue

SAMPLES = 100_000
CUBE = 0.911
HEAD = (
    "| mesh | tetrahedra | volume | | mesh to surface | of cell | surface to mesh, thick | of cell | all |\n"
    "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
)


class Reference:
    def __init__(self, scan):
        tissue = Tissue(scan)
        self.volume = tissue.volume(tissue.main)
        self.skin = reference.Surface(tissue, tissue.skin, tissue.bone)
        self.bone = reference.Surface(tissue, tissue.bone, tissue.skin)
        self.thickness = reference.Thickness(tissue.main, tissue)
        self.search = {name: surfaces.Search(s.points, s.triangles) for name, s in self.parts()}
        self.points = {name: surfaces.sampled(s.points, s.triangles, SAMPLES)[0] for name, s in self.parts()}
        self.thick = {name: self.thickness(points) for name, points in self.points.items()}

    def parts(self):
        return (("skin", self.skin), ("bone", self.bone))


class Measured:
    """A mesh held against the reference."""

    def __init__(self, path, known):
        self.nodes, self.cells, sets = vtu.read(path)
        self.faces, owners = surfaces.boundary(self.cells)
        self.size = cell_sizes(self.nodes, self.cells)[self.faces].mean(axis=1)
        self.on = {"skin": sets["skin"] | sets["airway"], "bone": sets["bone"]}
        self.volume = surfaces.volume(self.nodes, self.cells)
        self.known = known

    def to_surface(self, name):
        """Distances and local cells of points on the faces that lie on a boundary."""
        faces = self.on[name][self.faces].all(axis=1)
        points, of = surfaces.sampled(self.nodes, self.faces[faces], SAMPLES)
        return self.known.search[name].distances(points)[0], self.size[faces][of]

    def from_surface(self, name):
        """Distances and local cells of points of the surface."""
        faces = self.on[name][self.faces].any(axis=1)
        search = surfaces.Search(self.nodes, self.faces[faces])
        distance, of = search.distances(self.known.points[name])
        return distance, self.size[faces][of]


def cell_sizes(nodes, cells):
    """At each node the mean edge of its cells, as the edge of a cube of the lattice."""
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    mean = np.mean([np.linalg.norm(nodes[cells[:, i]] - nodes[cells[:, j]], axis=1) for i, j in pairs], axis=0)
    sums = np.bincount(cells.ravel(), np.repeat(mean, 4), len(nodes))
    return sums / np.maximum(np.bincount(cells.ravel(), minlength=len(nodes)), 1) / CUBE


def row(path, known):
    mesh = Measured(path, known)
    off = 100 * (mesh.volume / known.volume - 1)
    head = f"| {path.rsplit('/', 1)[-1]} | {len(mesh.cells)} | {off:+.2f} %"
    for name in ("skin", "bone"):
        there, cell = mesh.to_surface(name)
        back, cell_back = mesh.from_surface(name)
        thick = known.thick[name] >= cell_back
        print(
            f"{head} | {name} | {three(there)} | {np.quantile(there / cell, 0.95):.3f} | {three(back[thick])} | "
            f"{np.quantile((back / cell_back)[thick], 0.95):.3f} | {three(back)} ({100 * thick.mean():.0f} % thick) |",
            flush=True,
        )
        head = "| | | "


def three(values):
    return "{:.2f} / {:.2f} / {:.1f}".format(*np.quantile(values, [0.5, 0.95, 1]))


def main():
    known = Reference(sys.argv[1])
    print(f"tissue in one piece: {known.volume / 1e3:.1f} cm³\n\n{HEAD}")
    for path in sys.argv[2:]:
        row(path, known)


if __name__ == "__main__":
    main()
