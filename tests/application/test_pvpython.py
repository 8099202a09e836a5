"""Open the .xmf files beside a result in ParaView and find mesh and image with their points, cells and fields.

usage: python3 test_pvpython.py EQUIMAP [RANKS]
Exit code 77 (skipped) without ParaView, whose Python runs this file again to look at the result.
"""
import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import launcher


def check_grid(grid, vertices, cells):
    assert grid.GetNumberOfPoints() == vertices, grid.GetNumberOfPoints()
    assert grid.GetNumberOfCells() == cells, grid.GetNumberOfCells()
    ratio = grid.GetCellData().GetArray("ratio")
    assert ratio is not None and ratio.GetNumberOfTuples() == cells
    assert grid.GetPointData().GetArray("vertex_ratio").GetNumberOfTuples() == vertices
    low, high = ratio.GetRange()
    assert 0.0 < low <= 1.0 <= high < 10.0, (low, high)


def look(path, vertices, cells):
    """Runs inside pvpython: each of ParaView's two generations of XDMF readers, and the one it takes by itself."""
    from paraview import servermanager
    from paraview.simple import OpenDataFile, UpdatePipeline, XDMFReader, Xdmf3ReaderT

    for name, other in ((path, "map"), (path.replace(".xmf", ".map.xmf"), "mesh")):
        for source in (XDMFReader(FileNames=[name]), Xdmf3ReaderT(FileName=[name]), OpenDataFile(name)):
            UpdatePipeline(proxy=source)
            data = servermanager.Fetch(source)
            grid = data.GetBlock(0) if data.IsA("vtkMultiBlockDataSet") else data
            check_grid(grid, vertices, cells)
            assert grid.GetPointData().GetArray(other).GetNumberOfTuples() == vertices
        _, high = grid.GetPoints().GetData().GetRange(-1)
        assert other == "map" or 0.99 < high < 1.01, high  # the farthest point of the disk
    print(f"pvpython: {vertices} points, {cells} cells, fields found in mesh and image")


def make_and_look(equimap, ranks):
    pvpython = shutil.which("pvpython")
    if pvpython is None:
        print("skipped: no pvpython (Debian: paraview, python3-paraview)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        mesh, result = os.path.join(folder, "cap.obj"), os.path.join(folder, "cap.h5")
        subprocess.run([equimap, "generate", "cap", "-n", "2000", "-o", mesh], check=True, stdout=subprocess.DEVNULL)
        run = subprocess.run([*launcher(int(ranks)), equimap, "disk", mesh, "-o", result], stdout=subprocess.DEVNULL)
        assert run.returncode in (0, 4), run.returncode  # 4: not converged, map written
        with open(mesh) as lines:
            kinds = [line[:2] for line in lines]
        counts = [str(kinds.count(kind)) for kind in ("v ", "f ")]
        look_again = [pvpython, "--force-offscreen-rendering", os.path.abspath(__file__), "look"]
        return subprocess.run([*look_again, os.path.join(folder, "cap.xmf"), *counts]).returncode


if __name__ == "__main__":
    if sys.argv[1] == "look":
        look(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
    else:
        sys.exit(make_and_look(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "1"))
