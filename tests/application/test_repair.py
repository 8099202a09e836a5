"""Map meshes that need mending: ears on the boundary, twins, turned triangles, vertices of no cell. The result is in the
numbering of the input, and what was mended is in it too.

usage: python3 test_repair.py EQUIMAP [RANKS]
"""
import json
import os
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import triangle_areas
from meshes import write_obj
from program import run_in_folder

N = 12  # squares along a side


def make_mesh():
    """A bumpy sheet with an ear in the middle of each side, two twins, three turned triangles and a lost vertex."""
    x, y = numpy.meshgrid(numpy.arange(N + 1), numpy.arange(N + 1), indexing="ij")
    points = [(a, b, 2.0 * numpy.sin(0.4 * a) * numpy.cos(0.3 * b)) for a, b in zip(x.ravel(), y.ravel())]
    number = lambda a, b: a * (N + 1) + b
    cells = []
    for a in range(N):
        for b in range(N):
            p, q, r, s = number(a, b), number(a + 1, b), number(a + 1, b + 1), number(a, b + 1)
            cells += [(p, q, r), (p, r, s)] if (a < N // 2) == (b < N // 2) else [(p, q, s), (q, r, s)]
    points.append((50.0, 50.0, 50.0))  # of no cell
    half = N // 2
    ears = []
    for (a, b), (c, d), tip in [
        ((half, 0), (half + 1, 0), (half + 0.5, -0.8)),
        ((N, half), (N, half + 1), (N + 0.8, half + 0.5)),
        ((half + 1, N), (half, N), (half + 0.5, N + 0.8)),
        ((0, half + 1), (0, half), (-0.8, half + 0.5)),
    ]:
        ears.append(len(cells))
        cells.append((number(c, d), number(a, b), len(points)))
        points.append((*tip, 0.0))
    for turned in (3, 100, ears[0]):
        a, b, c = cells[turned]
        cells[turned] = (a, c, b)
    twins = [len(cells), len(cells) + 1]
    cells += [cells[7], cells[200][1:] + cells[200][:1]]
    return points, cells, ears, twins


def areas(points, cells):
    return triangle_areas(numpy.asarray(points), numpy.asarray(cells))


def check_result(path, points, cells, ears, twins, folds, split):
    """The map in input numbering with the ratios of the input's own cells, the mended one beside it: with the ears split where
    the map is better so, else as they are."""
    with h5py.File(path) as file:
        image, ratio = file["map/coordinates"][:], file["cell/ratio"][:]
        assert image.shape == (len(points), 2) and file["vertex/ratio"].shape == (len(points),)
        assert (file["mesh/cells"][:] == cells).all() and ratio.shape == (len(cells),)
        mended = {name: file["repaired"][name][:] for name in ("vertices", "cells", "coordinates", "parent")}
        counts = {name[7:]: int(value) for name, value in file.attrs.items() if name.startswith("repair_")}
        assert file.attrs["folds"] == folds and file.attrs["complete"] == 1
        assert file.attrs["prepared_mesh.folds"] == 0
    assert counts == {
        "duplicate_cells_removed": 2,
        "degenerate_cells_removed": 0,
        "cells_flipped": 3,
        "cells_split": 8 if split else 0,  # an ear and its neighbour, four times
        "vertices_added": 4 if split else 0,
        "vertices_unreferenced": 1,
    }, counts
    n = len(points)
    assert len(mended["vertices"]) == n + (4 if split else 0) and (mended["vertices"][:n] == points).all()
    assert (mended["coordinates"][:n] == image).all()
    assert sorted(set(mended["parent"])) == [c for c in range(len(cells)) if c not in twins]
    assert (areas(mended["coordinates"], mended["cells"]) > 0).all()
    kept = [c for c in range(len(cells)) if c not in twins]
    size, area = areas(points, cells)[kept], abs(areas(image, cells)[kept])
    expected = numpy.ones(len(cells))
    expected[kept] = area / size * (size.sum() / area.sum())
    assert numpy.allclose(ratio, expected, rtol=1e-9, atol=1e-12), abs(ratio - expected).max()
    return abs(areas(image, numpy.asarray(cells)[ears]))


def main(program):
    points, cells, ears, twins = make_mesh()
    write_obj(program, "ears.obj", points, cells)
    for target, folds, split in (("disk", 0, False), ("square", 4, True)):  # on the square the ears themselves lie along the sides
        refused = program.succeed(target, "ears.obj", "-o", "bad.h5", codes=(3,))
        assert "ears.obj -repair -o OUT" in refused.stderr and not os.path.exists("bad.h5")
        done = program.succeed(target, "ears.obj", "-repair", "-o", f"{target}.h5,{target}.obj", "-summary", "run.json", codes=(5,) if folds else (0, 4))
        assert "repair: 2 twins" in done.stdout and "warning: 1 vertex belongs to no usable triangle" in done.stdout
        flat = check_result(f"{target}.h5", points, cells, ears, twins, folds, split)
        with open("run.json") as file:
            summary = json.load(file)
        assert summary["mesh"]["vertices"] == len(points) and summary["mesh"]["cells"] == len(cells)
        assert "once more without splits" in done.stdout  # what the last run came to need not be what the user has
        assert f"  {summary['status']}: {summary['message']}\n" in done.stdout[done.stdout.index("\nears.obj, "):], done.stdout
        assert summary["folds"] == folds and summary["repair"]["cells_split"] == (8 if split else 0)
    assert (flat < 1e-14).all(), flat

    clean = [c for i, c in enumerate(cells) if i not in ears and i not in twins]
    whole = [tuple(c) if areas(numpy.asarray(points)[:, :2], [c])[0] > 0 else (c[0], c[2], c[1]) for c in clean]
    write_obj(program, "clean.obj", points, whole)
    loud = program.succeed("disk", "clean.obj", "-repair", "-o", "clean.h5", "-max_it", "2", codes=(0, 4))
    assert "repair: 0 twins" in loud.stdout
    with h5py.File("clean.h5") as file:
        assert "repaired" not in file and not [name for name in file.attrs if name.startswith("repair_")]
    quiet = program.succeed("disk", "clean.obj", "-repair", "-quiet", "-o", "clean.h5", "-max_it", "2", codes=(0, 4))
    assert "repair" not in quiet.stdout and "warning" not in quiet.stdout

    write_obj(program, "torn.obj", points, whole[:100] + whole[160:])
    refused = program.succeed("disk", "torn.obj", "-repair", "-o", "bad.h5", codes=(3,))
    assert "not even after -repair" in refused.stderr and not os.path.exists("bad.h5")
    print("repair: ears, twins, turned triangles and a lost vertex mended for disk and square")


if __name__ == "__main__":
    run_in_folder(main)
