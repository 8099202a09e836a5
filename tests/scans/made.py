"""Scans of our own making: name -> bytes of a file, each with what scanners and modelling programs leave in theirs."""
import os
import struct
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "zoo"))
from shapes import bricks, ellipsoid, grid, moved, together, torus  # noqa: E402


def hill(x, y, z):
    return x, y, 0.25 * numpy.sin(4 * x) * numpy.cos(3 * y)


def egg(x, y, z):
    return 1.3 * x + 0.1 * numpy.sin(5 * y), y + 0.1 * numpy.cos(4 * z), z * (1 + 0.15 * numpy.sin(3 * x))


FACE = moved(grid(25, 25), hill)
HEAD = moved(ellipsoid(1.0, 24, 24), egg)
FAR = (5.0, 0.0, 0.0)


def without(mesh, wrong):
    """Without the triangles whose middle is `wrong`; vertices of no triangle stay, as scanners leave them."""
    points, cells = mesh
    return points, [c for c in cells if not wrong(*(sum(points[v][k] for v in c) / 3 for k in range(3)))]


def shifted(mesh, by):
    return moved(mesh, lambda *p: tuple(x + d for x, d in zip(p, by)))


def eyes(x, y, z):
    return min((x - 0.3) ** 2 + (y - 0.65) ** 2, (x - 0.7) ** 2 + (y - 0.65) ** 2, (x - 0.5) ** 2 / 4 + 4 * (y - 0.25) ** 2) < 0.008


def obj(mesh, texture=None):
    points, faces = mesh
    lines = ["v %.17g %.17g %.17g" % tuple(p) for p in points]
    return ("\n".join(lines + ["f " + " ".join(str(v + 1) for v in face) for face in faces]) + "\n").encode()


def stl(mesh):
    points, cells = mesh
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0) for a, b, c in cells)
    return bytes(80) + struct.pack("<I", len(cells)) + body


def off(mesh):
    points, faces = mesh
    lines = ["OFF", f"{len(points)} {len(faces)} 0"] + ["%.17g %.17g %.17g" % tuple(p) for p in points]
    return ("\n".join(lines + [" ".join(map(str, (len(face), *face))) for face in faces]) + "\n").encode()


def freesurfer(mesh):
    points, cells = mesh
    return (b"\xff\xff\xfecreated by somebody\n\n" + struct.pack(">2i", len(points), len(cells)) +
            numpy.asarray(points, ">f4").tobytes() + numpy.asarray(cells, ">i4").tobytes())


def medit(mesh):
    points, cells = mesh
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))] + ["%.17g %.17g %.17g 0" % tuple(p) for p in points]
    return ("\n".join(lines + ["Tetrahedra", str(len(cells))] + ["%d %d %d %d 1" % tuple(v + 1 for v in c) for c in cells] + ["End"]) + "\n").encode()


def quads(columns, rows):
    """Faces of four corners; every third one of five, with a vertex on its side."""
    points, _ = moved(grid(columns, rows), hill)
    points, faces = list(points), []
    for j in range(rows - 1):
        for i in range(columns - 1):
            a = j * columns + i
            face = [a, a + 1, a + columns + 1, a + columns]
            if j == 0 and i % 3 == 0:
                points.append(tuple((p + q) / 2 for p, q in zip(points[a], points[a + 1])))
                face.insert(1, len(points) - 1)
            faces.append(tuple(face))
    return points, faces


def unwelded(mesh):
    """Every triangle with vertices of its own."""
    points, cells = mesh
    return [points[v] for c in cells for v in c], [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(len(cells))]


def seamed(mesh, left):
    """Cut along the border of `left`, as programs do that keep one texture coordinate per vertex."""
    points, cells = list(mesh[0]), []
    twin = {}
    side = [left(*(sum(mesh[0][v][k] for v in c) / 3 for k in range(3))) for c in mesh[1]]
    other = {v for c, s in zip(mesh[1], side) if not s for v in c}
    for c, s in zip(mesh[1], side):
        corners = []
        for v in c:
            if s and v in other:
                if v not in twin:
                    twin[v] = len(points)
                    points.append(points[v])
                v = twin[v]
            corners.append(v)
        cells.append(tuple(corners))
    return points, cells


def turned_some(mesh, every):
    return mesh[0], [(b, a, c) if k % every == 0 else (a, b, c) for k, (a, b, c) in enumerate(mesh[1])]


def handled(mesh, size):
    """Two triangles taken away and a thin bent pipe between them."""
    points, cells = list(mesh[0]), list(mesh[1])
    middles = numpy.array([[sum(points[v][k] for v in c) / 3 for k in range(3)] for c in cells])
    first = int(abs(middles[:, :2] - 0.4).max(axis=1).argmin())
    second = int(abs(middles[:, :2] - [0.4 + size, 0.4]).max(axis=1).argmin())
    one, two = cells[first], cells[second]
    two = min(([two[k], two[k - 1], two[k - 2]] for k in range(3)),
              key=lambda ring: sum(numpy.linalg.norm(numpy.subtract(points[a], points[b])) for a, b in zip(one, ring)))
    rings = [list(one)]
    for t in (0.25, 0.5, 0.75):
        rings.append(list(range(len(points), len(points) + 3)))
        for a, b in zip(one, two):
            p, q = numpy.array(points[a]), numpy.array(points[b])
            points.append(tuple((1 - t) * p + t * q + [0, 0, 0.4 * size * numpy.sin(numpy.pi * t)]))
    rings.append(list(two))
    cells = [c for k, c in enumerate(cells) if k not in (first, second)]
    for low, high in zip(rings, rings[1:]):
        for k in range(3):
            a, b, c, d = low[k], low[(k + 1) % 3], high[(k + 1) % 3], high[k]
            cells += [(a, b, c), (a, c, d)]
    return points, cells


