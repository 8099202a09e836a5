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
            axes.loglog([int(row["mesh.vertices"]) for row in rows], [float(row["cpu_seconds"]) for row in rows], "o-",
                        color=color, label=f"{label}: power {exponent(rows):.2f}")
    axes.set(title="growth", xlabel="vertices", ylabel="seconds of the processor")


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


def peers(axes, rows):
    """Seconds and how far areas are off: below and to the left is better."""
    rows = [row for row in rows if row["ratio_sd"]]
    for row, color in zip(rows, COLORS):
        axes.loglog(float(row["seconds"]), float(row["ratio_sd"]), "o", color=color,
                    label=f"{row['program']}, {float(row['angle_error_deg']):.0f}°")
    axes.set(title=f"programs, {int(rows[0]['vertices']):,} vertices, angle error" if rows else "", xlabel="seconds",
             ylabel="standard deviation of the area ratios")


def model(axes, rows):
    """Measured over modelled, for each quantity, by ranks."""
    quantities = list(dict.fromkeys((row["command"], row["quantity"]) for row in rows if row["ratio"]))
    markers = "os^dv*P"
    for k, (command, quantity) in enumerate(quantities):
        points = [(int(row["ranks"]), float(row["ratio"])) for row in rows
                  if (row["command"], row["quantity"]) == (command, quantity) and row["ratio"]]
        axes.plot(*zip(*points), marker=markers[k % len(markers)], linestyle="-" if command == "disk" else ":",
                  color=COLORS[k % len(COLORS)], label=f"{command}: {quantity.replace('_', ' ')}")
    axes.set_xscale("log", base=2)
    axes.set(title="the model", xlabel="ranks", ylabel="measured / model")
    axes.set_ylim(0., 1.8 * max((float(row["ratio"]) for row in rows if row["ratio"]), default=1.))  # room for the legend


def draw(tables, name, exponent, efficiencies):
    """All that the tables allow, on one page."""
    figure, grid = pyplot.subplots(2, 4, figsize=(19, 8.5), layout="constrained")
    panels = list(grid.flat)
    for axes, part, paint in zip(panels, ("kernels", "growth", "peers", "model"), (kernels, phases, peers, model)):
        if part in tables:
            paint(axes, tables[part])
    growth(panels[4], tables, exponent)
    memory(panels[5], tables)
    for axes, part in zip(panels[6:], ("strong", "weak")):
        if part in tables:
            scaling(axes, tables[part], f"{part} scaling", part == "weak", efficiencies)
    for axes in panels:
        axes.set_visible(axes.has_data())
        axes.grid(True, color="0.9")
        axes.set_axisbelow(True)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(framealpha=.9, fontsize=7, ncols=2 if axes is panels[3] else 1)
    figure.savefig(name, dpi=120)
    pyplot.close(figure)
