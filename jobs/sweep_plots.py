"""The pictures of a sweep: energy against iterations and against seconds, time against vertices. Used by sweep_report.py;
needs Matplotlib, and does without pictures where it is missing.

Lines join only what is one series: a shape in several sizes under the same options that ended in the same way."""
import dataclasses
import os
import sys

from sweep_table import Row, generated

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f")  # Okabe and Ito
MARKS = ("o", "s", "^", "D", "v", "P", "X")
LINES = ("-", "--", ":", "-.")
LOGARITHMIC_FROM = 500  # iterations
HOLLOW = {"marker": "o", "markerfacecolor": "white", "markersize": 7, "zorder": 3}
# What tells one way of computing from another.
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
    return (shape[0] if shape else run.row.mesh) + (f" to {run.row.mesh_b}" if run.row.mesh_b else "")


def series_of(runs):
    """Runs that may share a line: of one mesh or one generated shape in several sizes, computed and ended in one way.

    The rows' names, by which the legend calls them, with a * where they differ: {name: runs}."""
    groups = {}
    for run in runs:
        sizes_differ = not any(run.row.mesh == other.row.mesh for other in groups.get(key_of(run), ()))
        groups.setdefault(key_of(run) if sizes_differ else (key_of(run), run.row.name), []).append(run)
    found = {}
    for members in groups.values():
        name = common_name([run.row.name for run in members])
        found[name if name not in found else members[0].row.name] = members
    return found


def key_of(run):
    return (family(run), run.summary["status"], *(field(run) for field in FIELDS))


def common_name(names):
    """hills-*-ncg of hills-5000-ncg and hills-20000-ncg; all the names, if they have nothing in common."""
    if len(set(names)) == 1:
        return names[0]
    digits = "0123456789"  # a number is the same, or it is not
    before = os.path.commonprefix(names).rstrip(digits)
    after = os.path.commonprefix([name[len(before):][::-1] for name in names])[::-1].lstrip(digits)
    return f"{before}*{after}" if before or after else ", ".join(names)


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
    """A curve for each run: its colour is its series', and the larger of several meshes, the stronger."""
    sizes = sorted({run.vertices for run in runs})
    for k, (word, members) in enumerate(series_of(runs).items()):
        color = COLORS[k % len(COLORS)]
        for run in members:
            axes.plot(*zip(*run.curve(column)), LINES[k // len(COLORS) % len(LINES)], color=color, linewidth=1.6,
                      alpha=strength(run.vertices, sizes), label=word if run is members[-1] else None)
            for point in run.published_points(column):
                axes.plot(*point, markeredgecolor=color, **HOLLOW)
    for size in sizes if len(sizes) > 1 else ():
        axes.plot([], [], color="black", linewidth=1.6, alpha=strength(size, sizes), label=f"{size:,} vertices")
    if any(list(run.published_points("iteration")) for run in runs):
        axes.plot([], [], linestyle="none", markeredgecolor="0.3", label="published", **HOLLOW)
    style(axes)
    scale(axes, column, max(run.summary["iterations"] for run in runs))


def scale(axes, column, longest):
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if high < 100. * low:
        plain_numbers(axes.yaxis)
    if column == "seconds":
        axes.set_xscale("log")
        plain_numbers(axes.xaxis)
        return
    if longest > LOGARITHMIC_FROM:
        axes.set_xscale("symlog", linthresh=10, linscale=.5)
        plain_numbers(axes.xaxis)
    axes.set_xlim(left=0)


def strength(size, sizes):
    return .3 + .7 * (1 + sizes.index(size)) / len(sizes)


def draw_time(pyplot, runs, name):
    """Seconds over vertices, a line for each series, a point for what stands alone."""
    series, with_paper = series_of(runs), False
    columns = -(-len(series) // 30)
    figure, axes = pyplot.subplots(figsize=(8 + 2.4 * columns, max(4.8, .17 * min(len(series), 30))), layout="constrained")
    for k, (word, members) in enumerate(series.items()):
        color = COLORS[k % len(COLORS)]
        points = sorted((run.vertices, run.summary["seconds"]["total"]) for run in members)
        axes.plot(*zip(*points), MARKS[k // len(COLORS) % len(MARKS)] + "-", color=color, linewidth=1.6, markersize=5, label=word)
        for run in members:
            if run.row.paper == run.row.preset and "seconds" in run.paper.get(None, {}):
                with_paper = True
                axes.plot(run.vertices, run.paper[None]["seconds"], markeredgecolor=color, **HOLLOW)
    if with_paper:
        axes.plot([], [], linestyle="none", markeredgecolor="0.3", label="published (another machine)", **HOLLOW)
    style(axes)
    axes.set(xscale="log", yscale="log", xlabel="vertices", ylabel="seconds")
    plain_numbers(axes.xaxis)
    plain_numbers(axes.yaxis)
    axes.legend(loc="center left", bbox_to_anchor=(1., .5), frameon=False, fontsize=8, ncol=columns)
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
