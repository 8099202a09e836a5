"""The table of docs/formats.md: what it says is read and written is, and other programs read what we write.

usage: python3 test_formats.py EQUIMAP [all]
With `all` also the readers that take seconds to start: ParaView, Workbench, Gmsh, Blender, MeshLab.
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


BLENDER = """
import sys, bpy
for name in sys.argv[sys.argv.index("--") + 1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if name.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=name)
    elif name.endswith(".ply"):
        bpy.ops.import_mesh.ply(filepath=name)
    else:
        bpy.ops.import_mesh.stl(filepath=name)
    mesh = bpy.data.meshes[0]
    with open(name + ".read.txt", "w") as stream:
        for vertex in mesh.vertices:
            print("v", *vertex.co, file=stream)
        for face in mesh.polygons:
            print("f", *face.vertices, file=stream)
        for corner in mesh.uv_layers.active.data if mesh.uv_layers else ():
            print("t", *corner.uv, file=stream)
"""


def numbers_of(name, letter):
    with open(name + ".read.txt", encoding="utf-8") as stream:
        return numpy.array([line.split()[1:] for line in stream if line.startswith(letter)], float)


def read_blender(name):
    """What one Blender has read of all files (run_blender)."""
    return numbers_of(name, "v"), numbers_of(name, "f").astype(int)


def run_blender(program, names):
    program.write("blend.py", BLENDER)
    subprocess.run(["blender", "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "-P", program.file("blend.py"), "--",
                    *map(program.file, names)], check=True, stdout=subprocess.DEVNULL)


def run_meshlab(folder, name):
    """What MeshLab writes again, with the qualities that it has found."""
    environment = {**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder}
    subprocess.run(["xvfb-run", "-a", "meshlabserver", "-i", name, "-o", name + ".read.ply", "-m", "vq", "fq", "vt", "wt"], cwd=folder, check=True,
                   env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return name + ".read.ply"


def read_meshlab(name):
    run_meshlab(os.path.dirname(name), name)
    equimap = Program(sys.argv[1], 1, os.path.dirname(name))
    equimap.succeed("convert", name + ".read.ply", name + ".read.h5")
    return read_h5py(name + ".read.h5")


READERS = {"h5py": read_h5py, "meshio": read_meshio, "nibabel": read_nibabel, "gmsh": read_gmsh, "ParaView": read_paraview,
           "Workbench": read_workbench, "Blender": read_blender, "MeshLab": read_meshlab}


def available(every):
    """The readers that are installed; of those that are slow only if they are asked for."""
    there = {"h5py"}
    there |= {name for name in ("meshio", "nibabel") if subprocess.run([sys.executable, "-c", "import " + name],
                                                                      stderr=subprocess.DEVNULL).returncode == 0}
    slow = {"gmsh": "gmsh", "ParaView": "pvpython", "Workbench": "wb_command", "Blender": "blender", "MeshLab": "meshlabserver"}
    there |= {name for name, command in slow.items() if every and shutil.which(command)}
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


def check_textures(program):
    """Blender finds the map in its UV editor: of a surface with its map as texture coordinates, and of a result in MeshLab's way."""
    program.succeed("generate", "hills", "-n", 300, "-o", "scan.obj")
    for suffix in ("obj", "ply"):
        program.succeed("square", "scan.obj", "-o", f"uv_{suffix}.h5", "-uv", f"uv.{suffix}", "-quiet", codes=(0, 4))
    run_blender(program, ["uv.obj", "uv.ply"])
    for suffix in ("obj", "ply"):
        name = program.file(f"uv.{suffix}")
        with h5py.File(program.file(f"uv_{suffix}.h5")) as file:
            images, cells = file["/map/coordinates"][...], file["/mesh/cells"][...]
        assert (numbers_of(name, "f") == cells).all() and abs(numbers_of(name, "t").reshape(-1, 3, 2) - images[cells]).max() < 1e-5, name


