"""What a file has per vertex and cell goes with its mesh: through `convert` and into results, where the format can hold it; what
cannot go is said.

usage: test_fields.py PROGRAM [RANKS]
"""
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

# what comes back of a file with these fields, and what is said not to be in it
ALL = "thickness normal label group"
COPIES = {"copy.vtu": (ALL, ""), "copy.vtk": (ALL, ""), "copy.h5": (ALL, ""), "copy.ply": ("thickness label group", ""),
          "copy.msh": ("group", ""), "copy.surf.gii": ("", "label group"), "copy.obj": ("group", "thickness normal label"),
          "copy.mesh": ("group", "thickness normal label"), "copy.meshb": ("group", "thickness normal label"),
          "copy.off": ("", ALL), "copy.stl": ("", ALL)}

QUAD_PLY = """ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
property uchar red
property float quality
element face 2
property list uchar int vertex_indices
property float weight
end_header
0 0 0 10 .5
1 0 0 20 1.5
1 1 0 30 2.5
0 1 0 40 3.5
2 .5 0 255 4.5
4 0 1 2 3 7
3 1 4 2 9
"""

SCALARS_VTK = """# vtk DataFile Version 3.0
t
ASCII
DATASET POLYDATA
POINTS 4 float
0 0 0 1 0 0 1 1 0 0 1 0
LINES 1 3
2 0 1
POLYGONS 2 8
3 0 1 2
3 0 2 3
CELL_DATA 3
SCALARS material int
LOOKUP_TABLE default
-1 5 6
POINT_DATA 4
VECTORS speed float
0 0 1 0 0 2 0 0 3 0 0 4
FIELD FieldData 1
heat 1 4 double
.25 .5 .75 1
"""

LINES_VTP = """<VTKFile type="PolyData" version="0.1"><PolyData><Piece NumberOfPoints="4" NumberOfLines="1" NumberOfPolys="2">
<PointData><DataArray type="Float32" Name="heat" format="ascii">1 2 3 4</DataArray>
<DataArray type="String" Name="text" format="ascii">97 0 98 0</DataArray></PointData>
<CellData><DataArray type="Int32" Name="material" format="ascii">-1 5 6</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
<Lines><DataArray type="Int32" Name="connectivity" format="ascii">0 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">2</DataArray></Lines>
<Polys><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 0 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">3 6</DataArray></Polys></Piece></PolyData></VTKFile>
"""

TEXTURED_OBJ = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 2 0.5 0.25
vn 0 0 1
vt 0 0
vt .5 0
vt .5 1
vt 0 1
vt 1 .5
vt .6 1
f 1/1 2/2 3/3 4/4
g left side
f 2/2 5/5 3/6
"""

ENTITIES_MSH = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 4 "rim"
2 7 "upper half"
$EndPhysicalNames
$Entities
1 1 2 0
1 0 0 0 0
1 0 0 0 1 0 0 1 4 1 1
5 0 0 0 1 1 0 1 7 1 1
6 0 0 0 1 1 0 0 1 1
$EndEntities
$Nodes
1 4 1 4
2 5 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
2 2 1 2
2 6 2 1
1 1 2 3
2 5 2 1
2 1 3 4
$EndElements
"""


def fields_of(program, name):
    """All fields of an .h5 by name."""
    with h5py.File(program.file(name), "r") as file:
        return {field: values[...] for group in ("vertex", "cell") for field, values in file.get(group, {}).items()}


def converted(program, source, target="back.h5"):
    """What `convert` prints."""
    return program.succeed("convert", source, target).stdout


def check_round_trips(program, fields):
    for name, (held, dropped) in COPIES.items():
        said = converted(program, "mesh.h5", name).partition("note: not in ")[2].partition(" of ")[0]
        assert sorted(said.replace(",", "").split()[1:]) == sorted(dropped.split()), (name, said)
        said = converted(program, name).partition("note: left out: ")[2]
        assert said.startswith("$NodeData, $ElementData") == (name == "copy.msh"), (name, said)
        back = fields_of(program, "back.h5")
        for field in held.split():
            assert numpy.array_equal(back[field], fields[field]), (name, field)
    assert os.path.exists(program.file("copy.shape.gii"))


def check_other_readers(program, fields):
    try:
        import meshio
    except ImportError:
        return
    mesh = meshio.read(program.file("copy.vtu"))
    assert numpy.array_equal(mesh.point_data["normal"], fields["normal"])
    assert numpy.array_equal(mesh.cell_data["label"][0].ravel(), fields["label"])
    mesh = meshio.read(program.file("copy.msh"))
    assert numpy.array_equal(mesh.cell_data["gmsh:physical"][0], fields["group"])
    mesh = meshio.read(program.file("copy.mesh"))
    assert numpy.array_equal(mesh.cell_data["medit:ref"][0], fields["group"])


