"""Measures facies and its peers side by side, and writes rows, tables and a chart.

run.py ENVIRONMENT SHELLS_BENCH OUTPUT [--quick] [--sizes 30k 100k …] [--materials abd] [--threads 1 2]
       [--rounds 3] [--peers NAME …] [--no-columns]
"""

import argparse
import json
import sys
from pathlib import Path

import chart
import measure
import report


def main():
    options = arguments()
    bench = measure.Bench(options.environment, options.shells_bench, options.peers)
    output = Path(options.output)
    output.mkdir(parents=True, exist_ok=True)
    rows = []
    for size, material, threads, columns, rounds in plan(options):
        for turn in range(rounds):
            print(f"{size} ({material}), {threads} threads, round {turn + 1} of {rounds}", file=sys.stderr)
            rows += bench.round(size, material, threads, columns)
            (output / "rows.json").write_text(json.dumps(rows, indent=1))
    checked = bench.check_assembly()
    write(report.medians(rows), report.machine(options.environment), bench.absent(), checked, output)


def plan(options):
    """Size, material, threads, whether the columns of a response, and how many rounds."""
    sizes = list(measure.available(options.sizes))
    for threads in options.threads:
        for size in sizes:
            for material in options.materials:
                largest = size not in (*measure.SMALL, "300k")
                if largest and material != "a":
                    continue
                yield size, material, threads, False, 1 if largest else options.rounds
    if "300k" in sizes and not options.no_columns:
        yield "300k", "a", 1, True, 1
        yield "300k", "a", 2, True, 1
        yield "30k", "a", 1, True, 1


def write(medians, machine, absent, checked, output):
    text = report.markdown(medians, machine, absent, checked)
    (output / "peers.md").write_text(text)
    results = {"machine": machine, "absent": absent, "assembly": checked, "rows": medians}
    (output / "peers.json").write_text(json.dumps(results, indent=1))
    (output / "peers.svg").write_text(chart.draw(medians))
    print(text)


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("environment")
    parser.add_argument("shells_bench")
    parser.add_argument("output")
    parser.add_argument("--sizes", nargs="+", default=["30k", "100k", "300k", "1M"])
    parser.add_argument("--materials", default="abd")
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--peers", nargs="+")
    parser.add_argument("--no-columns", action="store_true")
    parser.add_argument("--quick", action="store_true", help="30k and 100k only, one round")
    options = parser.parse_args()
    if options.quick:
        options.sizes, options.rounds = ["30k", "100k"], 1
    return options


if __name__ == "__main__":
    main()
