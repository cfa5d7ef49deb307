"""Finite elements of linear and neo-Hookean tissue, written once more: docs/verification.md#v29, #v14, #growth.

The slab of V.29: 60 x 30 x 12 mm, mirrored at y = 0, six tetrahedra a cube along its diagonal or hexahedra, E 15 kPa. The base moves
by d where |x| <= 12 and y <= 12 and stays where |x| >= 24 or y >= 24; the top is skin. Lengths in mm, forces in mN, moduli in kPa.
`slab.py fine` computes the rows of the finest meshes too, in some minutes and 3 GB.
"""

import itertools
import sys

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from printed import Page

YOUNG, SIZE = 15.0, (60, 30, 12)
MOVED = np.array([4.0, 0, 8])


def lame(nu):
    return YOUNG * nu / ((1 + nu) * (1 - 2 * nu)), YOUNG / (2 * (1 + nu))


def grid(h):
    """Nodes of cubes of h, x running fastest, and the eight corners of each cube."""
    counts = [round(length / h) for length in SIZE]
    axes = [np.linspace(0, length, n + 1) for length, n in zip(SIZE, counts)]
    axes[0] = axes[0] - 30
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).transpose(2, 1, 0, 3).reshape(-1, 3)
    strides = np.array([1, counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)])
    first = np.array([(i, j, k) for k in range(counts[2]) for j in range(counts[1]) for i in range(counts[0])]) @ strides
    offsets = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)]) @ strides
    return nodes, first[:, None] + offsets


def tetrahedra(cubes):
    """Six a cube, around the diagonal from the first to the last corner."""
    paths = []
    for order in itertools.permutations((1, 2, 4)):
        corners = np.cumsum((0, *order))
        odd = [order.index(1), order.index(2), order.index(4)] in ([1, 0, 2], [0, 2, 1], [2, 1, 0])
        paths.append(corners[[0, 2, 1, 3]] if odd else corners)
    return cubes[:, np.array(paths)].reshape(-1, 4)


def quadratic(nodes, cells):
    """A node in the middle of each edge."""
    pairs = np.sort(cells[:, [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]].reshape(-1, 2), axis=1)
    unique, where = np.unique(pairs, axis=0, return_inverse=True)
    middles = nodes[unique].mean(axis=1)
    return np.vstack([nodes, middles]), np.hstack([cells, len(nodes) + where.reshape(-1, 6)])


# Points of integration with weights that add up to the volume of the unit cell, and gradients of the shape functions there.
def tet4():
    gradients = np.vstack([[-1, -1, -1], np.eye(3)])
    return [(1 / 6, gradients)]


def tet10():
    one, other = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20
    corner = np.vstack([[-1, -1, -1], np.eye(3)])
    points = []
    for k in range(4):
        l = np.full(4, other)
        l[k] = one
        corners = (4 * l - 1)[:, None] * corner
        edges = [4 * (l[a] * corner[b] + l[b] * corner[a]) for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
        points.append((1 / 24, np.vstack([corners, edges])))
    return points


def hex8():
    signs = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)])
    ends = (0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3))
    points = []
    for x in itertools.product(ends, repeat=3):
        factors = np.where(signs == 1, x, 1 - np.array(x))
        gradients = np.empty((8, 3))
        for axis in range(3):
            others = [a for a in range(3) if a != axis]
            gradients[:, axis] = np.where(signs[:, axis] == 1, 1, -1) * factors[:, others].prod(axis=1)
        points.append((1 / 8, gradients))
    return points


def at_points(nodes, cells, rule):
    """For each point: volumes of the cells there, and gradients N_a,i."""
    corners = nodes[cells]
    result = []
    for weight, reference in rule:
        jacobian = np.einsum("cai,aj->cij", corners, reference)
        result.append((weight * np.linalg.det(jacobian), np.einsum("aj,cji->cai", reference, np.linalg.inv(jacobian))))
    return result


def dilatation(points):
    """The gradients averaged over each cell."""
    volume = sum(v for v, _ in points)
    return sum(v[:, None, None] * g for v, g in points) / volume[:, None, None]


