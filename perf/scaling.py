#!/usr/bin/env python3
"""Strong scaling, weak scaling and size sweeps on generated meshes.

    perf/scaling.py build/equimap                                         sizes 20000 and 100000, ranks 1 and 2, one thread
    perf/scaling.py build/equimap --sizes 1000000 --ranks 1,2,4 --threads 1,2
    perf/scaling.py build/equimap --weak --sizes 50000 --ranks 1,2,4      50000 vertices for every core
    perf/scaling.py build/equimap --shape fins --command square -- -max_it 10 -method lm

Every run is `mpirun -n RANKS PROGRAM COMMAND MESH -threads THREADS -summary ... OPTIONS`. The summaries become rows of
FOLDER/scaling.csv, their keys joined by dots (seconds.total, work.solves, memory_bytes.max_per_rank, ...), in front of
them shape, size, ranks, threads, weak and options. Of several runs of a case (--repeat) the fastest is kept. Meshes are
made once and kept. Where Matplotlib is installed, FOLDER/scaling.png shows seconds and parallel efficiency over cores.

Seconds are worth something on a quiet machine only; counts (evaluations, factorizations, solves) and energies anywhere:
compare.py holds them against perf/baselines.
"""
import argparse
import csv
import json
import os
import subprocess
import sys

MAP_WRITTEN = (0, 4, 5)  # converged, stopped before, folds remain


def numbers(text):
    return [int(part) for part in text.split(",")]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--command", default="disk")
    parser.add_argument("--shape", default="hills", help="what equimap generate makes")
    parser.add_argument("--sizes", type=numbers, default=[20000, 100000], help="vertices; with --weak: for every core")
    parser.add_argument("--ranks", type=numbers, default=[1, 2])
    parser.add_argument("--threads", type=numbers, default=[1])
    parser.add_argument("--weak", action="store_true", help="let the mesh grow with the cores")
    parser.add_argument("--repeat", type=int, default=1, help="keep the fastest of so many runs")
    parser.add_argument("--folder", default="perf-scaling", help="where meshes, summaries, table and picture go")
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    args = parser.parse_args(words[:split])
    args.options = words[split + 1:]  # of the map command
    return args


def environment(threads):
    result = dict(os.environ, OMP_NUM_THREADS=str(threads))
    if os.geteuid() == 0:  # Open MPI refuses root unless told twice
        result.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return result


def make_mesh(args, size):
    mesh = os.path.join(args.folder, f"{args.shape}-{size}.h5")
    if not os.path.exists(mesh):
        part = os.path.join(args.folder, f"part-{args.shape}-{size}.h5")
        subprocess.run([args.program, "generate", args.shape, "-n", str(size), "-o", part], env=environment(1), check=True)
        os.replace(part, mesh)
    return mesh


def run_once(args, mesh, stem, ranks, threads):
    launch = ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]
    command = [args.program, args.command, mesh, "-o", stem + ".h5", "-summary", stem + ".json", "-quiet"]
    done = subprocess.run(launch + command + ["-threads", str(threads)] + args.options, env=environment(threads),
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode not in MAP_WRITTEN:
        sys.exit(f"{' '.join(command)} ended with exit code {done.returncode}:\n{done.stdout[-2000:]}")
    with open(stem + ".json") as file:
        return json.load(file)


def flatten(tree, prefix=""):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flatten(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def run_case(args, size, ranks, threads):
    total = size * ranks * threads if args.weak else size
    mesh = make_mesh(args, total)
    stem = os.path.join(args.folder, f"{args.command}-{args.shape}-{total}-r{ranks}-t{threads}")
    runs = [run_once(args, mesh, stem, ranks, threads) for _ in range(args.repeat)]
    best = min(runs, key=lambda run: run["seconds"]["total"])
    row = {"shape": args.shape, "size": total, "ranks": ranks, "threads": threads, "weak": int(args.weak),
           "options": " ".join(args.options)}
    row.update(flatten(best))
    print(f"{total:>9} vertices, {ranks} ranks x {threads} threads: {row['seconds.total']:8.2f} s, "
          f"{row['work.solves']} solves, energy {row['energy.final']:.3e}", flush=True)
    return row


def write_table(rows, name):
    with open(name, "w", newline="") as file:
        table = csv.DictWriter(file, fieldnames=list(rows[0]), restval="", extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)


def efficiency(cores, seconds, weak):
    """Of the speed per core on the fewest cores, the first, how much is left: t1 c1 / (t c), weak t1 / t."""
    if weak:
        return [seconds[0] / s for s in seconds]
    return [seconds[0] * cores[0] / (s * c) for s, c in zip(seconds, cores)]


def draw(args, rows, name):
    try:
        import matplotlib
    except ImportError:
        print("no Matplotlib: no picture")
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
    ticks = sorted({r["ranks"] * r["threads"] for r in rows})
    for axes in left, right:
        axes.set_xscale("log")
        axes.set_xticks(ticks, labels=ticks)
        axes.minorticks_off()
    left.set_yscale("log")
    for size in args.sizes:
        curve = [r for r in rows if r["size"] == (size * r["ranks"] * r["threads"] if args.weak else size)]
        curve.sort(key=lambda r: (r["ranks"] * r["threads"], r["ranks"]))
        cores = [r["ranks"] * r["threads"] for r in curve]
        seconds = [r["seconds.total"] for r in curve]
        left.plot(cores, seconds, "o-", label=f"{size}" + (" per core" if args.weak else " vertices"))
        right.plot(cores, efficiency(cores, seconds, args.weak), "o-")
    left.set(xlabel="cores", ylabel="seconds")
    right.set(xlabel="cores", ylabel="parallel efficiency", ylim=(0, 1.1))
    left.legend()
    figure.savefig(name, dpi=150)
    print(name)


def main():
    args = arguments()
    os.makedirs(args.folder, exist_ok=True)
    rows = [run_case(args, size, ranks, threads) for size in args.sizes for ranks in args.ranks for threads in args.threads]
    table = os.path.join(args.folder, "scaling.csv")
    write_table(rows, table)
    print(table)
    draw(args, rows, os.path.join(args.folder, "scaling.png"))


if __name__ == "__main__":
    main()
