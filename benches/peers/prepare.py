"""Assembles the system of a shell and a material for all peers, and prints how long that took.

prepare.py SIZE MATERIAL FOLDER [--columns]
"""

import json
import resource
import sys
import time
from pathlib import Path

import numpy as np

import assembly
import shell


def main(size, material, folder, *flags):
    nodes, cells, tag, band = shell.read(size)
    loads = shell.response_loads if "--columns" in flags else shell.standard_load
    seconds, cpu = [], []
    for _ in range(4):  # the first compiles
        begin, cpu_begin = time.perf_counter(), time.process_time()
        held, known = shell.held(tag), loads(nodes, tag)
        system = assembly.assemble(nodes, cells, shell.lame(material, band), held, known)
        seconds.append(time.perf_counter() - begin)
        cpu.append(time.process_time() - cpu_begin)
    indptr, indices, blocks, right = system
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in [
        ("indptr", indptr),
        ("indices", indices),
        ("blocks", blocks),
        ("right", right),
        ("known", known),
        ("free", np.flatnonzero(~held)),
        ("positions", nodes[~held]),
    ]:
        np.save(folder / f"{name}.npy", content)
    report = {
        "unknowns": 3 * (len(indptr) - 1),
        "columns": right.shape[2],
        "assembly_s": float(np.median(seconds[1:])),
        "assembly_cpu_s": float(np.median(cpu[1:])),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    print(json.dumps(report))


if __name__ == "__main__":
    main(*sys.argv[1:])
