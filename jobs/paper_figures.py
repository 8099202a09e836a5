"""The figures of the papers, redrawn from our runs. Used by paper_page.py; needs Matplotlib, NumPy and h5py."""
import dataclasses
import subprocess

import h5py
import matplotlib
import numpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

from sweep_plots import COLORS, HOLLOW, Run, plain_numbers, style  # noqa: E402
from sweep_report import read_history  # noqa: E402
from sweep_table import Store, find_preset, published  # noqa: E402

# Which of a paper's figures each of ours redraws.
REDRAWN = {
    "000": {"pictures": "Figure 2", "histogram": "Figure 3", "bars": "Figure 4", "time": "Figure 5"},
    "001": {"pictures": "Figure 4", "energy": "Figures 5 to 7"},
    "002": {"pictures": "Figures 2 and 4", "energy": "Figure 5", "histogram": "Figure 6"},
    "003": {"pictures": "Figure 3", "histogram": "Figure 4", "energy": "Figures 5 and 6 (a)", "time": "Figure 6 (b)", "bars": "Figure 7",
            "folds": "Figure 8"},
    "004": {"pictures": "Figures 1 to 3", "quasi": "Figure 3", "histogram": "Figure 4", "energy": "Figures 5 and 6", "steps": "Figures 7 and 8"},
}
WIDTH = 4.2
ACROSS = 3


@dataclasses.dataclass
class Curves(Run):
    """A run, with its cells."""
    result: object = None  # the path of its HDF5 file
    program: object = None  # equimap, which draws reports; None: it is not there

    @property
    def word(self):
        """The row's name without that of the table's mesh."""
        mesh = (self.row.others.get("stands_for") or self.row.mesh).rpartition("/")[2] + "-"
        return self.row.name[len(mesh):] if self.row.name.startswith(mesh) else self.row.name

    def column(self, name):
        return numpy.array([float(line[name]) for line in self.history])

    def dataset(self, path):
        with h5py.File(self.result) as file:
            return file[path][:] if path in file else None


def families(runs):
    found = {}
    for run in runs:
        found.setdefault(run.row.mesh, []).append(run)
    return found


def grid(count, height=3.):
    """So many panels, three in a line."""
    lines = -(-count // ACROSS)
    across = min(ACROSS, count)
    figure, axes = pyplot.subplots(lines, across, figsize=(WIDTH * across, .6 + height * lines), squeeze=False, layout="constrained")
    panels = list(axes.flat)
    for spare in panels[count:]:
        spare.set_visible(False)
    return figure, panels[:count]


def color_of(words, word):
    return COLORS[words.index(word) % len(COLORS)]


def per_mesh(runs, draw_panel):
    """A panel for each mesh, a colour for each method; None if nothing is in them."""
    words = list(dict.fromkeys(run.word for run in runs))
    meshes = families(runs)
    figure, panels = grid(len(meshes))
    for axes, (mesh, members) in zip(panels, meshes.items()):
        for run in members:
            draw_panel(axes, run, color_of(words, run.word))
        style(axes)
        axes.set_title(f"{mesh}, {members[0].vertices:,} vertices", fontsize=9, loc="left")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize=7)
    if any(axes.has_data() for axes in panels):
        return figure
    pyplot.close(figure)
    return None


def histogram(paper, runs):
    """Ratios; of solids their errors, of conformal maps the angle errors."""
    def panel(axes, run, color):
        if paper == "004":
            counts, edges = run.dataset("histogram/angle_error"), run.dataset("histogram/angle_error_edges")
            if counts is None:
                return
            shown = edges[1:] <= 10.
            axes.stairs(counts[shown] / counts.sum(), edges[:shown.sum() + 1], color=color, label=run.word)
            axes.set_xlabel("angle error, degrees")
            return
        ratio = run.dataset("cell/ratio")
        values, low, high = (numpy.abs(ratio - 1.), 0., .25) if paper == "003" else (ratio, .85, 1.15)
        counts, edges = numpy.histogram(numpy.clip(values, low, high), 60, (low, high))
        axes.stairs(counts / len(values), edges, color=color, linewidth=1.3, label=run.word)
        axes.set_xlabel("|ratio - 1| (the last bar: and more)" if paper == "003" else "ratio (the outer bars: and beyond)")
        axes.set_ylabel("share of the cells")

    return per_mesh(runs, panel)


def quasi(paper, runs):
    """Quasi-conformal distortion of conformal maps."""
    def panel(axes, run, color):
        values = run.dataset("cell/quasi_conformal")
        if values is None:
            return
        low, high = 1., 1.5
        counts, edges = numpy.histogram(numpy.clip(values, low, high), 60, (low, high))
        axes.stairs(counts / len(values), edges, color=color, linewidth=1.3, label=run.word)
        axes.set(xlabel="ratio of the singular values (the last bar: and more)", ylabel="share of the cells")

    return per_mesh(runs, panel) if paper == "004" else None


