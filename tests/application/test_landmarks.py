"""Landmarks with weights of their own, and feature curves: what they do to the map, where they are kept, how they are drawn.

usage: python3 test_landmarks.py EQUIMAP [RANKS]
"""
import json
import os
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import read_obj  # noqa: E402
from program import run_in_folder  # noqa: E402

HEAVY = 3  # of the landmarks, the one that gets a weight


def register(program, name, *options):
    """Draw landmarks of hills to points of the disk: where they end, and the result."""
    program.succeed("register", "hills.h5", "target", "-landmarks", name + ".csv", "-o", name + ".h5", "-summary", name + ".json", "-quiet",
                    "-landmark_weight", "1e-2", "-landmark_stages", "1", "-max_it", "30", *options, codes=(0, 4))
    with h5py.File(program.file(name + ".h5")) as file:
        kept = {key: value[...] for key, value in file["/register/landmarks"].items()}
        return file["/map/coordinates"][...][kept["vertex"], :2], kept


def check_weights(program, vertices):
    """A weak pull leaves landmarks where they are, a landmark of weight 1e4 goes to its place; a column of ones changes nothing."""
    with h5py.File(program.file("hills.h5")) as file:
        places = file["/map/coordinates"][...]
    inside = numpy.flatnonzero((places ** 2).sum(axis=1) < .5)[:: len(vertices) // 12]
    goals = places[inside] * .8 + [.1, -.05]
    for name, weight in (("plain", None), ("ones", lambda k: 1), ("heavy", lambda k: 1e4 if k == HEAVY else 1)):
        rows = [f"{v},{x!r},{y!r}" + (f",{weight(k)}" if weight else "") for k, (v, (x, y)) in enumerate(zip(inside, goals.tolist()))]
        program.write(name + ".csv", "a,x,y" + (",weight" if weight else "") + "\n" + "\n".join(rows) + "\n")
    for method in ("lm", "lbfgs", "fixed-point"):
        ends = {name: register(program, name, "-method", method) for name in ("plain", "ones", "heavy")}
        off = {name: numpy.linalg.norm(end - goals, axis=1) for name, (end, _) in ends.items()}
        assert abs(ends["plain"][0] - ends["ones"][0]).max() < 1e-12, method
        assert off["heavy"][HEAVY] < .05 * off["plain"][HEAVY], (method, off)
        assert numpy.delete(off["heavy"], HEAVY).mean() > .3 * numpy.delete(off["plain"], HEAVY).mean(), (method, off)
        kept = ends["heavy"][1]
        assert kept["weight"][HEAVY] == 1e4 and "weight" not in ends["plain"][1] and abs(kept["goal"] - goals).max() < 1e-15


def check_curves(program, vertices):
    """Curves are kept and drawn: in the picture only where there are some."""
    chosen = numpy.argsort(vertices[:, 0])[:: len(vertices) // 9]
    program.write("curves.csv", "a,b,curve\n" + "".join(f"{v},{v},{k // 3 - 1}\n" for k, v in enumerate(chosen)))
    program.write("points.csv", "a,b\n" + "".join(f"{v},{v}\n" for v in chosen))
    for name in ("curves", "points"):
        program.succeed("register", "hills.h5", "hills.h5", "-landmarks", name + ".csv", "-o", name + ".h5", "-quiet")
    with h5py.File(program.file("curves.h5")) as file, h5py.File(program.file("points.h5")) as other:
        assert file["/register/landmarks/curve"][...].tolist() == [k // 3 - 1 for k in range(len(chosen))]
        assert "curve" not in other["/register/landmarks"]
    drawn = [program.run("report", name + ".h5", "-o", name + ".svg", ranks=1) for name in ("curves", "points")]
    if any("cairo" in one.stderr for one in drawn):
        return  # a build without it draws nothing
    assert b"stroke-dasharray" in program.read("curves.svg") and b"stroke-dasharray" not in program.read("points.svg")


def adjacent_path(vertices, cells, start, steps):
    """A way along edges, always to the neighbour that is farthest in the direction of x."""
    way = [start]
    for _ in range(steps):
        near = numpy.unique(cells[(cells == way[-1]).any(axis=1)])
        way.append(int(near[vertices[near, 0].argmax()]))
    return way


def check_polylines(program, vertices, cells):
    """The same curve with twice as many vertices on a refined copy: each vertex of A's goes to where it is itself."""
    program.succeed("convert", "hills.obj", "fine.obj", "-refine", 1, ranks=1)
    fine, _ = read_obj(program.file("fine.obj"))
    middle = numpy.argsort(vertices[:, 0])[len(vertices) // 3]
    ways = [adjacent_path(vertices, cells, middle, 5), adjacent_path(vertices, cells, numpy.argsort(vertices[:, 0])[len(vertices) // 4], 4)]
    places = [numpy.array([vertices[way[k // 2]] if k % 2 == 0 else (vertices[way[k // 2]] + vertices[way[k // 2 + 1]]) / 2
                           for k in range(2 * len(way) - 1)]) for way in ways]
    numbers = [[int(numpy.linalg.norm(fine - place, axis=1).argmin()) for place in line] for line in places]
    for name, lists in (("a", ways), ("b", numbers)):
        program.write(name + ".csv", "curve,vertex\n" + "".join(f"{c},{v}\n" for c, line in enumerate(lists) for v in line))
    program.write("one.csv", f"a,b\n{ways[0][2]},{numbers[0][4]}\n")
    program.succeed("register", "hills.h5", "fine.obj", "-curves_a", "a.csv", "-curves_b", "b.csv", "-landmarks", "one.csv", "-o",
                    "lines.h5", "-quiet", codes=(0, 4))
    with h5py.File(program.file("lines.h5")) as file:
        kept = {key: value[...] for key, value in file["/register/landmarks"].items()}
    listed = [ways[0][2], *(v for way in ways for v in way if v != ways[0][2])]
    expected = list(dict.fromkeys(listed))
    assert kept["vertex"].tolist() == expected, (kept["vertex"], expected)
    assert abs(kept["point"] - vertices[expected]).max() < 1e-12 * abs(vertices).max()
    assert kept["curve"][0] == -1 and set(kept["curve"][1:].tolist()) == {0, 1}
    for name, text, words in (("short", "curve,vertex\n0,5\n", "no length"), ("strange", "curve,vertex\n0,5\n0,99999\n", "vertex 99999"),
                              ("other", "curve,vertex\n7,5\n7,6\n", "none of that number")):
        program.write(name + ".csv", text)
        result = program.run("register", "hills.h5", "fine.obj", "-curves_a", "a.csv", "-curves_b", name + ".csv", "-o", "no.h5", "-quiet")
        assert result.returncode == 2 and words in result.stderr, (name, result.stderr)


def check_refused(program):
    for name, text, words in (("zero", "a,b,weight\n3,4,0\n", "weight 0"), ("half", "a,b,curve\n3,4,1.5\n", "curve 1.5"),
                              ("order", "a,weight,b,x,y\n3,4,1,1,1\n", "a landmark is a vertex"),
                              ("between", "a,x,weight,z\n3,.1,1,.2\n", "come last")):
        program.write(name + ".csv", text)
        result = program.run("register", "hills.h5", "hills.h5", "-landmarks", name + ".csv", "-o", "no.h5", "-quiet")
        messages = program.messages(result)
        assert result.returncode == 2 and len(messages) == 1 and words in messages[0], (name, result.stderr)


def main(program):
    program.succeed("generate", "hills", "-n", 700, "-o", "hills.obj", ranks=1)
    program.succeed("disk", "hills.obj", "-o", "hills.h5", "-quiet", "-ratio_tol", "3e-3", "-summary", "hills.json", ranks=1)
    assert json.loads(program.read("hills.json"))["folds"] == 0
    vertices, cells = read_obj(program.file("hills.obj"))
    check_weights(program, vertices)
    check_curves(program, vertices)
    check_polylines(program, vertices, cells)
    check_refused(program)
    print("landmarks: weights, curves, refusals: fine")


if __name__ == "__main__":
    run_in_folder(main)
