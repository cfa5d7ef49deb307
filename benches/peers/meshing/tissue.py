"""Soft tissue of a CT by SciPy alone: what a mesh is held against. It shares no code with the mesher.

Tissue lies where min(I_skin - skin, bone - I_bone, distance to the outermost voxel centres) > 0. I_skin and I_bone are
cubic B-splines of the smoothed image, with cavities of bone and linings of airways filled in I_bone and what is apart from
the head emptied in I_skin, as `mechanics/src/domain/compartments.rs` describes it. Lengths in mm, values in Hounsfield units.
"""

import gzip

import numpy as np
from scipy import ndimage

SKIN, BONE = -300.0, 250.0
SMOOTHING, OPENING, GAP = 0.8, 10.0, 5.0
CORNER = 1.5


def read_nrrd(path):
    """Values as [z, y, x], and the spacing in that order; axes along those of space."""
    head, _, data = open(path, "rb").read().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    sizes = [int(size) for size in fields["sizes"].split()]
    vectors = [[float(x) for x in v.strip("()").split(",")] for v in fields["space directions"].split()]
    raw = gzip.decompress(data) if fields["encoding"] == "gzip" else data
    values = np.frombuffer(raw, {"short": "<i2", "float": "<f4"}[fields["type"]]).reshape(sizes[::-1])
    assert np.count_nonzero(vectors) == 3, "axes along those of space"
    origin = [float(x) for x in fields["space origin"].strip("()").split(",")]
    return values.astype(float), np.diag(vectors)[::-1], np.array(origin)[::-1]


def largest(mask):
    labels, _ = ndimage.label(mask)
    return labels == 1 + np.argmax(np.bincount(labels.ravel())[1:])


def flood(seeds, passes):
    labels, count = ndimage.label(passes)
    reached = np.zeros(count + 1, bool)
    reached[labels[seeds & passes]] = True
    reached[0] = False
    return reached[labels]


def distance_to(mask, spacing):
    return ndimage.distance_transform_edt(~mask, spacing) if mask.any() else np.full(mask.shape, np.inf)


def outer_air(head, spacing):
    """Air that a ball as wide as an opening reaches from the edges of the image, and grooves beside it."""
    at_ends = [(index == 0) | (index == size - 1) for index, size in zip(np.indices(head.shape), head.shape)]
    borders = sum(end.astype(int) for end in at_ends)
    seeds = flood(~head & (borders >= 2), ~head & (borders >= 1))
    fits = ~head & (distance_to(head, spacing) > OPENING / 2)
    reached = flood(seeds, fits) | seeds
    return ~head & (distance_to(reached, spacing) <= CORNER * OPENING / 2)


def spread(marks, passes):
    """Marks 1 and 2 grow by steps over faces; where both arrive at once the lower stays."""
    cross = ndimage.generate_binary_structure(3, 1)
    while True:
        free = passes & (marks == 0)
        grown = [ndimage.binary_dilation(marks == mark, cross) & free for mark in (1, 2)]
        if not (grown[0] | grown[1]).any():
            return marks
        marks[grown[1]] = 2
        marks[grown[0]] = 1


def channels(values, spacing):
    """The values for skin and those for bone."""
    body, bone = values >= SKIN, values >= BONE
    head = largest(body)
    outer = outer_air(head, spacing) | (~head & body)
    bone &= head
    wide = distance_to(bone, spacing) > GAP / 2
    open_ = flood(outer, outer | wide)
    sides = spread(np.where(open_, 1, np.where(wide & ~open_, 2, 0)), ~bone)
    bony = bone | (sides != 1)
    inner, tissue = ~head & ~outer & ~bony, head & ~bony
    whole = np.ones((3, 3, 3), bool)
    filled = bony & ~bone
    for between in (tissue, inner):
        lining = between & ndimage.binary_dilation(bony, whole) & ndimage.binary_dilation(inner, whole)
        bony, filled = bony | lining, filled | lining
        tissue, inner = tissue & ~lining, inner & ~lining
    scale = BONE - SKIN
    mirrored = np.clip(2 * BONE - values, BONE + 0.3 * scale, BONE + scale)
    for_bone = np.where(filled, np.maximum(values, mirrored), values)
    emptied = np.clip(2 * SKIN - values, SKIN - scale, SKIN - 0.3 * scale)
    return np.where(outer & body, emptied, values), for_bone


class Tissue:
    """The members of the function on a grid so many times as fine along z, y and x."""

    def __init__(self, path, times=(2, 4, 4)):
        values, spacing, self.origin = read_nrrd(path)
        values = ndimage.gaussian_filter(values, SMOOTHING / spacing, mode="mirror", truncate=4)
        self.coefficients = [
            ndimage.spline_filter(c, 3, mode="mirror") for c in channels(values, spacing)
        ]
        self.voxel, self.shape = spacing, values.shape
        self.spacing = spacing / times
        self.skin, self.bone = (self.refined(c, times) for c in self.coefficients)
        self.skin, self.bone = (self.skin - SKIN) / (BONE - SKIN), (BONE - self.bone) / (BONE - SKIN)
        self.inside = (self.skin > 0) & (self.bone > 0)
        self.main = largest(self.inside)

    def refined(self, coefficients, times):
        """The spline along one axis after the other, on the finer grid."""
        grid = coefficients
        for axis, (size, n) in enumerate(zip(self.shape, times)):
            grid = np.moveaxis(grid, axis, 0)
            grid = along_first(grid, np.arange((size - 1) * n + 1) / n)
            grid = np.moveaxis(grid, 0, axis)
        return np.ascontiguousarray(grid, np.float32)

    def volume(self, mask):
        """By the share of each cell of the grid that is tissue, to first order in the function."""
        weight = np.ones(mask.shape, np.float32)
        for axis in range(3):
            ends = [slice(None)] * 3
            for end in (0, -1):
                ends[axis] = end
                weight[tuple(ends)] *= 0.5
        return float((mask * weight).sum(dtype=float) * np.prod(self.spacing))


def along_first(values, places):
    """Cubic B-spline from its coefficients along the first axis, mirrored about the ends."""
    whole = np.floor(places).astype(int)
    part = places - whole
    weights = (
        (1 - part) ** 3 / 6,
        (4 - 6 * part**2 + 3 * part**3) / 6,
        (1 + 3 * part + 3 * part**2 - 3 * part**3) / 6,
        part**3 / 6,
    )
    size = len(values)
    shape = (-1,) + (1,) * (values.ndim - 1)
    result = 0.0
    for step, weight in zip(range(-1, 3), weights):
        index = np.abs(whole + step)
        index = np.where(index >= size, 2 * (size - 1) - index, index)
        result = result + values[index] * weight.reshape(shape).astype(np.float32)
    return result
