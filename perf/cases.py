"""The runs behind measure.py's tables: the same case several times, all cases in turn, and of each the median."""
import json
import os
import resource
import subprocess

from compare import rows_of_run
from peers import measure_peers
from runs import flatten, make_mesh, run_once


def cpu_seconds():
    """Of all processes that have ended below this one. A launcher does not wait for all its ranks: of use for runs without one."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(args, command, shape, size, ranks, threads):
    """A row of one run: the program's figures, the processor's seconds, the load of the machine before."""
    mesh = make_mesh(args.program, args.folder, shape, size)
    stem = os.path.join(args.folder, f"{command}-{shape}-{size}-r{ranks}-t{threads}")
    load, before = os.getloadavg()[0], cpu_seconds()
    run = run_once(args.program, command, mesh, stem, ranks, threads, args.options)
    return {"shape": shape, "size": size, "ranks": ranks, "threads": threads, "options": " ".join(args.options), "load": load,
            "cpu_seconds": cpu_seconds() - before if ranks == 1 else "", "bytes_per_vertex": run["memory_bytes"]["total"] / run["mesh"]["vertices"],
            **dict(flatten(run))}


def median_row(rows):
    """The run in the middle by its seconds, with the fastest and the slowest beside."""
    rows = sorted(rows, key=lambda row: row["seconds.total"])
    return {**rows[len(rows) // 2], "runs": len(rows), "seconds.fastest": rows[0]["seconds.total"],
            "seconds.slowest": rows[-1]["seconds.total"],
            "cpu_seconds": sorted(row["cpu_seconds"] for row in rows)[len(rows) // 2]}


def measure_cases(args, cases):
    """A row per case. All cases in turn, then again: what the machine does beside meets all of them alike."""
    runs = [[] for _ in cases]
    for _ in range(args.repeat):
        for case, rows in zip(cases, runs):
            rows.append(timed(args, *case))
    table = [median_row(rows) for rows in runs]
    for row in table:
        print(f"  {row['mesh.vertices']:>9,} vertices, {row['ranks']} x {row['threads']}: {row['seconds.total']:8.2f} s "
              f"({row['seconds.fastest']:.2f} to {row['seconds.slowest']:.2f}), "
              + (f"cpu {row['cpu_seconds']:8.2f} s, " if row["ranks"] == 1 else "") +
              f"{row['bytes_per_vertex']:6.0f} bytes per vertex, energy {row['energy.final']:.3e}, load {row['load']:.1f}", flush=True)
    return table


def measure_kernels(args, size):
    """The benchmark's own figures, a row per kernel and number of threads; the triad is measured between them."""
    if not os.access(args.kernels, os.X_OK):
        print(f"  there is no {args.kernels}: build with -DEQUIMAP_PERF=ON, or say where it is with --kernels")
        return []
    name = os.path.join(args.folder, "kernels.json")
    load = os.getloadavg()[0]
    subprocess.run([args.kernels, "-n", str(size), "-max_threads", str(max(args.threads)), "-repetitions", str(5 * args.repeat),
                    "-json", name], check=True, stdout=subprocess.DEVNULL, env={**os.environ, "OMP_WAIT_POLICY": "passive"})
    with open(name, encoding="utf-8") as file:
        return [{**row, "size": size, "load": load} for row in json.load(file)["kernels"]]


def measure(args, part, scale):
    """The rows of a part."""
    grid = [(ranks, threads) for ranks in args.ranks for threads in args.threads]
    if part == "kernels":
        return measure_kernels(args, scale.kernels)
    if part == "growth":
        return measure_cases(args, [("disk", "hills", size, 1, 1) for size in scale.surfaces])
    if part == "solids":
        return measure_cases(args, [("ball", "blob", size, 1, 1) for size in scale.solids])
    if part == "strong":
        return measure_cases(args, [("disk", "hills", scale.strong, *cores) for cores in grid])
    if part == "weak":
        return measure_cases(args, [("disk", "hills", scale.weak * cores[0] * cores[1], *cores) for cores in grid])
    if part == "peers":
        return measure_peers(args, "hills", scale.peers)
    return [row for command, shape, size in (("disk", "hills", scale.model[0]), ("ball", "blob", scale.model[1]))
            for ranks in args.model_ranks for row in rows_of_run(args, command, shape, size, ranks)]
