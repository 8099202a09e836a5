"""A mesh made anew through its map: where the new vertices lie, fields, geometry images, another mesh's connectivity.

usage: python3 test_resample.py EQUIMAP [RANKS]
"""
import os
import struct
import sys
import zlib

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import read_obj
from program import run_in_folder


def with_fields(program, source, name):
    """The mesh of an OBJ file as HDF5, with the third coordinate as a field of the vertices and the number of each cell."""
    points, cells = read_obj(program.file(source))
    with h5py.File(program.file(name), "w") as file:
        file["mesh/vertices"], file["mesh/cells"] = points, cells
        file["vertex/height"], file["cell/number"] = points[:, 2], numpy.arange(len(cells), dtype=float)
    return points, cells


def read(path):
    with h5py.File(path) as file:
        fields = {name: file[name][:] for name in ("vertex/height", "cell/number", "vertex/number", "vertex/target") if name in file}
        return file["mesh/vertices"][:], file["mesh/cells"][:], fields


def locate(image, cells, place):
    """The cell of a planar image that a place lies in, and barycentric coordinates there, by trying all."""
    a, b, c = (image[cells[:, k]] for k in range(3))
    whole = numpy.cross(b - a, c - a)
    share = numpy.stack([numpy.cross(b - place, c - place), numpy.cross(c - place, a - place), numpy.cross(a - place, b - place)]) / whole
    best = int(share.min(axis=0).argmax())
    return best, share[:, best]


def check_square(program):
    program.succeed("generate", "hills", "-n", "500", "-o", "hills.obj")
    points, cells = with_fields(program, "hills.obj", "hills.h5")
    program.succeed("square", "hills.h5", "-o", "map.h5", "-balance", ".01", "-quiet")
    done = program.succeed("resample", "map.h5", "-grid", "15", "-o", "grid.h5,grid.obj,grid.png", "-transfer", "/vertex/ratio")
    program.succeed("resample", "map.h5", "-grid", "15", "-o", "alone.h5", ranks=1)
    with h5py.File("map.h5") as file:
        image = file["map/coordinates"][:]
    found, quads, fields = read("grid.h5")
    grid = numpy.stack(numpy.meshgrid(numpy.arange(15), numpy.arange(15), indexing="xy"), -1).reshape(-1, 2) / 14
    assert len(quads) == 2 * 14 * 14 and abs(fields["vertex/target"][:, :2] - grid).max() < 1e-15
    assert abs(fields["vertex/height"] - found[:, 2]).max() < 1e-12, "a field that is linear in space is carried exactly"
    for k, place in enumerate(grid):
        cell, share = locate(image, cells, place)
        assert abs(share @ points[cells[cell]] - found[k]).max() < 1e-9, (k, cell)
        assert fields["vertex/number"][k] == cell or share.min() < 1e-9, (k, cell)
    assert abs(read("alone.h5")[0] - found).max() < 1e-12, "the same on any number of ranks"
    flat = grid[quads]
    assert (numpy.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]) > 0).all()
    assert "area" in done.stdout and "outside" not in done.stdout, done.stdout
    check_png(found)
    check_tiff(program, found)


def check_png(found):
    """16 bits per channel between the extremes that the text chunks tell; upper side first."""
    with open("grid.png", "rb") as stream:
        bytes_ = stream.read()
    at, data, text = 8, b"", {}
    while at < len(bytes_):
        length, kind = struct.unpack(">I4s", bytes_[at : at + 8])
        body = bytes_[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            assert struct.unpack(">IIBB", body[:10]) == (15, 15, 16, 2)
        if kind == b"IDAT":
            data += body
        if kind == b"tEXt":
            key, value = body.split(b"\0")
            text[key.decode()] = value.decode()
        at += 12 + length
    rows = numpy.frombuffer(zlib.decompress(data), dtype=numpy.uint8).reshape(15, 1 + 90)
    before, pixels = numpy.zeros(90, int), []
    for row in rows:
        line = [int(x) for x in row[1:]]
        for i in range(90):  # the filters of PNG
            left, up, corner = (line[i - 6] if i >= 6 else 0), before[i], (before[i - 6] if i >= 6 else 0)
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, paeth)[row[0]]) % 256
        before = numpy.array(line)
        pixels.append(before[0::2] * 256 + before[1::2])
    low, high = (numpy.array([float(x) for x in text[key].split()]) for key in ("least", "largest"))
    shown = numpy.array(pixels).reshape(15, 15, 3)[::-1].reshape(-1, 3) / 65535 * (high - low) + low
    assert text["quantity"] == "position" and abs(shown - found).max() < 1e-5 * (high - low).max(), abs(shown - found).max()


def check_tiff(program, found):
    """The numbers themselves, in 32 bits, where the program was built with libtiff."""
    result = program.run("resample", "map.h5", "-grid", "15", "-o", "grid.tif")
    if result.returncode == 2 and "built without libtiff" in result.stderr:
        return
    assert result.returncode == 0, result.stderr
    with open("grid.tif", "rb") as stream:
        bytes_ = stream.read()
    directory = struct.unpack("<I", bytes_[4:8])[0]
    count = struct.unpack("<H", bytes_[directory : directory + 2])[0]
    tags = {tag: (number, value) for tag, _, number, value in struct.iter_unpack("<HHII", bytes_[directory + 2 : directory + 2 + 12 * count])}
    strips = tags[273][1]
    shown = numpy.frombuffer(bytes_[strips : strips + 4 * 675], dtype="<f4").reshape(15, 15, 3)[::-1].reshape(-1, 3)
    assert abs(shown - found).max() < 1e-6 * abs(found).max()


