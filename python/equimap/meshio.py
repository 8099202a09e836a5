"""Our HDF5 files in meshio: `import equimap.meshio` registers the format "equimap" for the suffix .h5.

meshio asks no installed package for formats of its own accord, so that the import is what it takes; in its command line
tools the format is not known.

Read are the mesh, fields per vertex (point_data) and per cell (cell_data), the image of each vertex as the point data "map",
and the attributes (info). Written are the mesh and those data, under vertex/ and cell/."""
import meshio
import numpy

from .files import arrays_of, read_hdf5, write

KINDS = {3: "triangle", 4: "tetra"}


def load(name):
    """A meshio mesh of one of our files: with meshio.read(name) after the import."""
    result = read_hdf5(name)
    vertex, cell = {}, {}
    for path, values in {**result.fields, "cell/ratio": result.ratio, "vertex/ratio": result.vertex_ratio}.items():
        group, _, field = path.partition("/")
        if group == "vertex" and values is not None and len(values) == len(result.vertices):
            vertex[field] = values
        elif group == "cell" and values is not None and len(values) == len(result.cells):
            cell[field] = [values]
    if result.map is not None:
        flat = result.map.shape[1] == 2  # meshio's formats want vectors of three
        vertex["map"] = numpy.column_stack([result.map, numpy.zeros(len(result.map))]) if flat else result.map
    mesh = meshio.Mesh(result.vertices, [(KINDS[result.cells.shape[1]], result.cells)], point_data=vertex, cell_data=cell)
    mesh.info = result.attributes
    return mesh


def save(name, mesh):
    """One of our files of a meshio mesh: with mesh.write(name) after the import."""
    kind = KINDS[arrays_of(mesh)[1].shape[1]]
    fields = {"vertex/" + field: values for field, values in mesh.point_data.items() if field != "map"}
    if "map" in mesh.point_data:
        image = mesh.point_data["map"]
        flat = kind == "triangle" and not image[:, 2:].any()
        fields["map/coordinates"] = image[:, :2] if flat else image
    for field, blocks in mesh.cell_data_dict.items():
        if kind in blocks:
            fields["cell/" + field] = blocks[kind]
    write(name, mesh, fields)


meshio.register_format("equimap", [".h5"], load, {"equimap": save})
