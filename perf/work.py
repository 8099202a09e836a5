#!/usr/bin/env python3
"""Hold the work that maps take against the saved counts: the same on every machine, busy or not.

    perf/work.py                run the cases and compare: more work, a higher energy, a fold, more memory is a failure
    perf/work.py --update       save them instead, after a change that is meant to change them
    perf/work.py --only lm      cases whose names hold a word

Compared are iterations, evaluations, factorizations, coupled factorizations, solves, steps of conjugate gradients, folds, the
energy at the end and the bytes that each further vertex takes (from two sizes, so that what a process has anyway cancels out).
More than 15 % (--tolerance) above perf/baselines/work.json, and by more than rounding can turn about (two), is a failure; as
much below is told: then --update.
Exit code: 0 as before or better, 1 worse, 2 there is no baseline for a case.
"""
import argparse
import json
import os
import shlex
import sys
import tempfile

from runs import HERE, find_program, make_mesh, run_once

BASELINE = HERE / "baselines" / "work.json"
SLACK = 2  # so many iterations or solves more are no failure
# name: command, shape, vertices, ranks, options
CASES = {
    "disk lm": ("disk", "hills", 3000, 1, "-max_it 8"),
    "disk lm, 2 ranks": ("disk", "hills", 3000, 2, "-max_it 8"),
    "disk balanced": ("disk", "hills", 3000, 1, "-balance .01"),
    "disk ncg": ("disk", "hills", 3000, 1, "-method ncg -ncg_refresh 50 -energy_rtol 0 -max_it 60"),
    "disk fixed-point": ("disk", "hills", 3000, 1, "-method fixed-point -energy_rtol 0 -max_it 30"),
    "disk lbfgs": ("disk", "hills", 3000, 1, "-method lbfgs -max_it 40"),
    "square lm": ("square", "patch", 3000, 1, "-max_it 8"),
    "sphere lm": ("sphere", "head", 3000, 1, "-max_it 8"),
    "sphere rgd": ("sphere", "head", 3000, 1, "-method rgd -energy_rtol 0 -max_it 50"),
    "conformal disk": ("conformal", "hills", 3000, 1, ""),
    "conformal sphere": ("conformal", "head", 3000, 1, ""),
    "ball": ("ball", "blob", 1500, 1, "-max_it 60"),
}
# name: command, shape, the two sizes, options
MEMORY = {
    "memory disk lm": ("disk", "hills", (5000, 20000), "-max_it 3"),
    "memory ball": ("ball", "blob", (1500, 6000), "-max_it 10"),
}
COUNTS = ("evaluations", "factorizations", "coupled_factorizations", "solves", "cg_iterations")


def counts_of(summary):
    return {"iterations": summary["iterations"], **{key: summary["work"][key] for key in COUNTS if key in summary["work"]},
            "folds": summary["folds"], "energy": summary["energy"]["final"]}


def run_case(program, folder, name):
    """The figures of a case."""
    stem = os.path.join(folder, "run")

    def summary(command, shape, size, ranks, options):
        return run_once(program, command, make_mesh(program, folder, shape, size), stem, ranks, 1, shlex.split(options))

    if name in CASES:
        return counts_of(summary(*CASES[name]))
    command, shape, sizes, options = MEMORY[name]
    runs = [summary(command, shape, size, 1, options) for size in sizes]
    vertices = [run["mesh"]["vertices"] for run in runs]
    memory = [run["memory_bytes"]["total"] for run in runs]
    return {"bytes_per_vertex": (memory[1] - memory[0]) / (vertices[1] - vertices[0])}


def compare(now, saved, tolerance):
    """What is worse, what is better: two lists of words."""
    worse, better = [], []
    for key, then in saved.items():
        slack = SLACK if key in COUNTS or key == "iterations" else 0
        if now[key] > (1. + tolerance) * then + slack:
            worse.append(f"{key} {now[key]:g}, was {then:g}")
        elif now[key] < (1. - tolerance) * then - slack:
            better.append(f"{key} {now[key]:g}, was {then:g}")
    return worse, better


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--baseline", default=BASELINE)
    parser.add_argument("--tolerance", type=float, default=.15)
    parser.add_argument("--only", default="", help="cases whose names hold this")
    parser.add_argument("--update", action="store_true", help="save the figures instead")
    args = parser.parse_args()
    saved = {}
    if os.path.exists(args.baseline):
        with open(args.baseline, encoding="utf-8") as file:
            saved = json.load(file)
    codes = {0}
    with tempfile.TemporaryDirectory() as folder:
        for name in (name for name in (*CASES, *MEMORY) if args.only in name):
            now = run_case(args.program, folder, name)
            if args.update:
                saved[name] = now
                print(f"{name}: " + ", ".join(f"{key} {value:g}" for key, value in now.items()))
                continue
            if name not in saved:
                print(f"{name}: no baseline")
                codes.add(2)
                continue
            worse, better = compare(now, saved[name], args.tolerance)
            codes.add(int(bool(worse)))
            words = ["WORSE: " + "; ".join(worse)] if worse else [] if better else ["as before"]
            print(f"{name}: " + "; ".join(words + (["better: " + "; ".join(better)] if better else [])))
    if args.update:
        with open(args.baseline, "w", encoding="utf-8") as file:
            json.dump({name: saved[name] for name in (*CASES, *MEMORY) if name in saved}, file, indent=1)
            file.write("\n")
    elif 1 in codes:
        print("more work than saved: if the change is meant to, perf/work.py --update saves the new counts")
    return 1 if 1 in codes else max(codes)


if __name__ == "__main__":
    sys.exit(main())
