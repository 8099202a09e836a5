"""Meshes and results in files."""
import csv
import os
import pathlib
import tempfile

import h5py
import numpy

from .program import call

# Attributes of a result that the summary (JSON) keeps in groups: ratio_sd is summary["ratio"]["sd"].
GROUPS = {"mesh": "mesh", "energy": "energy", "ratio_error": "ratio_error", "ratio": "ratio", "angle_error": "angle_error_deg",
          "quasiconformal": "quasiconformal", "seconds": "seconds"}
NAMED = ("mesh/vertices", "mesh/cells", "map/coordinates", "cell/ratio", "vertex/ratio")


class Result:
    """A mesh, and a map of it if there is one; everything in the numbering of the input, vertices and cells from 0.

    vertices      n x 3
    cells         m x 3 triangles or m x 4 tetrahedra
    map           n x 2 or n x 3, where each vertex goes; None for a mesh without a map
    ratio         m: each cell's share of the image over its share of the surface or solid; None without a map
    vertex_ratio  n: the weighted mean of the ratios around each vertex
    history       a dict of arrays with an entry per iteration: iteration, energy, sd, folds, ..., seconds
    attributes    what the file says of its run
    summary       the same, in the groups and under the names that the program's -summary has
    fields        every other array of the file under its path, such as fields["cell/quasi_conformal"]
    """

    def __init__(self, vertices, cells, datasets=None, attributes=None):
        datasets = dict(datasets or {})
        self.vertices, self.cells = vertices, cells
        self.map = datasets.pop("map/coordinates", None)
        self.ratio = datasets.pop("cell/ratio", None)
        self.vertex_ratio = datasets.pop("vertex/ratio", None)
        self.history = {name.split("/")[1]: datasets.pop(name) for name in list(datasets) if name.startswith("history/")}
        self.fields = datasets
        self.attributes = attributes or {}
        self.summary = grouped(self.attributes)

    def __repr__(self):
        kind = "triangles" if self.cells.shape[1] == 3 else "tetrahedra"
        text = "%d vertices, %d %s" % (len(self.vertices), len(self.cells), kind)
        if self.map is not None:
            text += ", %s: %s" % (self.attributes.get("command", "map"), self.attributes.get("status", "of unknown status"))
        return "<equimap.Result: %s>" % text

    def weights(self):
        """The area or volume of each cell of the mesh, as it is in space."""
        return measures(self.vertices, self.cells)

    def image_weights(self):
        """The area or volume of each cell of the image, without a sign."""
        return measures(self.map, self.cells)


def measures(places, cells):
    """Areas of triangles in the plane or in space, volumes of tetrahedra."""
    edges = places[cells[:, 1:]] - places[cells[:, :1]]
    gram = numpy.einsum("eik,ejk->eij", edges, edges)
    return numpy.sqrt(numpy.maximum(numpy.linalg.det(gram), 0.)) / (2. if cells.shape[1] == 3 else 6.)


def plain(value):
    """An attribute as Python has it: text, int, float, or an array."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value.item() if isinstance(value, numpy.generic) else value


def grouped(attributes):
    summary = {}
    for name, value in attributes.items():
        group = next((key for key in GROUPS if name.startswith(key + "_")), None)
        if group:
            summary.setdefault(GROUPS[group], {})[name[len(group) + 1:]] = value
        else:
            summary[name] = value
    return summary


def read(name, program=None):
    """Read a result or a mesh. Files that are not HDF5 are read by the program (`equimap convert`)."""
    if h5py.is_hdf5(name):
        return read_hdf5(name)
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "mesh.h5")
        call(["convert", os.fspath(name), copy], program=program)
        return read_hdf5(copy)


def read_hdf5(name):
    datasets = {}

    def take(path, item):
        if isinstance(item, h5py.Dataset):
            datasets[path] = item[()]

    with h5py.File(name, "r") as file:
        file.visititems(take)
        attributes = {key: plain(value) for key, value in file.attrs.items()}
    missing = [path for path in NAMED[:2] if path not in datasets]
    if missing:
        raise ValueError("%s is no mesh or result of equimap: it has no /%s" % (name, missing[0]))
    return Result(datasets.pop("mesh/vertices"), datasets.pop("mesh/cells"), datasets, attributes)


def arrays_of(mesh):
    """Vertices and cells of what a caller may call a mesh: a Result, a pair of arrays, or a mesh of meshio."""
    if hasattr(mesh, "vertices") and hasattr(mesh, "cells"):
        vertices, cells = mesh.vertices, mesh.cells
    elif hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        kinds = [kind for kind in ("tetra", "triangle") if kind in mesh.cells_dict]
        if not kinds:
            raise ValueError("the mesh has neither triangles nor tetrahedra")
        vertices, cells = mesh.points, mesh.cells_dict[kinds[0]]
    else:
        vertices, cells = mesh
    vertices, cells = numpy.asarray(vertices, dtype=float), numpy.asarray(cells)
    if vertices.ndim != 2 or vertices.shape[1] not in (2, 3):
        raise ValueError("vertices are n x 3 (or n x 2, in the plane), not %s" % (vertices.shape,))
    if cells.ndim != 2 or cells.shape[1] not in (3, 4) or cells.dtype.kind not in "iu":
        raise ValueError("cells are whole numbers, m x 3 or m x 4, not %s of type %s" % (cells.shape, cells.dtype))
    if vertices.shape[1] == 2:
        vertices = numpy.column_stack([vertices, numpy.zeros(len(vertices))])
    return vertices, cells.astype("int64")


def write(name, mesh, fields=None, program=None):
    """Write a mesh: HDF5 by itself, any other format by the program (`equimap convert`), which the suffix says.

    `mesh` is a pair (vertices, cells), a Result or a mesh of meshio; `fields` more arrays under their paths, for HDF5, such as
    {"cell/density": weights}. A file appears whole or not at all."""
    vertices, cells = arrays_of(mesh)
    path = pathlib.Path(name)
    if path.suffix.lower() in (".h5", ".hdf5"):
        part = path.with_name("part-%d-%s" % (os.getpid(), path.name))
        try:
            write_hdf5(part, vertices, cells, fields or {})
            os.replace(part, path)
        finally:
            if part.exists():
                part.unlink()
        return
    if fields:
        raise ValueError("fields are kept in HDF5 only: give the file a name that ends in .h5")
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "mesh.h5")
        write_hdf5(copy, vertices, cells, {})
        call(["convert", copy, os.fspath(path)], program=program)


def write_hdf5(name, vertices, cells, fields):
    with h5py.File(name, "w") as file:
        for path, values in {**fields, "mesh/vertices": vertices, "mesh/cells": cells}.items():
            file.create_dataset(path, data=values)


def write_csv(name, values):
    """Numbers, a row each, under a header, without losing a digit."""
    values = numpy.asarray(values)
    rows = values.reshape(len(values), -1).tolist()
    with open(name, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["value"] if values.ndim == 1 else ["column%d" % k for k in range(values.shape[1])])
        table.writerows([repr(int(x)) if float(x).is_integer() else repr(x) for x in row] for row in rows)
