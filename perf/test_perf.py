"""The counts of work are no worse than the saved ones; a worse baseline would be seen; measure.py measures; the model holds.

usage: python3 test_perf.py EQUIMAP [all]     all: every part of measure.py in its short form, its tables as docs/performance.md says
"""
import csv
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PERF = pathlib.Path(__file__).resolve().parent
sys.path.append(str(PERF))
import dissection  # noqa: E402
import model  # noqa: E402


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


def table(part):
    with open(f"perf-results/{part}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def check_measure():
    """Tables with a row per case, an exponent, an efficiency; the picture."""
    sizes_of = {"growth": ["1000", "2000"], "solids": ["500", "1000"], "strong": ["2000", "2000"], "weak": ["1000", "2000"]}
    run("measure.py", "--scale", "tiny", "--ranks", "1,2", "--threads", "1", "--only", ",".join(sizes_of), "--", "-max_it", "2")
    for part, sizes in sizes_of.items():
        rows = table(part)
        assert [row["size"] for row in rows] == sizes and all(float(row["seconds.total"]) > 0. for row in rows), (part, rows)
        assert all(row["options"] == "-max_it 2" and int(row["iterations"]) <= 2 for row in rows), rows
        assert all((row["cpu_seconds"] == "") == (row["ranks"] == "2") and row["runs"] == "1" for row in rows), rows
    text = pathlib.Path("perf-results/measure.txt").read_text(encoding="utf-8")
    assert "to the power" in text and "strong: efficiency 1 x 1: 1.00, 2 x 1: " in text, text
    if importlib.util.find_spec("matplotlib"):
        assert pathlib.Path("perf-results/measure.png").read_bytes().startswith(b"\x89PNG")


def check_dissection():
    """George's constants; the tree of ranks cuts what its formulas say: a square in four has two cuts, a cube in eight three."""
    n = 1e8
    square, larger = (dissection.dissect(count, 2, 1) for count in (n, 4. * n))
    assert abs((larger.nonzeros - 4. * square.nonzeros) / (8. * n) / (31. / 8.) - 1.) < .01
    assert abs(larger.operations / (4. * n) ** 1.5 / (829. / 42.) - 1.) < .01
    assert abs(model.ghosts(n, 4, 2) / (4. * n ** .5) - 1.) < 1e-9
    assert abs(model.ghosts(n, 8, 3) / (6. * n ** (2. / 3.)) - 1.) < 1e-9
    assert model.ghosts(n, 1, 2) == 0. and model.factor(n, 1, 2, 2)["bytes_sent"] == 0.
    at = [ranks for *_, ranks in model.breaking_points(1e6, 3)]
    assert at == sorted(at) and at[0] < 1000, at


def check_model():
    """What a run on one and two ranks holds and sends is within the factors that docs/performance.md names."""
    run("measure.py", "--scale", "tiny", "--model-ranks", "1,2", "--only", "model")
    rows = table("model")
    ratios = {(row["command"], row["ranks"], row["quantity"]): float(row["ratio"]) for row in rows if row["ratio"]}
    for command in ("disk", "ball"):
        for ranks, quantity in (("1", "nonzeros"), ("1", "operations"), ("2", "largest_front"), ("2", "halo_bytes")):
            assert .6 < ratios[command, ranks, quantity] < 1.5, (command, ranks, quantity, ratios)
    assert .6 < ratios["disk", "2", "factor_bytes"] < 2., ratios
    reductions = {row["ranks"]: float(row["measured"]) for row in rows
                  if row["command"] == "disk" and row["quantity"] == "reductions_per_iteration"}
    assert reductions["1"] == 0. < reductions["2"], reductions


def check_time_to_energy():
    """A row per setting says whether the reference's energy was reached; the cascade alone goes only so far."""
    run("time_to_energy.py", "1500", "--repeat", "1")
    rows = table("time_to_energy")
    assert len({row["settings"] for row in rows}) == len(rows) == 4, rows
    assert all(row["reached"] == "True" for row in rows if row["settings"] != "-method cascade"), rows
    assert all((float(row["energy"]) <= float(rows[0]["energy"])) == (row["reached"] == "True") and float(row["cpu_seconds"]) > 0.
               for row in rows), rows
    assert rows[0]["coupled_factorizations"] == rows[3]["factorizations"] == "0" < rows[3]["set_ups"], rows


def check_documented():
    """The short form of everything: each table has the columns that docs/performance.md lists."""
    said = run("measure.py")
    page = (PERF.parent / "docs" / "performance.md").read_text(encoding="utf-8")
    listed = {part: re.findall("`([^`]+)`", columns) for part, columns in re.findall(r"^\| `(\w+)\.csv` \| (.*) \|$", page, re.M)}
    assert set(listed) == {"kernels", "growth", "solids", "strong", "weak", "peers", "model"}, listed
    for part, columns in listed.items():
        rows = table(part)
        assert rows and columns and not set(columns) - set(rows[0]), (part, columns, list(rows[0]))
    triads = {row["threads"]: float(row["triad_bytes_per_second"]) for row in table("kernels")}
    assert set(triads) == {"1", "2"} and min(triads.values()) > 1e8, triads
    assert {row["program"] for row in table("peers")} >= {"equimap disk", "equimap conformal"}
    for peer in ("BFF", "CGAL"):
        assert f"{peer} left out: " in said or f"peer {peer}" in said, said


if __name__ == "__main__":
    os.environ["EQUIMAP"] = os.path.abspath(sys.argv[1])
    os.environ.pop("EQUIMAP_MPIRUN", None)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for check in (check_documented,) if sys.argv[2:] == ["all"] else (
                check_gate, check_measure, check_time_to_energy, check_dissection, check_model):
            check()
        os.chdir("/")
