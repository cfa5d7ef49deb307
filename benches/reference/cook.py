"""Cook's membrane by Taylor and Hood's element (biquadratic displacement, bilinear pressure) in plane strain: docs/verification.md#v4."""

import itertools

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from printed import Page

# Corners in mm, and points of integration of order 5 along one axis.
CORNERS = np.array([(0, 0), (48, 44), (48, 60), (0, 44)], float)
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(3)
PLACES, WEIGHTS = (PLACES + 1) / 2, WEIGHTS / 2


def place(s, t):
    shape = [(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t]
    return np.stack(shape, axis=-1) @ CORNERS


def functions(x, count):
    """Lagrange's functions and slopes of a line with two or three nodes."""
    if count == 2:
        return np.array([1 - x, x]), np.array([-1.0, 1])
    return (np.array([2 * (x - 0.5) * (x - 1), 4 * x * (1 - x), 2 * x * (x - 0.5)]),
            np.array([4 * x - 3, 4 - 8 * x, 4 * x - 1]))


def tip(young, nu, force, n):
    """Vertical displacement of the upper corner and of the middle of the right side, mm."""
    lam, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    side = 2 * n + 1
    grid = np.linspace(0, 1, side)
    nodes = place(*np.meshgrid(grid, grid, indexing="ij")).reshape(-1, 2)
    node = lambda i, j: i * side + j
    pressure = lambda i, j: i * (n + 1) + j
    size = 2 * side * side
    entries = []
    load = np.zeros(size + (n + 1) ** 2)
    for i, j in itertools.product(range(n), repeat=2):
        at = [node(2 * i + a, 2 * j + b) for a in range(3) for b in range(3)]
        dofs = np.array([2 * k + axis for k in at for axis in (0, 1)])
        kept = np.array([size + pressure(i + a, j + b) for a in (0, 1) for b in (0, 1)])
        k, b, c = np.zeros((18, 18)), np.zeros((4, 18)), np.zeros((4, 4))
        for (x, wx), (y, wy) in itertools.product(zip(PLACES, WEIGHTS), repeat=2):
            (fx, sx), (fy, sy) = functions(x, 3), functions(y, 3)
            slopes = np.stack([np.outer(sx, fy).ravel(), np.outer(fx, sy).ravel()], axis=-1)
            jacobian = nodes[at].T @ slopes
            weight = wx * wy * np.linalg.det(jacobian)
            g = slopes @ np.linalg.inv(jacobian)
            k += weight * mu * (np.kron(g @ g.T, np.eye(2)) + np.einsum("aj,bi->aibj", g, g).reshape(18, 18))
            q = np.outer(functions(x, 2)[0], functions(y, 2)[0]).ravel()
            b += weight * np.outer(q, g.ravel())
            c += weight * np.outer(q, q) / lam
        entries += [(dofs, dofs, k), (kept, dofs, b), (dofs, kept, b.T), (kept, kept, -c)]
        if i == n - 1:  # the right side carries its share of the force, by Simpson's rule
            for b_, share in ((0, 1 / 6), (1, 4 / 6), (2, 1 / 6)):
                load[2 * node(2 * n, 2 * j + b_) + 1] += force * share / n
    rows = np.concatenate([np.repeat(r, len(s)) for r, s, _ in entries])
    columns = np.concatenate([np.tile(s, len(r)) for r, s, _ in entries])
    values = np.concatenate([v.ravel() for _, _, v in entries])
    whole = sparse.csc_matrix((values, (rows, columns)))
    held = np.zeros(len(load), bool)
    held[: 2 * side] = True  # the left side: i = 0
    u = np.zeros(len(load))
    u[~held] = splu(whole[~held][:, ~held]).solve(load[~held])
    return [u[2 * node(2 * n, 2 * n) + 1], u[2 * node(2 * n, n) + 1]]


if __name__ == "__main__":
    page = Page()
    rows = [
        (0.9375, 0.25, 1, [25.164, 23.965]),
        (240.565, 0.4999, 100, [8.069, 7.691]),
        (1.12499998125, 0.499999975, 1, [17.252, 16.444]),
        (250, 0.4999, 100, [7.764, 7.401]),
        (15, 0.46, 1, [1.3551, 1.2915]),
    ]
    for young, nu, force, printed in rows:
        page.holds(f"V.4 E {young}, nu {nu}, F {force}: corner, middle", tip(young, nu, force, 32), printed, 1.2e-3 * printed[0])
    page.end()
