"""Surfaces in OBJ files, and the same surfaces in another order."""
import numpy


def read_obj(path):
    with open(path) as stream:
        rows = [line.split() for line in stream]
    vertices = [[float(word) for word in row[1:4]] for row in rows if row and row[0] == "v"]
    cells = [[int(word.split("/")[0]) - 1 for word in row[1:4]] for row in rows if row and row[0] == "f"]
    return numpy.array(vertices), numpy.array(cells)


def write_obj(program, name, vertices, cells):
    """Arrays or lists of rows; cells count from 0."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in numpy.asarray(vertices, float).tolist()]
    lines += [f"f {i + 1} {j + 1} {k + 1}" for i, j, k in numpy.asarray(cells).tolist()]
    program.write(name, "\n".join(lines) + "\n")


def renumber(vertices, cells, seed):
    """The same mesh with vertices and cells renumbered and cells begun at other corners; the new numbers of the vertices."""
    random = numpy.random.RandomState(seed)
    place = random.permutation(len(vertices))
    moved = numpy.empty_like(vertices)
    moved[place] = vertices
    return moved, numpy.array([numpy.roll(cell, random.randint(3)) for cell in place[cells[random.permutation(len(cells))]]]), place
