#!/usr/bin/env python3
"""Hold runs against the saved ones: work and energies must stay, seconds are only talked about.

    perf/compare.py perf-scaling/scaling.csv                    table of scaling.py, or summaries of equimap (.json)
    perf/compare.py perf-scaling/scaling.csv --update perf/baselines/hills.json     save them instead; with --seconds on a
                                                                                    quiet machine

A run and a saved run are of one case if command, method, mesh (checksum), ranks and options agree; a summary knows no
options and is taken for a run without. Threads change no count. More than 15 % (--tolerance) more evaluations,
factorizations or solves, or a final energy more than 15 % higher, is a failure; less is told, for the baseline could be
renewed. Seconds that are 15 % up give a warning, and only on the machine that the baseline comes from.
Exit code 0: as before or better, 1: worse, 2: no case in common with the baselines.
"""
import argparse
import csv
import glob
import json
import os
import platform
import sys

COUNTS = ("work.evaluations", "work.factorizations", "work.coupled_factorizations", "work.solves")
HELD = COUNTS + ("energy.final",)
CASE = ("command", "method", "mesh.checksum", "mesh.vertices", "parallel.ranks", "options")


def machine():
    """Processor and node: what seconds depend on."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model} ({os.cpu_count()} cores, {platform.node()})"


def flatten(tree, prefix=""):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flatten(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def read_runs(name):
    with open(name, newline="") as file:
        if name.endswith(".csv"):
            return list(csv.DictReader(file))
        return [dict(flatten(json.load(file)), options="")]


def case_of(run):
    return " ".join(str(run[key]) for key in CASE).strip()


def kept(run, with_seconds):
    """What a baseline keeps of a run."""
    seconds = {key: float(value) for key, value in run.items() if with_seconds and key.startswith("seconds.")}
    return {**{key: run[key] for key in CASE}, "threads": int(run["parallel.threads"]),
            **{key: float(run[key]) for key in HELD}, **seconds}


def update(name, runs, with_seconds):
    with open(name, "w") as file:
        json.dump({"machine": machine(), "runs": [kept(run, with_seconds) for run in runs]}, file, indent=1)
        file.write("\n")
    print(f"{name}: {len(runs)} runs")


def read_baselines(names):
    saved = {}
    for name in names:
        with open(name) as file:
            content = json.load(file)
        for run in content["runs"]:
            saved[case_of(run)] = dict(run, machine=content["machine"])
    return saved


def check(run, saved, tolerance):
    """Print what differs; is anything worse?"""
    worse = False
    print(f"{case_of(run)}")
    for key in HELD:
        now, then = float(run[key]), float(saved[key])
        if now > (1. + tolerance) * then:
            worse = True
            print(f"  WORSE   {key} {now:g}, was {then:g}")
        elif now < (1. - tolerance) * then:
            print(f"  better  {key} {now:g}, was {then:g}")
    if machine() == saved["machine"] and int(run["parallel.threads"]) == saved["threads"]:
        for key in (k for k in saved if k.startswith("seconds.")):
            now, then = float(run[key]), saved[key]
            if now > (1. + tolerance) * then and now - then > .1:
                print(f"  warning {key} {now:.2f}, was {then:.2f}")
    return worse


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--baselines", nargs="+", default=sorted(glob.glob(os.path.join(here, "baselines", "*.json"))))
    parser.add_argument("--tolerance", type=float, default=.15)
    parser.add_argument("--update", metavar="FILE", help="save the runs as a baseline instead")
    parser.add_argument("--seconds", action="store_true", help="with --update: save seconds too")
    args = parser.parse_args()
    runs = [run for name in args.files for run in read_runs(name)]
    if args.update:
        update(args.update, runs, args.seconds)
        return 0
    saved = read_baselines(args.baselines)
    known = [run for run in runs if case_of(run) in saved]
    for run in runs:
        if run not in known:
            print(f"{case_of(run)}\n  no baseline")
    if not known:
        return 2
    worse = [check(run, saved[case_of(run)], args.tolerance) for run in known]
    print(f"{len(known)} cases compared, {sum(worse)} worse")
    return int(any(worse))


if __name__ == "__main__":
    sys.exit(main())
