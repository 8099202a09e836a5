#!/usr/bin/env python3
# %% [markdown]
# # A field on a surface as an image
#
# An area-preserving map to the unit square turns a field on a surface into an image in which every pixel stands for the same
# area: means, histograms and convolutional networks then need no weights. Here: height on some hills, as 128 x 128 pixels.
# Run: `PYTHONPATH=python python3 examples/resample.py [MESH]`; without a mesh one is generated.

# %%
import sys

import numpy

import equimap

PIXELS = 128
mesh = equimap.read(sys.argv[1]) if len(sys.argv) > 1 else equimap.generate("hills", 2000)
result = equimap.run("square", mesh, balance=.01)
height = mesh.vertices[:, 2]
print(result, "E = %.2e, %d folds" % (result.summary["energy"]["final"], result.summary["folds"]))

# %% [markdown]
# Which triangle of the image covers each pixel's middle, and the field there by its barycentric coordinates: a triangle at a
# time, over the pixels of its bounding box.


# %%
def resample(places, cells, field, pixels):
    """The field, linear in each triangle, at the middles of pixels x pixels squares of the unit square."""
    image = numpy.full((pixels, pixels), numpy.nan)
    for cell in cells:
        corners = places[cell] * pixels - .5
        low = numpy.clip(numpy.ceil(corners.min(0)).astype(int), 0, pixels)
        high = numpy.clip(numpy.floor(corners.max(0)).astype(int) + 1, 0, pixels)
        if (low >= high).any():
            continue
        y, x = numpy.mgrid[low[1]:high[1], low[0]:high[0]]
        points = numpy.stack([x.ravel(), y.ravel()]) - corners[0][:, None]
        second, third = numpy.linalg.solve((corners[1:] - corners[0]).T, points)
        inside = (second >= -1e-9) & (third >= -1e-9) & (second + third <= 1. + 1e-9)
        values = (1. - second - third) * field[cell[0]] + second * field[cell[1]] + third * field[cell[2]]
        image[y.ravel()[inside], x.ravel()[inside]] = values[inside]
    return image


image = resample(result.map, result.cells, height, PIXELS)

# %% [markdown]
# The plain mean over the pixels is the area-weighted mean over the surface: that is what preserving area buys.

# %%
share = result.weights() / result.weights().sum()
weighted = (share * height[result.cells].mean(1)).sum()
print("pixels without a value: %d" % numpy.isnan(image).sum())
print("mean over the pixels:  %.6f" % numpy.nanmean(image))
print("mean over the surface: %.6f (by area); %.6f without weights, over its vertices" % (weighted, height.mean()))

# %%
numpy.save("height.npy", image)
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    print("no Matplotlib: no picture; the image is in height.npy")
else:
    pyplot.imsave("height.png", image, origin="lower", cmap="viridis")
    print("height.npy, height.png")
