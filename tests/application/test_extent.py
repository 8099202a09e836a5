"""Meshes of any size give the map of the mesh itself, and results in the file's unit; those whose areas or volumes are no numbers
there are refused with the command that scales them.

usage: test_extent.py PROGRAM [RANKS]
"""
import json
import math
import os
import re
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import read_obj, write_obj  # noqa: E402
from program import Program  # noqa: E402


def energy(program, mesh):
    program.succeed("disk", mesh, "-o", "out.h5", "-summary", "out.json", "-max_it", 3, "-quiet", codes=(0, 4))
    return json.loads(program.read("out.json"))["energy"]["final"]


def check_unit(program, vertices, cells, truth, area):
    """The map is that of the mesh at its own size; result, copy beside the checkpoint, texture, `check` and `measure` have the
    file's unit."""
    write_obj(program, "mesh.obj", vertices, cells)
    assert abs(energy(program, "mesh.obj") - truth) <= 1e-6 * truth, area
    assert math.isclose(json.loads(program.read("out.json"))["mesh"]["measure"], area, rel_tol=1e-9)
    with h5py.File(program.file("out.h5")) as result:
        assert (result["/mesh/vertices"][:] == vertices).all()
    program.succeed("measure", "mesh.obj", "out.h5", "-summary", "measured.json")
    measured = json.loads(program.read("measured.json"))
    assert math.isclose(measured["mesh"]["measure"], area, rel_tol=1e-9) and math.isclose(measured["energy"]["final"], truth, rel_tol=1e-6)
    program.succeed("check", "mesh.obj", "-summary", "check.json")
    assert math.isclose(json.loads(program.read("check.json"))["mesh"]["measure"], area, rel_tol=1e-9)
    program.succeed("disk", "mesh.obj", "-o", "out.h5", "-uv", "uv.obj", "-checkpoint", "run.ck", "-max_it", 1, "-quiet", codes=(4,))
    assert (read_obj(program.file("uv.obj"))[0] == vertices).all()
    program.succeed("disk", "-restart", "run.ck", "-o", "again.h5", "-max_it", 2, "-quiet", codes=(0, 4))
    with h5py.File(program.file("again.h5")) as result:
        assert (result["/mesh/vertices"][:] == vertices).all()


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 200, "-o", "hills.obj")
        vertices, cells = read_obj(program.file("hills.obj"))
        truth = energy(program, "hills.obj")
        area = json.loads(program.read("out.json"))["mesh"]["measure"]
        for exponent in (-55, 55):
            write_obj(program, "mesh.obj", vertices * 10.0 ** exponent, cells)
            assert abs(energy(program, "mesh.obj") - truth) <= 1e-6 * truth, exponent
        for exponent in (-120, 120):
            check_unit(program, vertices * 10.0 ** exponent, cells, truth, area * 10.0 ** (2 * exponent))
        for exponent in (-300, 300):
            write_obj(program, "mesh.obj", vertices * 10.0 ** exponent, cells)
            for command in (["disk", "mesh.obj", "-o", "out.h5"], ["check", "mesh.obj"], ["measure", "mesh.obj", "mesh.obj"]):
                refused = program.run(*command)
                assert refused.returncode == 3 and len(program.messages(refused)) == 1, (command, refused)
                advice = re.search(r"equimap convert mesh.obj OUT -scale (\S+)", refused.stderr)
                assert advice and "PETSC ERROR" not in refused.stderr, refused.stderr
            program.succeed("convert", "mesh.obj", "scaled.obj", "-scale", advice.group(1))
            assert abs(energy(program, "scaled.obj") - truth) <= 1e-6 * truth, exponent
        program.succeed("generate", "ball", "-n", 100, "-o", "ball.mesh")
        program.succeed("convert", "ball.mesh", "large.mesh", "-scale", "1e50")
        program.succeed("ball", "large.mesh", "-o", "out.h5", "-max_it", 3, codes=(0, 4))
        refused = program.run("register", "large.mesh", "large.mesh", "-o", "out.h5")
        assert refused.returncode == 3 and "volumes" in refused.stderr, refused
        for factor in ("0", "-1", "inf"):
            refused = program.run("convert", "ball.mesh", "other.mesh", "-scale", factor)
            assert refused.returncode == 2 and ("factor" in refused.stderr or "finite" in refused.stderr), refused


if __name__ == "__main__":
    main()
