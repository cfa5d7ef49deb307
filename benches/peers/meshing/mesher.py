"""One mesher on one surface, in a process of its own: mesher.py NAME SURFACE.npz MESH.npz CELL_MM.

SURFACE.npz holds `points`, `triangles` (outwards) and `holes`, a point in each void. Writes `nodes` and `cells`.
"""

import os
import sys
from pathlib import Path

import numpy as np

import surfaces


def gmsh(algorithm, threads):
    """Gmsh, the surface kept as it is; its own optimisation on, as by default. Threads of HXT wait for each other, which counts."""

    def run(points, triangles, holes, cell):
        import gmsh

        gmsh.initialize()
        gmsh.option.setNumber("General.Verbosity", 1)
        gmsh.option.setNumber("General.NumThreads", threads)
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        gmsh.option.setNumber("Mesh.MeshSizeMax", cell)
        all_shells = enumerate(surfaces.shells(points, triangles))
        loops = [discrete_shell(gmsh, number + 1, points, shell) for number, shell in all_shells]
        gmsh.model.geo.addVolume(loops, 1)
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(3)
        tags, places, _ = gmsh.model.mesh.getNodes()
        place = np.zeros((int(tags.max()) + 1, 3))
        place[tags] = places.reshape(-1, 3)
        cells = gmsh.model.mesh.getElementsByType(4)[1].reshape(-1, 4)
        return place, cells.astype(np.int64)

    return run


def discrete_shell(gmsh, number, points, triangles):
    """A surface of its own for each shell: HXT tells volumes apart by their surfaces."""
    gmsh.model.addDiscreteEntity(2, number)
    used = np.unique(triangles)
    gmsh.model.mesh.addNodes(2, number, used + 1, points[used].ravel())
    gmsh.model.mesh.addElementsByType(number, 2, [], (triangles + 1).ravel())
    return gmsh.model.geo.addSurfaceLoop([number])


def tetgen(points, triangles, holes, cell):
    """TetGen: boundary kept (Y), radius to edge at most 1.4, volume at most that of a lattice cell."""
    import tetgen

    mesher = tetgen.TetGen(points, triangles.astype(np.int32))
    for hole in holes:
        mesher.add_hole(hole)
    result = mesher.tetrahedralize(switches=f"pq1.4a{cell**3 / 12:.3f}YQ")
    return np.asarray(result[0]), np.asarray(result[1])[:, :4]


def ftetwild(points, triangles, holes, cell):
    """fTetWild with its defaults, an edge of a twentieth of the diagonal."""
    import pytetwild

    result = pytetwild.tetrahedralize(points, triangles.astype(np.int32), edge_length_fac=0.05, num_threads=2)
    return np.asarray(result[0]), np.asarray(result[1])


MESHERS = {
    "gmsh-hxt": gmsh(10, 1),
    "gmsh-hxt-two-threads": gmsh(10, 2),
    "gmsh-delaunay": gmsh(1, 1),
    "tetgen": tetgen,
    "ftetwild": ftetwild,
}


def main():
    name, surface, mesh, cell = sys.argv[1:]
    given, mesh = np.load(surface), Path(mesh).resolve()
    # TetGen leaves what it skips where it runs.
    os.chdir(mesh.parent)
    points, triangles = np.ascontiguousarray(given["points"]), np.ascontiguousarray(given["triangles"])
    nodes, cells = MESHERS[name](points, triangles, given["holes"], float(cell))
    a, b, c, d = (nodes[cells[:, corner]] for corner in range(4))
    turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    cells[turned] = cells[turned][:, [0, 2, 1, 3]]
    np.savez(mesh, nodes=nodes, cells=cells)


if __name__ == "__main__":
    main()
