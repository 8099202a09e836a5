"""The picture of measure.py; needs Matplotlib."""
import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

PHASES = ("read", "diagnose", "distribute", "start", "minimise", "checkpoint", "measure", "write")
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f")


def kernels(axes, rows):
    """Each kernel's share of the bandwidth, a bar for every number of threads."""
    names = list(dict.fromkeys(row["kernel"] for row in rows))
    threads = sorted({int(row["threads"]) for row in rows})
    for k, count in enumerate(threads):
        measured = {row["kernel"]: float(row["share_of_triad"]) for row in rows if int(row["threads"]) == count}
        places = [place + .8 * k / len(threads) for place in range(len(names))]
        axes.barh(places, [measured.get(name, 0.) for name in names], .8 / len(threads), color=COLORS[k % len(COLORS)],
                  label=f"{count} thread{'s' * (count > 1)}")
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.invert_yaxis()
    axes.set(title="kernels", xlabel="share of the triad's bandwidth")


def phases(axes, rows):
    """Where the seconds go, by size."""
    below = [0.] * len(rows)
    for phase, color in zip(PHASES, COLORS):
        seconds = [float(row.get(f"seconds.{phase}") or 0.) / float(row["seconds.total"]) for row in rows]
        if max(seconds) > .005:
            axes.bar(range(len(rows)), seconds, .7, bottom=below, color=color, label=phase)
        below = [one + other for one, other in zip(below, seconds)]
    axes.set_xticks(range(len(rows)), [f"{int(row['mesh.vertices']):,}" for row in rows], fontsize=7)
    axes.set(title="phases of surfaces", xlabel="vertices", ylabel="share of the seconds")


def growth(axes, tables, exponent):
    for (part, label), color in zip((("growth", "surfaces"), ("solids", "solids")), COLORS):
        rows = tables.get(part, [])
        if rows:
            axes.loglog([int(row["mesh.vertices"]) for row in rows], [float(row["seconds.total"]) for row in rows], "o-",
                        color=color, label=f"{label}: power {exponent(rows):.2f}")
    axes.set(title="growth", xlabel="vertices", ylabel="seconds")


def memory(axes, tables):
    for (part, label), color in zip((("growth", "surfaces"), ("solids", "solids")), COLORS):
        rows = tables.get(part, [])
        if rows:
            vertices = [int(row["mesh.vertices"]) for row in rows]
            bytes_each = [float(row["memory_bytes.total"]) / count for row, count in zip(rows, vertices)]
            axes.semilogx(vertices, [value / 1000. for value in bytes_each], "o-", color=color, label=label)
    axes.set(title="memory", xlabel="vertices", ylabel="kB per vertex")


def scaling(axes, rows, title, weak, efficiencies):
    for cores, value, label in efficiencies(rows, weak):
        axes.plot(cores, value, "o", color=COLORS[0])
        axes.annotate(label, (cores, value), textcoords="offset points", xytext=(5, 4), fontsize=7)
    axes.set(title=f"{title}, ranks x threads", xlabel="cores asked for", ylabel="efficiency", ylim=(0., 1.15))


def draw(tables, name, exponent, efficiencies):
    """All that the tables allow, on one page."""
    figure, grid = pyplot.subplots(2, 3, figsize=(14, 8), layout="constrained")
    panels = list(grid.flat)
    if "kernels" in tables:
        kernels(panels[0], tables["kernels"])
    if "growth" in tables:
        phases(panels[1], tables["growth"])
    growth(panels[2], tables, exponent)
    memory(panels[3], tables)
    for axes, part in zip(panels[4:], ("strong", "weak")):
        if part in tables:
            scaling(axes, tables[part], f"{part} scaling", part == "weak", efficiencies)
    for axes in panels:
        axes.set_visible(axes.has_data())
        axes.grid(True, color="0.9")
        axes.set_axisbelow(True)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(framealpha=.9, fontsize=8)
    figure.savefig(name, dpi=120)
    pyplot.close(figure)
