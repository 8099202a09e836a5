"""lm by cycles on a hierarchy of meshes: no factor, a map like that of a factor, the same bits after a restart and for any
number of threads, the same result on other ranks, with levels that one rank has or all share; where cycles gain nothing, a
factor; what it cannot do is refused.

usage: python3 test_cycles.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

CYCLES = ("-start", "cascade", "-linear_solver", "hierarchy", "-energy_rtol", 0, "-ratio_tol", 0)


def run(program, name, *options, target="disk", mesh="mesh.h5", **how):
    program.succeed(target, mesh, "-o", name + ".h5", "-summary", name + ".json", "-quiet", *options, codes=(0, 4), **how)
    return json.loads(program.read(name + ".json"))


def coordinates(program, name):
    with h5py.File(program.file(name + ".h5"), "r") as result:
        return result["/map/coordinates"][...]


def check_maps(program):
    """No factor at all, no fold, and an energy that few steps leave."""
    for target, shape, most in (("disk", "hills", 3e-4), ("square", "hills", 5e-5), ("sphere", "head", 1e-4)):
        program.succeed("generate", shape, "-n", 6000, "-o", f"{shape}.h5", ranks=1)
        found = run(program, target, *CYCLES, "-max_it", 4, target=target, mesh=f"{shape}.h5")
        work = found["work"]
        assert work["coupled_factorizations"] == work["factorizations"] == 0, work
        assert work["set_ups"] >= 4 and work["cg_iterations"] >= work["set_ups"], work
        assert found["folds"] == 0 and found["energy"]["final"] < most, (target, found["energy"])
        assert found["linear_solver"].startswith("hierarchy"), found["linear_solver"]


def check_restart(program, mesh, half):
    """Between two matrices that share their coarse motions. Returns what the whole run has found."""
    whole = run(program, "whole", *CYCLES, "-max_it", 2 * half, mesh=mesh)
    run(program, "begun", *CYCLES, "-max_it", half, "-checkpoint", "c.h5", "-checkpoint_every", half, mesh=mesh)
    again = run(program, "gone-on", *CYCLES, "-max_it", 2 * half, "-restart", "c.h5", mesh=mesh)
    assert numpy.array_equal(coordinates(program, "gone-on"), coordinates(program, "whole")), "a restart changes bits"
    assert again["work"] == whole["work"], (again["work"], whole["work"])
    return whole


def check_same(here, other):
    assert abs(here["energy"]["final"] - other["energy"]["final"]) < 1e-4 * other["energy"]["final"]
    assert here["work"] == other["work"], (here["work"], other["work"])


def check_small(program):
    """Levels that the first rank has."""
    check_same(check_restart(program, "mesh.h5", 2), run(program, "alone", *CYCLES, "-max_it", 4, ranks=1))


def check_shared(program):
    """Levels that ranks and threads share."""
    program.succeed("generate", "hills", "-n", 21000, "-o", "shared.h5", ranks=1)
    check_same(check_restart(program, "shared.h5", 1), run(program, "alone", *CYCLES, "-max_it", 2, "-threads", 2, mesh="shared.h5", ranks=1))
    if program.ranks == 1:
        assert numpy.array_equal(coordinates(program, "alone"), coordinates(program, "whole")), "threads change bits"


def check_fall_back(program):
    """At the end of arithmetic cycles gain nothing: a factor takes over, for this run and its restarts."""
    with open(program.file("five.obj"), "w", encoding="utf-8") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .4 .6 .1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n")
    options = ("-start", "tutte", *CYCLES[2:])
    told = program.succeed("disk", "five.obj", "-o", "five.h5", "-summary", "five.json", "-checkpoint", "five.c.h5", "-checkpoint_every", 1, *options)
    assert "factors instead" in told.stdout + told.stderr, told
    found = json.loads(program.read("five.json"))
    assert found["work"]["coupled_factorizations"] == 1 and found["work"]["set_ups"] > 1, found["work"]
    assert found["energy"]["final"] < 1e-25 and found["folds"] == 0, found
    again = run(program, "five-again", *options, "-restart", "five.c.h5", mesh="five.obj")
    assert again["energy"]["final"] < 1e-25 and again["work"]["set_ups"] == found["work"]["set_ups"], again["work"]


def check_refusals(program):
    with open(program.file("angles.csv"), "w", encoding="utf-8") as file:
        file.write("vertex,angle\n")
        with h5py.File(program.file("whole.h5"), "r") as result:
            xy, cells = result["/map/coordinates"][...], result["/mesh/cells"][...]
        edges = numpy.sort(numpy.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
        unique, count = numpy.unique(edges, axis=0, return_counts=True)
        for v in numpy.unique(unique[count == 1]):
            file.write(f"{v},{numpy.arctan2(xy[v, 1], xy[v, 0])}\n")
    refused = program.run("disk", "mesh.h5", "-o", "x.h5", "-linear_solver", "hierarchy", "-boundary_angles", "angles.csv")
    assert refused.returncode == 2 and "hierarchy moves the boundary, which is held" in refused.stderr, refused
    assert not os.path.exists(program.file("x.h5"))


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 3000, "-o", "mesh.h5", ranks=1)
        check_maps(program)
        check_small(program)
        check_refusals(program)
        check_shared(program)
        check_fall_back(program)


if __name__ == "__main__":
    main()
