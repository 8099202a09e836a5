"""Maps that other programs made: equimap measure finds them where they stand, and says the same of every form.

usage: test_measure.py PROGRAM [RANKS]
"""
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import read_obj, write_obj  # noqa: E402
from program import Program  # noqa: E402

FIGURES = (("energy", "final"), ("ratio", "sd"), ("ratio", "max"), ("angle_error_deg", "mean"))


def measured(program, mesh, image, *options, codes=(0,)):
    """The summary, and what was printed."""
    result = program.succeed("measure", mesh, image, "-summary", "measured.json", *options, codes=codes)
    return json.loads(program.read("measured.json")), result.stdout


def check_same(summary, truth, tolerance, what):
    for group, name in FIGURES:
        got, want = summary[group][name], truth[group][name]
        assert abs(got - want) <= tolerance * max(abs(want), 1e-3), f"{what}: {group}.{name} is {got!r}, not {want!r}"
    assert summary["folds"] == truth["folds"], what


def textured(vertices, points, faces):
    """OBJ text; a face is a list of (vertex, texture point)."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()] + [f"vt {u!r} {v!r}" for u, v in points.tolist()]
    lines += ["f " + " ".join(f"{v + 1}/{t + 1}" for v, t in face) for face in faces]
    return "\n".join(lines) + "\n"


def check_texture(program, vertices, cells, uv, truth):
    """Texture coordinates, with and without seams; a file without a map is refused."""
    program.write("plain.obj", textured(vertices, uv, [[(v, v) for v in cell] for cell in cells.tolist()]))
    summary, printed = measured(program, "hills.obj", "plain.obj")
    check_same(summary, truth, 1e-9, "texture coordinates")
    assert "texture coordinates" in printed and "seams" not in printed, printed
    # a texture of another size, elsewhere, each triangle with texture points of its own, the right half moved away
    corners = 100 * uv[cells] + 7
    corners[corners[:, :, 0].mean(axis=1) > 7] += (500, 0)
    faces = [[(v, 3 * c + k) for k, v in enumerate(cell)] for c, cell in enumerate(cells.tolist())]
    program.write("seams.obj", textured(vertices, corners.reshape(-1, 2), faces))
    summary, printed = measured(program, "hills.obj", "seams.obj", "-o", "seams.h5,seams.ply", "-cells", "cells.csv")
    right = 100 * uv[cells] + 7
    on_both = numpy.intersect1d(cells[right[:, :, 0].mean(axis=1) > 7], cells[right[:, :, 0].mean(axis=1) <= 7])
    assert f"have {len(on_both)} more images" in printed, (len(on_both), printed)
    for group, name in FIGURES[1:]:
        assert abs(summary[group][name] - truth[group][name]) < 1e-9, name
    table = numpy.loadtxt(program.file("cells.csv"), delimiter=",", skiprows=1)
    with h5py.File(program.file("seams.h5"), "r") as result, h5py.File(program.file("hills.h5"), "r") as whole:
        assert result["/mesh/vertices"].shape[0] == len(vertices) + len(on_both)
        assert numpy.allclose(result["/cell/ratio"][...], whole["/cell/ratio"][...], rtol=1e-9)
        assert numpy.array_equal(table[:, 1], result["/cell/ratio"][...])
        assert numpy.array_equal(table[:, 2], result["/cell/quasi_conformal"][...])
    for arguments in (("hills.obj",), ("plain.obj", "-map_in", "vertices"), ("hills.off",)):
        result = program.run("measure", "hills.obj", *arguments)
        assert result.returncode == 3 and "there is no map" in result.stderr, (arguments, result)
    result = program.run("measure", "hills.obj", "hills.off", "-map_in", "texture")
    assert result.returncode == 3 and "no texture coordinates" in result.stderr, result


def check_written(program):
    """-uv writes the surface with its map as texture, which is measured as the map itself; spheres with their seam split."""
    program.succeed("disk", "hills.obj", "-o", "again.h5", "-uv", "disk.uv.obj", "-quiet")
    program.succeed("square", "hills.obj", "-o", "square.h5", "-uv", "square.uv.ply", "-quiet")
    for result, texture in (("again.h5", "disk.uv.obj"), ("square.h5", "square.uv.ply")):
        truth, _ = measured(program, "hills.obj", result)
        summary, printed = measured(program, "hills.obj", texture)
        check_same(summary, truth, 1e-9, texture)
        assert "texture coordinates\n" in printed, printed
    vertices, cells = read_obj(program.file("disk.uv.obj"))
    plain, plain_cells = read_obj(program.file("hills.obj"))
    assert numpy.array_equal(vertices, plain) and numpy.array_equal(cells, plain_cells)
    program.succeed("sphere", "head.obj", "-o", "head.h5", "-uv", "head.uv.obj", "-max_it", 1, "-quiet", codes=(0, 4))
    rows = [line.split() for line in program.read("head.uv.obj").decode().splitlines()]
    uv = numpy.array([row[1:] for row in rows if row[0] == "vt"], float)
    vertices, cells = read_obj(program.file("head.uv.obj"))
    corners = numpy.array([[int(word.split("/")[1]) - 1 for word in row[1:]] for row in rows if row[0] == "f"])
    with h5py.File(program.file("head.h5"), "r") as result:
        image = result["/map/coordinates"][...]
    assert len(uv) > len(vertices) and uv.min() >= 0 and uv[:, 1].max() <= 1
    longitude, latitude = 2 * numpy.pi * (uv[:, 0] - 0.5), numpy.pi * (uv[:, 1] - 0.5)
    points = numpy.stack([numpy.cos(latitude) * numpy.cos(longitude), numpy.cos(latitude) * numpy.sin(longitude), numpy.sin(latitude)], 1)
    assert abs(points[corners] - image[cells]).max() < 1e-6
    u = uv[corners, 0]
    assert (u.max(1) - u.min(1) <= 0.5).mean() > 0.99  # but for triangles around a pole
    for name in ("no.stl", "no.h5"):
        refused = program.run("disk", "hills.obj", "-o", "x.h5", "-uv", name)
        assert refused.returncode == 2 and "-uv" in refused.stderr, refused


def check_points(program, uv, truth):
    """CSV with and without header and numbers, NPY of both precisions and orders."""
    order = numpy.random.RandomState(5).permutation(len(uv))
    program.write("uv.csv", "u,v\n" + "".join(f"{u!r},{v!r}\n" for u, v in uv.tolist()))
    program.write("blank.csv", "".join(f"{u!r} {v!r} 0.0\n" for u, v in uv.tolist()))
    program.write("numbered.csv", "vertex;u;v\n" + "".join(f"{i};{uv[i, 0]!r};{uv[i, 1]!r}\n" for i in order.tolist()))
    numpy.save(program.file("uv.npy"), uv)
    numpy.save(program.file("fortran.npy"), numpy.asfortranarray(uv))
    numpy.save(program.file("single.npy"), uv.astype(">f4"))
    for name in ("uv.csv", "blank.csv", "numbered.csv", "uv.npy", "fortran.npy", "single.npy"):
        summary, _ = measured(program, "hills.obj", name)
        check_same(summary, truth, 2e-2 if name == "single.npy" else 1e-12, name)
    program.write("short.csv", "u,v\n0,0\n1,0\n")
    program.write("twice.csv", "vertex,u,v\n" + "0,0,0\n" * len(uv))
    numpy.save(program.file("whole.npy"), numpy.zeros((len(uv), 2), dtype=int))
    for name, code, words in (("short.csv", 3, "2 vertices"), ("twice.csv", 6, "must come once"), ("whole.npy", 6, "float64")):
        result = program.run("measure", "hills.obj", name)
        assert result.returncode == code and words in result.stderr, (name, result)


def check_no_map(program, uv):
    """Images that are no map are refused, and nothing is written."""
    lost = uv.copy()
    lost[5, 0] = numpy.nan
    for image, words in ((0 * uv, "no area"), (uv * (1, 0), "no area"), (1e200 * uv, "beyond a double's range"), (lost, "vertex 5 is not finite")):
        numpy.save(program.file("no_map.npy"), image)
        result = program.run("measure", "hills.obj", "no_map.npy", "-summary", "no_map.json")
        assert result.returncode == 3 and words in result.stderr and "PETSC" not in result.stderr, (words, result)
        assert not os.path.exists(program.file("no_map.json"))


def check_sphere(program):
    """A sphere of any size anywhere; a surface in space has no folds."""
    program.succeed("generate", "head", "-n", 400, "-o", "head.obj")
    program.succeed("sphere", "head.obj", "-o", "head.h5,ball.obj", "-max_it", 5, "-quiet", codes=(0, 4))
    truth, _ = measured(program, "head.obj", "head.h5")
    image, cells = read_obj(program.file("ball.obj"))
    write_obj(program, "large.obj", 100 * image + (1000, -2000, 3000), cells)
    summary, printed = measured(program, "head.obj", "large.obj")
    check_same(summary, truth, 1e-8, "a large sphere")
    assert "sphere of radius 100 at (1000, -2000, 3000)" in printed, printed
    write_obj(program, "egg.obj", image * (1, 1, 2) + (5, 0, 0), cells)
    summary, printed = measured(program, "head.obj", "egg.obj")
    assert summary["folds"] == 0 and "not counted" in printed, printed
    write_obj(program, "folded.obj", numpy.where(numpy.arange(len(image))[:, None] == 17, -image, image) * 3, cells)
    summary, _ = measured(program, "head.obj", "folded.obj", codes=(5,))
    assert summary["folds"] > 0


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 400, "-o", "hills.obj")
        program.succeed("convert", "hills.obj", "hills.off")
        program.succeed("disk", "hills.obj", "-o", "hills.h5", "-quiet")
        truth, _ = measured(program, "hills.obj", "hills.h5")
        vertices, cells = read_obj(program.file("hills.obj"))
        with h5py.File(program.file("hills.h5"), "r") as result:
            uv = result["/map/coordinates"][...]
        check_texture(program, vertices, cells, uv, truth)
        check_points(program, uv, truth)
        check_no_map(program, uv)
        check_sphere(program)
        check_written(program)


if __name__ == "__main__":
    main()
