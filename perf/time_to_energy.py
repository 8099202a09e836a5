#!/usr/bin/env python3
"""How soon other settings reach the energy that the papers' method has at its end.

    perf/time_to_energy.py                                  generated surfaces of 10,000 and 48,000 vertices
    perf/time_to_energy.py bunny.obj scan.ply,2             meshes of one's own; ,2: refined twice first
    perf/time_to_energy.py --command sphere head.obj        against rgd -max_it 100
    perf/time_to_energy.py --command ball 60000 solid.msh   against ncg -max_it 500
    perf/time_to_energy.py --settings "-start cascade -linear_solver hierarchy" --repeat 5

The reference runs first (disk, square: -method ncg -max_it 100; sphere: -method rgd -max_it 100; ball: -method ncg -max_it 500); its energy is the target of the other
settings (-energy_target). All of them take turns, --repeat rounds; of a setting the median is told of: seconds of the processor in all,
own ones without what every run does alike (reading, distributing, measuring, writing; the share of start and iterations is that of the
program's clock), and the ratios of the reference's to them, medians over the rounds. One rank, one thread. Leaves
FOLDER/time_to_energy.csv, a row per mesh and setting, and prints it with the exponent by which seconds grow with vertices.
"""
import argparse
import os
import statistics
import subprocess

from cases import cpu_seconds
from runs import environment, find_program, machine, make_mesh, run_once, write_table
from tables import exponent

REFERENCE = {"disk": ("-method", "ncg", "-max_it", "100"), "square": ("-method", "ncg", "-max_it", "100"),
             "sphere": ("-method", "rgd", "-max_it", "100"), "ball": ("-method", "ncg", "-max_it", "500", "-energy_rtol", "0")}
SETTINGS = ("", "-method cascade", "-start cascade -linear_solver hierarchy")
SHAPES = {"sphere": "head", "ball": "blob"}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="*", help="files, with ,N refined N times; or sizes of generated surfaces (default: 10000 48000)")
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--command", choices=REFERENCE, default="disk")
    parser.add_argument("--settings", action="append", help="options of the other runs; may be given several times")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--folder", default="perf-results")
    args = parser.parse_args()
    args.meshes = args.meshes or ["10000", "48000"]
    args.settings = args.settings or (SETTINGS[:1] if args.command == "ball" else SETTINGS)
    return args


def prepare(args, name):
    """The mesh as a file that is read fast, refined."""
    if name.isdigit():
        return make_mesh(args.program, args.folder, SHAPES.get(args.command, "hills"), int(name))
    file, _, times = name.partition(",")
    mesh = os.path.join(args.folder, f"{os.path.splitext(os.path.basename(file))[0]}-{times or 0}.h5")
    if not os.path.exists(mesh):
        subprocess.run([args.program, "convert", file, mesh, "-refine", times or "0"], env=environment(1), check=True,
                       stdout=subprocess.DEVNULL)
    return mesh


def timed(args, mesh, options):
    before = cpu_seconds()
    run = run_once(args.program, args.command, mesh, os.path.join(args.folder, "time_to_energy"), options=options)
    seconds, used = run["seconds"], cpu_seconds() - before
    return used, used * (seconds["start"] + seconds["minimise"]) / seconds["total"], run


def measure(args, mesh):
    """A row per setting, the reference first."""
    reference = timed(args, mesh, REFERENCE[args.command])[-1]
    target = ("-energy_target", repr(reference["energy"]["final"]))
    runs = {" ".join(REFERENCE[args.command]): REFERENCE[args.command],
            **{words or "default": (*words.split(), *target) for words in args.settings}}
    rounds = [{name: timed(args, mesh, options) for name, options in runs.items()} for _ in range(args.repeat)]
    first = next(iter(runs))
    rows = []
    for name in runs:
        last = rounds[-1][name][-1]
        rows.append({"mesh": os.path.basename(mesh), "mesh.vertices": last["mesh"]["vertices"], "settings": name,
                     "cpu_seconds": statistics.median(turn[name][0] for turn in rounds), "own_seconds": statistics.median(turn[name][1] for turn in rounds),
                     "ratio": statistics.median(turn[first][0] / turn[name][0] for turn in rounds),
                     "own_ratio": statistics.median(turn[first][1] / turn[name][1] for turn in rounds),
                     "energy": last["energy"]["final"], "reached": last["energy"]["final"] <= reference["energy"]["final"],
                     "angle": last["angle_error_deg"]["mean"], "folds": last["folds"], "iterations": last["iterations"],
                     **last["work"]})
        row = rows[-1]
        angle = "" if row["angle"] is None else f" {row['angle']:.1f} degrees,"
        print(f"{row['mesh.vertices']:>9,} {row['cpu_seconds']:8.2f} s, own {row['own_seconds']:8.2f} s, ratio {row['ratio']:5.2f}, own "
              f"{row['own_ratio']:5.2f}, E {row['energy']:.3e}{'' if row['reached'] else ' (not reached)'},{angle} "
              f"{row['folds']} folds, {name}", flush=True)
    return rows


def main():
    args = arguments()
    os.makedirs(args.folder, exist_ok=True)
    print(machine())
    rows = [row for name in args.meshes for row in measure(args, prepare(args, name))]
    write_table(rows, os.path.join(args.folder, "time_to_energy.csv"))
    for settings in dict.fromkeys(row["settings"] for row in rows):
        mine = [row for row in rows if row["settings"] == settings]
        if len({row["mesh.vertices"] for row in mine}) > 1:
            print(f"{settings}: seconds grow as vertices to the power {exponent(mine):.2f}, own ones {exponent(mine, 'own_seconds'):.2f}")


if __name__ == "__main__":
    main()
