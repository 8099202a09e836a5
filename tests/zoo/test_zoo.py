"""The zoo: every mesh of catalogue.py ends as table.csv says, on any number of ranks.

usage: python3 test_zoo.py EQUIMAP [RANKS] [all]

Without `all` the rows that are in every run: on one rank those of part 1 and 3, on several those of part 3. A row: part (n: only
with `all`), mesh, command with options, exit code (two where rounding decides whether a triangle far below it is turned over), and how good the map is at most (root mean square of ratio - 1; degrees of mean
angle error for conformal maps), or a word of the message. Folds are counted here once more, from the result file.
"""
import csv
import json
import os
import sys
import tempfile

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "support"))
sys.path.insert(0, HERE)
import catalogue  # noqa: E402
import shapes  # noqa: E402
from program import Program  # noqa: E402

CONVERGED, NOT_CONVERGED, FOLDS = 0, 4, 5


def count_folds(path):
    """Cells of the image that are turned over, by determinants of our own; tetrahedra that the file itself has turned the
    other way (-repair) by those of the file."""
    with h5py.File(path) as file:
        places, cells, vertices = file["/map/coordinates"][:], file["/mesh/cells"][:], file["/mesh/vertices"][:]
    corners = places[cells]
    if cells.shape[1] == 3 and places.shape[1] == 2:
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        measure = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    elif cells.shape[1] == 3:
        measure = numpy.linalg.det(corners)
    else:
        size = numpy.abs(vertices - vertices[0]).max()
        solid = ((vertices - vertices[0]) / size)[cells]
        measure = numpy.linalg.det(corners[:, 1:] - corners[:, :1]) * numpy.sign(numpy.linalg.det(solid[:, 1:] - solid[:, :1]))
    if numpy.median(measure) < 0:  # a mesh whose cells all turn the other way
        measure = -measure
    return int((~(measure > 0)).sum())


def judge_map(program, row, summary):
    """What is wrong with a map that was written."""
    folds = summary["folds"] + (summary.get("boundary_folds") or 0)
    found = count_folds(program.file("map.h5"))
    quality = summary["angle_error_deg"]["mean"] if row["command"].startswith("conformal") else summary["ratio_weighted"]["sd"]
    if summary["exit_code"] == FOLDS:
        return [] if folds > 0 else ["exit code 5 without a fold"]
    wrong = []
    if folds or found:
        wrong.append(f"{folds} folds, {found} by our own count")
    if not quality <= float(row["at_most"]):
        wrong.append(f"quality {quality:.3g}, at most {row['at_most']}")
    if summary["poor"] and summary["exit_code"] == CONVERGED:
        wrong.append("poor, and converged")
    return wrong


def judge(program, row, result):
    """Everything that is not as the row says."""
    wrong = []
    codes = [int(code) for code in row["exit"].split()]
    written = os.path.exists(program.file("map.h5"))
    if result.returncode not in codes:
        wrong.append(f"exit code {result.returncode}, not {row['exit']}")
    if "PETSC ERROR" in result.stderr:
        wrong.append("a trace")
    if row["says"] and row["says"] not in result.stderr + result.stdout:
        wrong.append(f"no word of '{row['says']}'")
    if written != (codes[0] in (CONVERGED, NOT_CONVERGED, FOLDS)):
        wrong.append("a result" if written else "no result")
    if not wrong and written:
        wrong += judge_map(program, row, json.loads(program.read("map.json")))
    return wrong


def run(program, row):
    shapes.write(program.file(row["mesh"]), catalogue.ALL[row["mesh"]]())
    for name in ("map.h5", "map.json"):
        if os.path.exists(program.file(name)):
            os.remove(program.file(name))
    command, *options = row["command"].split()
    result = program.run(command, row["mesh"], *options, "-quiet", "-o", "map.h5", "-summary", "map.json")
    wrong = judge(program, row, result)
    if wrong:
        print(f"{row['command']} {row['mesh']}: {'; '.join(wrong)}\n{result.stdout[-400:]}{result.stderr[:800]}", flush=True)
    return not wrong


def main():
    ranks = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    parts = "n13" if sys.argv[3:] == ["all"] else "13" if ranks == 1 else "3"
    with open(os.path.join(HERE, "table.csv"), newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) >= 120 and {row["mesh"] for row in rows} == set(catalogue.ALL), "a mesh without a row"
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], ranks, folder)
        passed = [run(program, row) for row in rows if row["part"] in parts]
    print(f"{sum(passed)} of {len(passed)} meshes end as they should")
    return 0 if passed and all(passed) else 1


sys.exit(main())
