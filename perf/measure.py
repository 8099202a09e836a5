#!/usr/bin/env python3
"""Measure: kernels against the machine's bandwidth, phases, growth over sizes, strong and weak scaling, peers, the model; to CSV and a picture.

    perf/measure.py                                    all parts in their short form: two minutes on two quiet cores
    perf/measure.py --scale medium --ranks 1,2,4 --threads 1,2 --repeat 3
    perf/measure.py --scale large --only growth,solids       up to 4 and 1 million vertices: hours, 64 GiB
    perf/measure.py --only growth --sizes 10000,1000000      sizes of one's own
    perf/measure.py --draw                             only the picture and the summary, of the tables that are there

Parts are kernels (bench_kernels: each kernel's share of the bandwidth that a triad reaches in between), growth (surfaces to the
disk: seconds per phase, memory, the exponent), solids (the same to the ball), strong (one mesh on ranks x threads), weak (so many
vertices for each core), peers (BFF and CGAL on the same mesh, where they are installed), model (what model.py says of halos,
factors and fronts against PETSc's log and the program's counts, on --model-ranks ranks, more than there are cores).
Each leaves FOLDER/PART.csv. Columns of growth, solids, strong and weak are the figures of the program's summary joined by dots
(seconds.total, work.solves, memory_bytes.max_per_rank, ...), and load, cpu_seconds, runs, seconds.fastest, seconds.slowest: of
--repeat runs of a case, taken in turn with the others, the median is kept. All together leave FOLDER/measure.png, with
Matplotlib, and FOLDER/measure.txt. Options of the map commands follow two dashes: -- -balance .01

Seconds are worth something on a quiet machine only, where ranks x threads do not exceed the cores; the load is in the tables. The
processor's seconds, which the exponents are fitted to and runs on one rank have, suffer less; work.py watches what any machine can tell: counts of work.
"""
import argparse
import dataclasses
import os
import sys

from cases import measure
from runs import find_program, numbers, write_table
from tables import efficiencies, exponent, read_tables, summary

PARTS = ("kernels", "growth", "solids", "strong", "weak", "peers", "model")


@dataclasses.dataclass
class Scale:
    """Vertices of the parts' meshes; weak: for each core, model: of the surface and of the solid."""
    kernels: int
    surfaces: list
    solids: list
    strong: int
    weak: int
    peers: int
    model: tuple


SCALES = {
    "tiny": Scale(5000, [1000, 2000], [500, 1000], 2000, 1000, 1000, (2000, 1000)),
    "short": Scale(100000, [2500, 5000, 10000], [1000, 2000, 4000], 10000, 5000, 5000, (10000, 3000)),
    "medium": Scale(1000000, [10000, 30000, 100000, 300000], [10000, 30000, 100000], 50000, 25000, 10000, (50000, 10000)),
    "large": Scale(1000000, [10000, 30000, 100000, 300000, 1000000, 4000000], [10000, 30000, 100000, 300000, 1000000],
                   1000000, 250000, 100000, (100000, 20000)),
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--kernels", help="their benchmark (default: perf/bench_kernels beside the program)")
    parser.add_argument("--scale", choices=SCALES, default="short")
    parser.add_argument("--sizes", type=numbers, help="vertices of growth's surfaces, in place of the scale's")
    parser.add_argument("--solid-sizes", type=numbers, help="vertices of growth's solids")
    parser.add_argument("--only", default=",".join(PARTS), help="parts, with commas between")
    parser.add_argument("--ranks", type=numbers, default=[1, 2])
    parser.add_argument("--threads", type=numbers, default=[1, 2])
    parser.add_argument("--model-ranks", type=numbers, default=[1, 2, 4])
    parser.add_argument("--repeat", type=int, default=1, help="the median of so many runs")
    parser.add_argument("--folder", default="perf-results", help="where meshes, tables and the picture go")
    parser.add_argument("--draw", action="store_true", help="run nothing")
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    args = parser.parse_args(words[:split])
    args.options = words[split + 1:]
    args.kernels = args.kernels or os.path.join(os.path.dirname(args.program), "perf", "bench_kernels")
    args.only = args.only.split(",")
    if set(args.only) - set(PARTS):
        parser.error(f"parts are {', '.join(PARTS)}")
    return args


def main():
    args = arguments()
    os.makedirs(args.folder, exist_ok=True)
    scale = SCALES[args.scale]
    scale = dataclasses.replace(scale, surfaces=args.sizes or scale.surfaces, solids=args.solid_sizes or scale.solids)
    for part in args.only if not args.draw else ():
        print(part, flush=True)
        rows = measure(args, part, scale)
        if rows:
            write_table(rows, os.path.join(args.folder, f"{part}.csv"))
    tables = read_tables(args.folder, PARTS)
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
