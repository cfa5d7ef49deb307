"""Conjugate gradients with the inverse diagonal blocks: what thirty lines (numba) do."""

import numpy as np
from numba import njit, prange

from peer import TOLERANCE


def prepare(system):
    return system.indptr, system.indices, system.blocks


def setup(matrix, threads):
    indptr, indices, blocks = matrix
    rows = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    return matrix, np.linalg.inv(blocks[rows == indices])


def solve(state, right):
    (indptr, indices, blocks), inverse = state
    b = right.reshape(-1, 3)
    u, r = np.zeros_like(b), b.copy()
    z = precondition(inverse, r)
    p, rz, wanted = z.copy(), np.vdot(r, z), TOLERANCE * np.linalg.norm(b)
    for iteration in range(1, 5000):
        q = product(indptr, indices, blocks, p)
        alpha = rz / np.vdot(p, q)
        u += alpha * p
        r -= alpha * q
        if np.linalg.norm(r) <= wanted:
            return u.reshape(-1), iteration
        z = precondition(inverse, r)
        rz, before = np.vdot(r, z), rz
        p = z + (rz / before) * p
    raise RuntimeError(f"residual {np.linalg.norm(r) / np.linalg.norm(b):.1e} after 5000 iterations")


@njit(parallel=True, cache=True, fastmath=True)
def precondition(inverse, r):
    z = np.empty_like(r)
    for row in prange(len(r)):
        for i in range(3):
            z[row, i] = sum3(inverse, row, i, r, row)
    return z


@njit(parallel=True, cache=True, fastmath=True)
def product(indptr, indices, blocks, x):
    result = np.empty_like(x)
    for row in prange(len(x)):
        a = b = c = 0.0
        for entry in range(indptr[row], indptr[row + 1]):
            a += sum3(blocks, entry, 0, x, indices[entry])
            b += sum3(blocks, entry, 1, x, indices[entry])
            c += sum3(blocks, entry, 2, x, indices[entry])
        result[row, 0], result[row, 1], result[row, 2] = a, b, c
    return result


@njit(inline="always")
def sum3(blocks, entry, i, x, row):
    return blocks[entry, i, 0] * x[row, 0] + blocks[entry, i, 1] * x[row, 1] + blocks[entry, i, 2] * x[row, 2]
