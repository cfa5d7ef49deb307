"""PETSc conjugate gradients: smoothed aggregation (gamg) with rigid movements, or hypre's BoomerAMG (hypre)."""

import glob
import os
import sys

import numpy as np

# Debian keeps the module with the library; the link that should lead there, /usr/lib/petsc, is not on every machine.
LIBRARIES = sorted(glob.glob("/usr/lib/petscdir/petsc*/*-real"))
if LIBRARIES and not os.path.exists("/usr/lib/petsc"):
    os.environ.setdefault("PETSC_DIR", LIBRARIES[-1])
    sys.path.append(os.environ["PETSC_DIR"] + "/lib/python3/dist-packages")

import petsc4py  # noqa: E402  (after its place is known)

VARIANT = "gamg"
OPTIONS = {
    "gamg": "-pc_type gamg -pc_gamg_type agg -mg_levels_pc_type jacobi -mg_levels_ksp_type chebyshev",
    # Nodal coarsening and interpolation for systems, as hypre's manual recommends for elasticity.
    "hypre": "-pc_type hypre -pc_hypre_type boomeramg -pc_hypre_boomeramg_strong_threshold 0.5"
    " -pc_hypre_boomeramg_nodal_coarsen 4 -pc_hypre_boomeramg_vec_interp_variant 2",
}

petsc4py.init(sys.argv[:1])
from petsc4py import PETSc  # noqa: E402  (after init, as petsc4py asks)

from peer import TOLERANCE  # noqa: E402


def prepare(system):
    n = 3 * (len(system.indptr) - 1)
    matrix = PETSc.Mat().createAIJ(size=(n, n), csr=system_csr(system))
    matrix.setBlockSize(3)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    modes = [PETSc.Vec().createWithArray(mode.copy()) for mode in system.rigid_movements().T]
    for k, mode in enumerate(modes):  # PETSc wants them orthonormal
        for other in modes[:k]:
            mode.axpy(-mode.dot(other), other)
        mode.normalize()
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=modes))
    return matrix


def system_csr(system):
    """Scalar rows of the blocks, without SciPy, which Debian's Python need not have."""
    counts = 3 * np.diff(system.indptr)
    indptr = np.concatenate([[0], np.cumsum(np.repeat(counts, 3))]).astype(np.int32)
    order = np.empty(len(system.indices) * 9, np.int32)
    values = np.empty(len(system.indices) * 9)
    row_of = np.repeat(np.arange(len(counts)), np.diff(system.indptr))
    within = np.arange(len(system.indices)) - system.indptr[row_of]
    for i in range(3):
        for j in range(3):
            at = indptr[3 * row_of + i] + 3 * within + j
            order[at] = 3 * system.indices + j
            values[at] = system.blocks[:, i, j]
    return indptr, order, values


def setup(matrix, threads):
    PETSc.Options().insertString(OPTIONS[VARIANT])
    solver = PETSc.KSP().create()
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.setTolerances(rtol=TOLERANCE, max_it=2000)
    solver.setFromOptions()
    solver.setUp()
    return solver


def solve(solver, right):
    solution = np.zeros_like(right)
    solver.solve(PETSc.Vec().createWithArray(right), PETSc.Vec().createWithArray(solution))
    return solution, solver.getIterationNumber()


def release(solver):
    solver.destroy()
