"""Surface and image of a result side by side in ParaView, coloured by the logarithm of the ratio, with one selection for both.

    pvpython show_in_paraview.py map.h5                     in a window
    pvpython show_in_paraview.py map.h5 -o picture.png      into a file (Debian's ParaView wants a display: xvfb-run in front)

In ParaView itself it is a macro (Macros, Import new macro) and takes the result that is selected in the pipeline browser. A
result is map.h5 with the .xmf files that are written beside it, or map.vtu with map.surface.vtu. Cells that are selected in
one of the views are selected in the other. Blue is shrunk, red is grown, magenta is folded.
"""
import argparse
import os
import sys

from paraview import servermanager, simple

FIELD = "log2 ratio"
LINK = "equimap cells"


def files_of(name):
    """The files of surface and image."""
    stem, suffix = os.path.splitext(name)
    for ending in (".surface", ".map"):
        stem = stem[:-len(ending)] if stem.endswith(ending) else stem
    pair = (stem + ".surface" + suffix, stem + suffix) if suffix in (".vtu", ".vtk") else (stem + ".xmf", stem + ".map.xmf")
    absent = [file for file in pair if not os.path.exists(file)]
    if absent:
        raise RuntimeError(f"{absent[0]} is not there: -o map.h5 writes map.xmf and map.map.xmf beside it, -o map.vtu map.surface.vtu")
    return pair


def read(name):
    """A file as a source of cells with the logarithm of their ratio; folded cells, whose ratio is negative, have none."""
    source = simple.XDMFReader(FileNames=[name]) if name.endswith(".xmf") else simple.OpenDataFile(name)
    simple.UpdatePipeline(proxy=source)
    if source.GetDataInformation().DataInformation.IsCompositeDataSet():
        source = simple.MergeBlocks(Input=source, MergePoints=0)
    log = simple.PythonCalculator(Input=source, ArrayAssociation="Cell Data", ArrayName=FIELD,
                                  Expression="numpy.log2(numpy.where(ratio > 0., ratio, numpy.nan))")
    simple.RenameSource(os.path.basename(name), log)
    simple.UpdatePipeline(proxy=log)
    return log


def limit_of(source):
    """Nineteen twentieths of the cells are within; a map that is better than one percent is nearly white."""
    from vtk.util.numpy_support import vtk_to_numpy
    import numpy
    values = numpy.abs(vtk_to_numpy(servermanager.Fetch(source).GetCellData().GetArray(FIELD)))
    values = values[numpy.isfinite(values)]
    return max(float(numpy.quantile(values, .95)) if len(values) else 0., .0144)


def is_flat(source):
    bounds = source.GetDataInformation().GetBounds()
    return bounds[4] == bounds[5]


def is_relief(source):
    """A surface whose normals have much in common with the z axis is looked at from above; others stand with y upward."""
    import numpy
    from vtk.util.numpy_support import vtk_to_numpy
    outside = simple.ExtractSurface(Input=source)
    data = servermanager.Fetch(outside)
    simple.Delete(outside)
    points = vtk_to_numpy(data.GetPoints().GetData())
    corners = points[vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return abs(normals.sum(axis=0)[2]) > .4 * numpy.linalg.norm(normals, axis=1).sum()


def aim(source, view):
    if is_flat(source):
        view.InteractionMode = "2D"
    simple.ResetCamera(view)
    camera = view.GetActiveCamera()
    if is_relief(source) and not is_flat(source):
        camera.Elevation(-40.)
    elif not is_flat(source):
        camera.Azimuth(25.)
        camera.Elevation(12.)
    camera.Zoom(1.15)


def show(source, view, limit, with_bar):
    display = simple.Show(source, view)
    simple.ColorBy(display, ("CELLS", FIELD))
    display.SetRepresentationType("Surface")
    display.Ambient, display.Diffuse = (1., 0.) if is_flat(source) else (.35, .65)
    colors = simple.GetColorTransferFunction(FIELD)
    colors.AutomaticRescaleRangeMode = "Never"  # the scale is that of both views
    colors.ApplyPreset("Cool to Warm", True)
    colors.RescaleTransferFunction(-limit, limit)
    colors.NanColor = (.9, 0., .9)
    if with_bar:
        bar = simple.GetScalarBar(colors, view)
        bar.TitleColor = bar.LabelColor = (0., 0., 0.)
        bar.TitleFontSize = bar.LabelFontSize = 10
        bar.ScalarBarThickness, bar.ScalarBarLength = 10, .25
        bar.WindowLocation = "Lower Right Corner"
    display.SetScalarBarVisibility(view, with_bar)
    view.UseColorPaletteForBackground = 0
    view.Background = (1., 1., 1.)
    aim(source, view)


def show_map(name):
    """The two views, surface and image."""
    surface, image = map(read, files_of(name))
    layout = simple.CreateLayout("equimap")
    views = [simple.CreateView("RenderView") for _ in range(2)]
    simple.AssignViewToLayout(view=views[0], layout=layout, hint=0)
    layout.SplitHorizontal(0, .5)
    simple.AssignViewToLayout(view=views[1], layout=layout, hint=2)
    limit = limit_of(surface)
    for source, view in zip((surface, image), views):
        show(source, view, limit, with_bar=view is views[-1])
    simple.AddSelectionLink(surface, image, LINK)
    return (surface, image), views, layout


def opened():
    """In ParaView's window: the file of the source that is active; None where there is none, as in pvpython."""
    source = simple.GetActiveSource()
    names = [getattr(source, name) for name in ("FileNames", "FileName") if source and hasattr(source, name)]
    if not names:
        return None
    simple.HideAll()
    return names[0] if isinstance(names[0], str) else names[0][0]


def main():
    name = opened()
    if name:
        show_map(name)
        return
    if len(sys.argv) < 2:  # not an exit: that would end ParaView
        raise RuntimeError("name a result, or open one (.xmf or .vtu) and select it in the pipeline browser")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    parser.add_argument("-o", metavar="FILE", help="save a picture")
    args = parser.parse_args()
    _, _, layout = show_map(args.result)
    if args.o:
        simple.SaveScreenshot(args.o, layout, ImageResolution=[1600, 800])
    else:
        simple.Interact()


if __name__ == "__main__":
    main()
