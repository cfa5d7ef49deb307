"""Finite strain side by side: peers.py BENCH FOLDER [--cells N …] [--repeats N].

Runs the bench, which writes its meshes and answers, then each peer on the same meshes in a process of its own, and prints two
tables in Markdown. Processor seconds are those of a solution from the mesh in memory to the displacement in memory, imports and
compilation of kernels apart; peers move the bones by as large parts as their Newton's method bears (`block.by_parts`)."""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys

PEERS = ["felupe", "ngsolve"]
SMALL = 10


def ours(bench, folder, cells):
    text = subprocess.run([bench, str(SMALL), *map(str, cells), "--vtu", folder], check=True, stdout=subprocess.PIPE, text=True).stdout
    print(text)
    rows = [[part.strip() for part in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| plain | B")]
    return {row[2]: float(row[6]) for row in rows if row[3] == "0.46"}


def peer(name, folder, cells):
    script = pathlib.Path(__file__).parent / f"{name}_peer.py"
    meshes = [folder / f"{number}.vtu" for number in (SMALL, cells)]
    ended = subprocess.run([sys.executable, script, *meshes], capture_output=True, text=True)
    if ended.returncode != 0:
        return {"error": ended.stderr.strip().splitlines()[-1:] or ["ended without a word"]}
    return json.loads(ended.stdout.strip().splitlines()[-1])


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("bench")
    asked.add_argument("folder", type=pathlib.Path)
    asked.add_argument("--cells", type=int, nargs="+", default=[20, 30])
    asked.add_argument("--repeats", type=int, default=3)
    asked = asked.parse_args()
    processor_s = ours(asked.bench, asked.folder, asked.cells)
    print("| peer | tetrahedra | processor s | times ours | parts | steps | farthest node from ours mm | energy mN mm, ours |")
    print("|" + " --- |" * 8)
    for cells in asked.cells:
        for name in PEERS:
            runs = [peer(name, asked.folder, cells) for _ in range(asked.repeats)]
            print(row(name, runs, processor_s), flush=True)


def row(name, runs, processor_s):
    failed = [run["error"] for run in runs if "error" in run]
    if failed:
        return f"| {name} | {failed[0]} |" + " |" * 6
    first = runs[0]
    used = statistics.median(run["processor_s"] for run in runs)
    count = str(first["tetrahedra"])
    return (f"| {name} {first['version']} | {count} | {used:.2f} | {used / processor_s[count]:.0f} | {first['parts']} | "
            f"{first['steps']} | {first['farthest_mm']:.1e} | {first['energy']:.1f}, {first['our_energy']:.1f} |")


main()
