"""Where the volume of a mesh lacks, by the local thickness of the tissue: missed.py SCAN MESH.vtu …

The points of the reference grid are looked up in the cells of the mesh. For each mesh its volume against the reference, the same
without tissue thinner than 2.8 and than 4 mm in either, what is lost of each class of thickness, and what is too much.
"""

import sys

import numpy as np

import reference
import vtu
from tissue import Tissue

CLASSES = [0, 1.0, 2.0, 2.8, 4.0, 5.6, 8.0, 1e9]


def in_cells(nodes, cells, tissue, shape):
    """Which points of the grid lie in a cell."""
    inside = np.zeros(shape, bool)
    places = (nodes[:, ::-1] - tissue.origin) / tissue.spacing
    corners = places[cells]
    low = np.ceil(corners.min(axis=1)).astype(int).clip(0)
    high = np.floor(corners.max(axis=1)).astype(int)
    high = np.minimum(high, np.array(shape) - 1)
    base = corners[:, 0]
    frame = np.linalg.inv(np.stack([corners[:, n] - base for n in (1, 2, 3)], axis=2))
    extent = (high - low + 1).max(axis=0)
    for step in np.ndindex(*extent):
        at = low + step
        fits = (at <= high).all(axis=1)
        part = np.einsum("nij,nj->ni", frame[fits], at[fits] - base[fits])
        hit = (part >= 0).all(axis=1) & (part.sum(axis=1) <= 1)
        inside[tuple(at[fits][hit].T)] = True
    return inside


def main():
    tissue = Tissue(sys.argv[1])
    thickness = reference.Thickness(tissue.main, tissue).largest
    ml = lambda mask: tissue.volume(mask) / 1e3
    within = [(thickness >= low) & (thickness < high) for low, high in zip(CLASSES, CLASSES[1:])]
    print(f"tissue in one piece: {ml(tissue.main):.1f} ml, all of it {ml(tissue.inside):.1f} ml")
    told = [f"{low} mm on: {ml(tissue.main & mask):.1f} ml" for low, mask in zip(CLASSES, within)]
    print("by thickness from " + ", ".join(told))
    for path in sys.argv[2:]:
        nodes, cells, _ = vtu.read(path)
        a, b, c, d = (nodes[cells[:, n]] for n in range(4))
        volume = float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6e3)
        inside = in_cells(nodes, cells, tissue, tissue.main.shape)
        lost, more = tissue.main & ~inside, inside & ~tissue.main
        thick = []
        for least in (2.8, 4.0):
            thin = tissue.main & (thickness < least)
            thick.append(f"{100 * (ml(inside & ~thin) / ml(tissue.main & ~thin) - 1):+.2f} % of tissue thicker than {least} mm")
        print(
            f"{path.rsplit('/', 1)[-1]}: {100 * (volume / ml(tissue.main) - 1):+.2f} %, {', '.join(thick)}; "
            f"lost {ml(lost):.1f} ml, too much {ml(more):.1f} ml; lost by thickness from "
            + ", ".join(f"{low} mm on: {ml(lost & mask):.1f} ml" for low, mask in zip(CLASSES, within))
        )


if __name__ == "__main__":
    main()
