"""Energies, stresses and tangents of the hyperelastic laws by complex steps: docs/verification.md#v17 to #printed-values.

Each law is written here once more, from its energy alone. Nothing is differentiated by hand: the stress is the imaginary part
of the energy after a step of 1e-30 i, the tangent a difference of stresses.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import brentq, fsolve

from printed import Page

MU, LAMBDA, BULK = 5.136986301369863, 59.07534246575342, 62.5  # kPa: E 15 kPa, nu .46


def invariants(f):
    c = f.T @ f
    i1 = np.trace(c)
    i2 = (i1 * i1 - np.trace(c @ c)) / 2
    return i1, i2, np.linalg.det(f)


def barrier(bulk):
    return lambda j: bulk / 4 * (j * j - 1 - 2 * np.log(j))


def logarithmic(bulk):
    return lambda j: bulk / 2 * np.log(j) ** 2


def isochoric(shape, volume):
    """A law of the invariants of F without its volume, and a law of the volume."""

    def energy(f):
        i1, i2, j = invariants(f)
        return shape(i1 * j ** (-2 / 3), i2 * j ** (-4 / 3)) + volume(j)

    return energy


def saint_venant_kirchhoff(lam, mu):
    def energy(f):
        e = (f.T @ f - np.eye(3)) / 2
        return lam / 2 * np.trace(e) ** 2 + mu * np.trace(e @ e)

    return energy


def neo_hookean(lam, mu):
    def energy(f):
        i1, _, j = invariants(f)
        return mu / 2 * (i1 - 3) - mu * np.log(j) + lam / 2 * np.log(j) ** 2

    return energy


def polyconvex_barrier(lam, mu):
    b2 = min(mu / 2, lam / 4) / 2
    a2, c2 = mu / 2 - b2, lam / 4 - b2

    def energy(f):
        i1, i2, j = invariants(f)
        return a2 * (i1 - 3) + b2 * (i2 - 3) + c2 * (j * j - 1) - (mu + lam / 2) * np.log(j)

    return energy


def ogden(terms, volume):
    def energy(f):
        # Powers of C by its eigenvalues; complex ones are those of the shifted real matrix to first order.
        c = f.T @ f
        values, axes = np.linalg.eigh(c.real)
        shifts = np.einsum("ia,ij,ja->a", axes, c.imag, axes)
        stretches = np.sqrt(values + 1j * shifts)
        j = np.linalg.det(f)
        scaled = stretches * j ** (-1 / 3)
        return sum(mu / alpha * (np.sum(scaled**alpha) - 3) for mu, alpha in terms) + volume(j)

    return energy


def with_fibres(law, k1, k2, axis):
    axis = np.asarray(axis, float)

    def energy(f):
        a = f @ axis
        i4 = a @ a
        pull = k1 / (2 * k2) * (np.exp(k2 * (i4 - 1) ** 2) - 1) if i4.real > 1 else 0
        return law(f) + pull

    return energy


def rubin_bodner(eps0, p, eta1, eta2, theta):
    def energy(f):
        i1, _, j = invariants(f)
        t = 2 * eta1 * (j - 1 - np.log(j)) + theta * eta2 * (i1 * j ** (-2 / 3) - 3)
        return eps0 / (2 * p) * (np.exp(p * t) - 1)

    return energy


def stress(law, f):
    """First Piola-Kirchhoff stress, kPa."""
    step = 1e-30
    p = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            shifted = f.astype(complex)
            shifted[i, j] += 1j * step
            p[i, j] = np.imag(law(shifted)) / step
    return p


def pulled(law, stretch):
    """Nominal stress and lateral stretch with free sides."""
    free = lambda side: stress(law, np.diag([stretch, side, side]))[1, 1]
    side = brentq(free, 0.3, 1.6, xtol=1e-14)
    return stress(law, np.diag([stretch, side, side]))[0, 0], side


def stretched(law, stretch):
    """Nominal stress and stretch across a sheet that is stretched both ways."""
    free = lambda across: stress(law, np.diag([stretch, stretch, across]))[2, 2]
    across = brentq(free, 0.2, 1.9, xtol=1e-14)
    return stress(law, np.diag([stretch, stretch, across]))[0, 0], across


def sheared(law, shear):
    """Cauchy stress 12, 11, 22, 33."""
    f = np.eye(3)
    f[0, 1] = shear
    s = stress(law, f) @ f.T
    return [s[0, 1], s[0, 0], s[1, 1], s[2, 2]]


BARRIER = barrier(BULK)
LAWS = {
    "Saint Venant-Kirchhoff": saint_venant_kirchhoff(LAMBDA, MU),
    "neo-Hookean": neo_hookean(LAMBDA, MU),
    "neo-Hookean, isochoric": isochoric(lambda a, _: MU / 2 * (a - 3), BARRIER),
    "Mooney-Rivlin": isochoric(lambda a, b: 2 * (a - 3) + (MU / 2 - 2) * (b - 3), BARRIER),
    "Veronda-Westmann": isochoric(
        lambda a, b: MU / 2 * (np.exp(2 * (a - 3)) - 1) - MU / 2 * (b - 3), BARRIER
    ),
    "Fung": isochoric(lambda a, _: MU / 2 * (np.exp(a - 3) - 1), BARRIER),
    "Ogden": ogden([(2, 3), (3 - MU, -2)], BARRIER),
    "polyconvex barrier": polyconvex_barrier(LAMBDA, MU),
    "the generic face": isochoric(
        lambda a, _: 2.5 * (a - 3) + 1.175 * (a - 3) ** 2, logarithmic(25)
    ),
}
ALONG_X = {}
for along, axis in ((False, (0.6, 0.8, 0)), (True, (1, 0, 0))):
    tissue = with_fibres(LAWS["neo-Hookean, isochoric"], 3, 2, axis)
    (ALONG_X if along else LAWS)["fibres in neo-Hookean tissue"] = tissue

page = Page()

# The table of the tests: its numbers at one general deformation, then pulled, stretched both ways, sheared.
F = np.array([[1.2, 0.1, -0.05], [0.05, 0.9, 0.1], [0.02, -0.1, 1.05]])
H = np.array([[0.1, 0.2, 0], [0, -0.1, 0.3], [0.1, 0, 0.2]])
table = Path(__file__).parents[2] / "mechanics/tests/mechanics/material/laws.txt"
for line in table.read_text().splitlines():
    if line.startswith("#"):
        continue
    name, *parts = line.split("; ")
    numbers = [np.array(part.split(), float) for part in parts]
    law, along = LAWS[name], ALONG_X.get(name, LAWS[name])
    page.holds(f"{name}, energy", np.real(law(F.astype(complex))), numbers[0], 1e-9)
    page.holds(f"{name}, P", stress(law, F), numbers[1], 1e-8)
    step = 1e-6
    bend = np.sum(H * (stress(law, F + step * H) - stress(law, F - step * H))) / (2 * step)
    page.holds(f"{name}, H:A:H", bend, numbers[2], 1e-7)
    page.holds(f"{name}, pulled", [pulled(along, s) for s in (0.7, 0.9, 1.2, 1.5)], numbers[3], 1e-6)
    page.holds(f"{name}, stretched both ways", [stretched(along, s) for s in (0.9, 1.2)], numbers[4], 1e-6)
    page.holds(f"{name}, sheared", sheared(along, 0.6), numbers[5], 1e-6)


# V.17: incompressible, so that the pressure is whatever keeps the sides free. mu 5 kPa, in Pa.
def incompressible(law, f, sides):
    """Nominal stress along x where the Cauchy stress of `sides` vanishes by a pressure."""
    s = stress(law, f) @ f.T
    return 1e3 * (s[0, 0] - s[sides, sides]) / f[0, 0]


five = isochoric(lambda a, _: 2.5 * (a - 3), barrier(0))
ends = [incompressible(five, np.diag([s, s**-0.5, s**-0.5]), 1) for s in (0.8, 1.1, 1.3, 1.5)]
both = [incompressible(five, np.diag([s, s, s**-2]), 2) for s in (1.1, 1.3)]
shears = [1e3 * sheared(five, shear)[0] for shear in (0.1, 0.3)]
page.holds("V.17 pulled", ends, [-3812.5, 1367.769, 3541.420, 5277.778], 1e-3)
page.holds("V.17 both ways", both, [2395.393, 5153.355], 1e-3)
page.holds("V.17 sheared", shears, [500, 1500], 1e-6)

# V.18, V.19, in Pa.
stretches = (0.8, 0.9, 1.1, 1.3)
page.holds(
    "V.18 neo-Hookean", [1e3 * pulled(LAWS["neo-Hookean"], s)[0] for s in stretches],
    [-3760.954, -1663.018, 1374.034, 3580.767], 1e-3,
)
gives_way = brentq(lambda s: pulled(LAWS["Saint Venant-Kirchhoff"], s + 1e-5)[0]
                   - pulled(LAWS["Saint Venant-Kirchhoff"], s - 1e-5)[0], 0.5, 0.65)
page.holds("V.18 Saint Venant-Kirchhoff gives way", gives_way, 0.57735, 1e-5)
page.holds(
    "V.19 barrier", [1e3 * pulled(LAWS["polyconvex barrier"], s)[0] for s in stretches],
    [-4137.832, -1740.400, 1318.586, 3200.486], 1e-3,
)
page.end()
