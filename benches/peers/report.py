"""Medians over rounds, and tables of them in markdown."""

import datetime
import platform
import subprocess
from collections import defaultdict
from pathlib import Path
from statistics import median

from peers import OURS, PEERS, by_name

KEYS = ("program", "size", "material", "threads", "columns", "unknowns")
LISTED = ("numpy", "scipy", "numba", "pypardiso", "mkl", "scikit-sparse", "pyamgcl", "pyamg", "ngsolve")


def medians(rows):
    """One row for each program, size, material, threads and columns; numbers are medians over rounds."""
    groups = defaultdict(list)
    for row in rows:
        groups[tuple(row.get(key) for key in KEYS)].append(row)
    result = []
    for group, members in groups.items():
        merged = dict(zip(KEYS, group)) | {"rounds": len(members)}
        done = [row for row in members if "error" not in row]
        merged |= {"error": members[0]["error"]} if not done else {
            name: median(row[name] for row in done)
            for name, value in done[0].items()
            if isinstance(value, (int, float)) and name not in merged
        }
        result.append(merged)
    return result


def machine(environment):
    def output(*command):
        try:
            return subprocess.run(command, capture_output=True, text=True).stdout
        except OSError:
            return ""

    listed = output(str(Path(environment) / "venv/bin/pip"), "list", "--format", "freeze")
    versions = dict(line.split("==") for line in listed.splitlines() if "==" in line)
    model = [line for line in output("lscpu").splitlines() if line.startswith("Model name")]
    debian = output("dpkg-query", "-W", "-f", "${Package} ${Version}\n", "libcholmod3", "python3-petsc4py")
    amgcl = sorted(path.name for path in Path(environment).glob("pyamgcl-*.tar.gz"))
    return {
        "date": datetime.date.today().isoformat(),
        "processor": model[0].split(":")[1].strip() if model else platform.processor(),
        "versions": [f"{name} {versions[name]}" for name in LISTED if name in versions]
        + [name.removesuffix(".tar.gz") + " (its AMGCL headers)" for name in amgcl]
        + debian.splitlines(),
    }


def markdown(rows, machine, absent, checked):
    parts = [f"{machine['processor']}, {machine['date']}. {', '.join(machine['versions'])}."]
    for name, reason in absent.items():
        parts.append(f"Absent: {by_name(name).title} ({reason}).")
    single = [row for row in rows if row["columns"] == 1]
    for threads in sorted({row["threads"] for row in single}):
        here = [row for row in single if row["threads"] == threads]
        parts += [f"### {count(threads)}: seconds, mesh in memory to displacement in memory", times(here, "total_s")]
        parts += [f"### {count(threads)}: the same in processor seconds", times(here, "total_cpu_s")]
        parts += [f"### {count(threads)}: added memory, MB", times(here, "added_mb", "{:.0f}")]
        parts += [f"### {count(threads)}: iterations", times(here, "iterations", "{:.0f}")]
    parts += phases(single)
    many = [row for row in rows if row["columns"] > 1]
    if many:
        parts += ["### 24 right-hand sides, the columns of a plan response", columns(many)]
    parts += [agreement(rows), assembly(checked), *sorted(f"{key}: {value}." for key, value in failures(rows).items())]
    return "\n\n".join(parts) + "\n"


def count(threads):
    return "One thread" if threads == 1 else f"{threads} threads"


def titles(rows):
    present = {row["program"] for row in rows}
    return [peer for peer in [OURS, *PEERS] if peer.name in present]


def times(rows, value, shown="{:.3g}"):
    """One line a program, one column for each size and material."""
    cases = list(dict.fromkeys((row["size"], row["material"]) for row in rows))
    cells = {(row["program"], row["size"], row["material"]): row.get(value) for row in rows}
    lines = [["tool", *(f"{size} ({material})" for size, material in cases)]]
    for peer in titles(rows):
        found = [cells.get((peer.name, *case)) for case in cases]
        lines.append([peer.title, *("–" if each is None else shown.format(each) for each in found)])
    return table(lines)


def phases(rows):
    one = [row for row in rows if row["threads"] == 1 and row["material"] == "a" and "error" not in row]
    if not one:
        return []
    size = "300k" if any(row["size"] == "300k" for row in one) else one[-1]["size"]
    lines = [["tool", "assembly s", "setup s", "solve s", "iterations", "residual", "difference mm"]]
    for row in (row for row in one if row["size"] == size):
        numbers = [f"{row[f'{part}_s']:.3g}" for part in ("assembly", "setup", "solve")]
        last = [f"{row['iterations']:.0f}", f"{row['residual']:.1e}", f"{row['difference_mm']:.1e}"]
        lines.append([by_name(row["program"]).title, *numbers, *last])
    told = "Setup of facies is its check of the scene; its solve includes the hierarchy."
    return [f"### Phases, {size} (a), one thread", told, table(lines)]


def columns(rows):
    lines = [["tool", "shell", "threads", "total s", "setup s", "solve s", "added MB", "difference mm"]]
    for row in (row for row in rows if "error" not in row):
        numbers = [f"{row[f'{part}_s']:.3g}" for part in ("total", "setup", "solve")]
        last = [f"{row['added_mb']:.0f}", f"{row['difference_mm']:.1e}"]
        head = [by_name(row["program"]).title, row["size"], str(row["threads"])]
        lines.append([*head, *numbers, *last])
    return table(lines)


def agreement(rows):
    compared = [row for row in rows if "difference_mm" in row]
    worst = max(compared, key=lambda row: row["difference_mm"])
    verdict = "All agree" if worst["difference_mm"] <= 1e-4 else "NOT all agree"
    where = f"{by_name(worst['program']).title}, {worst['size']} ({worst['material']})"
    return f"{verdict}: the largest difference of any node from a direct solver is {worst['difference_mm']:.1e} mm ({where})."


def assembly(checked):
    if "error" in checked:
        return f"scikit-fem did not check the matrix: {checked['error']}."
    return (
        f"The matrix that the peers solve differs from that of scikit-fem by {checked['relative_difference']:.1e} of its "
        f"largest entry; scikit-fem assembles the {checked['size']} shell in {checked['scikit_fem_s']:.2g} s, our numba "
        f"in {checked['numba_s']:.2g} s."
    )


def failures(rows):
    failed = [row for row in rows if "error" in row]
    return {
        f"Failed: {row['program']}, {row.get('size')} ({row.get('material')}), {row.get('threads')} threads": row["error"]
        for row in failed
    }


def table(lines):
    lines = [lines[0], ["---"] * len(lines[0]), *lines[1:]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