def matrix(cells, blocks, count):
    """Blocks (cell, a, i, b, j) added up."""
    n, a = cells.shape
    rows = (3 * cells[:, :, None] + np.arange(3)).reshape(n, 3 * a)
    at = np.broadcast_to(rows[:, :, None], (n, 3 * a, 3 * a))
    values = blocks.reshape(n, 3 * a, 3 * a)
    return sparse.csc_matrix((values.ravel(), (at.ravel(), at.transpose(0, 2, 1).ravel())), shape=(3 * count, 3 * count))


def stiffness(cells, points, nu, count, mean=False):
    lam, mu = lame(nu)
    if mean:  # the volume change of each point is its mean over the cell
        bar = dilatation(points)
    total = 0
    for v, g in points:
        dots = np.einsum("cak,cbk->cab", g, g)
        both = mu * (np.einsum("cab,ij->caibj", dots, np.eye(3)) + np.einsum("caj,cbi->caibj", g, g))
        if mean:
            shift = (bar - g) / 3
            # eps becomes sym(g u) + shift.u 1: its trace is bar.u.
            both += 2 * mu * (np.einsum("cai,cbj->caibj", g, shift) + np.einsum("cai,cbj->caibj", shift, g)
                              + 3 * np.einsum("cai,cbj->caibj", shift, shift))
            both += lam * np.einsum("cai,cbj->caibj", bar, bar)
        else:
            both += lam * np.einsum("cai,cbj->caibj", g, g)
        total = total + v[:, None, None, None, None] * both
    return matrix(cells, total, count)


def conditions(nodes, moved):
    """Which components are held, and at what."""
    held, values = np.zeros(nodes.shape, bool), np.zeros(nodes.shape)
    x, y, z = nodes.T
    base = np.isclose(z, 0)
    jaw = base & (abs(x) <= 12 + 1e-9) & (y <= 12 + 1e-9)
    rest = base & ((abs(x) >= 24 - 1e-9) | (y >= 24 - 1e-9))
    held[jaw | rest] = True
    values[jaw] = moved
    held[np.isclose(y, 0), 1] = True
    return held.ravel(), values.ravel()


