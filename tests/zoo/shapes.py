"""Meshes that are hard in one way each: name -> (vertices, cells), made from a few lines of arithmetic."""
import numpy

PI = numpy.pi


# ---- surfaces with a boundary

def grid(columns, rows, keep=lambda i, j: True, width=1.0, height=1.0):
    """Small squares of two triangles each, where they are wanted."""
    points = [(width * i / (columns - 1), height * j / (rows - 1), 0.0) for j in range(rows) for i in range(columns)]
    cells = []
    for j in range(rows - 1):
        for i in range(columns - 1):
            a = j * columns + i
            if keep(i, j):
                cells += [(a, a + 1, a + columns + 1), (a, a + columns + 1, a + columns)]
    return used(points, cells)


def used(points, cells):
    """Without the vertices that no cell has."""
    numbers = sorted({v for cell in cells for v in cell})
    place = {v: k for k, v in enumerate(numbers)}
    return [points[v] for v in numbers], [tuple(place[v] for v in cell) for cell in cells]


def fan(count, apex=0.0, radius=lambda angle: 1.0):
    """Triangles round one vertex."""
    angles = [2 * PI * k / count for k in range(count)]
    points = [(0.0, 0.0, apex)] + [(radius(a) * numpy.cos(a), radius(a) * numpy.sin(a), 0.0) for a in angles]
    return points, [(0, 1 + k, 1 + (k + 1) % count) for k in range(count)]


def wheel(count, rings, twist=0.0):
    """Rings of vertices round one, each turned by `twist` spokes: a mesh with all symmetries of a wheel."""
    angle = lambda r, k: 2 * PI * (k + twist * r) / count
    points = [(0.0, 0.0, 0.0)]
    points += [(r * numpy.cos(angle(r, k)), r * numpy.sin(angle(r, k)), 0.0) for r in range(1, rings + 1) for k in range(count)]
    at = lambda r, k: 1 + (r - 1) * count + k % count
    cells = [(0, at(1, k), at(1, k + 1)) for k in range(count)]
    for r in range(1, rings):
        for k in range(count):
            cells += [(at(r, k), at(r + 1, k), at(r + 1, k + 1)), (at(r, k), at(r + 1, k + 1), at(r, k + 1))]
    return points, cells


def nested(depth):
    """A triangle, again and again one of its three parts cut in three: angles shrink, the boundary keeps three vertices."""
    points, cells = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.3, 0.9, 0.0)], [(0, 1, 2)]
    for level in range(depth):
        a, b, c = cells.pop(0)
        points.append(tuple(sum(points[v][k] for v in (a, b, c)) / 3 for k in range(3)))
        middle = len(points) - 1
        cells += [(a, b, middle), (b, c, middle), (c, a, middle)]
    return points, cells


def moved(mesh, change):
    points, cells = mesh
    return [tuple(change(*p)) for p in points], cells


def tube(rows, around, closed_end):
    """A pipe along x; one end closed by a vertex, the other open."""
    points = [(float(i), numpy.cos(2 * PI * j / around), numpy.sin(2 * PI * j / around)) for i in range(rows) for j in range(around)]
    cells = []
    for i in range(rows - 1):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            cells += [(a, b, a + around), (b, b + around, a + around)]
    if closed_end:
        points.append((-1.0, 0.0, 0.0))
        cells += [(rows * around, (j + 1) % around, j) for j in range(around)]
    return points, cells


def together(*meshes):
    points, cells = [], []
    for p, c in meshes:
        cells += [tuple(v + len(points) for v in cell) for cell in c]
        points += p
    return points, cells


# ---- closed surfaces

def turned(profile, around):
    """The surface that a profile (x, radius) from pole to pole makes round the x axis."""
    points, ring = [(profile[0][0], 0.0, 0.0)], len(profile) - 2
    for x, r in profile[1:-1]:
        points += [(x, r * numpy.cos(2 * PI * j / around), r * numpy.sin(2 * PI * j / around)) for j in range(around)]
    points.append((profile[-1][0], 0.0, 0.0))
    cells = [(0, 1 + (j + 1) % around, 1 + j) for j in range(around)]
    for i in range(ring - 1):
        for j in range(around):
            a, b = 1 + i * around + j, 1 + i * around + (j + 1) % around
            cells += [(a, b, a + around), (b, b + around, a + around)]
    last = 1 + (ring - 1) * around
    cells += [(len(points) - 1, last + j, last + (j + 1) % around) for j in range(around)]
    return points, cells


