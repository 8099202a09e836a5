"""Prepare meshes as scanners deliver them: seams, pieces, holes, pinched vertices, fins, turned triangles. The result is in
the numbering of the input, what was done is in summary and result.

usage: python3 test_prepare.py EQUIMAP [RANKS]
"""
import json
import os
import resource
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scans"))
import made
from evaluate import triangle_areas
from meshes import read_obj, write_obj
from program import run_in_folder
from shapes import bricks

N = 20  # squares along a side


def sheet(holes=(), seam=None):
    """A bumpy sheet without the squares of `holes`; along the column `seam` it is torn: the right side has vertices of its
    own."""
    x, y = numpy.meshgrid(numpy.arange(N + 1), numpy.arange(N + 1), indexing="ij")
    points = [(a, b, 1.5 * numpy.sin(0.3 * a) * numpy.cos(0.25 * b)) for a, b in zip(x.ravel(), y.ravel())]
    twin = {}
    if seam is not None:
        for b in range(N + 1):
            twin[seam * (N + 1) + b] = len(points)
            points.append(points[seam * (N + 1) + b])
    cells = []
    for a in range(N):
        for b in range(N):
            if (a, b) in holes:
                continue
            p, q, r, s = (c * (N + 1) + d for c, d in ((a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)))
            if seam is not None and a >= seam:
                p, q, r, s = (twin.get(v, v) for v in (p, q, r, s))
            # diagonals leave the corners of the sheet free
            cells += [(p, q, r), (p, r, s)] if (a < N // 2) == (b < N // 2) else [(p, q, s), (q, r, s)]
    return points, cells


def scan():
    """A sheet with three holes, two of which touch at a vertex, a fin, a second piece, turned and doubled triangles."""
    points, cells = sheet(holes={(4, 4), (4, 5), (5, 4), (12, 12), (13, 13), (15, 4)})
    middle = 8 * (N + 1) + 8
    fin = len(cells)
    points.append((8.5, 8.0, 5.0))
    cells.append((middle, middle + N + 1, len(points) - 1))
    island = range(len(cells) + 1, len(cells) + 3)
    cells.append(cells[10])
    first = len(points)
    points += [(40.0, 0.0, 0.0), (41.0, 0.0, 0.0), (41.0, 1.0, 0.0), (40.0, 1.0, 0.0)]
    cells += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    for turned in (3, 100):
        a, b, c = cells[turned]
        cells[turned] = (a, c, b)
    return points, cells, fin, list(island)


def areas(points, cells):
    return triangle_areas(numpy.asarray(points), numpy.asarray(cells))


def steps_of(path):
    with open(path) as file:
        return {entry["step"]: entry["count"] for entry in json.load(file)["prepared"]}


def test_scan(program):
    points, cells, fin, island = scan()
    write_obj(program, "scan.obj", points, cells)
    refused = program.succeed("disk", "scan.obj", "-o", "bad.h5", codes=(3,))
    assert "disk scan.obj -prepare auto -o OUT" in refused.stderr and not os.path.exists("bad.h5"), refused.stderr
    done = program.succeed("disk", "scan.obj", "-prepare", "auto", "-o", "scan.h5", "-summary", "scan.json")
    assert "prepared: holes: 4 filled" in done.stdout, done.stdout
    steps = steps_of("scan.json")
    assert steps["largest"] == 2 and steps["holes"] == 4, steps  # the fin is a piece of its own once it is cut off
    with h5py.File("scan.h5") as file:
        image, mapped = file["map/coordinates"][:], file["cell/mapped"][:]
        assert image.shape == (len(points), 2) and (file["mesh/cells"][:] == cells).all()
        parent, whole = file["repaired/parent"][:], file["repaired/cells"][:]
        place, positions = file["repaired/coordinates"][:], file["repaired/vertices"][:]
        assert "holes: 4 filled" in str(file.attrs["prepared"]) and file.attrs["folds"] == 0
    left_out = [fin, fin + 1, *island]
    assert [c for c in range(len(cells)) if not mapped[c]] == left_out, numpy.flatnonzero(mapped == 0)
    assert (positions[: len(points)] == points).all() and (place[: len(points)] == image).all()
    assert (parent < 0).any() and (parent[numpy.argmax(parent < 0) :] < 0).all(), "added cells come last"
    assert (areas(place, whole) > 0).all() and abs(areas(place, whole).sum() - numpy.pi) < 0.02
    assert (image[len(points) - 4 :] == 0).all(), "vertices of the piece that was left out"

    for options, name in ((("-prepare", "auto"), "a"), (("-prepare", "auto", "-target", "sphere"), "s")):
        program.succeed("convert", "scan.obj", f"{name}.obj", *options)
        program.succeed("convert", "scan.obj", f"{name}1.obj", *options, ranks=1)
        with open(f"{name}.obj") as one, open(f"{name}1.obj") as other:
            assert one.read() == other.read(), "the same on any number of ranks"
    assert "a closed surface without handles" in program.succeed("check", "s.obj").stdout
    assert "a disk-type surface" in program.succeed("check", "a.obj").stdout


def test_hole_weight(program):
    """A hole of little weight has a small image."""
    points, cells = sheet(holes={(a, b) for a in range(8, 12) for b in range(8, 12)})
    write_obj(program, "hole.obj", points, cells)
    share = []
    for weight in ("1", ".05"):
        program.succeed("disk", "hole.obj", "-prepare", "holes", "-hole_weight", weight, "-o", "hole.h5", codes=(0, 4))
        with h5py.File("hole.h5") as file:
            added = file["repaired/parent"][:] < 0
            area = areas(file["repaired/coordinates"][:], file["repaired/cells"][:])
        share.append(area[added].sum() / area.sum())
    assert 0.02 < share[0] < 0.08 and share[1] < 0.15 * share[0], share


def test_hole_weight_on_sphere(program):
    """A sheet becomes a sphere whose filled outside weighs little; the areas of the sheet itself are kept."""
    points, cells = sheet()
    write_obj(program, "sheet.obj", points, cells)
    share = []
    for weight in ("1", ".05"):
        program.succeed("sphere", "sheet.obj", "-prepare", "auto", "-hole_weight", weight, "-o", "sheet.h5", "-summary", "sheet.json", "-quiet")
        with open("sheet.json") as file:
            summary = json.load(file)
        assert summary["folds"] == 0 and summary["ratio_weighted"]["sd"] < 0.02 and not summary["poor"], summary["ratio_weighted"]
        with h5py.File("sheet.h5") as file:
            place, whole, added = file["repaired/coordinates"][:], file["repaired/cells"][:], file["repaired/parent"][:] < 0
        area = abs(numpy.linalg.norm(numpy.cross(place[whole[:, 1]] - place[whole[:, 0]], place[whole[:, 2]] - place[whole[:, 0]]), axis=1))
        assert (numpy.linalg.det(place[whole]) > 0).all()
        share.append(area[added].sum() / area.sum())
    assert share[0] > 0.3 and share[1] < 0.1 * share[0], share


def test_seam(program):
    """A torn sheet is sewn; both sides of the seam get the same image. A cut that makes a disk is left alone."""
    points, cells = sheet(seam=7)
    write_obj(program, "torn.obj", points, cells)
    program.succeed("disk", "torn.obj", "-prepare", "weld", "-o", "torn.h5", "-summary", "torn.json")
    assert steps_of("torn.json") == {"weld": N + 1}
    with h5py.File("torn.h5") as file:
        image = file["map/coordinates"][:]
    left = image[7 * (N + 1) : 8 * (N + 1)]
    assert (left == image[(N + 1) ** 2 :]).all() and abs(left).max() > 0.1
    assert "can begin" in program.succeed("disk", "torn.obj", "-prepare", "auto", "-o", "t.h5", "-dry_run").stdout
    wide = program.succeed("disk", "torn.obj", "-prepare", "weld", "-weld_tolerance", "2", "-o", "t.h5", codes=(2,))
    assert "-weld_tolerance" in wide.stderr


def test_flat(program):
    """Triangles without area: vertices on edges, and doubled vertices. The surface stays, the vertices keep their numbers."""
    for name, make, count in (("caps", lambda: made.capped(made.FACE, 20), None), ("needles", lambda: made.needled(13, 13, 3), 16)):
        points, cells = make()
        points, cells = numpy.array(points), numpy.array(cells)
        write_obj(program, "flat.obj", points, cells)
        flat = int((areas(points, cells) < 1e-12).sum())
        done = program.succeed("convert", "flat.obj", "mended.obj", "-prepare", "flat")
        assert f"flat: {count or flat} triangles" in done.stdout, done.stdout  # a collapse mends two
        program.succeed("convert", "flat.obj", "alone.obj", "-prepare", "flat", ranks=1)
        with open("mended.obj") as one, open("alone.obj") as other:
            assert one.read() == other.read(), "the same on any number of ranks"
        places, mended = read_obj(program.file("mended.obj"))
        size = areas(places, mended)
        assert (places == points).all() and size.min() > 1e-6 and abs(size.sum() / areas(points, cells).sum() - 1) < 1e-12
        program.succeed("disk", "flat.obj", "-prepare", "auto", "-o", "flat.h5", "-quiet", codes=(0, 4))
        with h5py.File("flat.h5") as file:
            image, parent = file["map/coordinates"][:], file["repaired/parent"][:]
            assert (areas(file["repaired/coordinates"][:], file["repaired/cells"][:]) > 0).all() and (parent >= 0).all()
        if name == "needles":
            twins = numpy.arange(169, len(points))
            original = [numpy.flatnonzero((points[:169] == points[k]).all(axis=1))[0] for k in twins]
            assert (image[twins] == image[original]).all(), "both vertices of a needle have one image"


def test_chain(program):
    """Vertices at one place, each collapsed onto the next: as many as there are, the work grows no faster. The limit is ten times
    what the program takes, and half of what it takes if it looks through them all for each."""
    copies = 60000
    columns = numpy.concatenate([numpy.arange(6), numpy.full(copies, 5), numpy.arange(6, 11)]).astype(float)
    n = len(columns)
    points = numpy.array([[x, y, 0.1 * x * y] for y in range(4) for x in columns])
    corner = (numpy.arange(3)[:, None] * n + numpy.arange(n - 1)).ravel()
    cells = numpy.concatenate([numpy.column_stack([corner, corner + 1, corner + 1 + n]), numpy.column_stack([corner, corner + 1 + n, corner + n])])
    write_obj(program, "chain.obj", points, cells)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    program.succeed("convert", "chain.obj", "mended.obj", "-prepare", "flat", ranks=1)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before < 5
    points, cells = read_obj(program.file("mended.obj"))
    used, place = points[cells], {tuple(x) for x in points}
    assert len(cells) == 60 and (areas(points, cells) > 0.1).all() and len(place) == 44 and len({tuple(x) for x in used.reshape(-1, 3)}) == 44


def test_cavities(program):
    """Cavities of a solid are filled around a vertex in their middle; one that is bent too much for that is left."""
    bent = {(5, 1, 1), (5, 2, 1), (6, 1, 1), (7, 1, 1), (7, 2, 1)}
    for name, wrong, left in (("two", {(1, 1, 1), (3, 2, 1)}, 0), ("bent", {(1, 1, 1), *bent}, 1)):
        points, cells = bricks((9, 4, 3), lambda i, j, k: (i, j, k) not in wrong)
        program.write("solid.mesh", made.medit((points, cells)))
        done = program.succeed("convert", "solid.mesh", f"{name}.h5", "-prepare", "holes")
        program.succeed("convert", "solid.mesh", "alone.h5", "-prepare", "holes", ranks=1)
        assert f"{2 - left} cavities filled with {12 * (2 - left)} tetrahedra" in done.stdout, done.stdout
        with h5py.File(f"{name}.h5") as file, h5py.File("alone.h5") as other:
            vertices, tets = file["mesh/vertices"][:], file["mesh/cells"][:]
            assert (vertices == other["mesh/vertices"][:]).all() and (tets == other["mesh/cells"][:]).all(), "the same on any number of ranks"
        corner = vertices[tets]
        volume = numpy.linalg.det(corner[:, 1:] - corner[:, :1]) / 6
        assert (volume > 0).all() and abs(volume.sum() - (108 - 5 * left)) < 1e-12 and (vertices[: len(points)] == points).all()
        told = program.run("check", f"{name}.h5").stdout
        assert ("boundary surfaces 2" if left else "boundary surfaces 1") in told, told


def test_handle(program):
    """A sheet with a thin bridge between two of its squares: the handle is placed, refused while it is large, cut else."""
    points, cells = sheet(holes={(5, 10), (13, 10)})
    corners = [[(a + c) * (N + 1) + 10 + d for c, d in ((0, 0), (1, 0), (1, 1), (0, 1))] for a in (5, 13)]
    rings, steps = [corners[0]], 9
    low, high = (numpy.array([points[v] for v in ring]) for ring in corners)
    for k in range(1, steps):  # the bridge rises from one hole and comes down in the other, mirrored
        t = k / steps
        ring = (1 - t) * low + t * high[[1, 0, 3, 2]] + [0, 0, 4 * numpy.sin(numpy.pi * t)]
        rings.append(list(range(len(points), len(points) + 4)))
        points += [tuple(x) for x in ring]
    rings.append([corners[1][k] for k in (1, 0, 3, 2)])
    for one, two in zip(rings, rings[1:]):
        for k in range(4):
            a, b, c, d = one[k], one[(k + 1) % 4], two[(k + 1) % 4], two[k]
            cells += [(a, b, c), (a, c, d)]
    write_obj(program, "bridge.obj", points, cells)
    told = program.succeed("check", "bridge.obj", "-summary", "check.json", codes=(3,)).stdout
    assert "the surface has 1 handle" in told and "around or through one: " in told, told
    with open("check.json") as file:
        where = json.load(file)["findings"]["genus"]["where"]
    loop = [v for part in where for v in part]
    edges = {frozenset(pair) for c in cells for pair in ((c[0], c[1]), (c[1], c[2]), (c[0], c[2]))}
    assert len(loop) == 4 and all(frozenset((loop[k], loop[(k + 1) % 4])) in edges for k in range(4)), loop
    refused = program.succeed("disk", "bridge.obj", "-prepare", "auto", "-o", "t.h5", "-handle_length", ".01", codes=(3,))
    assert "1 handle" in refused.stderr
    program.succeed("disk", "bridge.obj", "-prepare", "auto", "-o", "b.h5", "-handle_length", ".3", "-summary", "b.json", codes=(0, 4))
    assert steps_of("b.json")["handles"] == 1
    with h5py.File("b.h5") as file:
        fate = file["cell/mapped"][:]
        assert (fate > 0).all() and 4 <= (fate == 2).sum() <= 40 and file.attrs["prepared_mesh.cells_cut_off"] == (fate == 2).sum()
    program.succeed("convert", "bridge.obj", "b.obj", "-prepare", "handles", "-handle_length", ".3")
    program.succeed("convert", "bridge.obj", "b1.obj", "-prepare", "handles", "-handle_length", ".3", ranks=1)
    with open("b.obj") as one, open("b1.obj") as other:
        assert one.read() == other.read(), "the same on any number of ranks"
    assert "genus 0" in program.succeed("check", "b.obj").stdout


def test_usage(program):
    points, cells, _, _ = scan()
    write_obj(program, "scan.obj", points, cells)
    assert "weld, split, flat, largest, holes, handles" in program.succeed("disk", "scan.obj", "-prepare", "mend", "-o", "t.h5", codes=(2,)).stderr
    assert "there are only" in program.succeed("convert", "scan.obj", "t.obj", "-prepare", "split,largest", "-piece", "9", codes=(2,)).stderr
    done = program.succeed("convert", "scan.obj", "t.obj", "-prepare", "split,largest", "-piece", "3")
    assert " 2 triangles" in done.stdout, done.stdout  # the island; the fin is larger


def main(program):
    test_scan(program)
    test_hole_weight(program)
    test_hole_weight_on_sphere(program)
    test_seam(program)
    test_flat(program)
    if program.ranks == 1:
        test_chain(program)
    test_cavities(program)
    test_handle(program)
    test_usage(program)
    print("prepare: holes filled, pieces left out, seams sewn, non-manifold parts cut apart")


if __name__ == "__main__":
    run_in_folder(main)
