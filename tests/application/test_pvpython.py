"""Open the .xmf beside a result in ParaView and find both grids with their points, cells and fields.

usage: pvpython tests/application/test_pvpython.py RESULT.xmf VERTICES CELLS
   or: python3  tests/application/test_pvpython.py EQUIMAP   (makes a result first, then calls pvpython on it)
Exit code 77 (skipped) without ParaView.
"""
import os
import shutil
import subprocess
import sys
import tempfile


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

    for source in (XDMFReader(FileNames=[path]), Xdmf3ReaderT(FileName=[path])):
        UpdatePipeline(proxy=source)
        data = servermanager.Fetch(source)
        assert data.GetClassName() == "vtkMultiBlockDataSet", data.GetClassName()
        names = [data.GetMetaData(k).Get(data.NAME()) for k in range(data.GetNumberOfBlocks())]
        assert names == ["mesh", "map"], names
        for k in range(2):
            check_grid(data.GetBlock(k), vertices, cells)
        _, high = data.GetBlock(1).GetPoints().GetData().GetRange(-1)
        assert 0.99 < high < 1.01, high  # the farthest point of the disk
    source = OpenDataFile(path)
    UpdatePipeline(proxy=source)
    assert servermanager.Fetch(source).GetNumberOfPoints() == 2 * vertices
    print(f"pvpython: {vertices} points, {cells} cells, fields found in both grids")


def make_and_look(equimap):
    pvpython = shutil.which("pvpython")
    if pvpython is None:
        print("skipped: no pvpython (Debian: paraview)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        mesh, result = os.path.join(folder, "cap.obj"), os.path.join(folder, "cap.h5")
        quiet = {"check": True, "stdout": subprocess.DEVNULL}
        subprocess.run([equimap, "generate", "cap", "-n", "2000", "-o", mesh], **quiet)
        subprocess.run([equimap, "disk", mesh, "-o", result], **quiet)
        with open(mesh) as lines:
            kinds = [line[:2] for line in lines]
        counts = [str(kinds.count(kind)) for kind in ("v ", "f ")]
        script = os.path.abspath(__file__)
        xmf = os.path.join(folder, "cap.xmf")
        return subprocess.run([pvpython, "--force-offscreen-rendering", script, xmf, *counts]).returncode


if __name__ == "__main__":
    if len(sys.argv) == 4:
        look(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
    elif len(sys.argv) == 2:
        sys.exit(make_and_look(sys.argv[1]))
    else:
        sys.exit(__doc__)
