"""What measure.py's tables say: exponents, efficiencies, a summary in words."""
import csv
import math
import os

from compare import worst
from runs import machine


def read_tables(folder, parts):
    tables = {}
    for part in parts:
        name = os.path.join(folder, f"{part}.csv")
        if os.path.exists(name):
            with open(name, newline="", encoding="utf-8") as file:
                tables[part] = list(csv.DictReader(file))
    return tables


def exponent(rows, column="cpu_seconds"):
    """The slope of log of a column over log vertices, by least squares."""
    points = [(math.log(float(row["mesh.vertices"])), math.log(float(row[column]))) for row in rows if float(row[column]) > 0.]
    if len(points) < 2:
        return float("nan")
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread if spread > 0. else float("nan")


def efficiencies(rows, weak):
    """(cores, efficiency, label) against the first row: t1 c1 / (t c), weak t1 / t."""
    cores = [int(row["ranks"]) * int(row["threads"]) for row in rows]
    seconds = [float(row["seconds.total"]) for row in rows]
    return [(c, seconds[0] / s if weak else seconds[0] * cores[0] / (s * c), f"{row['ranks']} x {row['threads']}")
            for c, s, row in zip(cores, seconds, rows)]


def growth_lines(part, rows):
    last = rows[-1]
    grown = [] if len(rows) < 2 else [
        f"{part}: the processor's seconds grow as vertices to the power {exponent(rows):.2f} ({rows[0]['mesh.vertices']} to "
        f"{last['mesh.vertices']} vertices, {float(last['cpu_seconds']):.1f} s at the largest), bytes to the power "
        f"{exponent(rows, 'memory_bytes.total'):.2f}"]
    return [*grown,
            f"{part}: at {last['mesh.vertices']} vertices " + ", ".join(
                f"{key.split('.')[1]} {100. * float(last[key]) / float(last['seconds.total']):.0f} %" for key in last
                if key.startswith("seconds.") and key.split(".")[1] not in ("total", "fastest", "slowest") and float(last[key]) > 0.)]


def summary(tables):
    """measure.txt: what a person wants to know first."""
    loads = [float(row["load"]) for rows in tables.values() for row in rows if row.get("load")]
    lines = [machine() + (f"; load of the machine {min(loads):.1f} to {max(loads):.1f}" if loads else "")]
    for row in tables.get("kernels", ()):
        lines.append(f"kernel {row['kernel']}, {row['threads']} threads: {float(row['ns_per_cell']):.1f} ns per cell, "
                     f"{100. * float(row['share_of_triad']):.0f} % of the triad's bandwidth, "
                     f"{1e-9 * float(row['triad_bytes_per_second']):.1f} GB/s")
    for part in ("growth", "solids"):
        lines += growth_lines(part, tables[part]) if part in tables else []
    for part in ("strong", "weak"):
        if part in tables:
            points = efficiencies(tables[part], part == "weak")
            lines.append(f"{part}: efficiency " + ", ".join(f"{label}: {value:.2f}" for _, value, label in points))
    for row in tables.get("peers", ()):
        lines.append(f"peer {row['program']}: {float(row['seconds']):.2f} s, " + (
            f"{'energy {:.2e}'.format(float(row['energy'])) if row['energy'] else 'energy not its goal'}, ratios' sd {float(row['ratio_sd']):.3g}, angle error "
            f"{float(row['angle_error_deg']):.1f} degrees, {row['folds']} folds" if row["ratio_sd"] else row["status"]))
    return "\n".join(lines + worst(tables.get("model", ()))) + "\n"
