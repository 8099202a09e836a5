#!/usr/bin/env python3
"""MATLAB files of meshes (F, V, T, as the papers' authors keep them) into mesh files, and results into MATLAB files.

usage: jobs/mat.py IN.mat OUT.obj|.h5            the mesh; with --map NAME also the map that is in it, as OUT.csv
       jobs/mat.py RESULT.h5 OUT.mat             vertices V, faces F or tetrahedra T (from 1), map f, ratio

Which variables are the mesh is seen from their shapes, and from their names where several fit: V, F and T come first. Needs SciPy, and for
files of MATLAB 7.3 and results h5py.
"""
import argparse
import os
import pathlib
import sys

import numpy

VERTICES = ("V", "P", "vertices", "Vertices", "vertex", "node", "pts", "points")
TRIANGLES = ("F", "faces", "Faces", "face", "Tri", "tri", "elem")
TETRAHEDRA = ("T", "tets", "tet", "TetF", "elem")


def fail(message):
    sys.exit(f"mat: {message}")


def read_new(path):
    """Files of MATLAB 7.3 are HDF5, with the axes the other way round."""
    import h5py
    with h5py.File(path) as file:
        return {name: numpy.asarray(item).T for name, item in file.items() if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"}


def read(path):
    """Its arrays of numbers by name; those of a structure count as arrays of the file."""
    import scipy.io
    try:
        found = scipy.io.loadmat(path, squeeze_me=False, struct_as_record=True)
    except NotImplementedError:
        return read_new(path)
    except (OSError, ValueError, TypeError) as error:
        fail(f"cannot read {path}: {error}")
    arrays = {}
    for name, value in found.items():
        if name.startswith("__"):
            continue
        if value.dtype.names:
            arrays.update({field: value[field].flat[0] for field in value.dtype.names if value.size})
        else:
            arrays[name] = value
    return {name: numpy.asarray(value) for name, value in arrays.items() if getattr(value, "dtype", numpy.dtype("O")).kind in "fiubc"}


def numbers_vertices(array, columns, count):
    """Whole numbers from 1 to `count`, so many in a row?"""
    return (array.ndim == 2 and array.shape[1] == columns and len(array) > 0 and numpy.isfinite(array).all() and
            (array == numpy.round(array)).all() and array.min() >= 1 and array.max() <= count)


def choose(arrays, names, fits):
    known = [name for name in names if name in arrays and fits(arrays[name])]
    others = [name for name, array in arrays.items() if name not in names and fits(array)]
    return (known + others + [None])[0]


def take_mesh(arrays, path):
    """Names of the vertices and of the cells."""
    for vertices in [*filter(arrays.__contains__, VERTICES), *arrays]:
        array = arrays[vertices]
        if array.ndim != 2 or array.shape[1] not in (2, 3) or array.dtype.kind != "f" or len(array) < 3:
            continue
        for names, columns in ((TETRAHEDRA, 4), (TRIANGLES, 3)):
            cells = choose({k: v for k, v in arrays.items() if k != vertices}, names, lambda a: numbers_vertices(a, columns, len(array)))
            if cells:
                return vertices, cells
    shapes = ", ".join(f"{name} {'x'.join(map(str, array.shape))}" for name, array in arrays.items())
    fail(f"{path} holds no vertices (n x 3) with triangles (m x 3) or tetrahedra (m x 4) that count from 1; it has {shapes or 'no numbers'}")


def import_mesh(path, out, map_name):
    arrays = read(path)
    vertices, cells = take_mesh(arrays, path)
    points = numpy.zeros((len(arrays[vertices]), 3))
    points[:, : arrays[vertices].shape[1]] = arrays[vertices]
    sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "python"))
    import equimap
    equimap.write(out, (points, arrays[cells].astype(numpy.int64) - 1))
    print(f"{out}: {len(points)} vertices of {vertices}, {len(arrays[cells])} cells of {cells}")
    if map_name:
        image = arrays.get(map_name)
        if image is None or len(image) != len(points):
            fail(f"{map_name} is no array with a row per vertex of {path}")
        if numpy.iscomplexobj(image):
            image = numpy.column_stack([image.real, image.imag])
        name = os.path.splitext(out)[0] + ".csv"
        numpy.savetxt(name, image.reshape(len(points), -1), "%.17g", ",", header=",".join("xyz"[: image.reshape(len(points), -1).shape[1]]), comments="")
        print(f"{name}: the map {map_name}")


def export_result(path, out):
    import h5py
    import scipy.io
    with h5py.File(path) as file:
        cells = file["mesh/cells"][:] + 1
        content = {"V": file["mesh/vertices"][:], "T" if cells.shape[1] == 4 else "F": cells.astype(float)}
        for name, place in (("f", "map/coordinates"), ("ratio", "cell/ratio")):
            if place in file:
                content[name] = file[place][:]
    scipy.io.savemat(out, content, oned_as="column")
    print(f"{out}: {', '.join(content)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input")
    parser.add_argument("output")
    parser.add_argument("--map", metavar="NAME", help="write this variable, the image of each vertex, as CSV for equimap measure")
    arguments = parser.parse_args()
    if not os.path.exists(arguments.input):
        fail(f"there is no file {arguments.input}")
    try:
        import scipy.io  # noqa: F401
    except ImportError:
        fail("this needs SciPy (Debian: python3-scipy)")
    if arguments.output.endswith(".mat"):
        export_result(arguments.input, arguments.output)
    else:
        import_mesh(arguments.input, arguments.output, arguments.map)


if __name__ == "__main__":
    main()
