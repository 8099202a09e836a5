"""The counts of work are no worse than the saved ones; a worse baseline would be seen; measure.py measures.

usage: python3 test_perf.py EQUIMAP
"""
import csv
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PERF = pathlib.Path(__file__).resolve().parent


def run(script, *arguments, expected=0):
    done = subprocess.run([sys.executable, PERF / script, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=600, check=False)
    assert done.returncode == expected and "Traceback" not in done.stdout, (script, arguments, done.returncode, done.stdout)
    return done.stdout


def check_gate():
    """Held against the saved counts, and against ones that were lower by a fifth: those must make it fail."""
    print(run("work.py"))
    saved = json.loads((PERF / "baselines" / "work.json").read_text(encoding="utf-8"))
    case = saved["disk ncg"]
    lowered = {"disk ncg": {**case, "solves": .8 * case["solves"]}, "disk fixed-point": saved["disk fixed-point"]}
    pathlib.Path("lowered.json").write_text(json.dumps(lowered), encoding="utf-8")
    said = run("work.py", "--baseline", "lowered.json", "--only", "disk ncg", expected=1)
    assert "disk ncg: WORSE: solves" in said and "--update" in said, said
    assert "no baseline" in run("work.py", "--baseline", "lowered.json", "--only", "conformal sphere", expected=2)
    run("work.py", "--baseline", "lowered.json", "--only", "disk ncg", "--update")
    updated = json.loads(pathlib.Path("lowered.json").read_text(encoding="utf-8"))
    assert updated["disk ncg"]["solves"] >= lowered["disk ncg"]["solves"] and set(updated) == set(lowered)


def check_measure():
    """Tables with a row per case, an exponent, an efficiency; the picture."""
    sizes_of = {"growth": ["1000", "2000"], "solids": ["500", "1000"], "strong": ["2000", "2000"], "weak": ["1000", "2000"]}
    run("measure.py", "--scale", "tiny", "--ranks", "1,2", "--threads", "1", "--only", ",".join(sizes_of), "--", "-max_it", "2")
    for part, sizes in sizes_of.items():
        with open(f"perf-results/{part}.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert [row["size"] for row in rows] == sizes and all(float(row["seconds.total"]) > 0. for row in rows), (part, rows)
        assert all(row["options"] == "-max_it 2" and int(row["iterations"]) <= 2 for row in rows), rows
    text = pathlib.Path("perf-results/measure.txt").read_text(encoding="utf-8")
    assert "to the power" in text and "strong: 1 x 1: 1.00, 2 x 1: " in text, text
    if importlib.util.find_spec("matplotlib"):
        assert pathlib.Path("perf-results/measure.png").read_bytes().startswith(b"\x89PNG")


if __name__ == "__main__":
    os.environ["EQUIMAP"] = os.path.abspath(sys.argv[1])
    os.environ.pop("EQUIMAP_MPIRUN", None)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_gate()
        check_measure()
        os.chdir("/")
