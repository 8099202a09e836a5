"""Files that are more than a mesh of triangles: packed by gzip, with faces of more corners, described by XDMF; and a surface
that is filled.

usage: python3 test_reading.py EQUIMAP [RANKS]
"""
import gzip
import os
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scans"))
import made
from meshes import read_obj
from program import run_in_folder


def check_gzip(program):
    """As unpacked, whatever the format and name; of several members; damaged: refused."""
    program.succeed("generate", "hills", "-n", "300", "-o", "hills.gii")
    program.succeed("convert", "hills.gii", "plain.obj")
    packed = gzip.compress(program.read("hills.gii"))
    half = len(program.read("plain.obj")) // 2
    program.write("hills.gii.gz", packed)
    program.write("parts.gz", gzip.compress(program.read("plain.obj")[:half]) + gzip.compress(program.read("plain.obj")[half:]))
    for name in ("hills.gii.gz", "parts.gz"):
        program.succeed("convert", name, "again.obj")
        assert program.read("again.obj") == program.read("plain.obj"), name
    for damaged in (packed[:-40], packed[:200] + b"????" + packed[204:]):
        program.write("bad.gii.gz", damaged)
        assert "gzip" in program.succeed("check", "bad.gii.gz", codes=(6,)).stderr


def check_polygons(program):
    """Results per face of the file, and a texture for the faces as they were."""
    program.write("quads.obj", made.FILES["face_quads.obj"]())
    program.succeed("disk", "quads.obj", "-o", "quads.h5", "-uv", "quads.uv.obj", "-quiet")
    faces = [[int(word.split("/")[0]) for word in line.split()[1:]] for line in program.read("quads.obj").decode().splitlines() if line[0] == "f"]
    written = [[int(word.split("/")[0]) for word in line.split()[1:]] for line in program.read("quads.uv.obj").decode().splitlines() if line[0] == "f"]
    assert len(faces) == len(written) and {len(face) for face in faces} == {4, 5}
    for face, other in zip(faces, written):
        turned = other.index(face[0])
        assert other[turned:] + other[:turned] == face, (face, other)
    with h5py.File(program.file("quads.h5")) as file:
        polygon, ratio, mean = file["cell/polygon"][:].astype(int), file["cell/ratio"][:], file["polygon/ratio"][:]
        corners = file["mesh/vertices"][:][file["mesh/cells"][:]]
    assert (polygon == numpy.repeat(numpy.arange(len(faces)), [len(face) - 2 for face in faces])).all()
    area = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    expected = numpy.bincount(polygon, area * ratio) / numpy.bincount(polygon, area)
    assert abs(mean - expected).max() < 1e-12


def check_xdmf(program):
    """What ParaView opens opens here: arrays of an HDF5 file or in the text, with fields."""
    program.succeed("generate", "hills", "-n", "300", "-o", "hills.h5")
    program.succeed("disk", "hills.h5", "-o", "map.h5", "-quiet")
    program.succeed("convert", "map.xmf", "surface.obj")
    program.succeed("convert", "hills.h5", "hills.obj")
    points, cells = read_obj(program.file("hills.obj"))
    again, same = read_obj(program.file("surface.obj"))
    assert abs(points - again).max() < 1e-15 and (cells == same).all()
    program.succeed("convert", "map.xmf", "fields.h5")
    with h5py.File(program.file("fields.h5")) as file, h5py.File(program.file("map.h5")) as other:
        assert (file["cell/ratio"][:] == other["cell/ratio"][:]).all()
    text = (f'<?xml version="1.0"?>\n<Xdmf Version="3.0"><Domain><Grid Name="g"><Geometry GeometryType="XY"><DataItem DataType="Float" Dimensions="4 2" '
            'Format="XML">0 0 1 0 1 1 0 1</DataItem></Geometry><Topology TopologyType="Triangle" NumberOfElements="2"><DataItem '
            'DataType="Int" Dimensions="2 3" Format="XML">0 1 2 0 2 3</DataItem></Topology><Attribute Name="weight" Center="Cell">'
            '<DataItem Dimensions="2" Format="XML">0.5 2.5</DataItem></Attribute></Grid></Domain></Xdmf>')
    program.write("flat.xdmf", text)
    program.succeed("convert", "flat.xdmf", "flat.h5")
    with h5py.File(program.file("flat.h5")) as file:
        assert file["mesh/vertices"][:].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        assert file["mesh/cells"][:].tolist() == [[0, 1, 2], [0, 2, 3]] and file["cell/weight"][:].tolist() == [0.5, 2.5]
    for old, new, words in (("Triangle", "Hexahedron", "Hexahedron"), ("0 2 3<", "0 2 9<", "out of range"), (' Format="XML">0 0', ' Format="HDF">gone.h5:/x', "gone.h5"),
                            ("<Topology", "<Nothing", "Topology"), ("0 1 2 0 2 3", "0 1 2 0 2", "number 5 of 6"), ("0 2 3<", "0 2 .5<", "whole number"),
                            ('"2 3"', '"2000000000 3"', "too short"), ('"4 2"', '"2000000000 2000000000 2000000000"', "too many"),
                            ('"2 3" Format="XML">0 1 2 0 2 3', '"2000000000 3" Format="HDF">map.h5:/mesh/cells', "numbers that the XDMF file says")):
        assert old in text
        program.write("bad.xdmf", text.replace(old, new))
        result = program.succeed("check", "bad.xdmf", codes=(3, 6))
        assert words in result.stderr and len(program.messages(result)) == 1, result.stderr


def check_fill(program):
    """A solid within a surface, where the program was built with TetGen; else it says so before the work."""
    program.write("head.white", made.FILES["head.white"]())
    result = program.run("convert", "head.white", "solid.h5", "-fill")
    if result.returncode == 2:
        assert "EQUIMAP_TETGEN" in result.stderr and not os.path.exists("solid.h5")
        return
    assert result.returncode == 0, result.stderr
    program.succeed("convert", "solid.h5", "skin.obj", "-boundary")
    program.succeed("convert", "head.white", "head.obj")
    points, cells = read_obj(program.file("head.obj"))
    skin, triangles = read_obj(program.file("skin.obj"))
    assert (skin == points).all() and {frozenset(c) for c in triangles.tolist()} == {frozenset(c) for c in cells.tolist()}
    assert "ready for ball" in program.succeed("check", "solid.h5").stdout
    assert "one closed surface" in program.succeed("convert", "hills.obj", "x.h5", "-fill", codes=(3,)).stderr


def main(program):
    check_gzip(program)
    check_polygons(program)
    check_xdmf(program)
    check_fill(program)
    print("reading: gzip, polygons, XDMF, and a surface filled")


if __name__ == "__main__":
    run_in_folder(main)
