#!/usr/bin/env python3
# %% [markdown]
# # How good is a map, and how did it get there?
#
# Two methods map the same surface to the disk; we look at the histograms of their area ratios (one is perfect) and at
# their energies over the iterations. Cells begin at `# %%`: editors and Jupyter (jupytext) show the script as a notebook.
# Run: `PYTHONPATH=python python3 examples/histogram.py [MESH]`; without a mesh one is generated.

# %%
import sys

import numpy

import equimap

mesh = sys.argv[1] if len(sys.argv) > 1 else equimap.generate("hills", 2000)
METHODS = {"fixed-point": {"method": "fixed-point", "max_it": 30}, "default": {"max_it": 10}}
results = {name: equimap.run("disk", mesh, **options) for name, options in METHODS.items()}

# %% [markdown]
# The figures, from the summaries and from the arrays themselves: the energy is E = A Σ w (r − 1)², A the image's area and w the
# triangles' shares of the surface.

# %%
print("%-12s %12s %12s %8s %8s %6s" % ("method", "E", "E again", "r min", "r max", "folds"))
for name, result in results.items():
    share = result.weights() / result.weights().sum()
    energy = result.image_weights().sum() * (share * (result.ratio - 1.) ** 2).sum()
    print("%-12s %12.4e %12.4e %8.4f %8.4f %6d" % (name, result.summary["energy"]["final"], energy, result.ratio.min(),
                                                  result.ratio.max(), result.summary["folds"]))

# %% [markdown]
# The histogram: on a logarithmic scale half and double are equally far from one.

# %%
edges = numpy.linspace(-.5, .5, 22)
for name, result in results.items():
    counts, _ = numpy.histogram(numpy.clip(numpy.log2(result.ratio), -.5, .5), edges)
    print("\n%s: triangles by log2 of their ratio" % name)
    for low, count in zip(edges, counts):
        if count:
            print("%+.2f %6d %s" % (low, count, "#" * (1 + 60 * count // counts.max())))

# %% [markdown]
# The same as a picture, where Matplotlib is there.

# %%
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    print("no Matplotlib: no picture")
else:
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4))
    for name, result in results.items():
        left.hist(numpy.log2(result.ratio), edges, histtype="step", linewidth=1.6, label=name)
        right.semilogy(result.history["iteration"], result.history["energy"], linewidth=1.6, label=name)
    left.set(xlabel="log2 of the area ratio", ylabel="triangles")
    right.set(xlabel="iteration", ylabel="energy E")
    right.legend(frameon=False)
    figure.tight_layout()
    figure.savefig("histogram.png", dpi=120)
    print("histogram.png")
