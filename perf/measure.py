#!/usr/bin/env python3
"""Measure: kernels against the machine's bandwidth, phases, growth over sizes, strong and weak scaling; to CSV and a picture.

    perf/measure.py                                    all parts, small sizes: minutes
    perf/measure.py --scale medium --ranks 1,2,4 --threads 1,2
    perf/measure.py --scale large --only growth,solids       up to 4 and 1 million vertices: hours, 32 GiB
    perf/measure.py --draw                             only the picture and the summary, of the tables that are there

Parts are kernels (bench_kernels: each kernel's share of the bandwidth that a triad reaches), growth (surfaces to the disk: seconds
per phase, memory), solids (the same to the ball), strong (one mesh on ranks x threads), weak (so many vertices for each core).
Each leaves FOLDER/PART.csv, whose columns are the figures of the program's summary joined by dots (seconds.total, work.solves,
memory_bytes.max_per_rank, ...); all together leave FOLDER/measure.png, with Matplotlib, and FOLDER/measure.txt. Of --repeat runs
of a case the fastest is kept. Options of the map commands follow two dashes: -- -balance .01

Seconds are worth something on a quiet machine only, where ranks x threads do not exceed the cores; work.py watches what any
machine can tell: counts of work.
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys

from runs import HERE, find_program, flatten, machine, make_mesh, numbers, run_once, write_table

PARTS = ("kernels", "growth", "solids", "strong", "weak")
# Vertices: growth of surfaces, growth of solids, strong, weak (for each core).
SCALES = {
    "tiny": ([1000, 2000], [500, 1000], 2000, 1000),
    "small": ([5000, 10000, 20000, 50000], [2000, 5000, 10000], 50000, 20000),
    "medium": ([10000, 30000, 100000, 300000], [10000, 30000, 100000], 100000, 50000),
    "large": ([10000, 30000, 100000, 300000, 1000000, 4000000], [10000, 30000, 100000, 300000, 1000000], 1000000, 250000),
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--kernels", default=str(HERE.parent / "build" / "perf" / "bench_kernels"), help="their benchmark")
    parser.add_argument("--scale", choices=SCALES, default="small")
    parser.add_argument("--only", default=",".join(PARTS), help="parts, with commas between")
    parser.add_argument("--ranks", type=numbers, default=[1, 2])
    parser.add_argument("--threads", type=numbers, default=[1, 2])
    parser.add_argument("--repeat", type=int, default=1, help="keep the fastest of so many runs")
    parser.add_argument("--folder", default="perf-results", help="where meshes, tables and the picture go")
    parser.add_argument("--draw", action="store_true", help="run nothing")
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    args = parser.parse_args(words[:split])
    args.options = words[split + 1:]
    args.only = args.only.split(",")
    if set(args.only) - set(PARTS):
        parser.error(f"parts are {', '.join(PARTS)}")
    return args


def case(args, command, shape, size, ranks, threads):
    """A row of a table: the fastest of some runs."""
    mesh = make_mesh(args.program, args.folder, shape, size)
    stem = os.path.join(args.folder, f"{command}-{shape}-{size}-r{ranks}-t{threads}")
    runs = [run_once(args.program, command, mesh, stem, ranks, threads, args.options) for _ in range(args.repeat)]
    best = min(runs, key=lambda run: run["seconds"]["total"])
    vertices = best["mesh"]["vertices"]
    print(f"  {vertices:>9,} vertices, {ranks} x {threads}: {best['seconds']['total']:8.2f} s, "
          f"{best['memory_bytes']['total'] / vertices:8.0f} bytes per vertex, energy {best['energy']['final']:.3e}", flush=True)
    return {"shape": shape, "size": size, "ranks": ranks, "threads": threads, "options": " ".join(args.options),
            **dict(flatten(best))}


def measure_kernels(args):
    """The benchmark's own figures, a row per kernel and number of threads."""
    if not os.access(args.kernels, os.X_OK):
        print(f"  there is no {args.kernels}: build with -DEQUIMAP_PERF=ON, or say where it is with --kernels")
        return []
    name = os.path.join(args.folder, "kernels.json")
    size = str(SCALES[args.scale][0][-1])
    subprocess.run([args.kernels, "-n", size, "-max_threads", str(max(args.threads)), "-json", name], check=True,
                   stdout=subprocess.DEVNULL)
    with open(name, encoding="utf-8") as file:
        return json.load(file)["kernels"]


