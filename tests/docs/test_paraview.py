"""examples/show_in_paraview.py: surface and image in two views, coloured by the logarithm of the ratio, one selection for both.

usage: python3 test_paraview.py EQUIMAP
Exit code 77 (skipped) without pvpython or xvfb-run. pvpython runs this file again to look at what the example has made.
"""
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "examples")


def field_of(source):
    from paraview import servermanager
    from vtk.util.numpy_support import vtk_to_numpy
    return vtk_to_numpy(servermanager.Fetch(source).GetCellData().GetArray("log2 ratio"))


def check_pair(name, example):
    """Both views show the field with one colour scale; what is selected in one is selected in the other."""
    import h5py
    import numpy
    from paraview import simple
    (surface, image), views, layout = example.show_map(name)
    with h5py.File(os.path.join(os.path.dirname(name), "map.h5")) as file:
        ratio, points = file["/cell/ratio"][:], file["/map/coordinates"][:]
    for source in (surface, image):
        values = field_of(source)
        assert ratio[7] < 0. and numpy.isnan(values[7]) == (not name.endswith(".vtu")), values[7]
        assert numpy.allclose(numpy.delete(values, 7), numpy.log2(numpy.delete(ratio, 7)), atol=1e-6)
    bounds = image.GetDataInformation().GetBounds()
    assert abs(bounds[1] - points[:, 0].max()) < 1e-6 and set(simple.GetViewsInLayout(layout)) == set(views)
    for source, view in zip((surface, image), views):
        display = simple.GetRepresentation(source, view)
        assert display.Visibility == 1 and display.ColorArrayName[:] == ["CELLS", "log2 ratio"], display.ColorArrayName
    colors = simple.GetColorTransferFunction("log2 ratio").RGBPoints
    assert colors[0] == -colors[-4] < -.0143, colors
    simple.SetActiveSource(surface)
    simple.QuerySelect(QueryString="(id == 3)", FieldType="CELL", Source=surface)
    assert image.SMProxy.GetSelectionInput(0) is not None, "the selection is not linked"
    simple.RemoveLayout(layout)


def look(folder):
    """Inside pvpython."""
    sys.path.insert(0, EXAMPLES)
    import show_in_paraview
    for name in ("map.h5", "map.xmf", "map.map.xmf", "map.vtu", "map.surface.vtu"):
        check_pair(os.path.join(folder, name), show_in_paraview)
    try:
        show_in_paraview.show_map(os.path.join(folder, "absent.h5"))
    except RuntimeError as problem:
        assert "is not there" in str(problem)
    else:
        raise AssertionError("a result that is not there is shown")
    print("pvpython: both views, one scale, one selection")


def fold(folder):
    """A folded cell, in the result and so in the .xmf files that speak of it."""
    import h5py
    with h5py.File(os.path.join(folder, "map.h5"), "r+") as file:
        file["/cell/ratio"][7] = -.5


def main():
    if not (shutil.which("pvpython") and shutil.which("xvfb-run")):
        print("skipped: no pvpython (Debian: paraview, python3-paraview) or no xvfb-run (xvfb, xauth)")
        return 77
    equimap = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        for command in ("generate hills -n 900 -o scan.obj", "disk scan.obj -o map.h5,map.vtu -balance .01 -quiet"):
            subprocess.run([equimap, *command.split()], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        fold(folder)
        window = ["xvfb-run", "-a", "pvpython"]
        subprocess.run([*window, os.path.abspath(__file__), "look", folder], check=True, timeout=300)
        subprocess.run([*window, os.path.join(EXAMPLES, "show_in_paraview.py"), "map.h5", "-o", "map.png"], cwd=folder, check=True, timeout=300)
        assert os.path.getsize(os.path.join(folder, "map.png")) > 20000
    return 0


if __name__ == "__main__":
    if sys.argv[1] == "look":
        look(sys.argv[2])
    else:
        sys.exit(main())
