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
        assert summary["work"]["solves"] == 2 * summary["work"]["evaluations"] + 1 <= 61, summary["work"]
        program.succeed("measure", "cap.h5", "out.h5", "-summary", "measured.json", "-histogram", "measured.csv")
        check_csv(program.file("measured.csv"), counts)
        measured = json.loads(program.read("measured.json"))
        for group in ("angle_error_deg", "quasiconformal"):
            for name, value in measured[group].items():
                assert abs(value - summary[group][name]) <= 1e-12 * value, (group, name)
        print(f"conformal: mean angle error {summary['angle_error_deg']['mean']:.3f} degrees, {summary['work']['solves']} solves")


main()
