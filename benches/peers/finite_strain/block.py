"""The hard block as its bench defines it: what is held, by how much it is moved, and the energy of its tissue."""

import numpy as np

YOUNGS_MODULUS, POISSON_RATIO = 15.0, 0.46
MU = YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO))
LAMBDA = 2 * MU * POISSON_RATIO / (1 - 2 * POISSON_RATIO)


def held(nodes):
    """Numbers of the held nodes of block B, and where each is to be moved, in mm."""
    x, y, z = nodes.T
    outside = np.hypot(*(np.maximum(np.maximum(35 - v, v - 65), 0) for v in (x, y)))
    at = np.flatnonzero((np.abs(z) < 1e-9) & ((outside == 0) | (outside > 25)))
    angle, pivot = np.radians(15), np.array([50.0, 50.0, 0.0])
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    arm = nodes[at] - pivot
    moved = np.where(outside[at, None] == 0, arm @ turn.T - arm + [25.0, 0, 10.0], 0.0)
    return at, moved


def energy(nodes, cells, displacement):
    """Energy of neo-Hookean tissue in mN mm, and the smallest det F."""
    edges = [np.stack([points[cells[:, i]] - points[cells[:, 0]] for i in (1, 2, 3)], axis=2)
             for points in (nodes, nodes + displacement)]
    gradient = edges[1] @ np.linalg.inv(edges[0])
    volume = np.abs(np.linalg.det(edges[0])) / 6
    volume_change = np.linalg.det(gradient)
    logarithm = np.log(volume_change)
    density = MU / 2 * (np.einsum("nij,nij->n", gradient, gradient) - 3) - MU * logarithm + LAMBDA / 2 * logarithm**2
    return float(volume @ density), float(volume_change.min())


def by_parts(newton, state, least_part=1 / 64):
    """Moves the bones by equal parts, as users of peers do: all at once, and where Newton fails, by half as much.

    `newton(state, share)` gives the next state, or None where it does not converge. Gives the last state and the number of
    solved parts, or None where parts below `least_part` would be needed."""
    share, part, solved = 0.0, 1.0, 0
    while share < 1 - 1e-12:
        part = min(part, 1 - share)
        found = newton(state, share + part)
        if found is None:
            part /= 2
            if part < least_part:
                return None
            continue
        state, share, solved = found, share + part, solved + 1
    return state, solved
