"""Triangles of meshes and iso-surfaces, points on them, and distances between the two."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
NEAREST = 24


def boundary(cells):
    """The faces of one cell alone, and the cells."""
    faces = cells[:, FACES].reshape(-1, 3)
    ordered = np.sort(faces, axis=1).astype(np.int64)
    size = int(cells.max()) + 1
    keys = (ordered[:, 0] * size + ordered[:, 1]) * size + ordered[:, 2]
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    alone = np.sort(first[counts == 1])
    return faces[alone], alone // 4


def shells(points, triangles):
    """Triangles that hang together over edges, the shell of the largest volume first; those of voids have a negative one.

    Shells may share a node: where a void touches the outside."""
    edges = np.sort(np.vstack([triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1).astype(np.int64)
    order = np.argsort(edges[:, 0] * len(points) + edges[:, 1], kind="stable")
    of = np.tile(np.arange(len(triangles)), 3)[order]
    same = (edges[order][1:] == edges[order][:-1]).all(axis=1)
    pairs = np.stack([of[1:][same], of[:-1][same]])
    graph = coo_array((np.ones(pairs.shape[1]), pairs), shape=(len(triangles),) * 2)
    _, shell = connected_components(graph, directed=False)
    found = [triangles[shell == number] for number in range(shell.max() + 1)]
    return sorted(found, key=lambda one: -enclosed(points, one))


def enclosed(points, triangles):
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def volume(nodes, cells):
    a, b, c, d = (nodes[cells[:, corner]] for corner in range(4))
    return float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6)


def angles(nodes, cells):
    """All dihedral angles in degrees, six for each cell."""
    corners = [nodes[cells[:, corner]] for corner in range(4)]
    a, b, c, d = corners
    normals = [np.cross(c - b, d - b), np.cross(d - a, c - a), np.cross(b - a, d - a), np.cross(c - a, b - a)]
    normals = [normal / np.linalg.norm(normal, axis=1)[:, None] for normal in normals]
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    cosines = np.array([-np.einsum("ij,ij->i", normals[i], normals[j]) for i, j in pairs])
    return np.degrees(np.arccos(np.clip(cosines, -1, 1))).T


def sampled(points, triangles, count, seed=1):
    """Points spread evenly over the area of triangles, and the triangle of each."""
    random = np.random.default_rng(seed)
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = random.choice(len(triangles), count, p=area / area.sum())
    u, v = random.random((2, count))
    over = u + v > 1
    u[over], v[over] = 1 - u[over], 1 - v[over]
    return a[chosen] + (b - a)[chosen] * u[:, None] + (c - a)[chosen] * v[:, None], chosen


class Search:
    """The nearest point of triangles: the exact distance to those whose middles are nearest."""

    def __init__(self, points, triangles):
        self.corners = points[triangles]
        self.tree = cKDTree(self.corners.mean(axis=1))
        self.nearest = min(NEAREST, len(triangles))

    def distances(self, queries):
        """To each query the distance and the triangle."""
        result, of = np.empty(len(queries)), np.empty(len(queries), int)
        for begin in range(0, len(queries), 20000):
            block = slice(begin, begin + 20000)
            _, near = self.tree.query(queries[block], self.nearest)
            distance = to_triangles(queries[block][:, None], self.corners[near])
            best = distance.argmin(axis=1)
            rows = np.arange(len(best))
            result[block], of[block] = distance[rows, best], near[rows, best]
        return result, of


def to_triangles(p, corners):
    """Ericson, Real-Time Collision Detection, 2005, section 5.1.5, for arrays."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    ab, ac, ap = b - a, c - a, p - a
    dot = lambda x, y: np.einsum("...i,...i->...", x, y)
    d00, d01, d11 = dot(ab, ab), dot(ab, ac), dot(ac, ac)
    d20, d21 = dot(ap, ab), dot(ap, ac)
    determinant = np.maximum(d00 * d11 - d01 * d01, 1e-300)
    v, w = (d11 * d20 - d01 * d21) / determinant, (d00 * d21 - d01 * d20) / determinant
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    on_face = np.linalg.norm(ap - v[..., None] * ab - w[..., None] * ac, axis=-1)
    edges = np.minimum(np.minimum(to_segment(p, a, b), to_segment(p, b, c)), to_segment(p, c, a))
    return np.where(inside, on_face, edges)


def to_segment(p, a, b):
    along = b - a
    share = np.einsum("...i,...i->...", p - a, along) / np.maximum(np.einsum("...i,...i->...", along, along), 1e-300)
    return np.linalg.norm(p - a - np.clip(share, 0, 1)[..., None] * along, axis=-1)
