"""Runs every program on the same systems, each in a process of its own, taking turns; answers rows.

A row is a dictionary: program, size, material, threads, columns, assembly_s, setup_s, solve_s, total_s and
the same with cpu, iterations, residual, added_mb, difference_mm (against the program `reference`), or error.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import shell
from peers import OURS, PEERS

HERE = Path(__file__).parent
LONGEST = 1800  # seconds that one process may take
SMALL = ("30k", "100k")  # cheap enough to warm up and repeat within a process


class Bench:
    def __init__(self, environment, shells_bench, chosen):
        self.environment, self.shells_bench = Path(environment).resolve(), shells_bench
        self.python = str(self.environment / "venv/bin/python")
        self.peers = [peer for peer in PEERS if not chosen or peer.name in chosen]

    def absent(self):
        told = {path.name: path.read_text().strip() for path in self.environment.glob("absent/*")}
        return {peer.name: told[peer.needs] for peer in self.peers if peer.needs in told}

    def check_assembly(self):
        return self.call([self.python, "check_assembly.py", "30k", "b"], 1)

    def round(self, size, material, threads, columns):
        """One row of each program, in turn."""
        flag = ["--columns"] if columns else []
        name = f"{size}-{material}" + ("-columns" if columns else "")
        system = self.environment / "systems" / name
        made = self.call([self.python, "prepare.py", size, material, str(system), *flag], threads)
        rows = [self.own(size, material, threads, flag, system)]
        if "error" in made:
            return rows + [{"program": "assembly", **made}]
        absent = self.absent()
        for peer in self.peers:
            if columns and not peer.many:
                continue
            row = {"error": absent[peer.name]} if peer.name in absent else self.peer(peer, size, system, threads)
            rows.append({"program": peer.name, **added(row, made, peer)})
        common = {"size": size, "material": material, "threads": threads, "columns": made["columns"]}
        self.compare(rows, system)
        return [{**row, **common, "unknowns": made["unknowns"]} for row in rows]

    def peer(self, peer, size, system, threads):
        python = "/usr/bin/python3" if peer.debian else self.python
        runs = ["3", str(threads), "--warm"] if size in SMALL else ["1", str(threads)]
        return self.call([python, "peer.py", peer.name, str(system), *runs], threads)

    def own(self, size, material, threads, flag, system):
        answer, lines = system / "answer-facies.f64", system / "facies.json"
        lines.unlink(missing_ok=True)
        repeats = "7" if size in SMALL else "3"
        command = [self.shells_bench, size, "--materials", material, "--element", "plain", *flag]
        command += ["--repeats", repeats, "--json", str(lines), "--displacement", str(answer)]
        failed = self.call(command, threads, reads=False)
        if "error" in failed or not lines.exists():
            return {"program": OURS.name, "error": failed.get("error", "wrote nothing")}
        row = json.loads(lines.read_text().splitlines()[-1])
        row |= {"total_s": row["wall_s"], "total_cpu_s": row["cpu_s"], "setup_s": row["check_s"]}
        return {"program": OURS.name, **row, "assembly_s": row["assemble_s"]}

    def call(self, command, threads, reads=True):
        names = ("OMP", "MKL", "OPENBLAS", "NUMBA", "RAYON")
        limits = {f"{name}_NUM_THREADS": str(threads) for name in names}
        scratch = {"NUMBA_CACHE_DIR": "numba", "PYTHONPYCACHEPREFIX": "pycache"}
        scratch = {key: str(self.environment / value) for key, value in scratch.items()}
        library = {"AMGCL_LIBRARY": str(self.environment / "amgcl/libamgcl.so")}
        processors = ",".join(str(n) for n in sorted(os.sched_getaffinity(0))[:threads])
        try:
            done = subprocess.run(
                ["taskset", "-c", processors, *command],
                cwd=HERE,
                env={**os.environ, **limits, **scratch, **library, "OMP_WAIT_POLICY": "passive"},
                capture_output=True,
                text=True,
                timeout=LONGEST,
            )
        except subprocess.TimeoutExpired:
            return {"error": f"not done after {LONGEST} s"}
        if done.returncode:
            said = done.stderr.strip().splitlines() or [f"ended with {done.returncode}"]
            return {"error": said[-1][:200]}
        return json.loads(done.stdout.splitlines()[-1]) if reads else {}

    def compare(self, rows, system):
        """The largest difference in mm from the first direct solver, or else the first that converged."""
        answers = {}
        for row in rows:
            if "error" not in row:
                answers[row["program"]] = full(row["program"], system)
        order = ["pardiso", "cholmod", "ngsolve_own", *answers]
        reference = next((name for name in order if name in answers), None)
        for row in rows:
            if row["program"] in answers:
                difference = answers[row["program"]] - answers[reference]
                row["difference_mm"] = float(np.max(np.linalg.norm(difference, axis=1)))
                row["reference"] = reference


def added(row, made, peer):
    """The row with the assembly that it needed beside its own time, and what it took of memory."""
    if "error" in row:
        return row
    if row["residual"] > 1.05e-8:
        return {"error": f"residual {row['residual']:.1e} after {row['iterations']} iterations"}
    for clock in ("s", "cpu_s"):
        row[f"assembly_{clock}"] = 0.0 if peer.assembles else made[f"assembly_{clock}"]
        row[f"total_{clock}"] = sum(row[f"{part}_{clock}"] for part in ("assembly", "setup", "solve"))
    return {**row, "added_mb": row["peak_mb"] - row["base_mb"]}


def full(program, system):
    """Displacement of all nodes, (nodes, 3, columns), held ones included."""
    displacement = np.load(system / "known.npy")
    if program == OURS.name:
        shape = (displacement.shape[2], *displacement.shape[:2])
        return np.fromfile(system / "answer-facies.f64").reshape(shape).transpose(1, 2, 0)
    solution = np.load(system / f"answer-{program.replace(':', '-')}.npy")
    displacement[np.load(system / "free.npy")] = solution.reshape(-1, 3, displacement.shape[2])
    return displacement


def available(sizes):
    for size in sizes:
        if shell.path(size).exists():
            yield size
        else:
            print(f"skipped: {shell.path(size)} is not here", file=sys.stderr)
