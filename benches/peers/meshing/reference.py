"""The surfaces of the tissue of a CT: iso-surfaces of the finer grid by marching cubes, with the thickness of the tissue there.

A grid of .75 x .8 x .8 mm: marching cubes are linear between its points, which moves the surface by some hundredths of a mm.
"""

import numpy as np
from scipy import ndimage
from skimage.measure import marching_cubes

LEVELS = np.array([1.0, 1.5, 2.0, 2.5, 2.8, 3.2, 3.6, 4.0, 4.5, 5.0, 5.6, 6.5, 8.0, 10.0, 12.0, 16.0])


class Surface:
    """Points as x, y, z in mm, triangles, and the function that tells how thick tissue is."""

    def __init__(self, tissue, member, other):
        points, triangles, _, _ = marching_cubes(member, 0.0)
        middles = points[triangles].mean(axis=1)
        kept = at(other, middles) > 0
        kept &= near(tissue.main, middles)
        kept &= ((middles > 0.5) & (middles < np.array(member.shape) - 1.5)).all(axis=1)
        self.triangles = triangles[kept]
        self.points = (points * tissue.spacing + tissue.origin)[:, ::-1]


def at(grid, places, order=1):
    return ndimage.map_coordinates(grid, places.T, order=order, mode="nearest")


def near(mask, places):
    """Whether one of the eight grid points about a place is in the mask."""
    corner = np.floor(places).astype(int)
    found = np.zeros(len(places), bool)
    for step in np.ndindex(2, 2, 2):
        index = np.minimum(corner + step, np.array(mask.shape) - 1)
        found |= mask[tuple(index.T)]
    return found


class Thickness:
    """Local thickness: the diameter of the largest ball of tissue that reaches a place, in steps.

    Source: Hildebrand, Rueegsegger, A new method for the model-independent assessment of thickness in three-dimensional
    images, Journal of Microscopy 185 (1997)."""

    def __init__(self, mask, tissue):
        self.tissue = tissue
        half = 0.5 * float(np.mean(tissue.spacing))
        depth = ndimage.distance_transform_edt(np.pad(mask, 1, mode="edge"), tissue.spacing)
        depth = depth[1:-1, 1:-1, 1:-1] - half
        self.largest = np.zeros(mask.shape, np.float32)
        for level in LEVELS:
            core = depth >= level / 2
            if not core.any():
                break
            reached = ndimage.distance_transform_edt(~core, tissue.spacing) <= level / 2 + half
            self.largest[reached] = level

    def __call__(self, points):
        places = (points[:, ::-1] - self.tissue.origin) / self.tissue.spacing
        return at(self.largest, places, order=0)
