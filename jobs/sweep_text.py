"""A sweep for people: how many rows ended how, a line per method, what is not finished, how the rows stand against the papers,
and a table, mesh by mesh. Used by sweep_report.py."""
import statistics

CLOSE = .02  # energies that differ by less are taken for the same

HEAD = ("row", "name", "method", "cores", "iterations", "E", "published", "ours / theirs", "SD", "folds", "seconds", "status")


def number(value, form):
    return "" if value is None else format(value, form)


def cells_of(fixed, ours, paper):
    energy, theirs = ours.get("energy"), paper.get("energy")
    cores = f"{fixed['ranks']} x {fixed['threads']}"
    return (str(fixed["row"]), fixed["name"], fixed["method"], cores, number(ours.get("iterations"), "d"), number(energy, ".3e"),
            number(theirs, ".2e"), number(energy / theirs, ".3g") if energy is not None and theirs else "",
            number(ours.get("sd"), ".3e"), number(ours.get("folds"), "d"), number(ours.get("seconds"), ".1f"), fixed["status"])


def aligned(rows, left):
    """Rows of words as lines: the columns `left` to the left, numbers to the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) if k in left else cell.rjust(width)
                        for k, (cell, width) in enumerate(zip(row, widths))).rstrip()


def against_papers(ends):
    """In a line how many rows have a lower energy than was published, the same, or a higher one, and which those are."""
    compared = [(fixed["name"], ours["energy"] / paper["energy"]) for fixed, ours, paper in ends if paper.get("energy")]
    if not compared:
        return []
    lower = sum(ratio < 1. - CLOSE for _, ratio in compared)
    higher = sorted(((ratio, name) for name, ratio in compared if ratio > 1. + CLOSE), reverse=True)
    text = [f"against the papers: {lower} of {len(compared)} rows have a lower energy, "
            f"{len(compared) - lower - len(higher)} the same to {CLOSE:.0%}, {len(higher)} a higher one"]
    return text + [f"  {ratio:8.3g} times the published: {name}" for ratio, name in higher]


def by_method(ends):
    """A line per command and method: what hundreds of rows come to."""
    groups = {}
    for fixed, ours, _ in ends:
        groups.setdefault((fixed["command"], fixed["method"]), []).append((fixed, ours))
    rows = [("command", "method", "rows", "converged", "with folds", "E, median", "largest", "seconds, median", "largest")]
    for (command, method), members in groups.items():
        energies, seconds = ([ours[figure] for _, ours in members] for figure in ("energy", "seconds"))
        rows.append((command, method, str(len(members)), str(sum(fixed["status"] == "converged" for fixed, _ in members)),
                     str(sum(ours["folds"] > 0 for _, ours in members)), format(statistics.median(energies), ".3e"),
                     format(max(energies), ".3e"), format(statistics.median(seconds), ".1f"), format(max(seconds), ".1f")))
    return aligned(rows, {0, 1})


def page(lines, unfinished=()):
    """The text of sweep.txt; `unfinished` are lines about the rows that are not among them."""
    ends = [line for line in lines if line[0]["status"] != "on the way"]
    counts = {}
    for fixed, _, _ in ends:
        counts[fixed["status"]] = counts.get(fixed["status"], 0) + 1
    text = [f"{len(ends)} rows: " + ", ".join(f"{count} {status}" for status, count in counts.items())]
    folded = [fixed["name"] for fixed, ours, _ in ends if ours["folds"]]
    text += [f"with folds: {', '.join(folded)}"] if folded else []
    text += unfinished
    text += ["", *by_method(ends)]
    against = against_papers(ends)
    text += ["", *against] if against else []
    meshes = {}
    for line in lines:
        meshes.setdefault((line[0]["mesh"], line[0]["mesh_b"]), []).append(line)
    table = [HEAD] + [cells_of(*line) for members in meshes.values() for line in members]
    shown = list(aligned(table, {HEAD.index(word) for word in ("name", "method", "status")}))
    text += ["", shown[0]]
    begin = 1
    for (mesh, other), members in meshes.items():
        text += ["", f"{mesh}{' to ' + other if other else ''}, {members[0][0]['vertices']:,} vertices"]
        text += shown[begin:begin + len(members)]
        begin += len(members)
    return "\n".join(text) + "\n"
