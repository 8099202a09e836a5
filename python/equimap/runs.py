"""Running the program's commands."""
import json
import os
import tempfile

import numpy

from .files import Result, arrays_of, read, read_hdf5, write_csv, write_hdf5
from .program import call, failure, start

# Options that name a file of numbers: an array in their place is written to one.
TABLES = ("density", "density_a", "density_b", "landmarks", "align", "transfer")
MAP_WRITTEN = (0, 4, 5)  # converged, stopped before, folds remain


def is_file(mesh):
    return isinstance(mesh, (str, os.PathLike))


def text_of(name, value, folder):
    """An option's value as the command line has it."""
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if name in TABLES and not isinstance(value, (str, os.PathLike)):
        path = os.path.join(folder, name + ".csv")
        write_csv(path, value)
        return path
    if isinstance(value, (list, tuple, numpy.ndarray)):
        return ",".join(text_of("", one, folder) for one in value)
    if isinstance(value, (float, numpy.floating)):
        return repr(float(value))
    return os.fspath(value) if is_file(value) else str(value)


def words_of(options, folder):
    """Options as words of a command line; those that are None are left out."""
    words = []
    for name, value in options.items():
        if value is not None:
            words += ["-" + name, text_of(name, value, folder)]
    return words


def file_of(mesh, folder, name):
    """The file of a mesh: its own, or one that is written for it; a result goes with its map."""
    if is_file(mesh):
        return os.fspath(mesh)
    path = os.path.join(folder, name + ".h5")
    vertices, cells = arrays_of(mesh)
    has_map = isinstance(mesh, Result) and mesh.map is not None
    write_hdf5(path, vertices, cells, {"map/coordinates": mesh.map} if has_map else {})
    return path


def names_of(output, folder):
    """The files to write, and the HDF5 file among them that is read back."""
    names = [] if output is None else [os.fspath(output)] if is_file(output) else [os.fspath(name) for name in output]
    names = [one for name in names for one in name.split(",")]
    mine = next((name for name in names if name.lower().endswith((".h5", ".hdf5"))), None)
    return (names, mine) if mine else (names + [os.path.join(folder, "result.h5")], os.path.join(folder, "result.h5"))


def run(command, *meshes, output=None, ranks=1, threads=None, progress=None, accept=(0, 4), program=None, **options):
    """Map a mesh, or register two: what `equimap COMMAND MESH ... -o OUTPUT -OPTIONS` does, with its Result.

    command    disk, square, sphere, ball, cube, conformal, register
    meshes     files, pairs of arrays (vertices, cells), Results (register takes their maps), meshes of meshio
    output     one or several files to keep; the suffix says the format. Without it nothing is left behind
    ranks, threads   of the run; ranks are started by mpirun, or by what EQUIMAP_MPIRUN names
    progress   a function that is called with each line that the program prints, as it comes; True prints them
    accept     the exit codes that return a result: 0 converged, 4 stopped before, 5 folds remain. Any other raises an
               exception of equimap.errors with the program's message; of 4 and 5 it carries the result
    options    the program's, without their dash: max_it=20, repair=True, corners=[0, 312, 77, 1045]. An array serves for
               a file of numbers: density=weights, landmarks=pairs

    The result's `summary` is the program's own (-summary)."""
    with tempfile.TemporaryDirectory() as folder:
        files = [file_of(mesh, folder, "mesh%d" % k) for k, mesh in enumerate(meshes)]
        names, mine = names_of(output, folder)
        summary = os.fspath(options.pop("summary", None) or os.path.join(folder, "summary.json"))
        words = words_of({"threads": threads, **options}, folder)
        code, text, complaints = start([command, *files, "-o", ",".join(names), "-summary", summary, *words], ranks, program,
                                       progress)
        problem = None if code in accept else failure(code, text, complaints)
        if code not in MAP_WRITTEN:
            raise problem
        result = read_hdf5(mine)
        with open(summary, encoding="utf-8") as file:
            result.summary = json.load(file)
        if problem is not None:
            problem.message = result.summary["message"] or problem.message
            problem.args = (problem.message,)
            problem.result = result
            raise problem
        return result


def figures(arguments, accept, program):
    """The summary of a command that writes no map."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "summary.json")
        call([*arguments(folder), "-summary", name], program=program, accept=accept)
        with open(name, encoding="utf-8") as file:
            return json.load(file)


def check(mesh, program=None):
    """What a mesh is, what is wrong with it and where, which commands take it: the summary of `equimap check`. A mesh that no
    command can map raises nothing here: its exit_code is 3."""
    return figures(lambda folder: ["check", file_of(mesh, folder, "mesh")], (0, 3), program)


def measure(mesh, coordinates, program=None, **options):
    """Distortion and folds of any map, also of one made elsewhere: the summary of `equimap measure`. `coordinates` are n x 2 or
    n x 3, a row per vertex of the mesh, or a file that the program reads. Folds raise nothing: its exit_code is 5."""
    def arguments(folder):
        image = coordinates
        if not is_file(image):
            image = os.path.join(folder, "map.h5")
            vertices, cells = arrays_of(mesh if not is_file(mesh) else read(mesh, program))
            write_hdf5(image, vertices, cells, {"map/coordinates": numpy.asarray(coordinates, dtype=float)})
        return ["measure", file_of(mesh, folder, "mesh"), os.fspath(image), *words_of(options, folder)]

    return figures(arguments, (0, 5), program)


def generate(shape, n, program=None, **options):
    """A test surface or solid of about n vertices: hills, head, ball, ...; `equimap generate --help` lists them."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "mesh.h5")
        call(["generate", shape, "-n", str(n), "-o", name, *words_of(options, folder)], program=program)
        return read_hdf5(name)
