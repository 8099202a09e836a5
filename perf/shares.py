#!/usr/bin/env python3
"""Where the seconds and the bytes of a run went: shares.py SUMMARY.json"""
import json
import sys


def rows(title, seconds, total):
    print(title)
    for name, value in seconds:
        print(f"  {name:<12} {value:9.2f} s {100 * value / total:6.1f} %")


def main():
    with open(sys.argv[1]) as file:
        run = json.load(file)
    total = run["seconds"]["total"]
    names = {"partition": "METIS", "assemble": "assembly", "factor": "factorisation", "solve": "solves", "kernel": "kernels"}
    events = [(names.get(name, name), value) for name, value in run["events"].items()]
    vertices, memory = run["mesh"]["vertices"], run["memory_bytes"]
    parallel, work = run["parallel"], run["work"]
    print(f"\n{vertices} vertices, {run['mesh']['cells']} cells, {parallel['ranks']} ranks x {parallel['threads']} threads")
    rows("by phase", [(k, v) for k, v in run["seconds"].items() if k != "total"], total)
    rows("by kind of work", events + [("the rest", total - sum(v for _, v in events))], total)
    print(f"total        {total:11.2f} s; {work['factorizations']} factorisations, {work['solves']} solves, {work['evaluations']} evaluations")
    print(f"memory       {memory['total'] / 2**20:9.0f} MiB: {memory['total'] / vertices:.0f} bytes per vertex; {memory['max_per_rank'] / 2**20:.0f} MiB on the largest rank")
    print(f"energy       {run['energy']['initial']:.3e} -> {run['energy']['final']:.3e} in {run['iterations']} iterations, {run['folds']} folds: {run['status']}")


if __name__ == "__main__":
    main()
