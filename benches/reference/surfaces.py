"""Statistics of surfaces and methods, landmarks, regression: the numbers of docs/verification.md#surfaces-and-statistics."""

import itertools

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.stats import wilcoxon

from printed import Page

page = Page()


# V.39: 70 mm against 70 mm shifted by 2 mm: the distance of a point is 2 |cos|, |cos| uniform over the sphere.
share = (np.arange(2_000_000) + 0.5) / 2_000_000
apart = 2 * share
page.holds("V.39 mean, rms, p90, p95", [apart.mean(), np.sqrt((apart**2).mean()), *np.quantile(apart, (0.9, 0.95))],
           [1, 1.15470, 1.8, 1.9], 6e-6)

# A sphere of 70 mm turned by 2 degrees: a point moves by 2 R sin(1 deg) times the sine of its angle to the axis.
sines = np.sqrt(1 - share**2)
moved = 2 * 70 * np.sin(np.radians(1)) * sines
page.holds("Turned sphere: mean, rms, median, p90, p95, largest",
           [moved.mean(), np.sqrt((moved**2).mean()), *np.quantile(moved, (0.5, 0.9, 0.95)), moved.max()],
           [1.91899, 1.99498, 2.11599, 2.43109, 2.44028, 2.44334], 6e-6)

# Thin-plate spline with the kernel r in space.
rest = np.array([(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10), (10, 10, 10)], float)
wanted = rest.copy()
wanted[1] = (10, 0.5, 0)
wanted[4] = (11, 10, 10)
spline = RBFInterpolator(rest, wanted, kernel="linear", degree=1)
page.holds("Thin-plate spline", spline([[5, 5, 5]])[0], [5.2982481991, 5.1008759005, 5], 1e-9)

# V.41: inverse square of the distance.
places, values = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float), np.array([1, 3, 5])
weights = 1 / np.sum((places - [0.25, 0.25, 0]) ** 2, axis=1)
page.holds("V.41", weights @ values / weights.sum(), 1.8571428571, 1e-10)

# V.32: regression with sums of absolute differences.
features, answers = np.array([(0, 0), (1, 0), (0, 2)], float), np.array([1, 2, 4], float)


def regression(query, width, features, answers):
    g = np.abs(features - query).sum(axis=1)
    weight = np.exp(-(g - g.min()) / width)
    return weight @ answers / weight.sum()


page.holds("V.32 query", [regression([0.5, 0.5], s, features, answers) for s in (0.5, 1, 2)],
           [1.6584473458, 1.8884060087, 2.0817413440], 1e-10)


def left_out(width):
    others = [np.arange(3) != i for i in range(3)]
    errors = [regression(features[i], width, features[o], answers[o]) - answers[i] for i, o in enumerate(others)]
    return np.sqrt(np.mean(np.square(errors)))


page.holds("V.32 leave-one-out", [left_out(s) for s in (0.5, 1, 2, 10)], [1.8909993, 1.8471989, 1.8252781, 1.8530184], 1e-7)
page.holds("V.32 least of steps of .01", min(left_out(s) for s in np.arange(0.5, 10, 0.01)), 1.825256, 1e-6)


# V.40: exact signed ranks, by counting every choice of signs.
def least_p(pairs):
    return 2 / 2**pairs


page.holds("V.40 four and eleven pairs of one sign", [wilcoxon(np.arange(1.0, n + 1)).pvalue for n in (4, 11)],
           [0.125, 0.0009765625], 1e-12)
page.holds("V.40 the same by formula", [least_p(4), least_p(11)], [0.125, 0.0009765625], 0)

# Cephalometry of the example head, LPS, mm: S, N, A, B, upper and lower incisor, pairs of Po and Or.
S, N, U1, L1 = np.array([(0, 20, 60), (0, -48, 70), (0, -57, -6), (0, -53, -5)], float)


def point_angle(point):
    one, other = S - N, np.array(point, float) - N
    return np.degrees(np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other)))


sna, snb, snb_forward = point_angle((0, -52, 18)), point_angle((0, -46, -28)), point_angle((0, -50, -28))
frankfort = np.array([(55, 38, 38), (-55, 38, 38), (35, -38, 36), (-35, -38, 36)], float)
normal = np.linalg.svd(frankfort - frankfort.mean(axis=0))[2][2]
normal *= np.sign(normal[2])
forward = np.cross([1, 0, 0], normal)
forward *= -np.sign(forward[1])
page.holds("SNA, SNB, ANB", [sna, snb, sna - snb], [86.0328192310, 80.4649745481, 5.5678446829], 1e-9)
page.holds("overjet, overbite along Frankfort", [(U1 - L1) @ forward, (L1 - U1) @ normal], [4.0249223595, 0.8944271910], 1e-9)
page.holds("SNB, ANB, 4 mm forward", [snb_forward, sna - snb_forward], [82.8032532039, 3.2295660271], 1e-9)

# V.28: a hexahedron with positive corners that is folded inside.
corners = np.array([(0.7, -0.6, -0.2), (1.3, 0.1, 0), (0.7, 0.7, 0.7), (0.3, 1.4, -0.6), (-0.5, -0.1, 0.9),
                    (1, 0.4, 1.4), (0.7, 0.7, 0.6), (0.3, 1.6, 1.6)])
signs = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)])


def determinant(x):
    rows = np.empty((8, 3))
    for axis in range(3):
        factors = np.where(signs == 1, x, 1 - x)
        factors[:, axis] = np.where(signs[:, axis] == 1, 1, -1)
        rows[:, axis] = factors.prod(axis=1)
    return np.linalg.det(corners.T @ rows)


page.holds("V.28 least at a corner", min(determinant(np.array(s, float)) for s in signs), 0.052, 5e-4)
inside = min(determinant(np.array(x)) for x in itertools.product(np.linspace(0, 1, 61), repeat=3))
page.holds("V.28 inside", inside, -0.7645, 2e-3)
page.end()