def check_textures_in_meshlab(program):
    """MeshLab writes the texture coordinates again that it has found."""
    program.succeed("generate", "hills", "-n", 300, "-o", "scan.obj")
    program.succeed("square", "scan.obj", "-o", "st.h5", "-uv", "st.ply", "-quiet", codes=(0, 4))
    program.succeed("convert", run_meshlab(program.folder, program.file("st.ply")), "found.h5")
    with h5py.File(program.file("st.h5")) as file, h5py.File(program.file("found.h5")) as found:
        images, cells = file["/map/coordinates"][...], file["/mesh/cells"][...]
        assert abs(found["/cell/texcoord"][...].reshape(-1, 3, 2) - images[cells]).max() < 1e-6


def check_text(program):
    """The same as text, to the last digit; meshio finds values of vertices and faces."""
    program.succeed("generate", "head", "-n", 200, "-o", "scan.ply")
    program.succeed("sphere", "scan.ply", "-o", "image.h5,image.text.ply", "-quiet", codes=(0, 4))
    assert program.read("image.text.ply").startswith(b"ply\nformat ascii 1.0\n") and not program.read("scan.ply").startswith(b"ply\nformat ascii")
    program.succeed("convert", "image.text.ply", "again.h5")
    with h5py.File(program.file("image.h5")) as ours, h5py.File(program.file("again.h5")) as read:
        assert (read["/mesh/vertices"][...] == ours["/map/coordinates"][...]).all()
        assert (read["/cell/ratio"][...] == ours["/cell/ratio"][...]).all()
    if "meshio" in available(False):
        import meshio
        mesh = meshio.read(program.file("image.text.ply"))
        with h5py.File(program.file("image.h5")) as ours:
            assert (mesh.cell_data["ratio"][0] == ours["/cell/ratio"][...]).all()
            assert (mesh.point_data["vertex_ratio"] == ours["/vertex/ratio"][...]).all()


def check_quality(program, has_meshlab):
    """The ratio under the name by which MeshLab colours, and still under its own; MeshLab finds it."""
    program.succeed("generate", "head", "-n", 200, "-o", "scan.ply")
    program.succeed("sphere", "scan.ply", "-o", "image.h5,image.ply", "-quiet", codes=(0, 4))
    program.succeed("convert", "image.ply", "image.vtu")
    program.succeed("convert", "image.ply", "again.h5")
    with h5py.File(program.file("image.h5")) as ours, h5py.File(program.file("again.h5")) as read:
        for path, quality in (("/cell/ratio", "/cell/quality"), ("/vertex/vertex_ratio", "/vertex/quality")):
            assert abs(read[quality][...] - ours[path.replace("vertex_", "")][...]).max() < 1e-6
            assert (read[path][...] == ours[path.replace("vertex_", "")][...]).all()
    if has_meshlab:
        program.succeed("convert", run_meshlab(program.folder, program.file("image.ply")), "found.h5")
        with h5py.File(program.file("image.h5")) as ours, h5py.File(program.file("found.h5")) as found:
            assert abs(found["/cell/quality"][...] - ours["/cell/ratio"][...]).max() < 1e-6
            assert abs(found["/vertex/quality"][...] - ours["/vertex/ratio"][...]).max() < 1e-6


def main():
    every = sys.argv[2:] == ["all"]
    rows, there = table(), available(every)
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
        if "Blender" in there:
            run_blender(program, [file_name(kind, suffix) for kind, suffix, reader in wanted if reader == "Blender"])
            check_textures(program)
        check_text(program)
        check_quality(program, "MeshLab" in there)
        if "MeshLab" in there:
            check_textures_in_meshlab(program)
        for kind, suffix, reader in wanted:
            if reader in there:
                name = program.file(file_name(kind, suffix))
                check_same(f"{name} by {reader}", *read_h5py(program.file(kind + ".h5")), *READERS[reader](name))
                count += 1
    print(f"{len(rows)} formats, {count} of {len(wanted)} readings by {', '.join(sorted(there))}")
    assert len(rows) >= 14 and len(wanted) > 20


main()
