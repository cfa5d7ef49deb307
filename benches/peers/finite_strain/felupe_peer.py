"""FElupe with PARDISO: SMALL.vtu FILE.vtu; prints one line of JSON."""

import felupe
import numpy as np
import pypardiso

import block
import outcome


def solve(nodes, cells):
    mesh = felupe.Mesh(nodes, cells, "tetra")
    field = felupe.FieldContainer([felupe.Field(felupe.RegionTetra(mesh), dim=3)])
    tissue = felupe.SolidBody(felupe.NeoHookeCompressible(mu=block.MU, lmbda=block.LAMBDA), field)
    at, moved = block.held(nodes)
    held = (3 * at[:, None] + np.arange(3)).ravel()
    free = np.setdiff1d(np.arange(field[0].values.size), held)
    steps = 0

    def newton(values, share):
        nonlocal steps
        field[0].values[:] = values
        prescribed = (share * moved).ravel()
        try:
            with np.errstate(all="raise"):
                found = felupe.newtonrhapson(
                    items=[tissue], dof0=held, dof1=free, ext0=prescribed, solver=pypardiso.spsolve, tol=1e-6, verbose=0,
                    maxiter=16)
        except (ValueError, FloatingPointError):
            return None
        steps += found.iterations
        return found.x[0].values.copy()

    found = block.by_parts(newton, np.zeros_like(nodes))
    return found and (found[0], found[1], steps)


outcome.tell(felupe.__version__, solve)
