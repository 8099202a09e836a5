"""FreeSurfer's and GIFTI's files as the programs of the neurosciences have them: geometry of the volume and anatomical
structure are kept, a sphere has the radius 100 in FreeSurfer's file, a surface two arrays and its shapes a file of their own.

usage: test_brains.py PROGRAM [RANKS]

nibabel reads what was written, and Connectome Workbench, where they are installed.
"""
import base64
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree
import zlib

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

FOOTER = numpy.array([2, 0, 20], ">i4").tobytes() + (
    b"valid = 1  # volume info valid\nfilename = vol.mgz\nvolume = 256 256 256\nvoxelsize = 1.000000000000000e+00 1 1\n"
    b"xras   = -1 0 0\nyras   = 0 0 -1\nzras   = 0 1 0\ncras   = 5 6 7\n")


def read_surface(path):
    """Vertices, triangles and what stands behind them."""
    with open(path, "rb") as stream:
        content = stream.read()
    assert content[:3] == b"\xff\xff\xfe"
    begin = content.index(b"\n\n") + 2
    vertices, triangles = numpy.frombuffer(content, ">i4", 2, begin)
    points = numpy.frombuffer(content, ">f4", 3 * vertices, begin + 8).reshape(-1, 3)
    corners = numpy.frombuffer(content, ">i4", 3 * triangles, begin + 8 + 12 * vertices).reshape(-1, 3)
    return points, corners, content[begin + 8 + 12 * (vertices + triangles):]


def read_gifti(path):
    """Per array its intent, its numbers, its metadata."""
    arrays = []
    root = tree.parse(path).getroot()
    for array in root.iter("DataArray"):
        kind = {"NIFTI_TYPE_FLOAT32": "<f4", "NIFTI_TYPE_INT32": "<i4"}[array.get("DataType")]
        numbers = numpy.frombuffer(zlib.decompress(base64.b64decode(array.find("Data").text)), kind)
        entries = {entry.find("Name").text: entry.find("Value").text for entry in array.iter("MD")}
        arrays.append((array.get("Intent"), numbers, entries))
    assert int(root.get("NumberOfDataArrays")) == len(arrays)
    return arrays


def check_freesurfer(program, result):
    """From lh.white to lh.sphere and a file of areal distortion."""
    white, cells, _ = read_surface(program.file("lh.white"))
    points, corners, footer = read_surface(program.file("lh.sphere"))
    assert numpy.array_equal(corners, cells) and footer == FOOTER, footer
    assert numpy.array_equal(points, (100 * result["/map/coordinates"][...]).astype("f4")) or abs(
        points - 100 * result["/map/coordinates"][...]).max() < 1e-5
    assert abs(numpy.linalg.norm(points, axis=1) - 100).max() < 1e-4
    curvature = program.read("lh.areal.curv")
    assert curvature[:3] == b"\xff\xff\xff" and list(numpy.frombuffer(curvature, ">i4", 3, 3)) == [len(white), len(cells), 1]
    factor = result["/vertex/conformal_factor"][...] / numpy.log(2)
    assert abs(numpy.frombuffer(curvature, ">f4", -1, 15) - factor).max() < 1e-6
    refused = program.run("disk", "lh.areal.curv", "-o", "no.h5")
    assert refused.returncode == 6 and "lh.white" in refused.stderr, refused
    refused = program.run("convert", "lh.white", "other.curv")
    assert refused.returncode == 2 and "areal distortion" in refused.stderr, refused
    program.succeed("convert", "lh.white", "copy.white")
    assert all(numpy.array_equal(a, b) for a, b in zip(read_surface(program.file("copy.white"))[:2], (white, cells)))


def check_gifti(program, result):
    """Two arrays, shapes beside them; structure and space of the input."""
    (intent, points, entries), (second, corners, _) = read_gifti(program.file("lh.sphere.surf.gii"))
    assert (intent, second) == ("NIFTI_INTENT_POINTSET", "NIFTI_INTENT_TRIANGLE")
    assert entries == {"AnatomicalStructurePrimary": "CortexLeft", "GeometricType": "Spherical"}, entries
    assert abs(points.reshape(-1, 3) - result["/map/coordinates"][...]).max() < 1e-6
    assert numpy.array_equal(corners.reshape(-1, 3), result["/mesh/cells"][...])
    shapes = {entries["Name"]: numbers for _, numbers, entries in read_gifti(program.file("lh.sphere.shape.gii"))}
    assert set(shapes) == {"vertex_ratio", "areal_distortion_log2"}
    factor = result["/vertex/conformal_factor"][...] / numpy.log(2)
    assert abs(shapes["areal_distortion_log2"] - factor).max() < 1e-6
    program.succeed("convert", "lh.white", "plain.surf.gii")
    assert "AnatomicalStructurePrimary" not in read_gifti(program.file("plain.surf.gii"))[0][2]
    text = program.read("plain.surf.gii").decode()
    text = text.replace("NIFTI_XFORM_UNKNOWN", "NIFTI_XFORM_TALAIRACH").replace("1 0 0 0 0 1 0 0", "1 0 0 9 0 1 0 8").replace(
        "<MD>", "<MD><Name>AnatomicalStructurePrimary</Name><Value>CortexRight</Value></MD><MD>", 1)
    program.write("right.gii", text)
    program.succeed("sphere", "right.gii", "-o", "out.surf.gii", "-max_it", 1, "-quiet", codes=(0, 4))
    kept = program.read("out.surf.gii").decode()
    for words in ("NIFTI_XFORM_TALAIRACH", "1 0 0 9 0 1 0 8", "CortexRight"):
        assert words in kept, (words, kept[:2000])


def check_nibabel(program, result):
    """An independent reader of both."""
    try:
        import nibabel
    except ImportError:
        return
    points, cells, volume = nibabel.freesurfer.read_geometry(program.file("lh.sphere"), read_metadata=True)
    assert list(volume["cras"]) == [5, 6, 7] and numpy.array_equal(cells, result["/mesh/cells"][...])
    assert len(nibabel.freesurfer.read_morph_data(program.file("lh.areal.curv"))) == len(points)
    image = nibabel.load(program.file("lh.sphere.surf.gii"))
    assert len(image.darrays) == 2 and numpy.array_equal(image.agg_data("triangle"), cells)


def check_workbench(program):
    """Workbench computes the same distortion from the two surfaces, but for the constant of their sizes."""
    if not shutil.which("wb_command"):
        return
    program.succeed("convert", "lh.white", "lh.white.surf.gii")
    subprocess.run(["wb_command", "-surface-distortion", "lh.white.surf.gii", "lh.sphere.surf.gii", "wb.shape.gii"],
                   cwd=program.folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    import nibabel
    theirs = nibabel.load(program.file("wb.shape.gii")).darrays[0].data
    ours = read_gifti(program.file("lh.sphere.shape.gii"))[1][1]
    difference = theirs - ours
    assert difference.std() < 1e-5, difference.std()


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "head", "-n", 500, "-o", "lh.white", ranks=1)
        program.write("lh.white", program.read("lh.white") + FOOTER)
        program.succeed("sphere", "lh.white", "-o", "s.h5,lh.sphere,lh.areal.curv,lh.sphere.surf.gii", "-max_it", 3, "-quiet", codes=(0, 4))
        with h5py.File(program.file("s.h5"), "r") as result:
            check_freesurfer(program, result)
            check_gifti(program, result)
            check_nibabel(program, result)
        check_workbench(program)


if __name__ == "__main__":
    main()
