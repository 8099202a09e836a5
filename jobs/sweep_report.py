"""What a sweep ends in: one table with the papers' figures beside ours, the same for people, and plots. Used by sweep.py.

Columns of sweep.csv, a line per finished row, and one more ("on the way") for every number of iterations at which the
row's paper gives figures; a field is empty where there is no figure:

    row, name, command, mesh, mesh_b, preset, options, ranks, threads    as in the table; so are columns of its own
    method, status      the method that ran; how it ended: converged, not converged, folds remain, on the way
    vertices, cells     of the mesh
    memory_bytes        the most that all ranks together had
    attempts            how often the row was started
    wall_seconds        of all attempts, with the program's start and its reading and writing
    energy              E at the end (conformal: the Dirichlet energy; register: of the map of A to the target)
    sd, sd_by_mean      standard deviation of the ratios, unweighted; the same over their mean
    folds, iterations   at the end
    seconds             the program's own total of the last attempt
    error_mean, error_sd, error_p25 ... error_p95    of |r - 1| over the cells: mean, standard deviation, percentiles
    eigenvalue          the smallest of the energy's Hessian, with -hessian_eigenvalues
    noise_error         err-E of 001 (6.6) against the row that the column `against` names
    angle_mean, angle_median    conformal: angle error in degrees
    dissimilarity       register: d(phi) of 003
    landmark_error      register: the largest distance between landmarks in the target, in radii
    paper.X             the published X
"""
import csv
import sys

import sweep_plots
import sweep_text
from sweep_table import Store, find_preset, published

ALWAYS = ("energy", "sd", "folds", "iterations", "seconds")
SOMETIMES = ("angle_mean", "angle_median", "eigenvalue", "noise_error", "dissimilarity", "landmark_error")


def figures_at_end(summary):
    """Our figures of a finished run, by the names that the published ones have."""
    error, ratio = summary["ratio_error"], summary["ratio"]
    figures = {
        "energy": summary["energy"]["final"], "sd": ratio["sd"], "sd_by_mean": ratio["sd"] / ratio["mean"],
        "folds": summary["folds"], "iterations": summary["iterations"], "seconds": summary["seconds"]["total"],
        "error_mean": error["mean"], "error_sd": error["sd"],
        **{f"error_{p}": error[p] for p in ("p25", "p50", "p75", "p95")},
    }
    if summary.get("hessian_eigenvalues"):
        figures["eigenvalue"] = summary["hessian_eigenvalues"][0]
    if summary["command"] == "conformal":
        figures.update(angle_mean=summary["angle_error_deg"]["mean"], angle_median=summary["angle_error_deg"]["median"])
    return {**figures, **figures_of_registration(summary.get("register", {}))}


def figures_of_registration(register):
    figures = {"dissimilarity": register["dissimilarity"]} if "dissimilarity" in register else {}
    error = register.get("landmarks", {}).get("error", {}).get("max")
    return figures if error is None else {**figures, "landmark_error": error}


def figures_after(history, iterations):
    """Our figures after so many iterations, as far as the history has them."""
    for line in history:
        if int(line["iteration"]) == iterations:
            return {"energy": float(line["energy"]), "sd": float(line["sd"]), "folds": int(line["folds"]),
                    "iterations": iterations, "seconds": float(line["seconds"])}
    return {}


def read_history(store):
    try:
        with open(store.history_file, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))
    except OSError:
        return []


def noise_error(results, row, rows):
    """err-E_A of 001 (6.6) for a row with noise: how much its energy differs from that of the row named in its column
    `against`, per mean square of the vertices' displacement."""
    clean = next((one for one in rows if one.name == row.others.get("against")), None)
    if clean is None:
        return {}
    try:
        import h5py  # nothing else needs it
    except ImportError:
        print(f"sweep: {row.name}: no noise_error: {sys.executable} has no h5py (Debian: python3-h5py, for /usr/bin/python3)")
        return {}
    stores = Store(results, row), Store(results, clean)
    energies = [store.summary()["energy"]["final"] for store in stores]
    places = []
    for store in stores:
        with h5py.File(store.folder / "result.h5") as file:
            places.append(file["mesh/vertices"][:])
    moved = ((places[0] - places[1]) ** 2).sum()
    return {"noise_error": len(places[0]) * abs(energies[0] - energies[1]) / moved} if moved > 0. else {}


def lines_of(results, row, rows):
    """The lines that a row gives: one for its end, one for every number of iterations that the paper stops at."""
    store = Store(results, row)
    summary, outcome, history = store.summary(), store.outcome(), read_history(store)
    paper = published(find_preset(row.paper))
    fixed = {
        "row": row.number, "name": row.name, "command": row.command, "mesh": row.mesh, "mesh_b": row.mesh_b, "preset": row.preset,
        "options": " ".join(row.options), "ranks": row.ranks, "threads": row.threads, **row.others,
        "method": summary["method"], "status": summary["status"], "vertices": summary["mesh"]["vertices"],
        "cells": summary["mesh"]["cells"], "memory_bytes": summary["memory_bytes"]["total"],
        "attempts": outcome["attempts"], "wall_seconds": round(outcome["wall_seconds"], 3),
    }
    ours = {**figures_at_end(summary), **noise_error(results, row, rows)}
    yield fixed, ours, paper.get(None, {})
    for after in sorted(key for key in paper if key is not None and row.paper == row.preset):
        yield {**fixed, "status": "on the way"}, figures_after(history, after), {**paper[after], "iterations": after}


def write_table(lines, name):
    """A column `energy`, a column `paper.energy`, and so on for every figure that any paper's row has."""
    in_papers = [figure for _, _, paper in lines for figure in paper]
    ours = [figure for _, figures, _ in lines for figure in figures if figure in SOMETIMES]
    figures = list(dict.fromkeys([*ALWAYS, *ours, *in_papers]))
    columns = list(dict.fromkeys(key for fixed, _, _ in lines for key in fixed))
    for figure in figures:
        columns += [figure, f"paper.{figure}"] if figure in in_papers else [figure]
    with open(name, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, fieldnames=columns, restval="", extrasaction="ignore")
        table.writeheader()
        for fixed, ours, paper in lines:
            table.writerow({**fixed, **ours, **{f"paper.{figure}": value for figure, value in paper.items()}})


def write(results, rows, unfinished=()):
    """Write results/sweep.csv, sweep.txt, energy.png and time.png of the finished rows; `unfinished` are lines about the others."""
    if not rows:
        print("sweep: no row has finished: no table")
        return
    lines = [line for row in rows for line in lines_of(results, row, rows)]
    write_table(lines, results / "sweep.csv")
    (results / "sweep.txt").write_text(sweep_text.page(lines, unfinished), encoding="utf-8")
    print(f"sweep: {results / 'sweep.csv'}, and for reading {results / 'sweep.txt'}")
    runs = [sweep_plots.Run(row, Store(results, row).summary(), read_history(Store(results, row)),
                            published(find_preset(row.paper))) for row in rows]
    for picture in sweep_plots.draw(runs, results):
        print(f"sweep: {picture}")
