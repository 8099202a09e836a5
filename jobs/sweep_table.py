"""Sweep tables, presets and what is kept of a row: the part of sweep.py that knows no figures and starts no runs.

A table is a CSV (or .tsv) file with a header and a run per row; lines that begin with # are comments. Columns:

    name      a folder of that name holds what the run leaves; every row its own
    command   disk, square, sphere, ball, cube, conformal, register
    mesh      a file, seen from the folder of meshes; its suffix may be left out. SHAPE:N is generated (hills:20000)
    mesh_b    register: the other mesh, or the word target
    preset    an options file, seen from config/, without its suffix (000/table1-ncg-foot), or none
    options   more options of the program, or none; they win over the preset's
    paper     the preset whose published figures are set beside ours, if it is not the one that is run
    ranks, threads    1 if empty

Other columns are kept and appear in the result.
"""
import csv
import dataclasses
import json
import os
import pathlib
import re
import shlex
import zlib

COLUMNS = ("name", "command", "mesh", "mesh_b", "preset", "options", "paper", "ranks", "threads")
SUFFIXES = (".h5", ".obj", ".off", ".ply", ".msh", ".vtu", ".vtk", ".stl", ".gii")
MAP_WRITTEN = (0, 4, 5)  # converged, stopped before, folds remain
TARGET = "target"  # in the place of a second mesh: the unit disk or sphere itself
STOPPED = 75  # stopped on request with a checkpoint
OWN = (0, 2, 3, 4, 5, 6, 7, STOPPED)  # told by the program itself; 1 is a launcher's as well
NUMBER = r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?"
CONFIG = pathlib.Path(__file__).resolve().parent.parent / "config"

# "E 8.30e-4, SD 1.66e-2, 0 folds, 5.1 s" in the head of a preset; the names of the figures in the result
FIGURES = {
    "E": "energy", "SD": "sd", "SD/mean": "sd_by_mean", "mean error": "error_mean", "SD of the error": "error_sd",
    "25 %": "error_p25", "50 %": "error_p50", "75 %": "error_p75", "95 %": "error_p95", "eigenvalue": "eigenvalue",
    "err-E": "noise_error", "folds": "folds", "s": "seconds", "iterations": "iterations",
}


class TableError(Exception):
    """Something that the user can put right; said in one line."""


@dataclasses.dataclass
class Row:
    """A run of a table."""
    number: int  # from 1, as array tasks count
    name: str
    command: str
    mesh: str
    mesh_b: str
    preset: str
    options: list
    paper: str  # the preset with the published figures
    ranks: int
    threads: int
    others: dict

    @property
    def meshes(self):
        return [self.mesh, self.mesh_b] if self.mesh_b else [self.mesh]


def number_of(text, row, column):
    try:
        value = int(text or 1)
    except ValueError:
        value = 0
    if value < 1:
        raise TableError(f"row {row}: {column} is '{text}', wanted is a whole number from 1")
    return value


