"""What a peer tells of its solution: processor time, agreement with ours, energies."""

import json
import sys
import time

import numpy as np

import block
import vtu


def read(path):
    found = vtu.arrays(path)
    nodes, cells, displacement = found["Points"], found["connectivity"], found["displacement_mm"]
    return nodes.reshape(-1, 3), cells.reshape(-1, 4).astype(np.int64), displacement.reshape(-1, 3)


def tell(version, solve):
    """`solve(nodes, cells)` gives displacement, parts and steps; it is called on the small mesh first, to compile its kernels."""
    small, mesh = sys.argv[1:]
    solve(*read(small)[:2])
    nodes, cells, our = read(mesh)
    begun = time.process_time()
    found = solve(nodes, cells)
    used = time.process_time() - begun
    if found is None:
        sys.exit("no equilibrium was found")
    displacement, parts, steps = found
    far = float(np.linalg.norm(displacement - our, axis=1).max())
    print(json.dumps({
        "version": version, "tetrahedra": len(cells), "processor_s": used, "parts": parts, "steps": steps, "farthest_mm": far,
        "energy": block.energy(nodes, cells, displacement)[0], "our_energy": block.energy(nodes, cells, our)[0],
    }))
