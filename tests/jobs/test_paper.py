"""A paper's page: rows on meshes by the table's names, those of another size and substitutes in a table of their own, figures.

usage: python3 test_paper.py EQUIMAP [all]      without `all` only rows on a mesh by the table's name
"""
import csv
import hashlib
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

JOBS = pathlib.Path(__file__).resolve().parents[2] / "jobs"
sys.path.insert(0, str(JOBS))
import paper  # noqa: E402
from sweep_table import read_table  # noqa: E402


def run(*arguments, expected=0):
    done = subprocess.run([sys.executable, JOBS / "paper.py", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=300, check=False)
    assert done.returncode == expected and "Traceback" not in done.stdout, (arguments, done.returncode, done.stdout)
    return done.stdout


def lines_of(name):
    with open(name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def generate(shape, vertices, name):
    pathlib.Path(name).parent.mkdir(parents=True, exist_ok=True)
    command = [os.environ["EQUIMAP"], "generate", shape, "-n", str(vertices), "-o", name]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def check_meshes():
    """Every mesh and substitute of the list belongs to a table; files are known by their content, under any name."""
    meshes = {row.mesh for number in paper.PAPERS for row in read_table(JOBS / "tables" / f"{number}.csv")}
    for line in paper.known_meshes():
        assert line["mesh"] in meshes and line["role"] in ("exact", "substitute"), line
        assert paper.generated(line["file"]) or (len(line["sha256"]) == 64 and int(line["bytes"]) > 0), line
    pathlib.Path("deep/er").mkdir(parents=True)
    pathlib.Path("deep/er/any.name").write_bytes(b"content")
    found = paper.by_checksum("deep", {7})
    assert list(found) == [hashlib.sha256(b"content").hexdigest()] and not paper.by_checksum("deep", {8})


def check_exact():
    """A mesh under the table's name; what is published, the deviation, and the figures are on the page, the rest is named."""
    generate("hills", 300, "data/000/foot.obj")
    said = run("000", "--data", "data", "--only", "foot-*", "--no-substitutes")
    assert "3 finished" in said, said
    lines = {line["name"]: line for line in lines_of("paper-000/paper.csv")}
    assert set(lines) == {"foot-fixed-point", "foot-ncg", "foot-default"} and float(lines["foot-ncg"]["paper.energy"]) > 0.
    page = pathlib.Path("paper-000/paper.html").read_text(encoding="utf-8")
    for line in lines.values():
        assert f"<td>{float(line['energy']):.3e}</td>" in page, line
    off = 100. * (float(lines["foot-ncg"]["energy"]) / float(lines["foot-ncg"]["paper.energy"]) - 1.)
    assert f"{off:+.1f} %" in page and "<h2>On the paper's meshes</h2>" in page and "<h2>On substitutes</h2>" not in page
    for caption in ("as Figure 2 of the paper", "as Figure 3 of the paper", "as Figure 4 of the paper", "as Figure 5 of the paper", "Energy over iterations"):
        assert page.count(caption) == 2, caption
    assert len(re.findall("data:image/png;base64,[A-Za-z0-9+/=]{4000,}", page)) >= 5 and "http" not in page
    assert pathlib.Path("paper-000/paper.pdf").read_bytes().startswith(b"%PDF")
    assert "(before)" in run("000", "--data", "data", "--only", "foot-*", "--no-substitutes")


def check_others():
    """A mesh with another number of vertices than the paper's, and one that stands in: both in the second table."""
    generate("head", 300, "data/001/bull.obj")
    run("001", "--data", "data", "--only", "bull-rgd", "--no-substitutes")
    assert not pathlib.Path("paper-001/paper.csv").exists()
    assert lines_of("paper-001/substitutes.csv")[0]["name"] == "bull-rgd"
    run("004", "--data", "data", "--only", "face-b-*")
    line = {line["name"]: line for line in lines_of("paper-004/substitutes.csv")}["face-b-default"]
    assert line["stands_for"] == "004/face-b" and line["mesh"] == "hills:5000" and float(line["angle_mean"]) > 0.
    page = pathlib.Path("paper-004/paper.html").read_text(encoding="utf-8")
    assert "as Figure 3 of the paper" in page and "(theirs " in page  # quasi-conformal distortion, iterations
    assert "On substitutes" in page and "no mesh: face-b-qiem, face-b-default" in page


def main():
    if not all(importlib.util.find_spec(name) for name in ("matplotlib", "h5py", "numpy")):
        print("Matplotlib, NumPy or h5py is not there: left out")
        return 77
    check_meshes()
    check_exact()
    if sys.argv[2:] == ["all"]:
        check_others()
    assert "none of the paper's meshes" in run("002", "--data", "data", "--no-substitutes", expected=2)
    assert "no row" in run("002", "--only", "nonsense", expected=2)
    print("paper: pages of rows on meshes of the paper" + (", of others, and on substitutes" if sys.argv[2:] else ""))
    return 0


if __name__ == "__main__":
    os.environ["EQUIMAP"] = os.path.abspath(sys.argv[1])
    for name in ("EQUIMAP_MESHES", "EQUIMAP_RESULTS", "EQUIMAP_MPIRUN", "EQUIMAP_DATA"):
        os.environ.pop(name, None)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        CODE = main()
        os.chdir("/")
    sys.exit(CODE)
