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
import numpy

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


def arrays(program, name):
    """All of a result's arrays of reals but the clock."""
    found = {}
    with h5py.File(program.file(name)) as result:
        result.visititems(lambda path, item: found.update({path: item[()]}) if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" else None)
    found.pop("history/seconds", None)
    return found


def check_register(program):
    """Two meshes that are large or small alike, with points, fields and frames in their unit: all lengths are those of the
    correspondence at its own size, times the factor, and everything else is the same."""
    lengths = {"inverse/coordinates", "map/coordinates", "mesh/vertices", "mesh_b/vertices", "morph/frame_000", "morph/frame_001",
               "register/landmarks/point", "transfer/to_b/coordinates"}
    meshes = {}
    for name, seed in (("a", 1), ("b", 2)):
        program.succeed("generate", "hills", "-n", 200, "-seed", seed, "-o", name + ".obj")
        meshes[name] = read_obj(program.file(name + ".obj"))
    results = []
    for exponent in (0, 333, -333):
        factor = 2.0 ** exponent
        for name, (vertices, cells) in meshes.items():
            write_obj(program, name + ".obj", vertices * factor, cells)
        points = (meshes["b"][0] * factor)[[60, 90]]
        program.write("points.csv", "a,x,y,z\n" + "".join(f"{v},{x!r},{y!r},{z!r}\n" for v, (x, y, z) in zip((70, 80), points.tolist())))
        program.succeed("register", "a.obj", "b.obj", "-o", "phi.h5", "-landmarks", "points.csv", "-landmark_points", "surface", "-transfer",
                        "coordinates", "-frames", 2, "-summary", "phi.json", "-quiet", codes=(0, 4))
        results.append((factor, arrays(program, "phi.h5"), json.loads(program.read("phi.json"))))
    (_, usual, told), *others = results
    assert lengths <= set(usual), sorted(usual)
    for factor, found, summary in others:
        assert set(found) == set(usual)
        for path, values in usual.items():
            scale = factor if path in lengths else 1.0
            assert numpy.allclose(found[path] / scale, values, rtol=1e-6, atol=1e-9), (factor, path)
        for of in (lambda s: s["mesh"]["measure"], lambda s: s["register"]["b"]["measure"]):
            assert math.isclose(of(summary), of(told) * factor ** 2, rel_tol=1e-9), factor
        assert math.isclose(summary["energy"]["final"], told["energy"]["final"], rel_tol=1e-6)


def check_pieces(program, vertices, cells):
    """Two pieces, with coordinates beyond those whose squares of areas are numbers."""
    both = numpy.concatenate((vertices, vertices + 9.0)), numpy.concatenate((cells, cells + len(vertices)))
    areas = []
    for factor in (1.0, 2.0 ** 333, 2.0 ** -333):
        write_obj(program, "both.obj", both[0] * factor, both[1])
        program.succeed("disk", "both.obj", "-pieces", "each", "-o", "out.h5", "-quiet", codes=(0, 4))
        with h5py.File(program.file("out.h5")) as result:
            assert numpy.allclose(result["/mesh/vertices"][:] / factor, both[0], rtol=1e-12)
            areas.append(result["/piece/measure"][:] / factor ** 2)
    assert len(areas[0]) == 2 and all(numpy.allclose(found, areas[0], rtol=1e-9) for found in areas), areas


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
        refused = program.run("register", "large.mesh", "ball.mesh", "-o", "out.h5")
        assert refused.returncode == 3 and len(program.messages(refused)) == 1 and "differ in size" in refused.stderr, refused
        check_register(program)
        check_pieces(program, vertices, cells)
        for factor in ("0", "-1", "inf"):
            refused = program.run("convert", "ball.mesh", "other.mesh", "-scale", factor)
            assert refused.returncode == 2 and ("factor" in refused.stderr or "finite" in refused.stderr), refused


if __name__ == "__main__":
    main()
