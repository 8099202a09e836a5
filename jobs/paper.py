#!/usr/bin/env python3
"""Run the experiments of a paper, and set its tables and figures beside ours on one page.

    jobs/paper.py 000 --data /data/meshes            every row whose mesh is there, then substitutes for those that are not
    jobs/paper.py 000 --only '*bunny*'               rows by their names
    jobs/paper.py 000 --no-substitutes
    jobs/paper.py 000 --collect                      only the page, of what has been run

Papers are 000 to 004, as in docs/papers.md; the rows are those of jobs/tables/NUMBER*.csv. Meshes are looked for in --data
(EQUIMAP_DATA): by the names of the table (000/foot.obj), and by the sizes and checksums in jobs/papers/meshes.csv. A row whose
mesh has not the published number of vertices goes into the second table, with those run on substitutes.

The results go to --results (paper-NUMBER): paper.html, paper.pdf and tables like those of a sweep. Like a sweep it may be
stopped and started again. Matplotlib, NumPy and h5py are needed; a network is not.

Exit code: 0 all is done, 1 some rows failed, 2 wrong usage, 75 stopped on request: start again to go on.
"""
import argparse
import csv
import dataclasses
import fnmatch
import hashlib
import os
import pathlib
import re
import sys

import paper_page
import sweep
from sweep_launch import find_program
from sweep_report import lines_of, write_table
from sweep_table import STOPPED, TableError, find_mesh, find_preset, generated, read_table

HERE = pathlib.Path(__file__).resolve().parent
PAPERS = ("000", "001", "002", "003", "004")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paper", choices=PAPERS)
    parser.add_argument("--data", default=os.environ.get("EQUIMAP_DATA", "."), help="folder of meshes; default: EQUIMAP_DATA")
    parser.add_argument("--results", type=pathlib.Path, help="default: paper-NUMBER")
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--only", metavar="PATTERN", default="*", help="rows whose names match, like '*-ncg'")
    parser.add_argument("--no-substitutes", action="store_true", help="only rows whose mesh is there")
    parser.add_argument("--retry", action="store_true", help="run failed rows again")
    parser.add_argument("--collect", action="store_true", help="write the page; run nothing")
    args = parser.parse_args()
    args.results = args.results or pathlib.Path(f"paper-{args.paper}")
    return args


def known_meshes():
    """The lines of jobs/papers/meshes.csv."""
    with open(HERE / "papers" / "meshes.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def by_checksum(data, sizes):
    """{SHA-256: path} of the files in a folder that have one of these sizes."""
    found = {}
    for path in sorted(pathlib.Path(data).rglob("*")):
        if path.is_file() and path.stat().st_size in sizes:
            found[hashlib.sha256(path.read_bytes()).hexdigest()] = path
    return found


def choose_meshes(data, rows):
    """For each mesh of the table its file, and for each that has none those that stand in: ({mesh: path}, {mesh: [mesh]}), where
    one that stands in is a path or a SHAPE:N."""
    known = known_meshes()
    files = by_checksum(data, {int(line["bytes"]) for line in known if line["bytes"]})
    own, others = {}, {}
    for mesh in {row.mesh: None for row in rows}:
        lines = [line for line in known if line["mesh"] == mesh]
        exact = [files[line["sha256"]] for line in lines if line["role"] == "exact" and line["sha256"] in files]
        path = find_mesh(mesh, data) or (exact[0] if exact else None)
        if path:
            own[mesh] = path
            continue
        others[mesh] = [line["file"] if generated(line["file"]) else files[line["sha256"]] for line in lines
                        if line["role"] == "substitute" and (generated(line["file"]) or line["sha256"] in files)]
    return own, others


def link(folder, mesh, path):
    """Let a sweep find a file under the table's name of its mesh."""
    place = folder / (mesh + path.suffix)
    place.parent.mkdir(parents=True, exist_ok=True)
    if place.is_symlink() or place.exists():
        place.unlink()
    place.symlink_to(path.resolve())


def prepare(args, rows):
    """The rows to run, in two groups: on the paper's meshes, and on substitutes."""
    own, others = choose_meshes(args.data, rows)
    folder = args.results / "links"
    for mesh, path in own.items():
        link(folder, mesh, path)
    exact = [row for row in rows if row.mesh in own]
    instead = []
    for row in rows if not args.no_substitutes else ():
        for other in others.get(row.mesh, ())[:1]:
            name = other
            if isinstance(other, pathlib.Path):
                name = f"substitutes/{other.stem}"
                link(folder, name, other)
            instead.append(dataclasses.replace(row, mesh=name, others={**row.others, "stands_for": row.mesh}))
    return exact, instead, folder


def run(args, rows, results, meshes, stop):
    """Run the rows as a sweep does; their states."""
    settings = argparse.Namespace(results=results, meshes=meshes, program=args.program, retry=args.retry)
    states = []
    for row in rows:
        idle = args.collect or stop.asked
        states.append((row, sweep.state_of(settings, row) if idle else sweep.process(settings, row, stop)))
    if rows:
        sweep.tell(settings, states)
    return states


def published_size(row):
    """The number of vertices in the head of a row's preset, or None where the paper gives none."""
    preset = find_preset(row.paper)
    head = " ".join(preset.read_text(encoding="utf-8").split("\n# ")) if preset else ""
    match = re.search(r"Mesh: [^;]*?([\d,]+) vertices", head)
    return int(match[1].replace(",", "")) if match else None


def finished(states):
    return [row for row, state in states if state == "finished"]


def collect(args, groups):
    """The page: lines of rows on the paper's meshes, and of all the others."""
    papers, others = [], []
    for results, states in groups:
        rows = finished(states)
        for row in rows:
            lines = list(lines_of(results, row, rows))
            size = published_size(row)
            is_papers = results.name == "rows" and size in (None, lines[0][0]["vertices"])
            (papers if is_papers else others).append((results, row, lines))
    if not papers and not others:
        raise TableError("no row has finished: no page")
    for name, part in (("paper", papers), ("substitutes", others)):
        if part:
            write_table([line for _, _, lines in part for line in lines], args.results / f"{name}.csv")
    missing = [(row, state) for _, states in groups for row, state in states if state != "finished"]
    for path in paper_page.write(args.paper, args.results, papers, others, missing, args.program):
        print(f"paper: {path}")


def main():
    args = arguments()
    tables = sorted((HERE / "tables").glob(f"{args.paper}*.csv"))  # 001 has a second one, 001-noise
    rows = [row for table in tables for row in read_table(table) if fnmatch.fnmatch(row.name, args.only)]
    if not rows:
        raise TableError(f"no row of jobs/tables/{args.paper}*.csv is called {args.only}")
    if not args.program and not args.collect:
        raise TableError("there is no program; build it, or say where it is with --program or EQUIMAP")
    exact, instead, folder = prepare(args, rows)
    if not exact and not instead:
        raise TableError(f"none of the paper's meshes is in {args.data}, and nothing stands in for those of these rows")
    stop = sweep.Stop()
    groups = [(args.results / name, run(args, part, args.results / name, folder, stop))
              for name, part in (("rows", exact), ("substitutes", instead))]
    groups[0][1].extend((row, "no mesh") for row in rows if row not in exact)
    collect(args, groups)
    states = {state for _, part in groups for _, state in part}
    if stop.asked or states & {"interrupted", "begun"}:
        return STOPPED
    return 1 if "failed" in states else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TableError as problem:
        print(f"paper: {problem}", file=sys.stderr)
        sys.exit(2)
