"""Two predictions of one head from the front: picture.py SKINS.npz OUTPUT.png, after beside.py."""

import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from beside import SAME, interpolated, surfaces


def main():
    skins, output = np.load(sys.argv[1]), sys.argv[2]
    known = [skins[f"known_{part}"] for part in ("rest", "triangles", "moved")]
    template = [skins[f"template_{part}"] for part in ("rest", "triangles", "moved")]
    figure, axes = plt.subplots(1, 3, figsize=(11, 4.2), constrained_layout=True)
    length = lambda moved: np.linalg.norm(moved, axis=1)
    panel(figure, axes[0], "tetrahedra of the CT: movement", known, length(known[2]), "viridis", 5)
    panel(figure, axes[1], "template with its muscles: movement", template, length(template[2]), "viridis", 5)
    distance, near = surfaces.Search(template[0], template[1]).distances(known[0])
    there = interpolated(template[0], template[2], template[1][near], known[0])
    off = np.where(distance < SAME, length(known[2] - there), np.nan)
    panel(figure, axes[2], "difference, where the skins are the same", known, off, "magma", 3)
    figure.savefig(output, dpi=100)


def panel(figure, axis, title, skin, values, colours, most):
    """Triangles that face the viewer (LPS, from the front), the nearest last."""
    rest, triangles, _ = skin
    a, b, c = (rest[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    seen = normal[:, 1] < 0
    order = np.argsort(-(a + b + c)[seen][:, 1])
    triangles, normal = triangles[seen][order], normal[seen][order]
    value = values[triangles].mean(axis=1)
    colour = plt.get_cmap(colours)(np.clip(value / most, 0, 1))
    colour[np.isnan(value)] = 0.75
    light = -normal[:, 1] / np.linalg.norm(normal, axis=1)
    colour[:, :3] *= (0.55 + 0.45 * light)[:, None]
    shape = matplotlib.collections.PolyCollection(rest[triangles][:, :, [0, 2]], facecolors=colour, edgecolors=colour, linewidths=0.2)
    axis.add_collection(shape)
    axis.set_xlim(15, 195)
    axis.set_ylim(-5, 142)
    axis.set_aspect("equal")
    axis.set_title(title, fontsize=9)
    axis.set_axis_off()
    bar = plt.cm.ScalarMappable(matplotlib.colors.Normalize(0, most), colours)
    figure.colorbar(bar, ax=axis, shrink=0.6, orientation="horizontal", label="mm", pad=0.01)


if __name__ == "__main__":
    main()
