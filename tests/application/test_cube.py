"""equimap cube as a user runs it: what the result holds, measured by rules of our own; stopped and continued on another number
of ranks; from a map in a file; drawn; what it refuses.

usage: python3 test_cube.py EQUIMAP [RANKS]
"""
import json
import os
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import run_in_folder  # noqa: E402


def read(program, name):
    with h5py.File(program.file(name)) as file:
        return file["/map/coordinates"][...], file["/mesh/vertices"][...], file["/mesh/cells"][...], file["/cell/ratio"][...]


def volumes(points, cells):
    a, b, c = (points[cells[:, k]] - points[cells[:, 0]] for k in (1, 2, 3))
    return numpy.einsum("ij,ij->i", numpy.cross(a, b), c) / 6


def boundary(cells):
    """Triangles of one tetrahedron only."""
    faces = {}
    for cell in cells.tolist():
        for k in range(4):
            face = cell[:k] + cell[k + 1:]
            faces.setdefault(tuple(sorted(face)), []).append(face)
    return numpy.array([found[0] for found in faces.values() if len(found) == 1])


def check_map(program):
    """Boundary triangles lie flat in faces that are full, volumes are those of the ratios, and all is told in the summary."""
    program.succeed("cube", "blob.msh", "-o", "map.h5", "-summary", "map.json", "-quiet", "-max_it", 200)
    image, points, cells, ratio = read(program, "map.h5")
    summary = json.loads(program.read("map.json"))
    assert summary["folds"] == 0 and summary["energy"]["final"] < 5e-3
    volume, own = volumes(image, cells), abs(volumes(points, cells))
    assert volume.min() > 0 and abs(volume.sum() - 1) < 1e-12
    share = own / own.sum()
    assert abs(volume / share - ratio).max() < 1e-9
    energy = (share * (ratio - 1) ** 2).sum()
    assert abs(energy - summary["energy"]["final"]) < 1e-9 * energy, energy
    skin = boundary(cells)
    area = numpy.linalg.norm(numpy.cross(image[skin[:, 1]] - image[skin[:, 0]], image[skin[:, 2]] - image[skin[:, 0]]), axis=1) / 2
    total = 0
    for axis in range(3):
        for side in (0.0, 1.0):
            within = (image[skin][:, :, axis] == side).all(axis=1)
            assert abs(area[within].sum() - 1) < 1e-12, (axis, side)
            total += within.sum()
    assert total == len(skin)
    corners = {tuple(place) for place in image[numpy.unique(skin)].tolist() if set(place) <= {0.0, 1.0}}
    assert len(corners) == 8
    measured = program.succeed("measure", "blob.msh", "map.h5").stdout
    assert "cube" in measured and f"{energy:.6e}"[:6] in measured, measured
    return image


def check_again(program, image):
    """Stopped and continued on other ranks; begun with the map, and with the map moved and scaled."""
    program.succeed("cube", "blob.msh", "-o", "part.h5", "-checkpoint", "run.h5", "-max_it", 20, "-quiet", codes=(0, 4))
    program.succeed("cube", "-restart", "run.h5", "-o", "whole.h5", "-max_it", 200, "-quiet", ranks=3 - program.ranks % 2)
    assert abs(read(program, "whole.h5")[0] - image).max() < 1e-3
    with h5py.File(program.file("moved.h5"), "w") as file, h5py.File(program.file("map.h5")) as source:
        source.copy("/mesh", file)
        file["/map/coordinates"] = 3 * image - 1
    for name in ("map", "moved"):
        program.succeed("cube", "blob.msh", "-start", f"./{name}.h5", "-o", "begun.h5", "-max_it", 0, "-quiet", codes=(0, 4))
        assert abs(read(program, "begun.h5")[0] - image).max() < 1e-12, name
    drawn = program.run("report", "map.h5", "-o", "map.png", "-width", 400, ranks=1)
    assert drawn.returncode == 0 or "cairo" in drawn.stderr


def check_refused(program):
    program.succeed("generate", "head", "-n", 300, "-o", "head.obj", ranks=1)
    program.succeed("ball", "blob.msh", "-o", "ball.h5", "-max_it", 1, "-quiet", ranks=1, codes=(0, 4))
    program.write("one.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n"
                              "1 2 3 4 0\nEnd\n")
    for code, words, *arguments in ((3, "solid of tetrahedra is wanted", "head.obj"), (3, "too coarse", "one.mesh"),
                                    (2, "what its map fills: ball", "blob.msh", "-start", "./ball.h5"),
                                    (2, "no such method for the cube", "blob.msh", "-method", "qiem")):
        result = program.run("cube", *arguments, "-o", "no.h5", "-quiet")
        assert result.returncode == code and words in result.stderr and not os.path.exists(program.file("no.h5")), (
            arguments, result.returncode, result.stderr)


def main(program):
    program.succeed("generate", "blob", "-n", 700, "-o", "blob.msh", ranks=1)
    image = check_map(program)
    check_again(program, image)
    check_refused(program)
    print("cube: faces, volumes, restart, start, refusals: fine")


if __name__ == "__main__":
    run_in_folder(main)
