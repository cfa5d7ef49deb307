"""The matrix that peers solve against that of scikit-fem: largest relative difference, and seconds of both."""

import json
import sys
import time

import numpy as np
from scipy.sparse import bsr_array
from skfem import Basis, BilinearForm, ElementTetP1, ElementVector, MeshTet
from skfem.helpers import ddot, eye, sym_grad, trace

import assembly
import shell


def main(size, material):
    nodes, cells, tag, band = shell.read(size)
    lame, held, known = shell.lame(material, band), shell.held(tag), shell.standard_load(nodes, tag)
    assembly.assemble(nodes, cells, lame, held, known)  # compiles
    begin = time.perf_counter()
    indptr, indices, blocks, _ = assembly.assemble(nodes, cells, lame, held, known)
    ours_s = time.perf_counter() - begin
    begin = time.perf_counter()
    theirs = scikit_fem(nodes, cells, lame)
    theirs_s = time.perf_counter() - begin
    free = np.flatnonzero(~np.repeat(held, 3))
    ours = bsr_array((blocks, indices, indptr)).tocsr()
    difference = abs(ours - theirs[free][:, free]).max() / abs(ours).max()
    report = {"size": size, "relative_difference": difference, "numba_s": ours_s, "scikit_fem_s": theirs_s}
    print(json.dumps(report))


def scikit_fem(nodes, cells, lame):
    basis = Basis(MeshTet(nodes.T.copy(), cells.T.copy().astype(np.int64)), ElementVector(ElementTetP1()))

    @BilinearForm
    def stiffness(u, v, w):
        strain, (lam, mu) = sym_grad(u), lame.T[:, :, None]
        return ddot(lam * eye(trace(strain), 3) + 2 * mu * strain, sym_grad(v))

    return stiffness.assemble(basis).tocsr()


if __name__ == "__main__":
    main(*sys.argv[1:])