def measure(args, part):
    """The rows of a part."""
    surfaces, solids, strong, weak = SCALES[args.scale]
    grid = [(ranks, threads) for ranks in args.ranks for threads in args.threads]
    if part == "kernels":
        return measure_kernels(args)
    if part == "growth":
        return [case(args, "disk", "hills", size, 1, 1) for size in surfaces]
    if part == "solids":
        return [case(args, "ball", "blob", size, 1, 1) for size in solids]
    if part == "strong":
        return [case(args, "disk", "hills", strong, ranks, threads) for ranks, threads in grid]
    return [case(args, "disk", "hills", weak * ranks * threads, ranks, threads) for ranks, threads in grid]


def read_tables(folder):
    tables = {}
    for part in PARTS:
        name = os.path.join(folder, f"{part}.csv")
        if os.path.exists(name):
            with open(name, newline="", encoding="utf-8") as file:
                tables[part] = list(csv.DictReader(file))
    return tables


def exponent(rows, column="seconds.total"):
    """The slope of log seconds over log vertices, by least squares."""
    points = [(math.log(float(row["mesh.vertices"])), math.log(float(row[column]))) for row in rows if float(row[column]) > 0.]
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread if spread > 0. else float("nan")


def efficiencies(rows, weak):
    """(cores, efficiency, label) against the first row: t1 c1 / (t c), weak t1 / t."""
    cores = [int(row["ranks"]) * int(row["threads"]) for row in rows]
    seconds = [float(row["seconds.total"]) for row in rows]
    return [(c, seconds[0] / s if weak else seconds[0] * cores[0] / (s * c), f"{row['ranks']} x {row['threads']}")
            for c, s, row in zip(cores, seconds, rows)]


def summary(tables):
    """measure.txt: what a person wants to know first."""
    lines = [machine()]
    for part in ("growth", "solids"):
        if part in tables:
            rows = tables[part]
            lines.append(f"{part}: seconds grow as vertices to the power {exponent(rows):.2f} ({rows[0]['mesh.vertices']} to "
                         f"{rows[-1]['mesh.vertices']} vertices, {float(rows[-1]['seconds.total']):.1f} s at the largest)")
    for part in ("strong", "weak"):
        if part in tables:
            points = efficiencies(tables[part], part == "weak")
            lines.append(f"{part}: " + ", ".join(f"{label}: {value:.2f}" for _, value, label in points))
    for row in tables.get("kernels", ()):
        lines.append(f"kernel {row['kernel']}, {row['threads']} threads: {float(row['ns_per_cell']):.1f} ns per cell, "
                     f"{100. * float(row['share_of_triad']):.0f} % of the triad's bandwidth")
    return "\n".join(lines) + "\n"


def main():
    args = arguments()
    os.makedirs(args.folder, exist_ok=True)
    for part in args.only if not args.draw else ():
        print(part)
        rows = measure(args, part)
        if rows:
            write_table(rows, os.path.join(args.folder, f"{part}.csv"))
    tables = read_tables(args.folder)
    text = summary(tables)
    with open(os.path.join(args.folder, "measure.txt"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text, end="")
    try:
        import plots
    except ImportError:
        print("no Matplotlib: no picture")
        return
    plots.draw(tables, os.path.join(args.folder, "measure.png"), exponent, efficiencies)
    print(os.path.join(args.folder, "measure.png"))


if __name__ == "__main__":
    main()
