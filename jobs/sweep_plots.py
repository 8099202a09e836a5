"""The pictures of a sweep: energy against iterations and against seconds, time against vertices. Used by sweep_report.py;
needs Matplotlib, and does without pictures where it is missing."""
import dataclasses
import sys

from sweep_table import Row, generated

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f")  # Okabe and Ito
LOGARITHMIC_FROM = 500  # iterations
HOLLOW = {"marker": "o", "markerfacecolor": "white", "markersize": 7, "zorder": 3}
# What may tell one run from another, beside its mesh; the first that are needed become its label.
FIELDS = (
    lambda run: run.summary["command"],
    lambda run: run.summary["method"],
    lambda run: f"{run.row.ranks} rank{'s' * (run.row.ranks > 1)}",
    lambda run: f"{run.row.threads} thread{'s' * (run.row.threads > 1)}",
    lambda run: " ".join(run.row.options),
    lambda run: run.row.preset.rpartition("/")[2],
)


@dataclasses.dataclass
class Run:
    """What the pictures show of a row."""
    row: Row
    summary: dict
    history: list
    paper: dict  # {iterations or None for the end: {figure: value}}

    @property
    def vertices(self):
        return self.summary["mesh"]["vertices"]

    def curve(self, column):
        """Abscissa and energy, without the points that a logarithm cannot show."""
        points = [(float(line[column]), float(line["energy"])) for line in self.history]
        return [point for point in points if point[1] > 0.]

    def published_points(self, column):
        """The paper's (iterations or seconds, energy), of the same method."""
        figure = {"iteration": "iterations", "seconds": "seconds"}[column]
        for after, figures in self.paper.items() if self.row.paper == self.row.preset else ():
            place = figures.get(figure)
            if figure == "iterations":
                place = after or place or self.summary["iterations"]
            if place and figures.get("energy", 0.) > 0.:
                yield place, figures["energy"]


def family(run):
    """What shares a line of panels: the runs of a mesh, or of a generated shape."""
    shape = generated(run.row.mesh)
    return shape[0] if shape else run.row.mesh


def labels(runs):
    """For each run what tells it from the others of the same mesh, with as few words as will do."""
    def clashes(words):
        return len(runs) - len({(run.row.mesh, word) for run, word in zip(runs, words)})

    words = ["" for _ in runs]
    for field in FIELDS:
        longer = [", ".join(filter(None, (word, field(run)))) for word, run in zip(words, runs)]
        if clashes(longer) < clashes(words):
            words = longer
    if clashes(words):
        words = [run.row.name for run in runs]
    return [word or run.summary["method"] for word, run in zip(words, runs)]


