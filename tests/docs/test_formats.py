"""The table of docs/formats.md: what it says is read and written is, and other programs read what we write.

usage: python3 test_formats.py EQUIMAP
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.join(HERE, "..", "..")
sys.path[:0] = [os.path.join(HERE, "..", "support"), os.path.join(TOP, "python")]
from program import Program  # noqa: E402


def table():
    """The rows, as (suffix, read, written, readers of surfaces, readers of solids)."""
    with open(os.path.join(TOP, "docs", "formats.md"), encoding="utf-8") as stream:
        lines = [line for line in stream.read().partition("\n## ")[0].splitlines() if line.startswith("| ")]
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines[1:]]
    words = [[re.findall(r"\w+", cell) for cell in row[2:]] for row in rows]
    return [(row[1].strip("`."), *cells) for row, cells in zip(rows, words)]


def read_h5py(name):
    with h5py.File(name) as file:
        return file["/mesh/vertices"][...], file["/mesh/cells"][...]


def read_meshio(name):
    import meshio
    import equimap.meshio  # noqa: F401
    mesh = meshio.read(name)
    assert len(mesh.cells) == 1, mesh.cells
    return mesh.points, mesh.cells[0].data


def read_nibabel(name):
    import nibabel
    if name.endswith(".gii"):
        points, cells = (array.data for array in nibabel.load(name).darrays)
        return points, cells
    return nibabel.freesurfer.read_geometry(name)


def read_gmsh(name):
    """Through Gmsh's own file of version 2.2."""
    subprocess.run(["gmsh", name, "-save", "-format", "msh22", "-o", name + ".read"], check=True, stdout=subprocess.DEVNULL)
    with open(name + ".read") as stream:
        text = stream.read()
    nodes = text.split("$Nodes\n")[1].split("$EndNodes")[0].splitlines()[1:]
    elements = [line.split() for line in text.split("$Elements\n")[1].split("$EndElements")[0].splitlines()[1:]]
    points = numpy.array([line.split()[1:] for line in nodes], float)
    cells = [element[3 + int(element[2]):] for element in elements if element[1] in ("2", "4")]
    return points, numpy.array(cells, int) - 1


PARAVIEW = """
import sys, numpy
from paraview import simple, servermanager
from vtk.util.numpy_support import vtk_to_numpy
for name in sys.argv[1:]:
    data = servermanager.Fetch(simple.OpenDataFile(name))
    cells = [[data.GetCell(k).GetPointId(i) for i in range(data.GetCell(k).GetNumberOfPoints())] for k in range(data.GetNumberOfCells())]
    numpy.savez(name + ".read.npz", points=vtk_to_numpy(data.GetPoints().GetData()), cells=numpy.array(cells))
"""


def read_paraview(name):
    """What one run of pvpython has read of all files (run_paraview)."""
    with numpy.load(name + ".read.npz") as file:
        return file["points"], file["cells"]


def run_paraview(program, names):
    program.write("read.py", PARAVIEW)
    subprocess.run(["pvpython", "--force-offscreen-rendering", "read.py", *names], cwd=program.folder, check=True, stdout=subprocess.DEVNULL)


def read_workbench(name):
    """Workbench says how many there are; the file it writes again, as text, is read for the rest."""
    subprocess.run(["wb_command", "-gifti-convert", "ASCII", name, name + ".read.gii"], check=True)
    with open(name + ".read.gii", encoding="utf-8") as stream:
        points, cells = re.findall(r"<Data>([^<]*)</Data>", stream.read())
    return numpy.array(points.split(), float).reshape(-1, 3), numpy.array(cells.split(), int).reshape(-1, 3)


READERS = {"h5py": read_h5py, "meshio": read_meshio, "nibabel": read_nibabel, "gmsh": read_gmsh, "ParaView": read_paraview,
           "Workbench": read_workbench}


def available():
    there = {"h5py"}
    there |= {name for name in ("meshio", "nibabel") if subprocess.run([sys.executable, "-c", "import " + name],
                                                                      stderr=subprocess.DEVNULL).returncode == 0}
    there |= {name for name, command in (("gmsh", "gmsh"), ("ParaView", "pvpython"), ("Workbench", "wb_command")) if shutil.which(command)}
    return there


def file_name(kind, suffix):
    return f"{kind}.surf.gii" if suffix == "gii" else f"{kind}.{suffix}"


def check_written(program, rows):
    """Every mesh in every format that the table says, and back; refused where it says nothing."""
    for suffix, read, written, *_ in rows:
        for kind in ("surfaces", "solids"):
            name = file_name(kind, suffix)
            result = program.run("convert", kind + ".h5", name)
            assert (result.returncode == 0) == (kind in written), f"{name}: exit code {result.returncode}\n{result.stderr}"
            if kind in written and kind in read:
                program.succeed("convert", name, "back.h5")
                ours, theirs = read_h5py(program.file(kind + ".h5")), read_h5py(program.file("back.h5"))
                check_same(name, *ours, *theirs)
    listed = program.run("convert", "surfaces.h5", "x.none").stderr
    for suffix in re.findall(r" \.(\w+)", listed):
        family = "white" if suffix in ("pial", "sphere", "inflated", "orig", "smoothwm", "midthickness", "reg", "nofix") else suffix
        assert family in [row[0] for row in rows] + ["curv"], f".{suffix} is written, and not in the table"


def check_same(what, points, cells, other_points, other_cells):
    """The same cells in the same order, the same places of their corners; to the six digits that some formats have."""
    assert len(cells) == len(other_cells), f"{what}: {len(other_cells)} cells"
    difference = abs(points[cells] - numpy.asarray(other_points, float)[numpy.asarray(other_cells, int)]).max()
    assert difference < 1e-5, f"{what}: corners differ by {difference}"


def main():
    rows, there = table(), available()
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], 1, folder)
        program.succeed("generate", "head", "-n", 200, "-o", "surfaces.h5")
        program.succeed("generate", "blob", "-n", 200, "-o", "solids.h5")
        check_written(program, rows)
        wanted = [(kind, suffix, reader) for suffix, _, _, *both in rows for kind, readers in zip(("surfaces", "solids"), both)
                  for reader in readers]
        if "ParaView" in there:
            run_paraview(program, [file_name(kind, suffix) for kind, suffix, reader in wanted if reader == "ParaView"])
        for kind, suffix, reader in wanted:
            if reader in there:
                name = program.file(file_name(kind, suffix))
                check_same(f"{name} by {reader}", *read_h5py(program.file(kind + ".h5")), *READERS[reader](name))
                count += 1
    print(f"{len(rows)} formats, {count} of {len(wanted)} readings by {', '.join(sorted(there))}")
    assert len(rows) >= 14 and len(wanted) > 20


main()
