"""Other programs on the same mesh, where they are installed: their seconds, and the figures that `equimap measure` finds for their maps.

BFF: bff-command-line on the path, or named by EQUIMAP_BFF (Boundary First Flattening, R. Sawhney, K. Crane, ACM TOG 37, 2018).
CGAL: its headers where the compiler finds them (CPLUS_INCLUDE_PATH); cgal_maps.cpp is built with c++, or CXX.
"""
import json
import os
import shutil
import subprocess
import time

from runs import HERE, environment, run_once

LONGEST = 300  # seconds that a peer may take


def find_bff():
    return os.environ.get("EQUIMAP_BFF") or shutil.which("bff-command-line")


def build_cgal(folder):
    """cgal_maps in the folder, or a sentence that says why not."""
    program = os.path.join(folder, "cgal_maps")
    compiler = os.environ.get("CXX") or shutil.which("c++")
    if not os.path.exists(program):
        if not compiler:
            return None, "there is no C++ compiler for CGAL"
        found = subprocess.run([compiler, "-E", "-x", "c++", "-"], input="#include <CGAL/version.h>\n#include <Eigen/Core>\n",
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True, check=False)
        if found.returncode:
            return None, "CGAL or Eigen is not installed (CPLUS_INCLUDE_PATH may say where it is)"
        made = subprocess.run([compiler, "-O2", "-DNDEBUG", "-std=c++17", str(HERE / "cgal_maps.cpp"), "-o", program, "-lgmp"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if made.returncode:
            return None, "cgal_maps.cpp does not build:\n" + made.stdout[-1000:]
    return program, ""


def peers(folder):
    """(name, command words with MESH and OUT, suffix of MESH and OUT) of those that are here; the others are told."""
    found = []
    bff = find_bff()
    if bff:
        found.append(("BFF, conformal", [bff, "MESH", "OUT"], "obj"))
        found.append(("BFF, conformal to the disk", [bff, "MESH", "OUT", "--flattenToDisk"], "obj"))
    else:
        print("  BFF left out: there is no bff-command-line, and EQUIMAP_BFF names none")
    cgal, why = build_cgal(folder)
    if cgal:
        found += [(f"CGAL, {method}", [cgal, method, "MESH", "OUT"], "off") for method in ("authalic", "conformal", "arap")]
    else:
        print(f"  CGAL left out: {why}")
    return found


def convert(program, folder, shape, size, suffix):
    mesh = os.path.join(folder, f"{shape}-{size}.{suffix}")
    if not os.path.exists(mesh):
        subprocess.run([program, "generate", shape, "-n", str(size), "-o", mesh], env=environment(1), check=True, stdout=subprocess.DEVNULL)
    return mesh


def row(name, vertices, seconds, summary):
    return {"program": name, "vertices": vertices, "seconds": seconds, "energy": summary["energy"], "ratio_sd": summary["ratio_sd"],
            "angle_error_deg": summary["angle"], "folds": summary["folds"], "status": summary["status"]}


def run_peer(args, words, mesh, out):
    """(seconds, figures) of a peer; figures of nothing but a status where it fails."""
    figures = dict.fromkeys(("energy", "ratio_sd", "angle", "folds"), "")
    begin = time.monotonic()
    try:
        done = subprocess.run([{"MESH": mesh, "OUT": out}.get(word, word) for word in words], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return LONGEST, {**figures, "status": f"not done after {LONGEST} s"}
    seconds = time.monotonic() - begin
    if done.returncode or not os.path.exists(out):
        return seconds, {**figures, "status": "failed: " + " ".join(done.stdout.split())[-200:]}
    name = out + ".json"
    subprocess.run([args.program, "measure", mesh, out, "-summary", name], env=environment(1), check=True, stdout=subprocess.DEVNULL)
    with open(name, encoding="utf-8") as file:
        summary = json.load(file)
    return seconds, {"energy": summary["energy"]["final"], "ratio_sd": summary["ratio"]["sd"],
                     "angle": summary["angle_error_deg"]["mean"], "folds": summary["folds"], "status": "done"}


# equimap's own: the default, the same with angles kept in balance, the angle-preserving map.
OWN = (("equimap disk", "disk", []), ("equimap disk -balance .01", "disk", ["-balance", ".01"]), ("equimap conformal", "conformal", []))


def measure_peers(args, shape, size):
    """A row for every program: wall seconds of the whole process, reading and writing included."""
    rows = []
    for name, command, options in OWN:
        mesh = convert(args.program, args.folder, shape, size, "off")
        begin = time.monotonic()
        run = run_once(args.program, command, mesh, os.path.join(args.folder, "own"), 1, 1, options)
        rows.append(row(name, run["mesh"]["vertices"], time.monotonic() - begin,
                        {"energy": run["energy"]["final"] if command == "disk" else "", "ratio_sd": run["ratio"]["sd"],
                         "angle": run["angle_error_deg"]["mean"], "folds": run["folds"], "status": run["status"]}))
    for name, words, suffix in peers(args.folder):
        out = os.path.join(args.folder, f"peer-{len(rows)}.{suffix}")
        mesh = convert(args.program, args.folder, shape, size, suffix)
        rows.append(row(name, rows[0]["vertices"], *run_peer(args, words, mesh, out)))
    for line in rows:
        print(f"  {line['program']:<28} {line['seconds']:8.2f} s  energy {line['energy'] or '-':<10.4} angle error "
              f"{line['angle_error_deg'] or 0.:5.1f}  folds {line['folds']}  {line['status']}")
    return rows
