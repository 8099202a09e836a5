#!/usr/bin/env python3
"""A model of what a rank holds, sends and waits for, from the numbers of cells and ranks alone; what breaks first as they grow.

    perf/model.py --cells 1e9 --ranks 1000             a surface to the disk
    perf/model.py --cells 1e9 --ranks 1000 --solid
    perf/model.py --cells-per-rank 1e6                 at how many ranks each limit is met
    perf/measure.py --only model                       hold the model against runs on 1 to 16 ranks (compare.py)

The mesh is a square or a cube of vertices, cut into equal boxes, and dissected (dissection.py). Nothing is fitted: what a
real mesh has in place of a box is told by the ratios that measure.py writes to model.csv.
"""
import argparse
import math

from dissection import dissect, tree_of_ranks

REAL = 8                  # bytes
INT_MAX = 2 ** 31 - 1     # what MPI counts with; PETSc, too, unless built with 64-bit indices
SHARED_FRONT = 4000       # unknowns; larger fronts are shared (-linear_shared_front)
MESSAGES_PER_BLOCK = 4    # one after the other in a solve: a broadcast and a sum, up and down
INDICES = "indices of 32 bits: build with 64"
CELLS_PER_VERTEX = {2: 2., 3: 5.5}
# Of one rank of a machine: name of the option, value, unit.
MACHINE = {"flops": (1e10, "operations a second in a factorisation"), "stream": (7e9, "bytes of a factor a second in a solve"),
           "network": (5e9, "bytes a second of a link"), "latency": (2e-6, "seconds of a message; of a reduction times log2 of the ranks"),
           "memory": (4e9, "bytes of memory")}
DEFAULTS = {name: value for name, (value, _) in MACHINE.items()}
# Of one iteration of the default method, from model.csv; bytes per vertex beside the factor, of a run of a million vertices
# and of a solid of a hundred thousand, the latter with the multigrid's matrices (docs/performance.md).
WORK = {2: {"updates": 40, "reductions": 200, "solves": 24, "bytes_per_vertex": 1300.},
        3: {"updates": 2, "reductions": 18, "solves": 1, "bytes_per_vertex": 8200.}}


def ghosts(vertices, ranks, dimension):
    """Ghost vertices of all ranks: each cut has one layer on either side."""
    return tree_of_ranks(vertices, dimension, 1, ranks).ghosts


def halo_bytes(vertices, ranks, dimension, width):
    """Bytes that an average rank receives when the ghosts' `width` coordinates are brought up to date."""
    return REAL * width * ghosts(vertices, ranks, dimension) / ranks


def factor(vertices, ranks, dimension, dofs, shared_front=SHARED_FRONT):
    """What a factorisation holds and moves: a dictionary of numbers, per rank or over all as their names say."""
    whole, tree = dissect(vertices, dimension, dofs), tree_of_ranks(vertices, dimension, dofs, ranks, shared_front)
    return {"nonzeros": whole.nonzeros, "operations": whole.operations,
            "largest_front": tree.largest if ranks > 1 else whole.largest,
            "bytes_of_leader": REAL * (tree.own + tree.leader_entries), "bytes_sent": REAL * tree.entries_sent,
            "operations_on_path": whole.operations / ranks + tree.path_operations,
            "entries_on_path": whole.nonzeros / ranks + tree.path_entries, "largest_message": tree.largest_message,
            "blocks_on_path": tree.path_blocks, "own_entries": tree.own_panels}


def predict(cells, ranks, dimension, work, machine=None):
    """Rows (what, value, limit or None, what breaks there) for a mesh of so many cells."""
    machine = machine or DEFAULTS
    dofs = dimension  # of the coupled matrix
    vertices = cells / CELLS_PER_VERTEX[dimension]
    cost, alone = factor(vertices, ranks, dimension, dofs), factor(vertices, ranks, dimension, dofs, math.inf)
    return [
        ("cells", cells, INT_MAX, INDICES),
        ("unknowns", dofs * vertices, INT_MAX, INDICES),
        ("entries of the factor of a rank's part", cost["own_entries"], INT_MAX, INDICES),
        ("nonzeros of the factor, all ranks", cost["nonzeros"], None, ""),
        ("ghosts of a rank, share of its own", ghosts(vertices, ranks, dimension) / vertices, .5, "more ghosts than vertices"),
        ("halo, bytes of a rank and update", halo_bytes(vertices, ranks, dimension, dimension), None, ""),
        ("mesh and vectors, bytes of a rank", work["bytes_per_vertex"] * vertices / ranks, machine["memory"], "memory"),
        ("factor and fronts, bytes of the rank with most", cost["bytes_of_leader"], machine["memory"], "memory for factor and fronts"),
        ("the same, no front shared", alone["bytes_of_leader"], None, ""),
        ("largest front, unknowns", cost["largest_front"], None, ""),
        ("largest message, entries", cost["largest_message"], INT_MAX, "counts of a message"),
        ("halo, seconds of an iteration", work["updates"] * (halo_bytes(vertices, ranks, dimension, dimension) / machine["network"]
                                                            + 2 * dimension * machine["latency"]), None, ""),
        ("reductions, seconds of an iteration", work["reductions"] * machine["latency"] * math.log2(max(ranks, 2)), None, ""),
        ("factorisation, seconds", cost["operations_on_path"] / machine["flops"], None, ""),
        ("the same, no front shared", alone["operations_on_path"] / machine["flops"], None, ""),
        ("solves, seconds of an iteration", work["solves"] * 2. * REAL * cost["entries_on_path"] / machine["stream"], None, ""),
        ("messages of these solves, seconds", work["solves"] * cost["blocks_on_path"] * MESSAGES_PER_BLOCK * machine["latency"]
         * math.log2(max(ranks, 2)) / 2., None, ""),
        ("the same, no front shared", work["solves"] * 2. * REAL * alone["entries_on_path"] / machine["stream"], None, ""),
    ]


def breaking_points(cells_per_rank, dimension, machine=None):
    """(what breaks, the first power of two of ranks at which it does), the earliest first."""
    found = {}
    for ranks in (2 ** k for k in range(1, 21)):
        for name, value, limit, meaning in predict(cells_per_rank * ranks, ranks, dimension, WORK[dimension], machine):
            if limit is not None and value > limit and name not in found:
                found[name] = (meaning, ranks)
    return sorted(((name, *where) for name, where in found.items()), key=lambda row: row[2])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=float, default=1e9)
    parser.add_argument("--ranks", type=lambda text: int(float(text)), default=1000)
    parser.add_argument("--cells-per-rank", type=float, help="look for the ranks at which limits are met")
    parser.add_argument("--solid", action="store_true", help="tetrahedra instead of triangles")
    for name, (value, unit) in MACHINE.items():
        parser.add_argument(f"--{name}", type=float, default=value, help=f"{unit} (default {value:g})")
    args = parser.parse_args()
    machine = {name: getattr(args, name) for name in MACHINE}
    dimension = 3 if args.solid else 2
    if args.cells_per_rank:
        for name, meaning, ranks in breaking_points(args.cells_per_rank, dimension, machine):
            print(f"{ranks:>8} ranks, {args.cells_per_rank * ranks:8.1e} cells: {name}: {meaning}")
        return
    print(f"{args.cells:.1e} {'tetrahedra' if args.solid else 'triangles'} on {args.ranks} ranks")
    for name, value, limit, meaning in predict(args.cells, args.ranks, dimension, WORK[dimension], machine):
        print(f"  {name:<46} {value:10.3g}" + (f"  over {limit:.2g}: {meaning}" if limit is not None and value > limit else ""))


if __name__ == "__main__":
    main()
