"""CHOLMOD, supernodal, ordered by METIS (scikit-sparse over SuiteSparse)."""

from scipy.sparse import csc_matrix, tril
from sksparse.cholmod import cholesky


def prepare(system):
    return csc_matrix(tril(system.bsr().tocsc(), format="csc"))


def setup(matrix, threads):
    return cholesky(matrix, mode="supernodal", ordering_method="metis")


def solve(factor, right):
    return factor(right), 1