def read_table(path):
    """The rows of a table."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            lines = [line for line in file if line.strip() and not line.startswith("#")]
    except OSError as error:
        raise TableError(f"cannot read the table {path}: {error.strerror}") from error
    reader = csv.DictReader(lines, delimiter="\t" if str(path).endswith(".tsv") else ",")
    absent = {"command", "mesh"} - set(reader.fieldnames or ())
    if absent:
        raise TableError(f"{path} has no column {' and '.join(sorted(absent))}; wanted are {', '.join(COLUMNS)}")
    rows = [make_row(number, {key: (value or "").strip() for key, value in fields.items() if isinstance(key, str)})
            for number, fields in enumerate(reader, 1)]
    names = [row.name for row in rows]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TableError(f"{path}: two rows are called {twice[0]}; give every row a name of its own")
    if not rows:
        raise TableError(f"{path} has no rows")
    return rows


def make_row(number, fields):
    name = fields.get("name") or f"row{number:03d}"
    if not re.fullmatch(r"[\w.+-]+", name):
        raise TableError(f"row {number}: '{name}' is no name for a folder; take letters, digits and . + - _")
    for column in ("command", "mesh"):
        if not fields.get(column):
            raise TableError(f"row {number}: no {column}")
    if bool(fields.get("mesh_b")) != (fields["command"] == "register"):
        raise TableError(f"row {number}: register wants two meshes, in the columns mesh and mesh_b, every other command one")
    try:
        options = shlex.split(fields.get("options", ""))
    except ValueError as error:
        raise TableError(f"row {number}: the options '{fields['options']}' cannot be understood: {error}") from error
    return Row(number, name, fields["command"], fields["mesh"], fields.get("mesh_b", ""), fields.get("preset", ""), options,
               fields.get("paper") or fields.get("preset", ""), number_of(fields.get("ranks"), number, "ranks"),
               number_of(fields.get("threads"), number, "threads"), {key: value for key, value in fields.items() if key not in COLUMNS})


def find_preset(name):
    """The options file of a preset, or None for a row without."""
    if not name:
        return None
    for candidate in (CONFIG / f"{name}.yaml", CONFIG / name, pathlib.Path(name)):
        if candidate.is_file():
            return candidate
    raise TableError(f"there is no preset '{name}' in {CONFIG}")


def find_mesh(name, folder):
    """The file of a mesh, or None if it is not there."""
    for suffix in ("", *SUFFIXES):
        candidate = pathlib.Path(folder) / (name + suffix)
        if candidate.is_file():
            return candidate
    return None


def generated(mesh):
    """(shape, vertices) of a mesh like hills:20000, else None."""
    match = re.fullmatch(r"([a-z]+):(\d+)", mesh)
    return (match[1], int(match[2])) if match else None


def preset_options(preset):
    """The lines of an options file that are no comments."""
    lines = preset.read_text(encoding="utf-8").splitlines() if preset else []
    return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def published(preset):
    """The paper's figures in a preset's head: {iterations or None for the end: {figure: value}}."""
    if not preset:
        return {}
    head = " ".join(line[1:].strip() for line in preset.read_text(encoding="utf-8").splitlines() if line.startswith("#"))
    found = {}
    for after, text in re.findall(r"Published(?: after ([\d,]+) iterations)?: (.*?)\.(?= |$)", head):
        figures = {}
        for part in text.split(", "):
            match = (re.fullmatch(rf"(?P<name>.+) (?P<value>{NUMBER})", part)
                     or re.fullmatch(rf"(?P<value>{NUMBER}) (?P<name>.+)", part))
            if match and match["name"] in FIGURES:
                figures[FIGURES[match["name"]]] = float(match["value"].replace(",", ""))
        if figures:
            found[int(after.replace(",", "")) if after else None] = figures
    return found


def fingerprint(row, meshes):
    """What a row's outcome depends on; if it has changed, the outcome is of another run."""
    contents = [mesh if mesh == TARGET else zlib.crc32(mesh.read_bytes()) for mesh in meshes]
    return {"command": row.command, "mesh": contents if row.mesh_b else contents[0],
            "preset": preset_options(find_preset(row.preset)), "options": row.options, "ranks": row.ranks, "threads": row.threads}


class Store:
    """What a row leaves in its folder."""

    def __init__(self, results, row):
        self.row = row
        self.folder = pathlib.Path(results) / row.name
        self.outcome_file = self.folder / "outcome.json"
        self.summary_file = self.folder / "summary.json"
        self.history_file = self.folder / "history.csv"
        self.checkpoint = self.folder / "checkpoint.h5"
        self.log_file = self.folder / "log.txt"

    def outcome(self):
        return read_json(self.outcome_file)

    def summary(self):
        return read_json(self.summary_file)

    def has_checkpoint(self):
        """The checkpoint itself, the one before it, or those of register's parts (checkpoint.h5.1)."""
        return any(self.folder.glob("checkpoint.h5*"))

    def forget_checkpoint(self):
        """And the program's copies of the meshes, from which it goes on where they are gone."""
        for path in self.folder.glob("checkpoint*"):
            path.unlink()

    def state(self, meshes):
        """finished, interrupted, failed, begun (it runs, or was killed), or to do; what lies there may be of another run."""
        outcome = self.outcome()
        if outcome is None or outcome["fingerprint"] != fingerprint(self.row, meshes):
            return "to do"
        if outcome["exit_code"] is None:
            return "begun"
        if outcome["exit_code"] in MAP_WRITTEN and self.summary():
            return "finished"
        return "interrupted" if outcome["exit_code"] == STOPPED else "failed"

    def clear(self, *kept):
        for path in self.folder.iterdir():
            if path.name not in kept and path.is_file():
                path.unlink()

    def write_outcome(self, content):
        part = self.outcome_file.with_suffix(".part")
        part.write_text(json.dumps(content, indent=1) + "\n")
        os.replace(part, self.outcome_file)

    def complaint(self):
        """The program's last word, for the list of failures."""
        try:
            lines = self.log_file.read_text(errors="replace").splitlines()
        except OSError:
            return ""
        own = [line for line in lines if line.startswith("equimap: ")]
        return (own or lines or [""])[-1][:200]


def read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None
