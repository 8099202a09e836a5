"""Meshes of any size: those whose areas or volumes are no numbers are refused with the command that scales them; after it
they give the map of the mesh itself.

usage: test_extent.py PROGRAM [RANKS]
"""
import json
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import read_obj, write_obj  # noqa: E402
from program import Program  # noqa: E402


def energy(program, mesh):
    program.succeed("disk", mesh, "-o", "out.h5", "-summary", "out.json", "-max_it", 3, "-quiet", codes=(0, 4))
    return json.loads(program.read("out.json"))["energy"]["final"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 200, "-o", "hills.obj")
        vertices, cells = read_obj(program.file("hills.obj"))
        truth = energy(program, "hills.obj")
        for exponent in (-55, 55):
            write_obj(program, "mesh.obj", vertices * 10.0 ** exponent, cells)
            assert abs(energy(program, "mesh.obj") - truth) <= 1e-6 * truth, exponent
        for exponent in (-300, -120, 120, 300):
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
        refused = program.run("ball", "large.mesh", "-o", "out.h5")
        assert refused.returncode == 3 and "volumes" in refused.stderr, refused
        for factor in ("0", "-1", "inf"):
            refused = program.run("convert", "ball.mesh", "other.mesh", "-scale", factor)
            assert refused.returncode == 2 and ("factor" in refused.stderr or "finite" in refused.stderr), refused


if __name__ == "__main__":
    main()
