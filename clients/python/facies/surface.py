"""Triangulated surfaces from the binary glTF of the service.

Source: glTF 2.0 specification, Khronos Group, sections 3.6 (buffers and accessors) and 4.4 (GLB).
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

HEADER_BYTES = 12
CHUNK_HEADER_BYTES = 8
NUMBERS = {5125: np.dtype("<u4"), 5126: np.dtype("<f4")}
COMPONENTS = {"SCALAR": 1, "VEC3": 3}


@dataclass(frozen=True)
class Surface:
    """Points in mm in the frame of the case, triangles, and values at the points by the names of their attributes."""

    points_mm: NDArray[np.float64]
    triangles: NDArray[np.uint32]
    values: dict[str, NDArray[np.float32]]
    extras: dict[str, Any]

    @staticmethod
    def from_glb(content: bytes) -> Surface:
        """The surface of a file that the service wrote."""
        document, binary = chunks(content)

        def array(accessor: int) -> NDArray[Any]:
            said = document["accessors"][accessor]
            view = document["bufferViews"][said["bufferView"]]
            components = COMPONENTS[said["type"]]
            numbers = np.frombuffer(binary, NUMBERS[said["componentType"]],
                                    said["count"] * components, view.get("byteOffset", 0))
            return numbers if components == 1 else numbers.reshape(-1, components)

        primitive = document["meshes"][0]["primitives"][0]
        values = {name: array(accessor) for name, accessor in primitive["attributes"].items()}
        metres = values.pop("POSITION").astype(np.float64)
        to_case = np.array(document["extras"]["matrix4x4_to_case_row_major"]).reshape(4, 4)
        return Surface(metres @ to_case[:3, :3].T + to_case[:3, 3],
                       array(primitive["indices"]).reshape(-1, 3), values, document["extras"])


def chunks(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The document and the numbers of a GLB file."""
    magic, version, length = struct.unpack_from("<4sII", content)
    if magic != b"glTF" or version != 2 or length != len(content):
        raise ValueError(f"no whole GLB 2 file: {magic!r}, version {version}, {length} of {len(content)} bytes")
    (text,) = struct.unpack_from("<I", content, HEADER_BYTES)
    begin = HEADER_BYTES + CHUNK_HEADER_BYTES
    return json.loads(content[begin:begin + text]), content[begin + text + CHUNK_HEADER_BYTES:]
