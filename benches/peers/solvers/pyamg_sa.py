"""PyAMG, smoothed aggregation with rigid movements, conjugate gradients."""

import pyamg
from scipy.sparse import bsr_matrix

from peer import TOLERANCE


def prepare(system):
    return bsr_matrix(system.bsr()), system.rigid_movements()


def setup(prepared, threads):
    matrix, modes = prepared
    # The default, a pseudo-inverse of the coarsest matrix, takes longer than all the rest.
    return pyamg.smoothed_aggregation_solver(
        matrix, B=modes, symmetry="symmetric", max_coarse=100, coarse_solver="splu"
    )


def solve(hierarchy, right):
    residuals = []
    solution = hierarchy.solve(
        right, tol=TOLERANCE, accel="cg", maxiter=1000, residuals=residuals
    )
    return solution, len(residuals) - 1
