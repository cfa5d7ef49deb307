"""Solves a prepared system with one peer in this process, and prints times and memory as JSON.

peer.py NAME SYSTEM_FOLDER RUNS THREADS [--warm]. NAME is a module of solvers/, or MODULE:VARIANT. A module has

    prepare(system)          brings the matrix into the form that the peer wants; not timed
    setup(prepared, threads) factorises, or builds a hierarchy
    solve(state, right)      one right-hand side (n) or several (n, columns); answers solution and iterations
    release(state)           where Python alone does not give the memory back
"""

import importlib
import json
import os
import resource
import sys
import time
from pathlib import Path

import numpy as np

TOLERANCE = 1e-8  # |f - K u| / |f|, in the Euclidean norm


class System:
    """K u = f of the free nodes in 3x3 blocks, as prepare.py wrote it."""

    def __init__(self, folder):
        def load(name):
            return np.load(Path(folder) / f"{name}.npy")

        self.folder = folder
        self.indptr, self.indices, self.blocks = load("indptr"), load("indices"), load("blocks")
        self.right = load("right").reshape(3 * (len(self.indptr) - 1), -1)
        self.positions = load("positions")

    def bsr(self):
        from scipy.sparse import bsr_array

        return bsr_array((self.blocks, self.indices, self.indptr))

    def original(self):
        """Nodes, cells, band, Lame's constants, held displacement and free nodes, for peers that assemble."""
        import shell

        size, material = Path(self.folder).name.split("-")[:2]
        nodes, cells, _, band = shell.read(size)
        known, free = (np.load(Path(self.folder) / f"{name}.npy") for name in ("known", "free"))
        return nodes, cells, band, shell.lame(material, band), known, free

    def rigid_movements(self):
        """Three translations and three small rotations about the centre, (n, 6)."""
        x = self.positions - self.positions.mean(axis=0)
        x /= np.abs(x).max()
        modes = np.zeros((len(x), 3, 6))
        modes[:, range(3), range(3)] = 1.0
        for mode, (i, j) in enumerate([(0, 1), (1, 2), (2, 0)]):
            modes[:, i, 3 + mode], modes[:, j, 3 + mode] = -x[:, j], x[:, i]
        return modes.reshape(-1, 6)

    def relative_residual(self, solution):
        product = self.bsr() @ solution.reshape(self.right.shape)
        return np.max(np.linalg.norm(self.right - product, axis=0) / np.linalg.norm(self.right, axis=0))


def main(name, folder, runs, threads, *flags):
    module_name, _, variant = name.partition(":")
    module = importlib.import_module(f"solvers.{module_name}")
    if variant:
        module.VARIANT = variant
    base = resident_mb()
    system = System(folder)
    prepared = module.prepare(system)
    right = system.right[:, 0].copy() if system.right.shape[1] == 1 else system.right
    laps = []
    for _ in range(int(runs) + ("--warm" in flags)):
        begin = clocks()
        state = module.setup(prepared, int(threads))
        middle = clocks()
        solution, iterations = module.solve(state, right)
        laps.append((middle - begin, clocks() - middle))
        # The memory of a run is free before the next one begins.
        getattr(module, "release", lambda state: None)(state)
        del state
    setup, solve = np.median(laps["--warm" in flags :], axis=0)
    report = {
        "setup_s": setup[0],
        "setup_cpu_s": setup[1],
        "solve_s": solve[0],
        "solve_cpu_s": solve[1],
        "iterations": iterations,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "base_mb": base,
    }
    report["residual"] = system.relative_residual(solution)
    np.save(Path(folder) / f"answer-{name.replace(':', '-')}.npy", solution)
    print(json.dumps(report))


def clocks():
    return np.array([time.perf_counter(), time.process_time()])


def resident_mb():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20


if __name__ == "__main__":
    main(*sys.argv[1:])
