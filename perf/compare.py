"""The model held against runs: what PETSc's log and the program's summary say of a run on several ranks."""
import csv
import os
import re

import model
from runs import make_mesh, run_once

SOLVER = re.compile(r"factor of ([0-9.e+-]+) nonzeros, ([0-9.e+-]+) operations, at most ([0-9.e+-]+) GiB per rank")
# command: dimension; coordinates of a ghost, unknowns of a vertex in the matrix that couples them
TARGETS = {"disk": 2, "ball": 3}
ITERATIONS = (2, 4)  # of the two runs whose difference tells what an iteration takes


def read_log(name, stage):
    """Of -log_view :FILE:ascii_csv: event -> rank -> its figures, in one stage. PETSc counts what is sent and what is received."""
    events = {}
    with open(name, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["Stage Name"] == stage and row["Rank"].isdigit():
                events.setdefault(row["Event Name"], {})[int(row["Rank"])] = {
                    key: float(row[key]) for key in ("Count", "Num Messages", "Message Length", "Num Reductions")}
    return events


def total(events, event, column):
    return sum(row[column] for row in events.get(event, {}).values())


def solver_figures(summary):
    """Nonzeros, operations, largest front, bytes per rank, from the words that describe the solver; {} of an iterative one."""
    words = summary["linear_solver"]
    found = SOLVER.search(words)
    if not found:
        return {}
    front = re.search(r"largest front (\d+)", words)
    nonzeros, operations, gib = (float(word) for word in found.groups())
    return {"nonzeros": nonzeros, "operations": operations, "bytes_of_leader": gib * 2 ** 30,
            **({"largest_front": float(front.group(1))} if front else {})}


def difference(folder_log, stage="Minimise"):
    """What the further iterations of the longer of two runs took: event -> rank -> figures."""
    first, second = (read_log(name, stage) for name in folder_log)
    return {event: {rank: {key: value - first.get(event, {}).get(rank, {}).get(key, 0.) for key, value in row.items()}
                    for rank, row in ranks.items()} for event, ranks in second.items()}


def halo_figures(events, ranks):
    """Bytes that a rank receives in an update of its ghosts, and from how many."""
    rows = events.get("SFBcastBegin", {})
    updates = max((row["Count"] for row in rows.values()), default=0.)
    if ranks == 1 or updates == 0.:
        return {}
    received = [row["Message Length"] / 2. / updates for row in rows.values()]
    return {"halo_bytes": sum(received) / ranks, "halo_bytes_largest": max(received),
            "neighbours": total(events, "SFBcastBegin", "Num Messages") / 2. / updates / ranks}


def counts_per_iteration(events, summaries):
    """What the model takes as given."""
    iterations = max(summaries[1]["iterations"] - summaries[0]["iterations"], 1)
    updates = max((row["Count"] for row in events.get("SFBcastBegin", {}).values()), default=0.)
    reductions = max((row["Num Reductions"] for row in events.get("summary", {}).values()), default=0.)
    return {f"{name}_per_iteration": value / iterations for name, value in
            (("updates", updates), ("reductions", reductions),
             *((name, summaries[1]["work"][name] - summaries[0]["work"][name])
               for name in ("solves", "factorizations", "coupled_factorizations")))}


def rows_of_run(args, command, shape, size, ranks):
    """A row per quantity: what was measured, what the model says, and their ratio. Two runs, of which one goes further."""
    dimension = TARGETS[command]
    mesh = make_mesh(args.program, args.folder, shape, size)
    stems = [os.path.join(args.folder, f"model-{command}-{size}-r{ranks}-i{iterations}") for iterations in ITERATIONS]
    summaries = [run_once(args.program, command, mesh, stem, ranks, 1,
                          ["-log_view", f":{stem}.log.csv:ascii_csv", "-max_it", str(iterations), "-energy_rtol", "0",
                           *args.options])
                 for stem, iterations in zip(stems, ITERATIONS)]
    events = difference([stem + ".log.csv" for stem in stems])
    figures = {**solver_figures(summaries[1]), **halo_figures(events, ranks)}
    vertices = summaries[1]["mesh"]["vertices"]
    said = {"halo_bytes": model.halo_bytes(vertices, ranks, dimension, dimension), **model.factor(vertices, ranks, dimension, dimension)}
    factors, coupled = (summaries[1]["work"][name] - summaries[0]["work"][name]
                        for name in ("factorizations", "coupled_factorizations"))
    if "largest_front" in figures and factors > 0:
        figures["factor_bytes"] = total(events, "EqmFactor", "Message Length") / 2.
        said["factor_bytes"] = (coupled * said["bytes_sent"]
                                + (factors - coupled) * model.factor(vertices, ranks, dimension, 1)["bytes_sent"])
    head = {"command": command, "vertices": vertices, "ranks": ranks, "options": " ".join(args.options)}
    rows = [{**head, "quantity": name, "measured": value, "model": said.get(name, ""),
             "ratio": value / said[name] if said.get(name) else ""} for name, value in figures.items()]
    return rows + [{**head, "quantity": name, "measured": value, "model": "", "ratio": ""}
                   for name, value in counts_per_iteration(events, summaries).items()]


def worst(rows):
    """Lines: over all runs of a command the range of a quantity's ratio of measured to modelled."""
    ratios = {}
    for row in rows:
        if row["ratio"] != "":
            ratios.setdefault((row["command"], row["quantity"]), []).append(float(row["ratio"]))
    return [f"model, {command}: {quantity} measured is {min(values):.2f} to {max(values):.2f} of the model's"
            for (command, quantity), values in ratios.items()]
