"""-start FILE: a run that begins with a map made before or elsewhere, in any format, place and size; folds are mended; what does
not fit is refused.

usage: python3 test_start.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402


def energies(program, target, mesh, start, *options):
    """Energy at the start and at the end of a run of one iteration, and its folds."""
    program.succeed(target, mesh, "-o", "next.h5", "-start", start, "-max_it", 1, "-summary", "next.json", *options, codes=(0, 4))
    summary = json.loads(program.read("next.json"))
    assert summary["folds"] == 0
    return summary["energy"]["initial"], summary["energy"]["final"]


def image_of(program, name):
    with h5py.File(program.file(name), "r") as file:
        return file["/map/coordinates"][...], file["/mesh/cells"][...]


def first_map(program, target, mesh, *outputs):
    program.succeed(target, mesh, "-o", ",".join(("map.h5", *outputs)), "-max_it", 2, "-summary", "map.json", codes=(0, 4))
    return json.loads(program.read("map.json"))["energy"]["final"]


def write_points(program, name, points):
    program.write(name, "x,y,z\n"[:2 * points.shape[1] - 1] + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in points.tolist()))
    return name


def fold(image, cells, every):
    """Exchange the images of the first two corners of some triangles that are far apart from each other."""
    folded = image.copy()
    for cell in cells[::every]:
        folded[cell[:2]] = folded[cell[1::-1]]
    return folded


def check_same(program, target, mesh, energy, names):
    """The run goes on from the energy that the map has, and lowers it."""
    for name in names if program.ranks == 1 else names[::len(names) - 1 or 1]:
        begun, ended = energies(program, target, mesh, name)
        assert abs(begun - energy) <= 1e-4 * energy, f"{target} from {name}: begins at {begun}, not {energy}"
        assert ended < .9 * begun, f"{target} from {name}: ends at {ended}"


def check_folds(program, target, mesh, energy, image, cells):
    """Folds are mended, and what is far from them stays: the first energy is far below that of a start from nothing."""
    inner = numpy.bincount(cells.ravel(), minlength=len(image)) if target == "sphere" else numpy.ones(len(image))
    if target != "sphere":
        inner = (abs(image - .5).max(axis=1) < .45) if target == "square" else numpy.hypot(*image.T) < .9
    own = cells[inner[cells].all(axis=1)]
    folded = write_points(program, "folded.csv", fold(image, own, len(own) // 3))
    result = program.succeed(target, mesh, "-o", "next.h5", "-start", folded, "-max_it", 1, codes=(0, 4))
    assert "unfolding at the start" in result.stdout and "0 afterwards" in result.stdout, result.stdout
    begun, ended = energies(program, target, mesh, folded)
    assert energy < begun < 1., f"{target}: begins at {begun} after unfolding"
    assert ended < begun


def check_disk(program):
    energy = first_map(program, "disk", "disk.obj", "map.obj")
    image, cells = image_of(program, "map.h5")
    program.succeed("disk", "disk.obj", "-o", "other.h5", "-uv", "uv.obj", "-max_it", 2, codes=(0, 4))
    write_points(program, "moved.csv", 100. * image[:, ::-1] + [3., -7.])  # larger, elsewhere, and mirrored
    check_same(program, "disk", "disk.obj", energy, ["map.h5", "map.obj", "uv.obj", "moved.csv"])
    check_folds(program, "disk", "disk.obj", energy, image, cells)
    return image


def check_square(program):
    energy = first_map(program, "square", "disk.obj")
    image, cells = image_of(program, "map.h5")
    write_points(program, "turned.csv", numpy.column_stack([-image[:, 1], image[:, 0]]))
    check_same(program, "square", "disk.obj", energy, ["map.h5", "turned.csv"])
    check_folds(program, "square", "disk.obj", energy, image, cells)
    # other corners than the default's: refused with the option that helps
    boundary = numpy.nonzero(abs(image - .5).max(axis=1) == .5)[0]
    order = boundary[numpy.argsort(numpy.arctan2(*(image[boundary] - .5).T[::-1]))]
    corners = ",".join(str(order[(k * len(order)) // 4 + 3]) for k in range(4))
    program.succeed("square", "disk.obj", "-o", "corners.h5", "-corners", corners, "-max_it", 2, codes=(0, 4))
    result = program.run("square", "disk.obj", "-o", "next.h5", "-start", "corners.h5")
    assert result.returncode == 2 and "-corners " in result.stderr, result.stderr
    given = result.stderr.split("-corners ")[1].split()[0]
    assert sorted(given.split(",")) == sorted(corners.split(",")), f"{given}, not {corners}"
    energies(program, "square", "disk.obj", "corners.h5", "-corners", given)


def check_closed(program):
    energy = first_map(program, "sphere", "closed.obj", "map.gii", "map.ply")
    image, cells = image_of(program, "map.h5")
    write_points(program, "large.csv", 100. * image + [0., 0., 5.])
    check_same(program, "sphere", "closed.obj", energy, ["map.h5", "map.gii", "map.ply", "large.csv"])
    check_folds(program, "sphere", "closed.obj", energy, image, cells)


def check_solid(program):
    energy = first_map(program, "ball", "solid.msh")
    check_same(program, "ball", "solid.msh", energy, ["map.h5"])


def check_refusals(program, image):
    broken = image.copy()
    broken[7, 0] = numpy.nan
    unordered = image.copy()
    rim = numpy.nonzero(abs(numpy.hypot(*image.T) - 1.) < 1e-9)[0][:40:20]
    unordered[rim] = unordered[rim[::-1]]
    for target, mesh, start, code, words in (
            ("disk", "disk.obj", "nowhere.h5", 6, "there is no such file"),
            ("disk", "disk.obj", write_points(program, "short.csv", image[1:]), 3, "do not belong together"),
            ("disk", "disk.obj", write_points(program, "nan.csv", broken), (2, 6), "7"),
            ("disk", "disk.obj", write_points(program, "order.csv", unordered), 2, "along the boundary"),
            ("disk", "disk.obj", "corners.h5", 2, "square"),
            ("square", "disk.obj", write_points(program, "disk.csv", image), 2, "disk"),
            ("sphere", "closed.obj", "closed.obj", 2, "a surface in space"),
            ("disk", "disk.obj", "closed.obj", 3, "do not belong together"),
            ("disk", "disk.obj", "cascad", 2, "did you mean cascade"))[::1 if program.ranks == 1 else 3]:
        result = program.run(target, mesh, "-o", "refused.h5", "-start", start)
        assert result.returncode in numpy.atleast_1d(code), f"{start}: exit code {result.returncode}\n{result.stderr}"
        assert len(program.messages(result)) == 1 and words in result.stderr, f"{start}: {result.stderr}"
        assert not os.path.exists(program.file("refused.h5"))


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        for shape, number, name in (("hills", 800, "disk.obj"), ("head", 800, "closed.obj"), ("figure", 600, "solid.msh")):
            program.succeed("generate", shape, "-n", number, "-o", name, ranks=1)
        image = check_disk(program)
        check_square(program)
        check_closed(program)
        check_solid(program)
        check_refusals(program, image)


if __name__ == "__main__":
    main()