def solved(k, held, values, forces=0):
    free = ~held
    u = values.copy()
    load = np.broadcast_to(forces, u.shape) - k[:, held] @ values[held]
    factors = splu(k[free][:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0, options={"SymmetricMode": True})
    u[free] = factors.solve(load[free])
    return u


def skin_of(nodes, u):
    """Displacements of the 45 points of the skin."""
    wanted = [(x, y, 12) for x in range(-24, 25, 6) for y in range(0, 25, 6)]
    index = {tuple(np.round(p, 6)): i for i, p in enumerate(nodes)}
    return u.reshape(-1, 3)[[index[p] for p in map(lambda p: tuple(map(float, p)), wanted)]]


def model(kind, h):
    nodes, cubes = grid(h)
    if kind == "hexahedra":
        return nodes, cubes, at_points(nodes, cubes, hex8())
    cells = tetrahedra(cubes)
    if kind == "quadratic":
        nodes, cells = quadratic(nodes, cells)
        return nodes, cells, at_points(nodes, cells, tet10())
    return nodes, cells, at_points(nodes, cells, tet4())


def linear(kind, h, nu, moved=MOVED, mean=False):
    nodes, cells, points = model(kind, h)
    held, values = conditions(nodes, moved)
    return skin_of(nodes, solved(stiffness(cells, points, nu, len(nodes), mean), held, values))


def stabilised(h, nu, moved=MOVED):
    """Linear pressures with the projection of Dohrmann and Bochev: K u + B^T p = f, B u - C p = 0."""
    nodes, cells, [(v, g)] = model("tetrahedra", h)
    lam, mu = lame(nu)
    dots = np.einsum("cak,cbk->cab", g, g)
    blocks = mu * (np.einsum("cab,ij->caibj", dots, np.eye(3)) + np.einsum("caj,cbi->caibj", g, g))
    k = matrix(cells, v[:, None, None, None, None] * blocks, len(nodes))
    n = len(cells)
    b = np.broadcast_to((v / 4)[:, None, None, None] * g[:, None, :, :], (n, 4, 4, 3))
    rows = np.broadcast_to(cells[:, :, None, None], b.shape)
    columns = np.broadcast_to((3 * cells[:, :, None] + np.arange(3))[:, None], b.shape)
    b = sparse.csc_matrix((b.ravel(), (rows.ravel(), columns.ravel())), shape=(len(nodes), 3 * len(nodes)))
    mass = (np.ones((4, 4)) + np.eye(4)) / 20
    c = v[:, None, None] * (mass / lam + (mass - 1 / 16) / mu)
    at = np.broadcast_to(cells[:, :, None], c.shape)
    c = sparse.csc_matrix((c.ravel(), (at.ravel(), at.transpose(0, 2, 1).ravel())), shape=(len(nodes),) * 2)
    held, values = conditions(nodes, moved)
    whole = sparse.bmat([[k, b.T], [b, -c]]).tocsc()
    none = np.zeros(len(nodes), bool)
    u = solved(whole, np.concatenate([held, none]), np.concatenate([values, np.zeros(len(nodes))]))
    return skin_of(nodes, u[: 3 * len(nodes)])


def neo_hookean(kind, h, nu, moved, parts=4):
    """Newton's method for mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J, the movement made in equal parts."""
    nodes, cells, points = model(kind, h)
    lam, mu = lame(nu)
    held, values = conditions(nodes, moved)
    free = ~held
    u = np.zeros(3 * len(nodes))
    for part in range(1, parts + 1):
        step = np.where(held, values * part / parts - u, 0)
        for _ in range(60):
            residual, blocks = np.zeros((len(nodes), 3)), 0
            for v, g in points:
                f = np.eye(3) + np.einsum("cai,caj->cij", u.reshape(-1, 3)[cells], g)
                inverse = np.linalg.inv(f)
                log_j = np.log(np.linalg.det(f))
                # P = mu F + (lambda ln J - mu) F^-T.
                p = mu * f + (lam * log_j - mu)[:, None, None] * inverse.transpose(0, 2, 1)
                np.add.at(residual, cells, v[:, None, None] * np.einsum("cij,caj->cai", p, g))
                turned = np.einsum("cji,caj->cai", inverse, g)  # F^-T g
                dots = np.einsum("cak,cbk->cab", g, g)
                at = mu * np.einsum("cab,ij->caibj", dots, np.eye(3))
                at += lam * np.einsum("cai,cbj->caibj", turned, turned)
                at -= (lam * log_j - mu)[:, None, None, None, None] * np.einsum("caj,cbi->caibj", turned, turned)
                blocks = blocks + v[:, None, None, None, None] * at
            k = matrix(cells, blocks, len(nodes))
            change = solved(k, held, step, -residual.ravel())
            scale = 1.0
            while True:  # no point of integration may turn inside out
                tried = (u + scale * change).reshape(-1, 3)[cells]
                if all(np.linalg.det(np.eye(3) + np.einsum("cai,caj->cij", tried, g)).min() > 0 for _, g in points):
                    break
                scale /= 2
            u, step = u + scale * change, step * (1 - scale)
            if scale == 1.0 and np.abs(change[free]).max() < 1e-9:
                break
        else:
            raise SystemExit("no rest in 60 steps")
    return skin_of(nodes, u)


def error(skin, truth):
    return np.linalg.norm(skin - truth, axis=1).mean()


def shrunk(nu, g, h):
    """The skin of tissue that has g of its volume, nothing else moved: eigenstrain (g^(1/3) - 1) 1."""
    nodes, cells, points = model("quadratic", h)
    lam, mu = lame(nu)
    forces = np.zeros((len(nodes), 3))
    for v, gradients in points:
        np.add.at(forces, cells, ((3 * lam + 2 * mu) * (np.cbrt(g) - 1) * v)[:, None, None] * gradients)
    held, values = conditions(nodes, np.zeros(3))
    return skin_of(nodes, solved(stiffness(cells, points, nu, len(nodes)), held, values, forces.ravel()))


def largest_of_jacobi(nu):
    """Largest eigenvalue of D^-1 K, D the 3 x 3 blocks, on 16 x 16 x 4 cubes of 60 x 60 x 12 mm with a held base."""
    global SIZE
    kept, SIZE = SIZE, (60, 60, 15)
    nodes, cubes = grid(3.75)
    SIZE = kept
    nodes[:, 2] *= 12 / 15
    cells = tetrahedra(cubes)
    k = stiffness(cells, at_points(nodes, cells, tet4()), nu, len(nodes))
    free = np.repeat(~np.isclose(nodes[:, 2], 0), 3)
    k = k[free][:, free].tobsr((3, 3))
    rows = np.repeat(np.arange(k.shape[0] // 3), np.diff(k.indptr))
    diagonal = k.data[rows == k.indices]
    inverse = np.linalg.inv(np.linalg.cholesky(diagonal))
    scaled = sparse.block_diag(inverse, format="csr")
    return sparse.linalg.eigsh(scaled @ k @ scaled.T, k=1, which="LA", return_eigenvectors=False)[0]


if __name__ == "__main__":
    page = Page()
    is_fine = "fine" in sys.argv[1:]
    page.holds("V.14 largest eigenvalue at nu .46, .499", [largest_of_jacobi(nu) for nu in (0.46, 0.499)], [2.771, 3.405], 6e-4)

    truth = linear("quadratic", 2.0 if is_fine else 3.0, 0.46)
    page.holds("V.29 mean of the skin, nu .46", np.linalg.norm(truth, axis=1).mean(), 4.22975, 6e-6 if is_fine else 0.01)
    rows = [("tetrahedra", 6, 0.518), ("tetrahedra", 3, 0.233), ("quadratic", 6, 0.052)]
    for kind, h, printed in rows:
        page.holds(f"V.29 {kind} of {h} mm", error(linear(kind, h, 0.46), truth), printed, 6e-4 if is_fine else 0.012)
    page.holds("V.29 stabilised of 3 mm", error(stabilised(3, 0.46), truth), 0.073, 6e-4 if is_fine else 0.012)
    page.holds("V.29 hexahedra of 3 mm", error(linear("hexahedra", 3, 0.46), truth), 0.086, 6e-4 if is_fine else 0.012)
    page.holds("V.29 the same, mean dilatation", error(linear("hexahedra", 3, 0.46, mean=True), truth), 0.062, 6e-4 if is_fine else 0.012)

    # What neo-Hookean tissue does beside linear one, both of quadratic tetrahedra of 6 mm.
    apart = [error(neo_hookean("quadratic", 6, 0.46, s * MOVED), linear("quadratic", 6, 0.46, s * MOVED)) for s in (0.25, 0.5, 1, 1.5)]
    page.holds("V.29 neo-Hookean beside linear", apart, [0.048, 0.186, 0.697, 1.464], 6e-4)

    # Tissue that loses 2, 5, 10 % of its volume, and what a fit of nu makes of 5 % that it does not know of, to first order.
    lost = [np.linalg.norm(shrunk(0.46, g, 3), axis=1).mean() for g in (0.98, 0.95, 0.9)]
    page.holds("Growth: the skin of the slab", lost, [0.192, 0.485, 0.987], 4e-3)
    loss = shrunk(0.46, 0.95, 6).ravel()
    biases = []
    for moved in ((4, 0, 8), (0, 0, -6), (8, 0, 0)):
        skins = [(linear("quadratic", 6, nu, np.array(moved, float)) + shrunk(nu, 0.95, 6)).ravel() for nu in (0.455, 0.465)]
        slope = (skins[1] - skins[0]) / 0.01
        biases.append(slope @ loss / (slope @ slope))
    page.holds("Growth: nu is off by", biases, [0.17, -0.31, 0.25], 6e-3)
    page.end()
