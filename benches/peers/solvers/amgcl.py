"""AMGCL, smoothed aggregation with 3x3 blocks or with rigid movements (amgcl.cpp, which `install` builds)."""

import ctypes
import os
from weakref import finalize

import numpy as np

from peer import TOLERANCE

VARIANT = "block"
library = ctypes.CDLL(os.environ["AMGCL_LIBRARY"])
library.setup_block.restype = library.setup_rigid.restype = ctypes.c_void_p


class Hierarchy:
    def __init__(self, state):
        self.state = ctypes.c_void_p(state)
        finalize(self, getattr(library, f"release_{VARIANT}"), self.state)


def pointer(values):
    return values.ctypes.data_as(ctypes.c_void_p)


def prepare(system):
    return system.bsr().tocsr(), np.ascontiguousarray(system.rigid_movements())


def setup(prepared, threads):
    matrix, modes = prepared
    parts = [pointer(part) for part in (matrix.indptr, matrix.indices, matrix.data, modes)]
    make = getattr(library, f"setup_{VARIANT}")
    return Hierarchy(make(ctypes.c_long(matrix.shape[0]), *parts, ctypes.c_double(TOLERANCE)))


def solve(hierarchy, right):
    solution, rows = np.zeros_like(right), ctypes.c_long(len(right))
    run = getattr(library, f"solve_{VARIANT}")
    iterations = run(hierarchy.state, rows, pointer(right), pointer(solution))
    return solution, iterations
