"""Tetrahedra of a .vtu as the mesher writes it: arrays in base64 over zlib blocks (VTK file formats)."""

import base64
import re
import zlib

import numpy as np

KINDS = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}


def decoded(text, kind):
    numbers = np.frombuffer(base64.b64decode(text[:32]), "<u8")
    blocks = int(numbers[0])
    length = 8 * (3 + blocks)
    head_chars = 4 * -(-length // 3)
    sizes = np.frombuffer(base64.b64decode(text[:head_chars]), "<u8")[3:]
    data, parts, at = base64.b64decode(text[head_chars:]), [], 0
    for size in sizes:
        parts.append(zlib.decompress(data[at : at + int(size)]))
        at += int(size)
    return np.frombuffer(b"".join(parts), KINDS[kind])


def arrays(path):
    """Every array of the file by its name, flat."""
    text = open(path).read()
    found = {}
    for attributes, body in re.findall(r"<DataArray ([^>]*)>\s*([^<]*)</DataArray>", text):
        field = dict(re.findall(r'(\w+)="([^"]*)"', attributes))
        if field["format"] == "binary" and field["Name"] not in found:
            found[field["Name"]] = decoded(body.strip(), field["type"])
    return found


def read(path):
    """Nodes, cells, and the sets of nodes by name."""
    found = arrays(path)
    sets = {name[4:]: values > 0 for name, values in found.items() if name.startswith("set_")}
    return found["Points"].reshape(-1, 3), found["connectivity"].reshape(-1, 4), sets