def pictures(_, runs):
    """The report of the best run for each mesh, as the program draws it; None where it cannot."""
    shown = []
    for members in families(runs).values():
        best = min(members, key=lambda run: (run.summary["folds"], run.summary["energy"]["final"]))
        picture = best.result.with_name("report.png")
        drawn = subprocess.run([best.program, "report", best.result, "-o", picture, "-width", "1400"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False) if best.program else None
        if drawn and drawn.returncode == 0:
            shown.append(pyplot.imread(picture))
    if not shown:
        return None
    figure, panels = pyplot.subplots(len(shown), 1, figsize=(11., 6.1 * len(shown)), squeeze=False, layout="constrained")
    for axes, image in zip(panels.flat, shown):
        axes.imshow(image)
        axes.axis("off")
    return figure


def energy(_, runs):
    def panel(axes, run, color):
        axes.plot(*zip(*run.curve("iteration")), color=color, linewidth=1.4, label=run.word)
        for point in run.published_points("iteration"):
            axes.plot(*point, markeredgecolor=color, **HOLLOW)
        axes.set(yscale="log", xlabel="iteration (hollow: published)", ylabel="energy")
        if run.summary["iterations"] > 500:
            axes.set_xscale("symlog", linthresh=10, linscale=.5)

    return per_mesh(runs, panel)


def folds(_, runs):
    def panel(axes, run, color):
        axes.plot(run.column("iteration"), run.column("folds"), color=color, linewidth=1.4, label=run.word)
        axes.set(xlabel="iteration", ylabel="folds")
        axes.set_yscale("symlog", linthresh=1)

    folded = [run for run in runs if run.column("folds").any()]
    return per_mesh(folded, panel) if folded else None


def curve_of(column, label, positive):
    def draw(_, runs):
        def panel(axes, run, color):
            values = run.column(column)
            shown = values > 0.
            if shown.any():
                axes.plot(run.column("iteration")[shown], values[shown], color=color, linewidth=1.2, label=run.word)
            axes.set(xlabel="iteration", ylabel=label, yscale="log" if positive else "linear")

        return per_mesh(runs, panel)

    return draw


def bars(paper, runs):
    """Energy and SD at the end, ours and the published ones side by side."""
    ends = [run for run in runs if run.row.paper == run.row.preset and run.paper.get(None)]
    if not ends or paper == "004":
        return None
    spread = ((("error_mean", "mean of |ratio - 1|"), ("error_sd", "SD of |ratio - 1|")) if paper == "003"
              else (("sd", "SD of the ratios"),))
    figure, panels = grid(1 + len(spread), height=2.2 + .1 * len(ends))
    for axes, (name, label) in zip(panels, (("energy", "energy"), *spread)):
        for k, run in enumerate(ends):
            figures = run.summary["ratio_error" if name.startswith("error") else "ratio"]
            ours = run.summary["energy"]["final"] if name == "energy" else figures[name.rpartition("_")[2]]
            axes.barh(k - .2, ours, .38, color=COLORS[0])
            theirs = run.paper[None].get(name) or (run.paper[None].get("sd_by_mean") if name == "sd" else None)
            if theirs:
                axes.barh(k + .2, theirs, .38, color="0.75")
        axes.set_yticks(range(len(ends)), [run.row.name for run in ends] if name == "energy" else [""] * len(ends), fontsize=7)
        axes.invert_yaxis()
        axes.set(xscale="log", xlabel=f"{label} (grey: published)")
        axes.set_xlim(left=axes.get_xlim()[0] / 3.)
        style(axes)
    return figure


def time(_, runs):
    """Seconds over vertices; points of different meshes are not joined."""
    words = list(dict.fromkeys(run.word for run in runs))
    figure, panels = grid(1, height=4.)
    figure.set_size_inches(7., 4.4)
    axes = panels[0]
    seen = set()
    for run in runs:
        color = color_of(words, run.word)
        axes.plot(run.vertices, run.summary["seconds"]["total"], "o", color=color, label=None if run.word in seen else run.word)
        seen.add(run.word)
        theirs = run.paper.get(None, {}).get("seconds") if run.row.paper == run.row.preset else None
        if theirs:
            axes.plot(run.vertices, theirs, markeredgecolor=color, **HOLLOW)
    style(axes)
    axes.set(xscale="log", yscale="log", xlabel="vertices", ylabel="seconds (hollow: published, another machine)")
    plain_numbers(axes.xaxis)
    plain_numbers(axes.yaxis)
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1., .5))
    return figure


KINDS = {
    "pictures": ("A mesh each and its map", pictures), "histogram": ("Histograms of the cells", histogram),
    "quasi": ("Quasi-conformal distortion", quasi), "bars": ("Energies and standard deviations", bars),
    "energy": ("Energy over iterations", energy), "folds": ("Folds over iterations", folds),
    "gradient": ("Norm of the gradient", curve_of("gradient_norm", "norm of the gradient", True)),
    "steps": ("Step sizes", curve_of("step", "step", True)), "time": ("Seconds over vertices", time),
}


def draw(paper, parts, program):
    """(caption, figure) for every figure that has something to show."""
    runs = []
    for results, row, _ in parts:
        store = Store(results, row)
        runs.append(Curves(row, store.summary(), read_history(store), published(find_preset(row.paper)),
                           store.folder / "result.h5", program))
    runs = [run for run in runs if run.history]
    for kind, (caption, make) in KINDS.items():
        figure = make(paper, runs) if runs else None
        if figure is not None:
            like = REDRAWN[paper].get(kind)
            yield f"{caption} (as {like} of the paper)" if like else caption, figure
