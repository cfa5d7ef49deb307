"""MKL Pardiso for symmetric positive definite matrices (pypardiso)."""

from pypardiso import PyPardisoSolver
from scipy.sparse import csr_matrix, triu


def prepare(system):
    return csr_matrix(triu(system.bsr().tocsr(), format="csr"))


def setup(matrix, threads):
    solver = PyPardisoSolver(mtype=2)
    solver.factorize(matrix)
    return solver, matrix


def solve(state, right):
    solver, matrix = state
    return solver.solve(matrix, right), 1


def release(state):
    solver, _ = state
    solver.free_memory(everything=True)
