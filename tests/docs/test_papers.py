"""docs/papers.md has every algorithm, table and figure of the five papers, and presets and rows that exist.

usage: python3 test_papers.py EQUIMAP
"""
import fnmatch
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "jobs"))
from sweep_table import read_table  # noqa: E402

# How many there are in each paper.
CONTENTS = {
    "000": {"Algorithm": 1, "Table": 1, "Figure": 7},
    "001": {"Algorithm": 2, "Table": 8, "Figure": 11},
    "002": {"Algorithm": 1, "Table": 1, "Figure": 6},
    "003": {"Algorithm": 1, "Table": 3, "Figure": 10},
    "004": {"Table": 5, "Figure": 9},
}


def numbers(text, kind):
    """Those of "Table 3", "Figures 1 to 3, 8", "Figures 5 and 6 (a), energy"."""
    found = set()
    for part in re.findall(rf"{kind}s? (\d+(?:(?:, | and | to )\d+| \([a-z]\))*)", text):
        part = re.sub(r" \([a-z]\)", "", part)
        for piece in re.split(r", | and ", part):
            ends = [int(number) for number in piece.split(" to ")]
            found.update(range(ends[0], ends[-1] + 1))
    return found


def main():
    sections = re.split(r"\n## (\d{3}): ", (ROOT / "docs" / "papers.md").read_text(encoding="utf-8"))
    assert sections[1::2] == list(CONTENTS), sections[1::2]
    for paper, text in zip(sections[1::2], sections[2::2]):
        rows = [line.split("|")[1:-1] for line in text.splitlines() if line.startswith("| ")]
        assert all(len(row) == 4 for row in rows), [row for row in rows if len(row) != 4]
        items = "\n".join(row[0] for row in rows)
        for kind, count in CONTENTS[paper].items():
            missing = set(range(1, count + 1)) - numbers(items, kind)
            assert not missing, f"{paper}: no row for {kind} {sorted(missing)}"
        for name in re.findall(r"config/[\w./*-]+\.yaml", text):
            assert list(ROOT.glob(name)), f"{paper}: there is no {name}"
        names = [row.name for table in (ROOT / "jobs" / "tables").glob(f"{paper}*.csv") for row in read_table(table)]
        for pattern in re.findall(r"--only '([^']+)'", text):
            assert fnmatch.filter(names, pattern), f"{paper}: no row is called {pattern}"
    print("papers: every algorithm, table and figure has a row")


if __name__ == "__main__":
    main()
