"""equimap conformal as a user runs it on a surface with a boundary: the Riemann map, and every measure of angles computed anew.

usage: python3 test_conformal.py EQUIMAP [RANKS]
"""
import csv
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import boundary_edges, conformal_factor, corner_angles, dirichlet_energy, evaluate, singular_values  # noqa: E402
from meshes import write_obj  # noqa: E402
from program import Program  # noqa: E402


def check_angles(result, vertices, image, cells):
    """What the result file says of angles."""
    singular = singular_values(vertices, image, cells)
    assert numpy.allclose(result["/cell/quasi_conformal"][...], singular[:, 0] / singular[:, 1], rtol=1e-6)
    assert numpy.allclose(result["/vertex/conformal_factor"][...], conformal_factor(vertices, image, cells), atol=1e-9)
    errors = abs(corner_angles(image, cells) - corner_angles(vertices, cells)).ravel()
    edges, counts = result["/histogram/angle_error_edges"][...], result["/histogram/angle_error"][...]
    assert counts.sum() == errors.size and edges[0] == 0.0 and edges[-1] == 180.0
    # rounding may put a few that lie on an edge into the bin beside it
    assert abs(counts - numpy.histogram(errors, edges)[0]).sum() <= 4, "histogram"
    return counts, singular[:, 0] / singular[:, 1]


def check_csv(path, counts):
    with open(path) as stream:
        rows = list(csv.DictReader(stream))
    assert [int(row["corners"]) for row in rows] == counts.tolist()
    assert float(rows[3]["from"]) == 0.75 and float(rows[3]["to"]) == 1.0, rows[3]


def strip(length, across):
    """A flat strip of width one, and its cells."""
    along = length * across
    points = numpy.array([(i / across, j / across, 0.0) for i in range(along + 1) for j in range(across + 1)])
    corners = [(i * (across + 1) + j, (i + 1) * (across + 1) + j) for i in range(along) for j in range(across)]
    return points, numpy.array([cell for k, (a, b) in enumerate(corners)
                                for cell in (((a, b, b + 1), (a, b + 1, a + 1)) if (k + k // across) % 2 else ((a, b, a + 1), (b, b + 1, a + 1)))])


def check_strips(program):
    """Long surfaces crowd the ends of their boundary. A strip of 8:1 can be mapped, one of 20:1 is beyond a double's digits."""
    write_obj(program, "strip8.obj", *strip(8, 8))
    program.succeed("conformal", "strip8.obj", "-o", "strip8.h5", "-summary", "strip8.json")
    summary = json.loads(program.read("strip8.json"))
    points, cells = strip(8, 8)
    with h5py.File(program.file("strip8.h5"), "r") as result:
        image = result["/map/coordinates"][...]
    truth = evaluate(points, cells, image)
    assert truth["folds"] == 0 and summary["iterations"] <= 10, summary["iterations"]
    assert abs(corner_angles(image, cells) - corner_angles(points, cells)).mean() < 9.0
    assert dirichlet_energy(points, image, cells) < 1.01 * numpy.pi
    # halfway between the middle and an end, by the map of an infinite strip: tanh(pi x / 2), x = 2
    middle = points[:, 1] == 0.5
    radius = numpy.linalg.norm(image[middle & (abs(points[:, 0] - 4.0) == 2.0)], axis=1)
    assert numpy.allclose(radius, numpy.tanh(numpy.pi), atol=2e-3), radius
    write_obj(program, "strip20.obj", *strip(20, 4))
    result = program.run("conformal", "strip20.obj", "-o", "strip20.h5", "-quiet", "-summary", "strip20.json")
    summary = json.loads(program.read("strip20.json"))
    assert result.returncode == 4 and summary["folds"] == 0 and "long and narrow" in summary["message"], summary["message"]


def check_limbs(program):
    """Folds of the published method in thin limbs are told, with what to do about them, which does it."""
    program.succeed("generate", "starfish", "-n", 900, "-o", "star.obj", ranks=1)
    arguments = ("conformal", "star.obj", "-method", "qiem", "-o", "star.h5", "-quiet", "-summary", "star.json")
    program.succeed(*arguments, "-start", "normals", "-max_it", 1, "-unfold", "none", codes=(5,))
    summary = json.loads(program.read("star.json"))
    assert summary["folds"] > 0 and "-start resolved" in summary["message"], summary["message"]
    program.succeed(*arguments, "-start", "resolved", codes=(0, 4))
    assert json.loads(program.read("star.json"))["folds"] == 0


def main():
    with tempfile.TemporaryDirectory() as directory:
        program = Program(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1, directory)
        program.succeed("generate", "cap", "-n", "2500", "-o", "cap.h5")
        program.succeed("conformal", "cap.h5", "-o", "out.h5", "-summary", "out.json", "-histogram", "out.csv")
        summary = json.loads(program.read("out.json"))
        with h5py.File(program.file("out.h5"), "r") as result:
            vertices, cells, image = (result[name][...] for name in ("/mesh/vertices", "/mesh/cells", "/map/coordinates"))
            counts, quasiconformal = check_angles(result, vertices, image, cells)
            history = result["/history/energy"][...]
        check_csv(program.file("out.csv"), counts)
        boundary = sorted({i for edge in boundary_edges(cells) for i in edge})
        assert numpy.allclose(numpy.linalg.norm(image[boundary], axis=1), 1.0, atol=1e-14)
        truth = evaluate(vertices, cells, image)
        assert truth["folds"] == summary["folds"] == summary["exit_code"] == 0 and summary["command"] == "conformal"
        assert abs(summary["energy"]["final"] - dirichlet_energy(vertices, image, cells)) < 1e-9
        assert summary["energy"]["final"] == history[-1] < history[0]
        assert numpy.pi * 0.99 < summary["energy"]["final"] < numpy.pi * 1.02, "not conformal"
        for name, value in (("mean", quasiconformal.mean()), ("median", numpy.median(quasiconformal)), ("max", quasiconformal.max())):
            assert abs(summary["quasiconformal"][name] - value) < 1e-6 * value, name
        assert summary["work"]["factorizations"] == 1 and summary["work"]["coupled_factorizations"] == 0
        assert summary["work"]["solves"] == 2 * summary["work"]["evaluations"] + 2 <= 62, summary["work"]
        program.succeed("measure", "cap.h5", "out.h5", "-summary", "measured.json", "-histogram", "measured.csv")
        check_csv(program.file("measured.csv"), counts)
        measured = json.loads(program.read("measured.json"))
        for group in ("angle_error_deg", "quasiconformal"):
            for name, value in measured[group].items():
                assert abs(value - summary[group][name]) <= 1e-12 * value, (group, name)
        check_strips(program)
        check_limbs(program)
        print(f"conformal: mean angle error {summary['angle_error_deg']['mean']:.3f} degrees, {summary['work']['solves']} solves")


main()
