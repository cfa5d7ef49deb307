"""Scenes with closed forms: the numbers of docs/verification.md that follow from a formula.

Lengths in mm, forces in mN, stress in kPa.
"""

import itertools

import numpy as np
from scipy.interpolate import BSpline

from printed import Page

page = Page()


def lame(young, nu):
    return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))


# V.7: a thick sphere whose inner wall moves outwards by d, E 15 kPa.
A, B, D = 60.0, 72.0, 2.0


def outer_wall(nu):
    lam, mu = lame(15, nu)
    bulk = lam + 2 * mu / 3
    # u = p r + q / r^2: the inner wall is given, the outer one free of radial stress.
    p, q = np.linalg.solve([[A, A**-2], [3 * bulk, -4 * mu * B**-3]], [D, 0])
    return p * B + q / B**2


ratios = (0, 0.3, 0.43, 0.46, 0.49, 0.499, 0.4999)
page.holds("V.7 outer wall", [outer_wall(nu) for nu in ratios],
           [1.93133, 1.65441, 1.49180, 1.44919, 1.40436, 1.39045, 1.38904], 6e-6)
page.holds("V.7 incompressible", D * A**2 / B**2, 1.38889, 6e-6)

# V.8: the same at finite strain and constant volume.
page.holds("V.8 outer wall", [np.cbrt(B**3 + (A + d) ** 3 - A**3) - B for d in (2, 5)], [1.40799, 3.58785], 6e-6)

# V.10, V.11: layers in series; a strip of skin stretched by 1 %.
page.holds("V.10", (10 / 15) / (10 / 15 + 20 / 300), 0.909091, 1e-6)
page.holds("V.11 force and lateral strain", [200 * 0.01 * 10 * 1.5, -0.45 * 0.01], [30, -0.0045], 1e-12)


# V.13: springs on the edges of tetrahedra, k = sum E V / L^2: C_ijkl = sum k L^4 d_i d_j d_k d_l / (E V) with unit edges d.
def spring_constants(edges_of_cells, volume):
    total = np.zeros((3, 3, 3, 3))
    for cell_volume, edges in edges_of_cells:
        for edge in edges:
            length = np.linalg.norm(edge)
            d = edge / length
            total += cell_volume * np.einsum("i,j,k,l->ijkl", d, d, d, d)
    return total / volume


def edges_of(corners):
    corners = np.array(corners, float)
    volume = abs(np.linalg.det(corners[1:] - corners[0])) / 6
    return volume, [b - a for a, b in itertools.combinations(corners, 2)]


kuhn = []
for order in itertools.permutations(range(3)):
    corner = np.zeros(3)
    corners = [corner]
    for axis in order:
        corner = corner + np.eye(3)[axis]
        corners.append(corner)
    kuhn.append(edges_of(corners))
cube = spring_constants(kuhn, 1.0)
page.holds("V.13 Kuhn's cube C1111, C1122, C1212", [cube[0, 0, 0, 0], cube[0, 0, 1, 1], cube[0, 1, 0, 1]],
           [13 / 9, 5 / 18, 5 / 18], 1e-12)
regular = [edges_of([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])]
cell = spring_constants(regular, regular[0][0])
page.holds("V.13 regular tetrahedra", [cell[0, 0, 0, 0], cell[0, 0, 1, 1], cell[0, 1, 0, 1]], [1, 0.5, 0.5], 1e-12)
page.holds("V.13 trace", [np.einsum("iijj", cube), np.einsum("iijj", cell)], [6, 6], 1e-12)


# V.16: tissue with fibres along x by the mass-tensor law (lambda and mu of E_f and E_t at one nu), and by engineering constants.
def tensor(lam, mu, dlam, dmu, beta, a):
    one, aa = np.eye(3), np.outer(a, a)
    e = np.einsum
    c = lam * e("ij,kl->ijkl", one, one) + mu * (e("ik,jl->ijkl", one, one) + e("il,jk->ijkl", one, one))
    c += dlam * (e("ij,kl->ijkl", aa, one) + e("ij,kl->ijkl", one, aa))
    for first, second in ((aa, one), (one, aa)):
        c += dmu * (e("ik,jl->ijkl", first, second) + e("il,jk->ijkl", first, second))
    return c + beta * e("ij,kl->ijkl", aa, aa)


PAIRS = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def voigt(c):
    return np.array([[c[i, j, k, l] for k, l in PAIRS] for i, j in PAIRS])


def modulus(c, direction):
    """Young's modulus along a direction: 1 / (n n S n n)."""
    compliance = np.linalg.inv(voigt(c))
    n = np.array(direction) / np.linalg.norm(direction)
    stress = np.array([n[i] * n[j] for i, j in PAIRS])
    # Engineering shear strains: S maps stresses to (e11, e22, e33, 2 e23, 2 e13, 2 e12).
    return 1 / (stress @ compliance @ stress)


def mass_tensor_law(along, across, nu):
    lam, mu = lame(across, nu)
    lam_a, mu_a = lame(along, nu)
    dlam, dmu = lam_a - lam, mu_a - mu
    return tensor(lam, mu, dlam, dmu, -(dlam + 2 * dmu), np.array([1.0, 0, 0]))


def mandel(c):
    """The tensor as a matrix with its own eigenvalues."""
    weights = np.sqrt([1, 1, 1, 2, 2, 2])
    return voigt(c) * np.outer(weights, weights)


muscle = mass_tensor_law(500, 790, 0.43)
directions = ((1, 0, 0), (0, 1, 0), (1, 1, 0))
page.holds("V.16 mass-tensor law", [modulus(muscle, d) for d in directions], [839.034, 892.819, 541.773], 1e-3)
least = [np.linalg.eigvalsh(mandel(mass_tensor_law(*law)))[0] for law in ((790, 500, 0.43), (110, 6.2, 0.49))]
page.holds("V.16 refused, least eigenvalue", least, [-29.5, -1646], 0.5)