def check_kinds(program):
    """Fields as the formats have them: of polygons, beside lines, attributes of legacy VTK."""
    program.write("quad.ply", QUAD_PLY)
    converted(program, "quad.ply")
    back = fields_of(program, "back.h5")
    assert list(back["weight"]) == [7, 7, 9] and list(back["red"]) == [10, 20, 30, 40, 255] and back["quality"][4] == 4.5
    converted(program, "quad.ply", "again.ply")
    header = program.read("again.ply").partition(b"end_header")[0].decode()
    assert "property uchar red" in header and "property double quality" in header, header
    converted(program, "again.ply")
    assert list(fields_of(program, "back.h5")["red"]) == [10, 20, 30, 40, 255]
    program.write("scalars.vtk", SCALARS_VTK)
    program.write("lines.vtp", LINES_VTP)
    for name in ("scalars.vtk", "lines.vtp"):
        printed = converted(program, name)
        back = fields_of(program, "back.h5")
        assert list(back["material"]) == [5, 6], (name, back)
        assert ("left out: text" in printed) == (name == "lines.vtp"), printed
    converted(program, "scalars.vtk")
    back = fields_of(program, "back.h5")
    assert list(back["heat"]) == [.25, .5, .75, 1] and list(back["speed"][:, 2]) == [1, 2, 3, 4]


def check_groups(program):
    """Groups of OBJ and Gmsh with their names, texture coordinates with their seams."""
    program.write("textured.obj", TEXTURED_OBJ)
    printed = converted(program, "textured.obj", "copy.obj")
    assert "left out: normals of textured.obj" in printed and "cut into triangles" in printed, printed
    converted(program, "copy.obj", "via.h5")
    back = fields_of(program, "via.h5")
    assert list(back["group"]) == [0, 0, 1] and back["texcoord"].shape == (3, 6)
    assert list(back["texcoord"][2]) == [.5, 0, 1, .5, .6, 1], back["texcoord"]
    converted(program, "via.h5", "last.obj")
    assert program.read("last.obj") == program.read("copy.obj") and b"g left side" in program.read("last.obj")
    program.write("entities.msh", ENTITIES_MSH)
    converted(program, "entities.msh", "old.msh")
    text = program.read("old.msh").decode()
    assert '2 7 "upper half"' in text and "rim" not in text, text
    assert "1 2 2 0 1 1 2 3" in text and "2 2 2 7 7 1 3 4" in text, text
    converted(program, "old.msh", "named.obj")
    assert b"g upper half\nf 1 3 4" in program.read("named.obj")


def check_results(program, fields):
    """Into results: fields of the input beside the map's own, those of an older map replaced, and no texture in an image."""
    program.succeed("disk", "mesh.h5", "-o", "map.h5,map.vtu,map.obj", "-max_it", 2, "-quiet", codes=(0, 4))
    result = fields_of(program, "map.h5")
    for field, values in fields.items():
        assert numpy.array_equal(result[field], values), field
    assert "quasi_conformal" in result
    for name in ("map.xmf", "map.map.xmf", "map.vtu", "map.surface.vtu"):
        assert b'Name="thickness"' in program.read(name) and b'Name="label"' in program.read(name), name
    printed = program.succeed("disk", "map.h5", "-o", "again.h5,again.vtu", "-max_it", 3, "-quiet", codes=(0, 4)).stdout
    assert "note" not in printed, printed
    again = fields_of(program, "again.h5")
    assert set(again) == set(result) and not numpy.array_equal(again["quasi_conformal"], result["quasi_conformal"])
    assert program.read("again.vtu").count(b'Name="ratio"') == 1
    printed = converted(program, "map.h5", "fine.vtu") and program.succeed("convert", "map.h5", "fine.vtu", "-refine", 1).stdout
    assert "fields, as it is another mesh now" in printed, printed
    program.succeed("disk", "mesh.h5", "-o", "map.h5", "-uv", "textured.obj", "-max_it", 1, "-quiet", codes=(0, 4))
    printed = program.succeed("disk", "textured.obj", "-o", "t.h5,t.obj", "-max_it", 1, "-quiet", codes=(0, 4)).stdout
    assert "not in t.obj: texcoord of textured.obj" in printed and b"vt" not in program.read("t.obj"), printed
    assert "texcoord" in fields_of(program, "t.h5")


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 300, "-o", "mesh.h5")
        random = numpy.random.RandomState(3)
        with h5py.File(program.file("mesh.h5"), "r+") as file:
            num_vertices, num_cells = len(file["mesh/vertices"]), len(file["mesh/cells"])
            fields = {"thickness": random.rand(num_vertices), "normal": random.rand(num_vertices, 3),
                      "label": random.rand(num_cells), "group": random.randint(0, 5, num_cells).astype(float)}
            for name, values in fields.items():
                file[("vertex/" if len(values) == num_vertices else "cell/") + name] = values
            file["vertex/short"] = numpy.zeros(3)  # belongs to no vertex: left alone
        check_round_trips(program, fields)
        check_other_readers(program, fields)
        check_kinds(program)
        check_groups(program)
        check_results(program, fields)


if __name__ == "__main__":
    main()
