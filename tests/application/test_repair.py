"""Map meshes that need mending: ears on the boundary, twins, turned triangles, vertices of no cell. The result is in the
numbering of the input, and what was mended is in it too.

usage: python3 test_repair.py EQUIMAP [RANKS]
"""
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy

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


def write_obj(path, points, cells):
    with open(path, "w") as file:
        file.writelines("v %.17g %.17g %.17g\n" % tuple(p) for p in points)
        file.writelines("f %d %d %d\n" % tuple(i + 1 for i in c) for c in cells)


def areas(points, cells):
    p = numpy.asarray(points)[numpy.asarray(cells)]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    if p.shape[2] == 2:
        return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    return numpy.linalg.norm(numpy.cross(u, v), axis=1) / 2


def check_result(path, points, cells, ears, twins, folds):
    """The map in input numbering with the ratios of the input's own cells, the mended one beside it."""
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
        "cells_split": 8,  # an ear and its neighbour, four times
        "vertices_added": 4,
        "vertices_unreferenced": 1,
    }, counts
    n = len(points)
    assert len(mended["vertices"]) == n + 4 and (mended["vertices"][:n] == points).all()
    assert (mended["coordinates"][:n] == image).all()
    assert sorted(set(mended["parent"])) == [c for c in range(len(cells)) if c not in twins]
    assert (areas(mended["coordinates"], mended["cells"]) > 0).all()
    kept = [c for c in range(len(cells)) if c not in twins]
    size, area = areas(points, cells)[kept], abs(areas(image, cells)[kept])
    expected = numpy.ones(len(cells))
    expected[kept] = area / size * (size.sum() / area.sum())
    assert numpy.allclose(ratio, expected, rtol=1e-9, atol=1e-12), abs(ratio - expected).max()
    return abs(areas(image, numpy.asarray(cells)[ears]))


def main(equimap, ranks):
    mpirun = ["mpirun", "-n", ranks, "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]

    def run(*arguments, expected=(0,)):
        done = subprocess.run([*mpirun, equimap, *arguments], capture_output=True, text=True)
        assert done.returncode in expected, (arguments, done.returncode, done.stdout[-2000:], done.stderr[-2000:])
        return done

    points, cells, ears, twins = make_mesh()
    write_obj("ears.obj", points, cells)
    for target, folds in (("disk", 0), ("square", 4)):  # on the square the ears themselves lie along the sides
        refused = run(target, "ears.obj", "-o", "bad.h5", expected=(3,))
        assert "ears.obj -repair -o OUT" in refused.stderr and not os.path.exists("bad.h5")
        done = run(target, "ears.obj", "-repair", "-o", f"{target}.h5,{target}.obj", "-summary", "run.json", expected=(5,) if folds else (0, 4))
        assert "repair: 2 twins" in done.stdout and "warning: 1 vertex belongs to no usable triangle" in done.stdout
        flat = check_result(f"{target}.h5", points, cells, ears, twins, folds)
        with open("run.json") as file:
            summary = json.load(file)
        assert summary["mesh"]["vertices"] == len(points) and summary["mesh"]["cells"] == len(cells)
        assert summary["folds"] == folds and summary["repair"]["cells_split"] == 8
    assert (flat < 1e-14).all(), flat

    clean = [c for i, c in enumerate(cells) if i not in ears and i not in twins]
    whole = [tuple(c) if areas(numpy.asarray(points)[:, :2], [c])[0] > 0 else (c[0], c[2], c[1]) for c in clean]
    write_obj("clean.obj", points, whole)
    loud = run("disk", "clean.obj", "-repair", "-o", "clean.h5", "-max_it", "2", expected=(0, 4))
    assert "repair: 0 twins" in loud.stdout
    with h5py.File("clean.h5") as file:
        assert "repaired" not in file and not [name for name in file.attrs if name.startswith("repair_")]
    quiet = run("disk", "clean.obj", "-repair", "-quiet", "-o", "clean.h5", "-max_it", "2", expected=(0, 4))
    assert "repair" not in quiet.stdout and "warning" not in quiet.stdout

    write_obj("torn.obj", points, whole[:100] + whole[160:])
    refused = run("disk", "torn.obj", "-repair", "-o", "bad.h5", expected=(3,))
    assert "not even after -repair" in refused.stderr and not os.path.exists("bad.h5")
    print("repair: ears, twins, turned triangles and a lost vertex mended for disk and square")


if __name__ == "__main__":
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main(program, sys.argv[2] if len(sys.argv) > 2 else "1")
        os.chdir("/")