def ellipsoid(length, rows=16, around=12):
    return turned([(-length * numpy.cos(PI * k / rows), numpy.sin(PI * k / rows)) for k in range(rows + 1)], around)


def capsule(length, radius, rows, around=8):
    cap = [(numpy.cos(PI / 2 * k / 5), numpy.sin(PI / 2 * k / 5)) for k in range(6)]
    left = [(-length / 2 - radius * x, radius * r) for x, r in cap]
    middle = [(-length / 2 + length * k / rows, radius) for k in range(1, rows)]
    return turned(left + middle + [(-x, r) for x, r in reversed(left)], around)


def octahedron():
    points = [(1.0, 0, 0), (-1.0, 0, 0), (0, 1.0, 0), (0, -1.0, 0), (0, 0, 1.0), (0, 0, -1.0)]
    return points, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def spiked(mesh, every, length):
    """Some vertices pulled out of the surface."""
    points, cells = mesh
    return [tuple(length * x for x in p) if k % every == 0 else p for k, p in enumerate(points)], cells


def torus(columns, rows):
    points = [((3 + numpy.cos(2 * PI * j / rows)) * numpy.cos(2 * PI * i / columns),
               (3 + numpy.cos(2 * PI * j / rows)) * numpy.sin(2 * PI * i / columns), numpy.sin(2 * PI * j / rows))
              for j in range(rows) for i in range(columns)]
    cells = []
    for j in range(rows):
        for i in range(columns):
            a, b, c, d = (y % rows * columns + x % columns for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
            cells += [(a, b, c), (a, c, d)]
    return points, cells


# ---- solids

PATHS = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]


def bricks(size, filled=lambda i, j, k: True, scale=(1.0, 1.0, 1.0)):
    """Kuhn's small cubes: six tetrahedra round one diagonal, where they are wanted."""
    stride = (1, size[0] + 1, (size[0] + 1) * (size[1] + 1))
    points = [(x * scale[0], y * scale[1], z * scale[2])
              for z in range(size[2] + 1) for y in range(size[1] + 1) for x in range(size[0] + 1)]
    cells = []
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                for number, path in enumerate(PATHS if filled(i, j, k) else []):
                    corners = [i * stride[0] + j * stride[1] + k * stride[2]]
                    for step in path:
                        corners.append(corners[-1] + stride[step])
                    if number >= 3:
                        corners[2], corners[3] = corners[3], corners[2]
                    cells.append(tuple(corners))
    return used(points, cells)


def coned(mesh):
    """The tetrahedra between a closed surface round the origin and the origin."""
    points, cells = mesh
    return points + [(0.0, 0.0, 0.0)], [(a, b, c, len(points)) for a, c, b in cells]


def jittered(mesh, amount, seed):
    random = numpy.random.RandomState(seed)
    return moved(mesh, lambda *p: tuple(x + amount * random.uniform(-1, 1) for x in p))


# ---- files

def write(path, mesh):
    """OBJ for triangles, Medit for tetrahedra."""
    points, cells = mesh
    rows = [" ".join("%r" % float(x) for x in p) for p in points]
    corners = [" ".join(str(v + 1) for v in cell) for cell in cells]
    with open(path, "w") as stream:
        if path.endswith(".obj"):
            stream.write("".join("v %s\n" % row for row in rows) + "".join("f %s\n" % cell for cell in corners))
        else:
            stream.write("MeshVersionFormatted 2\nDimension 3\nVertices\n%d\n" % len(rows) + "".join("%s 0\n" % row for row in rows)
                         + "Tetrahedra\n%d\n" % len(cells) + "".join("%s 0\n" % cell for cell in corners) + "End\n")