def capped(mesh, every):
    """On every so many of the inner edges a vertex that one of its triangles knows; the other has a flat one beside it."""
    points, cells = list(mesh[0]), list(mesh[1])
    beside, taken = {}, set()
    for k, cell in enumerate(mesh[1]):
        for i in range(3):
            beside.setdefault(frozenset((cell[i], cell[(i + 1) % 3])), []).append((k, i))
    for number, pair in enumerate(beside.values()):
        if len(pair) < 2 or number % every or {pair[0][0], pair[1][0]} & taken:
            continue
        (k, i), (other, _) = pair
        taken |= {k, other}
        a, b, c = (cells[k][(i + step) % 3] for step in range(3))
        points.append(tuple((x + y) / 2 for x, y in zip(points[a], points[b])))
        cells[k] = (a, len(points) - 1, c)
        cells += [(len(points) - 1, b, c), (a, b, len(points) - 1)]
    return points, cells


def needled(columns, rows, every):
    """Vertices of a grid doubled where they are, with two triangles of no width between."""
    points, cells = (list(x) for x in moved(grid(columns, rows), hill))
    for row in range(1, rows - 1, every):
        for column in range(1, columns - 1, every):
            v, w = row * columns + column, len(points)
            points.append(points[v])
            above = {v + 1, v + columns + 1, v + columns, v - 1}
            cells = [tuple(w if u == v else u for u in c) if v in c and set(c) - {v} <= above else c for c in cells]
            cells += [(v, v + 1, w), (w, v - 1, v)]
    return points, cells


def ball_of_voxels(n):
    """A segmented volume: small cubes whose middle lies in a bumpy ball, six tetrahedra each."""
    def filled(i, j, k):
        x, y, z = ((2 * v + 1) / n - 1 for v in (i, j, k))
        return x * x + y * y + z * z < (0.75 + 0.15 * numpy.sin(3 * x) * numpy.cos(2 * y)) ** 2
    return bricks((n, n, n), filled)


FIN = together(FACE, ([(0.5, 0.5, 0.6)], []))
FILES = {
    "face_eyes_mouth.obj": lambda: obj(without(FACE, eyes)),
    "face_pinholes.obj": lambda: obj(without(FACE, lambda x, y, z: (int(97 * x) * 31 + int(89 * y)) % 41 == 0)),
    "face_islands.off": lambda: off(together(without(FACE, eyes), shifted(grid(3, 3), FAR), shifted(grid(2, 2), (0.0, 7.0, 0.0)))),
    "face_seam.obj": lambda: obj(seamed(FACE, lambda x, y, z: x < 0.4)),
    "face_soup.stl": lambda: stl(FACE),
    "face_unwelded.off": lambda: off(unwelded(FACE)),
    "face_turned.obj": lambda: obj(turned_some(FACE, 3)),
    "face_twins.obj": lambda: obj((FACE[0], FACE[1] + FACE[1][7:300:9] + [(3, 3, 4)])),
    "face_fin.obj": lambda: obj((FIN[0], FIN[1] + [(312, 313, len(FIN[0]) - 1)])),
    "face_quads.obj": lambda: obj(quads(20, 15)),
    "face_handle_small.obj": lambda: obj(handled(FACE, 0.12)),
    "face_caps.obj": lambda: obj(capped(FACE, 20)),
    "face_needles.obj": lambda: obj(needled(25, 25, 3)),
    "bowls_touching.obj": lambda: obj((FACE[0], [c for c in FACE[1] if not (FACE[0][c[0]][0] < 0.5) ^ (FACE[0][c[0]][1] < 0.5)])),
    "two_heads.off": lambda: off(together(HEAD, shifted(HEAD, FAR))),
    "head.white": lambda: freesurfer(HEAD),
    "head_medial_wall.white": lambda: freesurfer(without(HEAD, lambda x, y, z: x > 0.9)),
    "head_seam.obj": lambda: obj(seamed(HEAD, lambda x, y, z: y < 0)),
    "head_inside_out.stl": lambda: stl(turned_some(HEAD, 1)),
    "head_open_neck.off": lambda: off(without(HEAD, lambda x, y, z: z < -0.8)),
    "ring.off": lambda: off(torus(24, 12)),
    "points.off": lambda: off((FACE[0], [])),
    "voxels.mesh": lambda: medit(ball_of_voxels(8)),
    "voxels_island.mesh": lambda: medit(together(ball_of_voxels(8), shifted(bricks((1, 1, 1)), (20.0, 0, 0)))),
    "voxels_cavity.mesh": lambda: medit(bricks((3, 3, 3), lambda i, j, k: (i, j, k) != (1, 1, 1))),
    "voxels_cavity_bent.mesh": lambda: medit(bricks((5, 4, 3), lambda i, j, k: (i, j, k) not in [(1, 2, 1), (1, 1, 1), (2, 1, 1), (3, 1, 1), (3, 2, 1)])),
}
