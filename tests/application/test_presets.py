"""Run every preset of config/ on a small mesh; options files that are missing, damaged or overruled.

usage: python3 test_presets.py EQUIMAP [RANKS]
"""
import json
import os
import pathlib
import re
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import run_in_folder

CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config"


def read_options(preset):
    """The options of a preset, and that its head says how it is used and where it comes from."""
    lines = preset.read_text(encoding="utf-8").splitlines()
    head = "\n".join(line for line in lines if line.startswith("#"))
    target = preset.stem.split("-")[0]
    assert f"equimap {target} MESH -o OUT -options_file config/{preset.name}" in head, preset
    assert "Source: " in head and "Table" in head and "Measured here" in head, preset
    return dict(line.split(": ") for line in lines if not line.startswith("#"))


def read_row(preset):
    """The command and the options of a preset that stands for a row of a paper's table, and that its head is complete."""
    lines = preset.read_text(encoding="utf-8").splitlines()
    head = "\n".join(line for line in lines if line.startswith("#"))
    name = preset.relative_to(CONFIG)
    command = re.search(rf"^# equimap (\w+) MESH -o OUT -options_file config/{re.escape(str(name))}$", head, re.MULTILINE)
    assert command, (preset, "the first line says how it is used")
    for word in ("# Source: ", f"({preset.parent.name})", "Table", "# Mesh: ", "# Published", "# Measured here"):
        assert word in head, (preset, word)
    return command[1], dict(line.split(": ") for line in lines if not line.startswith("#"))


def main(program):
    def run(*arguments, codes=(0, 4)):
        return program.succeed(*arguments, codes=codes)

    def coordinates(path):
        with h5py.File(path) as file:
            return file["map/coordinates"][:]

    run("generate", "patch", "-n", "400", "-o", "patch.obj")
    presets = sorted(CONFIG.glob("*.yaml"))
    assert presets
    for preset in presets:
        wanted, target = read_options(preset), preset.stem.split("-")[0]
        run(target, "patch.obj", "-o", f"{preset.stem}.h5", "-summary", "run.json", "-options_file", preset)
        with open("run.json") as file:
            summary = json.load(file)
        assert summary["method"] == wanted["method"] and summary["folds"] == 0, (preset, summary)
        assert summary["iterations"] <= int(wanted.get("max_it", 1000))
        if wanted.get("energy_rtol") == "0":  # a paper's row: all its iterations, but for a map that is perfect before
            assert summary["iterations"] == int(wanted["max_it"]) or summary["energy"]["final"] < 1e-12, (preset, summary)
        with h5py.File(f"{preset.stem}.h5") as file:
            options = file.attrs["options"]
        assert all(f"-{name} {value}" in options for name, value in wanted.items()), (preset, options)
        # what it claims: the same as no options at all; on more ranks no two runs have the same bits
        if preset.stem.endswith("-default") and program.ranks == 1:
            run(target, "patch.obj", "-o", "bare.h5")
            assert numpy.array_equal(coordinates("bare.h5"), coordinates(f"{preset.stem}.h5")), preset

    known = set()
    for preset in sorted(CONFIG.glob("*/*.yaml")):  # of those with the same options, one is tried
        command, options = read_row(preset)
        closed = "head.obj" if options["start"] != "harmonic" else "patch.obj"  # Riemann maps begin with the harmonic one
        mesh = {"sphere": "head.obj", "conformal": closed, "ball": "ball.h5"}.get(command, "patch.obj")
        if (command, *options.items()) in known or program.ranks != 1:
            continue
        known.add((command, *options.items()))
        if not os.path.exists(mesh):
            run("generate", mesh.split(".")[0], "-n", "300", "-o", mesh)
        run(command, mesh, "-o", "row.h5", "-options_file", preset, "-dry_run", codes=(0,))
    assert not os.path.exists("row.h5")

    overruled = ("-o", "few.h5", "-options_file", CONFIG / "disk-ncg.yaml")
    for arguments in (("-max_it", "3", *overruled), (*overruled, "-max_it", "3")):  # the command line wins, either way
        run("disk", "patch.obj", *arguments)
        with h5py.File("few.h5") as file:
            assert file.attrs["iterations"] == 3 and file.attrs["method"] == "ncg"
    missing = run("disk", "patch.obj", "-o", "new.h5", "-options_file", "absent.yaml", codes=(6,))
    assert "cannot read the options file 'absent.yaml'" in missing.stderr and "PETSC ERROR" not in missing.stderr
    with open("damaged.yaml", "w") as file:
        file.write("max_it: [1,\n method")
    damaged = run("disk", "patch.obj", "-o", "new.h5", "-options_file", "damaged.yaml", codes=(2,))
    assert "cannot understand the options file 'damaged.yaml'" in damaged.stderr
    for name, text, words in (("again.txt", "-options_file again.txt\n", "names another"), ("again.yaml", "options_file: again.yaml\n", "names another"),
                              ("alias.yaml", "a: &x {b: *x}\n", "aliases"), ("bytes.yaml", "max_it: 1\0", "no text"), ("long.yaml", "#" * 2000000, "million")):
        with open(name, "w") as file:
            file.write(text)
        refused = run("disk", "patch.obj", "-o", "new.h5", "-options_file", name, codes=(2,))
        assert f"the options file '{name}'" in refused.stderr and words in refused.stderr, refused.stderr
    with open("misspelt.yaml", "w") as file:
        file.write("maxit: 3\n")
    misspelt = run("disk", "patch.obj", "-o", "new.h5", "-options_file", "misspelt.yaml", codes=(2,))
    assert "unknown option -maxit" in misspelt.stderr
    unused = run("disk", "patch.obj", "-o", "few.h5", "-max_it", "1", "-multigrid_kps_rtol", "1e-3")
    assert "no use for the option -multigrid_kps_rtol" in unused.stderr
    quiet = run("disk", "-quiet", "true", "patch.obj", "-o", "few.h5", "-max_it", "1")
    assert "iteration" not in quiet.stdout.split("patch.obj")[0]
    assert not os.path.exists("new.h5")
    print(f"presets: {len(presets)} run; options files overruled, missing, damaged, misspelt")


if __name__ == "__main__":
    run_in_folder(main)