def engineering(e_f, e_t, nu, shear):
    nu_tt = 1 - (1 - nu) * e_t / e_f
    s = np.zeros((6, 6))
    s[:3, :3] = [[1 / e_f, -nu / e_f, -nu / e_f], [-nu / e_f, 1 / e_t, -nu_tt / e_t], [-nu / e_f, -nu_tt / e_t, 1 / e_t]]
    s[3, 3] = 2 * (1 + nu_tt) / e_t
    s[4, 4] = s[5, 5] = 1 / shear
    return nu_tt, np.linalg.inv(s)


# Shear along the fibres as of tissue across them: E_t / (2 (1 + nu)).
nu_tt, c = engineering(110, 6.2, 0.49, 6.2 / (2 * 1.49))
page.holds("V.16 nu_tt", nu_tt, 0.9712545, 1e-7)
page.holds("V.16 C11, C12, C22, C23, along and across", [c[0, 0], c[0, 1], c[1, 1], c[1, 2], c[5, 5], c[3, 3]],
           [1882.550, 1808.725, 1847.210, 1844.065, 2.0805, 1.5726], 1e-3)

# V.20: a clamped cubic basis of five functions with the inner knot .5 at .3, a quadratic one of four.
cubic = BSpline.design_matrix([0.3], [0, 0, 0, 0, 0.5, 1, 1, 1, 1], 3).toarray()[0]
quadratic = BSpline.design_matrix([0.3], [0, 0, 0, 0.5, 1, 1, 1], 2).toarray()[0]
page.holds("V.20 cubic", cubic, [0.064, 0.558, 0.324, 0.054, 0], 1e-12)
page.holds("V.20 quadratic", quadratic, [0.16, 0.66, 0.18, 0], 1e-12)

# V.22: m x'' + d x' + k x = f from rest, in N, m, kg, s.
k, d, m, f = 80, 1, 1.32e-5, 0.01
roots = np.sort(np.roots([m, d, k]))[::-1]
page.holds("V.22 roots", roots, [-80.08466, -75677.491], 5e-4)
slow, fast = roots
moved = [f / k * (1 + (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (slow - fast)) for t in (5e-3, 12.5e-3, 50e-3, 100e-3)]
page.holds("V.22 micrometres", 1e6 * np.array(moved), [41.1567, 79.0150, 122.7178, 124.9584], 6e-5)
page.holds("V.22 longest explicit step, microseconds", 2e6 * m / d, 26.4, 1e-9)

# V.24: a block between four sliding walls, and between two.
page.holds("V.24 four walls", [lam + 2 * mu for lam, mu in (lame(15, nu) for nu in (0.3, 0.46, 0.49))],
           [20.1923, 69.3493, 256.7114], 6e-5)
page.holds("V.24 two walls", [15 / (1 - nu**2) for nu in (0.3, 0.46, 0.49)], [16.4835, 19.0259, 19.7394], 6e-5)

# V.26: Hertz, a rigid ball of radius 10 on a half space of E 15, nu .49 under 20 mN.
stiffness, radius, force = 15 / (1 - 0.49**2), 10, 20
a = np.cbrt(3 * force * radius / (4 * stiffness))
page.holds("V.26 radius, indentation, pressure", [a, a * a / radius, 3 * force / (2 * np.pi * a * a)],
           [1.96601, 0.386519, 2.470589], 6e-6)

# A sphere that is cut, two spheres that overlap, a box that is cut obliquely.
radius, away = 10, 6
height = radius - away
cap = np.pi * height**2 * (3 * radius - height) / 3
page.holds("Cuts: sphere", [cap, 4 / 3 * np.pi * radius**3 - cap, np.pi * (radius**2 - away**2), 2 * np.pi * radius * height],
           [435.634181, 3753.156023, 201.061930, 251.327412], 1e-6)
page.holds("Cuts: lens", 2 * np.pi * 2.5**2 * (3 * 10 - 2.5) / 3, 359.974158, 1e-6)
page.holds("Cuts: box", [40 * 30 * (5 + 0.1 * 20 + 0.2 * 15), 40 * 30 * np.sqrt(1 + 0.1**2 + 0.2**2)], [12000, 1229.634092], 1e-6)

# Growth by g of the volume: free, held at its sides, confined.
page.holds("Growth: free", np.cbrt(0.9), 0.9654893846, 1e-10)
grown = np.cbrt([0.98, 0.9]) - 1
page.holds("Growth: held at its sides, strain across", grown * (1 + 0.46) / (1 - 0.46), [-0.0181462, -0.0933065], 1e-6)
page.holds("Growth: held at its sides, stress", -15 * grown / (1 - 0.46), [0.186434, 0.958628], 1e-6)
page.holds("Growth: confined, pressure", -3 * 62.5 * grown[1], 6.47074, 6e-6)

# Muscles: free along their fibres, and held; T 10 kPa, E_f 110 kPa, nu .49, 100 mm2.
page.holds("Muscles", [-10 / 110, 0.49 * 10 / 110, 10 * 100], [-0.0909091, 0.0445455, 1000], 1e-6)

# A column under its own weight, mg/mm3, mm/ms2.
weight, length, area, young = 1.04 * 9.81e-3, 100, 100, 15
page.holds("Column: tip", weight * length**2 / (2 * young), 3.4008, 1e-4)
page.holds("Column: squared energy norm", [weight**2 * area * length * h**2 / (12 * young) for h in (10, 5)],
           [0.578272, 0.144568], 1e-6)
page.end()