def check_filled(program):
    """A hole that was filled: fields go on into it, cell fields have no number there."""
    points, cells = read_obj(program.file("hills.obj"))
    middle = abs(points[cells].mean(axis=1)[:, :2] - [0.4, 0.6]).max(axis=1) > 0.12
    cells = cells[middle]
    with h5py.File(program.file("holed.h5"), "w") as file:
        file["mesh/vertices"], file["mesh/cells"] = points, cells
        file["vertex/height"], file["cell/number"] = numpy.full(len(points), 7.0), numpy.arange(len(cells), dtype=float)
    program.succeed("disk", "holed.h5", "-o", "disk.h5", "-prepare", "auto", "-quiet")
    program.succeed("resample", "disk.h5", "-grid", "12", "-o", "rings.h5")
    found, rings, fields = read("rings.h5")
    assert len(found) == 1 + 3 * 12 * 13 and len(rings) == 6 * 144
    assert abs(fields["vertex/height"] - 7).max() < 1e-12
    inside, outside = (abs(found[:, :2] - [0.4, 0.6]).max(axis=1) < 0.05), (abs(found[:, :2] - [0.4, 0.6]).max(axis=1) > 0.25)
    assert inside.any() and numpy.isnan(fields["vertex/number"][inside]).all() and not numpy.isnan(fields["vertex/number"][outside]).any()


def check_closed(program):
    """The icosahedron, a sphere of radius 100 that another program made, and a ball: nothing is turned inside out."""
    program.succeed("generate", "head", "-n", "500", "-o", "head.obj")
    program.succeed("sphere", "head.obj", "-o", "sphere.h5", "-quiet", "-balance", ".01")
    program.succeed("resample", "sphere.h5", "-grid", "8", "-o", "ico.h5")
    program.succeed("generate", "sphere", "-n", "300", "-o", "regular.obj")
    program.succeed("convert", "regular.obj", "regular.surf.gii", "-scale", "100")
    program.succeed("resample", "sphere.h5", "-onto", "regular.surf.gii", "-o", "onto.obj")
    points, cells = read_obj(program.file("head.obj"))
    volume = numpy.linalg.det(points[cells]).sum() / 6
    for vertices, triangles in (read("ico.h5")[:2], read_obj(program.file("onto.obj"))):
        assert abs(numpy.linalg.det(vertices[triangles]).sum() / 6 / volume - 1) < 0.06
    assert len(read("ico.h5")[1]) == 20 * 64 and (read_obj(program.file("onto.obj"))[1] == read_obj(program.file("regular.obj"))[1]).all()
    program.succeed("sphere", "head.obj", "-o", "image.obj", "-quiet", "-balance", ".01")  # mesh and map in two files
    program.succeed("resample", "head.obj", "image.obj", "-grid", "8", "-o", "two.h5")
    assert abs(read("two.h5")[0] - read("ico.h5")[0]).max() < 1e-6

    program.succeed("generate", "blob", "-n", "600", "-o", "blob.msh")
    for target in ("ball", "cube"):
        program.succeed(target, "blob.msh", "-o", "solid.h5", "-quiet", "-max_it", "30", codes=(0, 4))
        program.succeed("resample", "solid.h5", "-grid", "3", "-o", "layers.h5")
        vertices, solid, fields = read("layers.h5")
        places = fields["vertex/target"]
        corner = places[solid]
        assert len(vertices) == 343 and (numpy.linalg.det(corner[:, 1:] - corner[:, :1]) > 0).all()
        corner = vertices[solid]
        assert (numpy.linalg.det(corner[:, 1:] - corner[:, :1]) > 0).mean() > 0.98
        assert target == "ball" or abs(places * 6 - numpy.rint(places * 6)).max() < 1e-14


def check_refusals(program):
    for arguments, code, words in (
        (("hills.obj", "-grid", "5", "-o", "x.obj"), 2, "no result"),
        (("map.h5", "-o", "x.obj"), 2, "-grid N or -onto"),
        (("map.h5", "-grid", "1", "-o", "x.obj"), 2, "for the square give 2"),
        (("map.h5", "-onto", "sphere.h5", "-o", "x.obj"), 2, "another target"),
        (("sphere.h5", "-grid", "5", "-o", "x.png"), 2, "map to the square"),
        (("map.h5", "-grid", "5", "-o", "x.png", "-image", "nothing"), 2, "no such field"),
    ):
        result = program.succeed("resample", *arguments, codes=(code,))
        assert words in result.stderr and not os.path.exists(arguments[-1]), result.stderr


def main(program):
    check_square(program)
    check_filled(program)
    check_closed(program)
    check_refusals(program)
    print("resample: squares, rings, icosahedra, balls, images and other meshes")


if __name__ == "__main__":
    run_in_folder(main)
