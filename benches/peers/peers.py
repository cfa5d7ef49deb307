"""The peers: how each is called, its row in tables, its module, and its line in charts."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Peer:
    name: str  # module of solvers/, with its variant
    title: str
    needs: str  # what `install` calls it
    colour: str
    dash: str
    mark: str
    assembles: bool = False  # makes its matrix itself, within the setup
    debian: bool = False  # runs under Debian's Python
    many: bool = False  # takes several right-hand sides at once


# Colours of Okabe and Ito, told apart by every kind of colour vision; dashes and marks repeat the difference.
PEERS = [
    Peer("pardiso", "MKL Pardiso", "pardiso", "#0072B2", "", "square", many=True),
    Peer("cholmod", "CHOLMOD, METIS", "cholmod", "#56B4E9", "8 3", "diamond", many=True),
    Peer("amgcl:block", "AMGCL, 3x3 blocks", "amgcl", "#009E73", "", "triangle"),
    Peer("amgcl:rigid", "AMGCL, rigid modes", "amgcl", "#009E73", "3 3", "triangle"),
    Peer("petsc:gamg", "PETSc GAMG, rigid modes", "petsc", "#E69F00", "", "circle", debian=True),
    Peer("petsc:hypre", "hypre BoomerAMG", "petsc", "#E69F00", "3 3", "circle", debian=True),
    Peer("pyamg_sa", "PyAMG, rigid modes", "pyamg", "#CC79A7", "8 3", "square"),
    Peer("ngsolve_own", "NGSolve, its Cholesky", "ngsolve", "#7F5A00", "", "diamond", assembles=True),
    Peer("jacobi", "block-Jacobi PCG", "numba", "#777777", "3 3", "circle"),
]
OURS = Peer("facies", "facies", "", "#D55E00", "", "circle", assembles=True, many=True)


def by_name(name):
    return next(peer for peer in [*PEERS, OURS] if peer.name == name)
