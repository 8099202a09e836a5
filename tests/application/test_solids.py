"""Solids of tetrahedra: every format keeps every bit, check says what ball would say, faults are told and mended, the
surface can be taken.

usage: python3 test_solids.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

MESH, IO = 3, 6

# The three ways of a path along the edges of a small cube that make its six tetrahedra.
PATHS = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]


def bricks(size, filled=lambda i, j, k: True):
    """Small cubes of six tetrahedra each, where they are wanted; vertices that nobody needs are there, too."""
    stride = (1, size[0] + 1, (size[0] + 1) * (size[1] + 1))
    points = [(x, y, z) for z in range(size[2] + 1) for y in range(size[1] + 1) for x in range(size[0] + 1)]
    cells = []
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                if not filled(i, j, k):
                    continue
                for number, path in enumerate(PATHS):
                    corners = [i * stride[0] + j * stride[1] + k * stride[2]]
                    for step in path:
                        corners.append(corners[-1] + stride[step])
                    if number >= 3:
                        corners[2], corners[3] = corners[3], corners[2]
                    cells.append(corners)
    return points, cells


def medit(points, cells):
    return ("MeshVersionFormatted 1\nDimension 3\nVertices\n%d\n" % len(points)
            + "".join("%r %r %r 0\n" % tuple(p) for p in points) + "Tetrahedra\n%d\n" % len(cells)
            + "".join("%d %d %d %d 0\n" % tuple(v + 1 for v in c) for c in cells) + "End\n")


def check_formats(program):
    """Around through all formats, and back to the same bytes."""
    program.succeed("generate", "blob", "-n", 400, "-o", "blob.mesh")
    first = program.read("blob.mesh")
    previous = "blob.mesh"
    for suffix in ("node", "vtu", "meshb", "vtk", "h5", "msh", "ele", "mesh"):
        program.succeed("convert", previous, "next." + suffix)
        previous = "next." + suffix
    assert program.read("next.mesh") == first, "the mesh has changed on its way"
    os.remove(program.file("next.ele"))
    result = program.succeed("check", "next.node", codes=(IO,))
    assert "next.ele" in result.stderr, result.stderr


def check_report(program, *arguments, codes=(0,)):
    result = program.succeed("check", *arguments, "-summary", "check.json", codes=codes)
    return result.stdout, json.loads(program.read("check.json"))


def check_verdicts(program):
    """Good solids, and each fault of a bad one."""
    for shape in ("ball", "blob", "figure", "cube"):
        program.succeed("generate", shape, "-n", 3000, "-seed", 3, "-o", "good.meshb")
        said, report = check_report(program, "good.meshb")
        assert report["commands"]["ball"] and not report["findings"], (shape, report["findings"])
        assert "ready for ball" in said
    faults = {
        "cavities": (bricks((3, 3, 3), lambda i, j, k: (i, j, k) != (1, 1, 1)), "holes", "cavity"),
        "tunnel": (bricks((3, 3, 2), lambda i, j, k: (i, j) != (1, 1)), "genus", "tunnel"),
        "pieces": (bricks((3, 1, 1), lambda i, j, k: i != 1), "components", "2 pieces"),
        "hinge": (bricks((2, 2, 1), lambda i, j, k: i == j), "non_manifold_vertex", "no face in common"),
    }
    for name, ((points, cells), finding, word) in faults.items():
        program.write(name + ".mesh", medit(points, cells))
        said, report = check_report(program, name + ".mesh", codes=(MESH,))
        assert finding in report["findings"] and not report["commands"]["ball"], (name, report["findings"])
        assert word in said, (name, said)


def check_repair(program):
    """All cells of a bar hang on the boundary alone; one of them is inside out and one is there twice."""
    points, cells = bricks((6, 1, 1))
    cells[5][2:] = cells[5][:1:-1]
    cells.append(cells[9][1:] + cells[9][:1])
    program.write("bar.mesh", medit(points, cells))
    said, report = check_report(program, "bar.mesh", codes=(MESH,))
    findings = {name: entry["count"] for name, entry in report["findings"].items()}
    assert findings["no_interior_vertex"] == 36 and findings["chord"] == 11, findings
    assert findings["inconsistent_orientation"] == 1 and findings["duplicate_cell"] == 1, findings
    assert "-repair" in said
    said, report = check_report(program, "bar.mesh", "-repair", "-o", "mended.node")
    assert report["commands"]["ball"] and not report["findings"], report["findings"]
    assert report["repair"]["cells_flipped"] == 1 and report["repair"]["duplicate_cells_removed"] == 1
    assert abs(report["mesh"]["measure"] - 6.0) < 1e-12
    _, report = check_report(program, "mended.ele")
    assert report["commands"]["ball"] and not report["findings"], report["findings"]


def volumes(points, cells):
    corner = points[cells]
    a, b, c = (corner[:, k] - corner[:, 0] for k in (1, 2, 3))
    return numpy.einsum("ij,ij->i", numpy.cross(a, b), c) / 6


def check_map_of_mended(program):
    """A map of a mended solid is told in the input's vertices and cells, in every format."""
    points, cells = bricks((6, 2, 2))
    cells[5][2:] = cells[5][:1:-1]
    cells.append(cells[9][1:] + cells[9][:1])
    program.write("thick.mesh", medit(points, cells))
    program.succeed("ball", "thick.mesh", "-repair", "-max_it", 20, "-o", "map.h5,map.mesh,map.vtu,map.node",
                    codes=(0, 4, 5))
    with h5py.File(program.file("map.h5")) as file:
        places, ratio = file["/map/coordinates"][:], file["/cell/ratio"][:]
        assert (file["/mesh/cells"][:] == numpy.array(cells)).all() and places.shape == (len(points), 3)
        parent, pieces = file["/repaired/parent"][:], file["/repaired/cells"][:]
        before = volumes(file["/repaired/vertices"][:], pieces)
    assert abs(before.sum() - 24) < 1e-12 and before.min() > 0
    used = sorted(set(parent))
    assert used == list(range(len(cells) - 1)) and ratio[-1] == 1  # the last cell is a twin
    # the ratios are those of the input's own cells, turned as the mended ones are
    own, image = (volumes(numpy.asarray(x, float), numpy.array(cells[:-1])) for x in (points, places))
    image *= numpy.sign(own)
    share = image / image.sum() / (abs(own) / abs(own).sum())
    assert abs(share - ratio[:-1]).max() < 1e-9, abs(share - ratio[:-1]).max()
    lines = program.read("map.mesh").decode().split("Vertices\n")[1].splitlines()
    assert (numpy.array([line.split()[:3] for line in lines[1:len(points) + 1]], float) == places).all()
    program.succeed("convert", "map.node", "node.mesh")
    program.succeed("convert", "map.vtu", "vtu.mesh")
    assert program.read("node.mesh") == program.read("vtu.mesh") == program.read("map.mesh")


def check_surface(program):
    """The surface of a solid is one that `sphere` takes, with the boundary's vertices."""
    program.succeed("generate", "figure", "-n", 1000, "-o", "figure.msh")
    _, solid = check_report(program, "figure.msh")
    program.succeed("convert", "figure.msh", "skin.obj", "-boundary")
    _, skin = check_report(program, "skin.obj")
    assert skin["commands"]["sphere"] and skin["mesh"]["genus"] == 0
    assert skin["mesh"]["vertices"] == solid["mesh"]["boundary_vertices"]
    result = program.succeed("convert", "skin.obj", "peeled.obj", "-boundary", codes=(2,))
    assert "of triangles" in result.stderr, result.stderr


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        check_formats(program)
        check_verdicts(program)
        check_repair(program)
        check_map_of_mended(program)
        check_surface(program)
    print("solids are read, written, diagnosed, mended and peeled as they should be")
    return 0


sys.exit(main())
