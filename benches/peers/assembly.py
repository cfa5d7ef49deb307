"""The equations of the free nodes of a shell, by rows, compiled with numba; the matrix that all peers solve.

K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I) for each pair of nodes of a tetrahedron, g its
gradients of the shape functions, V its volume; right-hand sides are - K_fb u_b.
"""

import numpy as np
from numba import njit, prange


def assemble(nodes, cells, lame, held, known):
    """indptr, indices, blocks (nnz, 3, 3) over free nodes, and right-hand sides (free, 3, columns)."""
    number = np.where(held, -1, np.cumsum(~held) - 1).astype(np.int32)
    gradients, volumes = shape_gradients(nodes, cells)
    start, around = cells_around_nodes(cells, len(nodes))
    free = np.flatnonzero(~held).astype(np.int32)
    indptr, indices = pattern(free, number, cells, start, around)
    blocks, right = values(
        free, number, cells, start, around, gradients, volumes, lame, known, indptr, indices
    )
    return indptr, indices, blocks, right


@njit(parallel=True, cache=True)
def shape_gradients(nodes, cells):
    gradients = np.empty((len(cells), 4, 3))
    volumes = np.empty(len(cells))
    for cell in prange(len(cells)):
        p, q, r, s = cells[cell]
        a, b, c = nodes[q] - nodes[p], nodes[r] - nodes[p], nodes[s] - nodes[p]
        bc, ca, ab = np.cross(b, c), np.cross(c, a), np.cross(a, b)
        six_volumes = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]
        for k in range(3):
            gradients[cell, 1, k] = bc[k] / six_volumes
            gradients[cell, 2, k] = ca[k] / six_volumes
            gradients[cell, 3, k] = ab[k] / six_volumes
            gradients[cell, 0, k] = -(bc[k] + ca[k] + ab[k]) / six_volumes
        volumes[cell] = abs(six_volumes) / 6.0
    return gradients, volumes


@njit(cache=True)
def cells_around_nodes(cells, count):
    start = np.zeros(count + 1, np.int32)
    for cell in range(len(cells)):
        for corner in range(4):
            start[cells[cell, corner] + 1] += 1
    for node in range(count):
        start[node + 1] += start[node]
    around, following = np.empty(4 * len(cells), np.int32), start.copy()
    for cell in range(len(cells)):
        for corner in range(4):
            node = cells[cell, corner]
            around[following[node]] = cell
            following[node] += 1
    return start, around


@njit(cache=True)
def pattern(free, number, cells, start, around):
    indptr = np.zeros(len(free) + 1, np.int32)
    indices = np.empty(len(free) * 32, np.int32)
    seen = np.full(len(free), -1, np.int32)
    end = 0
    for row in range(len(free)):
        begin = end
        for at in range(start[free[row]], start[free[row] + 1]):
            for corner in range(4):
                column = number[cells[around[at], corner]]
                if column >= 0 and seen[column] != row:
                    seen[column] = row
                    if end == len(indices):
                        indices = np.concatenate((indices, np.empty(end, np.int32)))
                    indices[end] = column
                    end += 1
        indices[begin:end].sort()
        indptr[row + 1] = end
    return indptr, indices[:end].copy()


@njit(parallel=True, cache=True)
def values(free, number, cells, start, around, gradients, volumes, lame, known, indptr, indices):
    blocks = np.zeros((len(indices), 3, 3))
    columns = known.shape[2]
    right = np.zeros((len(free), 3, columns))
    for row in prange(len(free)):
        block = np.empty((3, 3))
        for at in range(start[free[row]], start[free[row] + 1]):
            cell = around[at]
            own = 0
            while cells[cell, own] != free[row]:
                own += 1
            for corner in range(4):
                pair(block, gradients[cell, own], gradients[cell, corner], lame[cell], volumes[cell])
                column = number[cells[cell, corner]]
                if column < 0:
                    subtract(right[row], block, known[cells[cell, corner]], columns)
                    continue
                entry = indptr[row]
                while indices[entry] != column:
                    entry += 1
                for i in range(3):
                    for j in range(3):
                        blocks[entry, i, j] += block[i, j]
    return blocks, right


@njit(cache=True)
def pair(block, g_a, g_b, lame, volume):
    dot = g_a[0] * g_b[0] + g_a[1] * g_b[1] + g_a[2] * g_b[2]
    for i in range(3):
        for j in range(3):
            block[i, j] = volume * (lame[0] * g_a[i] * g_b[j] + lame[1] * g_b[i] * g_a[j])
        block[i, i] += volume * lame[1] * dot


@njit(cache=True)
def subtract(right, block, known, columns):
    for i in range(3):
        for j in range(3):
            for column in range(columns):
                right[i, column] -= block[i, j] * known[j, column]
