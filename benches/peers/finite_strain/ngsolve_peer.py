"""NGSolve with a symbolic energy and its own sparse Cholesky factorisation: SMALL.vtu FILE.vtu; prints one line of JSON."""

import netgen.meshing
import ngsolve
import numpy as np
from ngsolve import BilinearForm, CoefficientFunction, Det, Grad, GridFunction, Id, Trace, Variation, VectorH1, dx, log

import block
import outcome

ngsolve.SetNumThreads(1)


def netgen_mesh(nodes, cells):
    mesh = netgen.meshing.Mesh()
    at = [mesh.Add(netgen.meshing.MeshPoint(netgen.meshing.Pnt(*point))) for point in nodes]
    mesh.SetMaterial(1, "tissue")
    for cell in cells:
        mesh.Add(netgen.meshing.Element3D(1, [at[i] for i in cell]))
    return ngsolve.Mesh(mesh)


def solve(nodes, cells):
    space = VectorH1(netgen_mesh(nodes, cells), order=1)
    gradient = Id(3) + Grad(space.TrialFunction())
    logarithm = log(Det(gradient))
    density = (block.MU / 2 * (Trace(gradient.trans * gradient) - 3) - block.MU * logarithm
               + block.LAMBDA / 2 * logarithm * logarithm)
    form = BilinearForm(space, symmetric=True)
    form += Variation(density.Compile() * dx)
    at, moved = block.held(nodes)
    count = len(nodes)
    held = (at[:, None] + count * np.arange(3)).ravel()
    free = ngsolve.BitArray(space.ndof)
    free.Set()
    for dof in held:
        free.Clear(int(dof))
    is_free = np.ones(space.ndof, dtype=bool)
    is_free[held] = False
    state = GridFunction(space)
    residual, direction = state.vec.CreateVector(), state.vec.CreateVector()
    values = state.vec.FV().NumPy()
    steps = 0

    def newton(begun, share):
        nonlocal steps
        values[:] = begun
        step = np.zeros(space.ndof)
        step[held] = (share * moved).ravel() - begun[held]
        # The bones are moved by the tangent of the state before, so that their neighbours go along with them.
        for _ in range(16):
            form.Apply(state.vec, residual)
            form.AssembleLinearization(state.vec)
            direction.FV().NumPy()[:] = step
            residual.data += form.mat * direction
            try:
                inverse = form.mat.Inverse(free, inverse="sparsecholesky")
            except Exception:  # NGSolve throws what its factorisation finds as a plain exception
                return None
            direction.data -= inverse * residual
            values[:] += direction.FV().NumPy()
            step[:] = 0
            steps += 1
            form.Apply(state.vec, residual)
            forces = residual.FV().NumPy()
            if not np.isfinite(forces).all():
                return None
            if np.linalg.norm(forces[is_free]) < 1e-6 * np.linalg.norm(forces[held]):
                return values.copy()
        return None

    found = block.by_parts(newton, np.zeros(space.ndof))
    return found and (found[0].reshape(3, count).T, found[1], steps)


outcome.tell(ngsolve.__version__, solve)
