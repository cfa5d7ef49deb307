"""NGSolve with its own assembly and its own sparse Cholesky, on the same mesh, material and load.

The setup includes its assembly, because NGSolve makes its matrix itself.
"""

import numpy as np
from netgen.meshing import Element3D, FaceDescriptor, Mesh, MeshPoint, Pnt  # noqa: F401
import ngsolve as ng


def prepare(system):
    nodes, cells, band, lame, known, free = system.original()
    mesh = Mesh(dim=3)
    mesh.AddPoints(np.ascontiguousarray(nodes))
    for number in (1, 2):
        chosen = np.ascontiguousarray(cells[band == number - 1])
        if len(chosen):
            mesh.AddElements(dim=3, index=number, data=chosen, base=0)
    values = [lame[band == number][0] if (band == number).any() else lame[0] for number in (0, 1)]
    return ng.Mesh(mesh), np.array(values), known, free


def setup(prepared, threads):
    mesh, lame, known, free = prepared
    ng.SetNumThreads(threads)
    space = ng.VectorH1(mesh, order=1)
    u, v = space.TnT()
    lam, mu = (ng.CoefficientFunction([float(x) for x in column]) for column in lame.T)
    strain, virtual = ng.Sym(ng.Grad(u)), ng.Sym(ng.Grad(v))
    form = ng.BilinearForm(space, symmetric=True)
    form += (2 * mu * ng.InnerProduct(strain, virtual) + lam * ng.Trace(strain) * ng.Trace(virtual)) * ng.dx
    dofs = ng.BitArray(space.ndof)
    dofs.Clear()
    for component in range(3):
        for node in free:
            dofs.Set(int(node) + component * mesh.nv)
    with ng.TaskManager():
        form.Assemble()
        inverse = form.mat.Inverse(dofs, inverse="sparsecholesky")
    return mesh, form, inverse, known, free


def solve(state, right):
    mesh, form, inverse, known, free = state
    held, answer = form.mat.CreateColVector(), form.mat.CreateColVector()
    held.FV().NumPy()[:] = known[:, :, 0].T.ravel()
    with ng.TaskManager():
        answer.data = inverse * (-form.mat * held).Evaluate()
    return answer.FV().NumPy().reshape(3, -1).T[free].ravel().copy(), 1