def style(axes):
    axes.grid(True, which="major", color="0.9", linewidth=.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_energy(pyplot, runs, name):
    """A line of panels for each mesh: energy against iterations, against seconds."""
    families = {}
    for run in runs:
        families.setdefault(family(run), []).append(run)
    figure, grid = pyplot.subplots(len(families), 2, figsize=(11, .6 + 3. * len(families)), squeeze=False, sharey="row",
                                   layout="constrained")
    for panels, (mesh, members) in zip(grid, families.items()):
        for axes, column in zip(panels, ("iteration", "seconds")):
            draw_panel(axes, members, column)
        vertices = {run.vertices for run in members}
        panels[0].set_title(mesh + (f", {vertices.pop():,} vertices" if len(vertices) == 1 else ""), loc="left", fontsize=10)
        panels[0].set_ylabel("energy E")
        panels[1].legend(loc="center left", bbox_to_anchor=(1., .5), frameon=False, fontsize=8)
    for axes, title in zip(grid[-1], ("iterations", "seconds")):
        axes.set_xlabel(title)
    save(pyplot, figure, name)


def draw_panel(axes, runs, column):
    """A curve for each run: its colour is its label's, and the larger of several meshes, the stronger."""
    words = labels(runs)
    names, sizes = list(dict.fromkeys(words)), sorted({run.vertices for run in runs})
    for run, word in zip(runs, words):
        k = names.index(word)
        axes.plot(*zip(*run.curve(column)), "-" if k < len(COLORS) else "--", color=COLORS[k % len(COLORS)], linewidth=1.6,
                  alpha=strength(run.vertices, sizes), label=word if run.vertices == sizes[-1] else None)
        for point in run.published_points(column):
            axes.plot(*point, markeredgecolor=COLORS[k % len(COLORS)], **HOLLOW)
    for size in sizes if len(sizes) > 1 else ():
        axes.plot([], [], color="black", linewidth=1.6, alpha=strength(size, sizes), label=f"{size:,} vertices")
    if any(list(run.published_points("iteration")) for run in runs):
        axes.plot([], [], linestyle="none", markeredgecolor="0.3", label="published", **HOLLOW)
    style(axes)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if high < 100. * low:
        plain_numbers(axes.yaxis)
    longest = max(run.summary["iterations"] for run in runs)
    if column == "seconds":
        axes.set_xscale("log")
        plain_numbers(axes.xaxis)
    elif longest > LOGARITHMIC_FROM:
        axes.set_xscale("symlog", linthresh=10, linscale=.5)
        plain_numbers(axes.xaxis)
        axes.set_xlim(left=0)
    else:
        axes.set_xlim(left=0)


def strength(size, sizes):
    return .3 + .7 * (1 + sizes.index(size)) / len(sizes)


def draw_time(pyplot, runs, name):
    """Seconds over vertices, a line for each way of computing."""
    figure, axes = pyplot.subplots(figsize=(8, 4.8), layout="constrained")
    series, with_paper = {}, False
    for run, word in zip(runs, labels(runs)):
        series.setdefault(word, []).append(run)
    for k, (word, members) in enumerate(series.items()):
        color = COLORS[k % len(COLORS)]
        points = sorted((run.vertices, run.summary["seconds"]["total"]) for run in members)
        axes.plot(*zip(*points), "o-", color=color, linewidth=1.6, markersize=5, label=word)
        paper = sorted((run.vertices, run.paper[None]["seconds"]) for run in members
                       if run.row.paper == run.row.preset and "seconds" in run.paper.get(None, {}))
        if paper:
            with_paper = True
            axes.plot(*zip(*paper), ":", color=color, linewidth=1., markeredgecolor=color, **HOLLOW)
    if with_paper:
        axes.plot([], [], ":", color="0.3", markeredgecolor="0.3", label="published (another machine)", **HOLLOW)
    style(axes)
    axes.set(xscale="log", yscale="log", xlabel="vertices", ylabel="seconds")
    plain_numbers(axes.xaxis)
    plain_numbers(axes.yaxis)
    axes.legend(frameon=False, fontsize=8)
    save(pyplot, figure, name)


def plain_numbers(axis):
    """20,000 in the place of 2 x 10^4 on a logarithmic axis, and 2 and 5 beside 1 where it covers less than two decades."""
    from matplotlib import ticker

    low, high = axis.get_view_interval()
    form = ticker.FuncFormatter(lambda value, _: f"{value:,.10g}")
    axis.set_major_formatter(form)
    if low > 0. and high < 100. * low:
        axis.set_major_locator(ticker.LogLocator(subs=(1., 2., 5.)))
    axis.set_minor_formatter(ticker.NullFormatter())


def save(pyplot, figure, name):
    figure.savefig(name, dpi=130)
    pyplot.close(figure)


def draw(runs, folder):
    """Draw what can be drawn; the files."""
    try:
        import matplotlib
    except ImportError:
        print(f"sweep: no plots: {sys.executable} has no Matplotlib (Debian: python3-matplotlib, for /usr/bin/python3)")
        return []
    matplotlib.use("Agg")
    from matplotlib import pyplot

    runs = [run for run in runs if run.history]
    if not runs:
        return []
    draw_energy(pyplot, runs, folder / "energy.png")
    draw_time(pyplot, runs, folder / "time.png")
    return [folder / "energy.png", folder / "time.png"]
