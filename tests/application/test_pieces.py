"""-pieces each: every piece of a mesh gets a target of its own, in one result.

usage: python3 test_pieces.py EQUIMAP [RANKS]
"""
import json
import os
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "zoo"))
from evaluate import triangle_areas
from meshes import write_obj
from program import run_in_folder
from shapes import ellipsoid, grid, moved, together


def hill(x, y, z):
    return x, y, 0.3 * numpy.sin(4 * x) * numpy.cos(3 * y)


SMALL = moved(grid(8, 8), hill)
LARGE = moved(grid(14, 10, lambda i, j: not (5 <= i < 7 and 4 <= j < 6)), lambda x, y, z: hill(3 + 2 * x, 2 * y, z))
EGG = moved(ellipsoid(1.3, 10, 10), lambda x, y, z: (x + 9, y, z * (1 + 0.2 * numpy.sin(x))))


def areas(points, cells):
    return triangle_areas(numpy.asarray(points), numpy.asarray(cells))


def textures(path):
    """Texture coordinates of the corners of every triangle."""
    with open(path) as stream:
        rows = [line.split() for line in stream]
    points = numpy.array([[float(x) for x in row[1:3]] for row in rows if row and row[0] == "vt"])
    return points[[[int(word.split("/")[1]) - 1 for word in row[1:4]] for row in rows if row and row[0] == "f"]]


def check_disks(program):
    """Two sheets, the larger with a hole, and an egg, which is no disk."""
    points, cells = together(SMALL, LARGE, EGG)
    write_obj(program, "scene.obj", points, cells)
    done = program.succeed("disk", "scene.obj", "-prepare", "auto", "-pieces", "each", "-balance", ".01", "-o", "each.h5", "-uv", "uv.obj",
                           "-summary", "each.json", "-quiet", codes=(0, 4))
    assert "piece 1: not mapped: the surface is closed" in done.stdout and "2 of 3 pieces mapped" in done.stdout, done.stdout
    counts = [len(SMALL[1]), len(LARGE[1]), len(EGG[1])]
    numbers = numpy.repeat([3, 2, 0], counts)
    with h5py.File("each.h5") as file:
        image, piece, energy = file["map/coordinates"][:], file["cell/piece"][:], file["piece/energy"][:]
        measure, ratio, whole = file["piece/measure"][:], file["cell/ratio"][:], file.attrs["energy_final"]
        assert (file["piece/cells"][:] == [0, counts[1], counts[0]]).all() and (file["piece/exit_code"][:][1:] == 0).all()
    assert (piece == numbers).all()
    space = areas(points, cells)
    for number in (2, 3):
        mine = numbers == number
        flat = areas(image, numpy.array(cells)[mine])
        rim = 0.9 if number == 2 else 0.97  # the hole's share is not the file's
        assert (flat > 0).all() and rim * numpy.pi * 0.9 < flat.sum() < numpy.pi and numpy.linalg.norm(image, axis=1).max() < 1 + 1e-12
        own = flat / flat.sum() / (space[mine] / space[mine].sum())
        assert abs(own - ratio[mine]).max() < 1e-9, "ratios are those of the piece"
        assert abs(energy[number - 1] / (flat.sum() * (space[mine] / space[mine].sum() * (own - 1) ** 2).sum()) - 1) < 1e-6
        assert abs(measure[number - 1] / space[mine].sum() - 1) < 1e-9
        program.succeed("disk", "scene.obj", "-prepare", "auto", "-piece", number, "-balance", ".01", "-o", "one.h5", "-quiet", codes=(0, 4))
        with h5py.File("one.h5") as file:
            used = numpy.unique(numpy.array(cells)[mine])
            assert abs(file["map/coordinates"][:][used] - image[used]).max() < 1e-12, "as -piece K maps it"
    r, w = ratio[numbers > 0], space[numbers > 0] / space[numbers > 0].sum()
    mean = (measure[1:] * [areas(image, numpy.array(cells)[numbers == n]).sum() for n in (2, 3)]).sum() / measure[1:].sum()
    assert abs(whole / (mean * (w * (r - 1) ** 2).sum()) - 1) < 1e-6, "the energy of the whole"
    with open("each.json") as file:
        assert json.load(file)["pieces"] == {"all": 3, "mapped": 2}
    check_charts(textures("uv.obj"), numbers, space)


def check_charts(corners, numbers, space):
    """The charts lie apart in the unit square, with areas in proportion."""
    boxes = {n: (corners[numbers == n].reshape(-1, 2).min(axis=0), corners[numbers == n].reshape(-1, 2).max(axis=0)) for n in (2, 3)}
    assert all((low >= 0).all() and (high <= 1).all() for low, high in boxes.values())
    assert (boxes[2][1] < boxes[3][0]).any() or (boxes[3][1] < boxes[2][0]).any(), boxes
    flat = abs(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2)
    share = [flat[numbers == n].sum() / space[numbers == n].sum() for n in (2, 3)]
    assert abs(share[0] / share[1] - 1) < 0.1, share  # up to the hole and to the polygon in the circle


def check_spheres(program):
    points, cells = together(EGG, moved(EGG, lambda x, y, z: (x + 9, 2 * y, 2 * z)))
    write_obj(program, "eggs.obj", points, cells)
    program.succeed("sphere", "eggs.obj", "-pieces", "each", "-o", "eggs.h5", "-quiet")
    with h5py.File("eggs.h5") as file:
        image, piece = file["map/coordinates"][:], file["cell/piece"][:]
        assert file.attrs["folds"] == 0
    assert (piece == numpy.repeat([2, 1], len(EGG[1]))).all() and abs(numpy.linalg.norm(image, axis=1) - 1).max() < 1e-12
    for half in (cells[: len(EGG[1])], cells[len(EGG[1]) :]):
        assert numpy.linalg.det(image[numpy.array(half)]).sum() / 6 > 3.5


def check_refusals(program):
    for arguments, code, words in (
        (("disk", "eggs.obj"), 3, "none of its 2 pieces"),
        (("disk", "scene.obj", "-history", "x.csv"), 2, "no -history"),
        (("disk", "scene.obj", "-start", "./scene.obj"), 2, "no -start FILE"),
        (("square", "scene.obj", "-corners", "0,1,2,3"), 2, "no -corners"),
        (("disk", "scene.obj", "-checkpoint", "x.chk"), 2, "no -checkpoint"),
        (("sphere", "eggs.obj", "-uv", "x.obj"), 2, "side by side"),
        (("disk", "scene.obj", "-pieces", "all"), 2, "-pieces"),
    ):
        result = program.succeed(*arguments, *([] if "all" in arguments else ["-pieces", "each"]), "-o", "x.h5", codes=(code,))
        assert words in result.stderr and not os.path.exists("x.h5"), result.stderr


def main(program):
    check_disks(program)
    check_spheres(program)
    check_refusals(program)
    print("pieces: each on its own, side by side in a texture")


if __name__ == "__main__":
    run_in_folder(main)
