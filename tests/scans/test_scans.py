"""What people have on their disks: every file of table.csv ends as its row says, each within a minute of work on one
rank.

usage: python3 test_scans.py EQUIMAP [RANKS] [all]

Files are made here (made.py), or public: those of the archives that Debian's package libcgal-demo brings, unpacked in the folder
that EQUIMAP_SCANS names. Public files that are not there are left out, and all of them without `all`. A row: where the file comes
from, its name, the command that its user would call (with -prepare auto), exit code (two where rounding decides), how good the map
of the file's own cells is at most (root mean square of ratio - 1, by area), and a word of the message where there is none.
Folds are counted here once more.
"""
import csv
import json
import os
import resource
import shutil
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "support"))
sys.path.insert(0, HERE)
import h5py  # noqa: E402
import made  # noqa: E402
import numpy  # noqa: E402
from program import Program  # noqa: E402

SECONDS = 60
NO_MAP = ("2", "3")


def count_folds(path):
    """Cells of the prepared mesh, or of the file's, whose image is turned over, by determinants of our own."""
    with h5py.File(path) as file:
        group = "repaired" if "repaired/coordinates" in file else None
        places = file["repaired/coordinates" if group else "map/coordinates"][:]
        cells = file["repaired/cells" if group else "mesh/cells"][:]
    corners = places[cells]
    if cells.shape[1] == 4 or places.shape[1] == 2:
        corners = corners[:, 1:] - corners[:, :1]
    measure = numpy.linalg.det(corners)
    if numpy.median(measure) < 0:  # a mesh whose cells all turn the other way
        measure = -measure
    return int((~(measure > 0)).sum())


def spent():
    """Seconds that runs have worked so far; waiting for a busy machine does not count."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def judge(program, row, result, seconds):
    """Everything that is not as the row says."""
    wrong = [] if str(result.returncode) in row["exit"].split() else [f"exit code {result.returncode}, not {row['exit']}"]
    written = os.path.exists(program.file("map.h5"))
    if written == (row["exit"] in NO_MAP):
        wrong.append("a result" if written else "no result")
    if row["says"] not in result.stderr:
        wrong.append(f"no word of '{row['says']}'")
    if seconds > SECONDS and program.ranks == 1:  # several ranks wait busily
        wrong.append(f"{seconds:.0f} seconds")
    if written and not wrong:
        summary = json.loads(program.read("map.json"))
        folds, quality = count_folds(program.file("map.h5")), summary["ratio_weighted"]["sd"]
        if folds or summary["folds"]:
            wrong.append(f"{summary['folds']} folds, {folds} by our own count")
        if not quality <= float(row["at_most"]):
            wrong.append(f"sd {quality:.3g}, at most {row['at_most']}")
    return wrong


def bring(program, row):
    """The file in the working folder; False where it is not there."""
    if row["from"] == "made":
        program.write(row["file"], made.FILES[row["file"]]())
        return True
    path = os.path.join(os.environ.get("EQUIMAP_SCANS", ""), row["file"])
    if not os.environ.get("EQUIMAP_SCANS") or not os.path.exists(path):
        return False
    shutil.copy(path, program.file(os.path.basename(row["file"])))
    return True


def run(program, row):
    """True: as the row says; None: the file is not there."""
    if not bring(program, row):
        return None
    for name in ("map.h5", "map.json"):
        if os.path.exists(program.file(name)):
            os.remove(program.file(name))
    command, *options = row["command"].split()
    begin = spent()
    result = program.run(command, os.path.basename(row["file"]), "-prepare", "auto", *options, "-quiet", "-o", "map.h5", "-summary",
                         "map.json", timeout=5 * SECONDS)
    wrong = judge(program, row, result, spent() - begin)
    if wrong:
        print(f"{row['command']} {row['file']}: {'; '.join(wrong)}\n{result.stdout[-400:]}{result.stderr[:800]}", flush=True)
    return not wrong


def main():
    ranks = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with open(os.path.join(HERE, "table.csv"), newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) >= 60 and {row["file"] for row in rows if row["from"] == "made"} == set(made.FILES), "a file without a row"
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], ranks, folder)
        passed = [run(program, row) for row in rows if row["from"] == "made" or sys.argv[3:] == ["all"]]
    print(f"{passed.count(True)} of {len(rows)} files end as they should, {passed.count(None)} are not there")
    return 0 if False not in passed else 1


sys.exit(main())
