"""The face-like shells of the shared data, their materials and their standard load (the README of the data)."""

import base64
import os
import re
import struct
import zlib
from pathlib import Path

import numpy as np

FIXED, MAXILLA, MANDIBLE, REAR = 1, 2, 3, 4  # values of the point array "tag" that are held or moved

# Young's modulus in kPa and Poisson's ratio of the soft tissue and of the bands.
MATERIALS = {
    "a": ((15.0, 0.46), (15.0, 0.46)),
    "b": ((3.0, 0.46), (790.0, 0.43)),
    "c": ((15.0, 0.49), (15.0, 0.49)),
    "d": ((15.0, 0.499), (15.0, 0.499)),
}


def path(size):
    shared = os.environ.get("FACIES_SHARED") or Path(__file__).parents[2] / ".." / "shared"
    return Path(shared) / "data" / "shell" / f"{size}.vtu"


def read(size):
    """Nodes (n, 3) in mm, tetrahedra (m, 4), tag of each node, band of each tetrahedron."""
    text = path(size).read_bytes()
    nodes = array(text, "Points", np.float64).reshape(-1, 3)
    cells = array(text, "connectivity", np.int32).reshape(-1, 4)
    return nodes, cells, array(text, "tag", np.int32), array(text, "band", np.int32)


def array(text, name, kind):
    """An inline array of a VTU file: base64 of block sizes, then base64 of zlib blocks."""
    found = re.search(rb'<DataArray[^>]*Name="%s"[^>]*>\s*([^<]*?)\s*<' % name.encode(), text)
    encoded = found.group(1)
    blocks = struct.unpack("<I", base64.b64decode(encoded[:8])[:4])[0]
    head = 4 * -(-(4 * (3 + blocks)) // 3)
    sizes = struct.unpack(f"<{3 + blocks}I", base64.b64decode(encoded[:head])[: 4 * (3 + blocks)])[3:]
    packed, begin, parts = base64.b64decode(encoded[head:]), 0, []
    for size in sizes:
        parts.append(zlib.decompress(packed[begin : begin + size]))
        begin += size
    return np.frombuffer(b"".join(parts), kind)


def lame(material, band):
    """Lame's lambda and mu in kPa for each tetrahedron."""
    e, nu = np.array(MATERIALS[material]).T
    by_band = np.stack([e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))], axis=1)
    return np.ascontiguousarray(by_band[(band == 1).astype(int)])


def held(tag):
    return np.isin(tag, [FIXED, MAXILLA, MANDIBLE, REAR])


def standard_load(nodes, tag):
    """Displacement (n, 3, 1) in mm of the held nodes, zero elsewhere."""
    u = np.zeros_like(nodes)
    for value, axis, pivot, along in [
        (MAXILLA, 0, (0, 50, -10), (0, 7, -4)),
        (MANDIBLE, 2, (0, 40, -50), (0, -7, 4)),
    ]:
        x = nodes[tag == value] - np.array(pivot, float)
        shift = 8.0 * np.array(along, float) / np.linalg.norm(along)
        u[tag == value] = x @ (rotation(axis, np.radians(3.0)).T - np.eye(3)) + shift
    return u[:, :, None]


def response_loads(nodes, tag):
    """Displacement (n, 3, 24): column 12 s + 4 i + j multiplies (R - I)_ij (j < 3) or t_i (j = 3)."""
    u = np.zeros((len(nodes), 3, 24))
    for segment, value in enumerate([MAXILLA, MANDIBLE]):
        moved = np.flatnonzero(tag == value)
        x = nodes[moved] - nodes[moved].mean(axis=0)
        factors = np.column_stack([x, np.ones(len(x))])
        for i in range(3):
            for j in range(4):
                u[moved, i, 12 * segment + 4 * i + j] = factors[:, j]
    return u


def rotation(axis, angle):
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = np.cos(angle)
    turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
    return turn
