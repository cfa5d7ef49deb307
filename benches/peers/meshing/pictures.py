"""Pictures of meshes: pictures.py MESH.vtu … OUTPUT.png

One sagittal slice of each mesh, cells filled by their size and by their smallest dihedral angle.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import distances
import surfaces
import vtu

ORDER = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


def slice_of(nodes, cells, axis, place):
    """The polygons in which a plane cuts cells, and the cells."""
    above = nodes[:, axis] > place
    crossed = np.flatnonzero((above[cells].sum(axis=1) % 4) != 0)
    others = [a for a in range(3) if a != axis]
    polygons = []
    for cell in cells[crossed]:
        ends = [(cell[i], cell[j]) for i, j in ORDER if above[cell[i]] != above[cell[j]]]
        at = [nodes[a] + (nodes[b] - nodes[a]) * (place - nodes[a][axis]) / (nodes[b][axis] - nodes[a][axis]) for a, b in ends]
        at = np.array(at)[:, others]
        middle = at.mean(axis=0)
        polygons.append(at[np.argsort(np.arctan2(*(at - middle).T[::-1]))])
    return polygons, crossed


def drawn(axes, title, polygons, values, limits, colours):
    filled = PolyCollection(polygons, array=values, cmap=colours, edgecolors="#00000060", linewidths=0.15)
    filled.set_clim(*limits)
    axes.add_collection(filled)
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(title, fontsize=7)
    return filled


def main():
    *meshes, output = sys.argv[1:]
    figure, grid = plt.subplots(2, len(meshes), figsize=(3.4 * len(meshes), 5.0), dpi=115, squeeze=False)
    for column, path in enumerate(meshes):
        nodes, cells, _ = vtu.read(path)
        polygons, crossed = slice_of(nodes, cells, 0, float(np.median(nodes[:, 0])) + 0.13)
        size = distances.cell_sizes(nodes, cells)[cells[crossed]].mean(axis=1)
        angle = surfaces.angles(nodes, cells[crossed]).min(axis=1)
        name = path.rsplit("/", 1)[-1][:-4]
        by_size = drawn(grid[0, column], f"{name}: size in mm", polygons, size, (2, 8), "viridis_r")
        by_angle = drawn(grid[1, column], f"{name}: smallest angle in degrees", polygons, angle, (20, 60), "magma")
    figure.colorbar(by_size, ax=grid[0, :].tolist(), shrink=0.6)
    figure.colorbar(by_angle, ax=grid[1, :].tolist(), shrink=0.6)
    figure.savefig(output, bbox_inches="tight")


if __name__ == "__main__":
    main()
