"""The animals: what each mesh is for, and how it is made."""
import math

from shapes import (bricks, capsule, coned, ellipsoid, fan, grid, jittered, moved, nested, octahedron, spiked, together, torus, tube,
                    turned, wheel)

PLAIN = grid(9, 7)
BALL = ellipsoid(1.0)
CUBE = bricks((3, 3, 3))


def hilly(mesh):
    return moved(mesh, lambda x, y, z: (x, y, 0.3 * math.sin(5 * x) * math.cos(4 * y)))


def scaled(mesh, factor):
    return moved(mesh, lambda *p: tuple(factor * x for x in p))


def shifted(mesh, by):
    return moved(mesh, lambda *p: tuple(x + by for x in p))


def replaced(mesh, cells=None, points=None):
    return list(points or mesh[0]), list(cells or mesh[1])


def flipped(mesh, every):
    return replaced(mesh, [(b, a, *rest) if k % every == 0 else (a, b, *rest) for k, (a, b, *rest) in enumerate(mesh[1])])


HILLS = hilly(PLAIN)
LAST = len(HILLS[0]) - 1

# surfaces with a boundary
DISKS = {
    "triangle": lambda: ([(0.0, 0, 0), (1.0, 0, 0), (0, 1.0, 0)], [(0, 1, 2)]),
    "two_triangles": lambda: grid(2, 2),
    "fan4": lambda: fan(4, apex=0.5),
    "fan1000": lambda: fan(1000),
    "fan2000": lambda: fan(2000),
    "wheel16": lambda: wheel(16, 2),
    "wheel8_twisted": lambda: wheel(8, 3, 0.3),
    "wheel12_twisted": lambda: wheel(12, 3, 0.3),
    "spike": lambda: fan(40, apex=1000.0),
    "star": lambda: fan(40, radius=lambda a: 1.0 + 0.8 * math.cos(20 * a)),
    "grid": lambda: PLAIN,
    "hills": lambda: HILLS,
    "notched": lambda: grid(12, 12, lambda i, j: j < 4 or i not in (3, 7)),
    "comb": lambda: grid(14, 8, lambda i, j: j < 2 or i % 2 == 0),
    "spiral_wall": lambda: grid(13, 13, lambda i, j: not (j % 4 == 2 and (i < 11 if j % 8 == 2 else i > 0))),
    "strip": lambda: grid(500, 3, width=500.0),
    "long_strip": lambda: grid(2000, 3, width=2000.0),
    "longest_strip": lambda: grid(50000, 3, width=50000.0),
    "ribbon": lambda: grid(300, 2, width=300.0),
    "needles": lambda: grid(9, 9, width=1e6),
    "graded": lambda: moved(PLAIN, lambda x, y, z: (x ** 12, y ** 12, z)),
    "nested": lambda: nested(60),
    "thimble": lambda: tube(6, 12, True),
    "sock": lambda: tube(60, 8, True),
    "tiny50": lambda: scaled(HILLS, 1e-50),
    "huge50": lambda: scaled(HILLS, 1e50),
    "tiny100": lambda: scaled(HILLS, 1e-100),
    "huge100": lambda: scaled(HILLS, 1e100),
    "tiny200": lambda: scaled(HILLS, 1e-200),
    "huge200": lambda: scaled(HILLS, 1e200),
    "far": lambda: shifted(HILLS, 1e8),
    "very_far": lambda: shifted(HILLS, 1e17),
    "annulus": lambda: grid(9, 9, lambda i, j: not (2 < i < 6 and 2 < j < 6)),
    "two_pieces": lambda: together(HILLS, shifted(HILLS, 5.0)),
    "kissing": lambda: grid(7, 7, lambda i, j: (i < 3) == (j < 3)),
    "pinched": lambda: grid(7, 7, lambda i, j: (i, j) not in ((2, 2), (3, 3))),
    "fin": lambda: replaced(HILLS, HILLS[1] + [(0, 10, LAST + 1)], HILLS[0] + [(0.5, 0.5, 1.0)]),
    "twin": lambda: replaced(HILLS, HILLS[1] + HILLS[1][5:6]),
    "turned_cell": lambda: flipped(HILLS, 37),
    "turned_all": lambda: flipped(HILLS, 1),
    "flat_cell": lambda: replaced(HILLS, points=HILLS[0][:31] + [HILLS[0][30]] + HILLS[0][32:]),
    "collinear": lambda: moved(PLAIN, lambda x, y, z: (x, 0.0, 0.0)),
    "point": lambda: moved(PLAIN, lambda x, y, z: (1.0, 1.0, 1.0)),
    "nan": lambda: replaced(HILLS, points=HILLS[0][:20] + [(math.nan, 0.0, 0.0)] + HILLS[0][21:]),
    "infinite": lambda: replaced(HILLS, points=HILLS[0][:20] + [(math.inf, 0.0, 0.0)] + HILLS[0][21:]),
    "loose_nan": lambda: replaced(HILLS, points=HILLS[0] + [(math.nan, 0.0, 0.0)]),
    "repeated": lambda: replaced(HILLS, HILLS[1] + [(3, 3, 4)]),
    "moebius": lambda: ([(math.cos(a) * (2 + t * math.cos(a / 2)), math.sin(a) * (2 + t * math.cos(a / 2)), t * math.sin(a / 2))
                         for a in (2 * math.pi * k / 12 for k in range(12)) for t in (-0.5, 0.5)],
                        [c for k in range(12) for c in
                         (((2 * k, 2 * k + 2, 2 * k + 1), (2 * k + 1, 2 * k + 2, 2 * k + 3)) if k < 11
                          else ((22, 1, 23), (23, 1, 0)))]),
}

# closed surfaces
CLOSED = {
    "octahedron": octahedron,
    "tetrahedron": lambda: ([(1.0, 1, 1), (1.0, -1, -1), (-1.0, 1, -1), (-1.0, -1, 1)], [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]),
    "ball_skin": lambda: BALL,
    "bipyramid": lambda: turned([(-1.0, 0.0), (0.0, 1.0), (1.0, 0.0)], 200),
    "long_ellipsoid": lambda: ellipsoid(30.0),
    "pancake": lambda: ellipsoid(0.01),
    "capsule10": lambda: capsule(10.0, 1.0, 20),
    "capsule100": lambda: capsule(20.0, 0.1, 200),
    "dumbbell": lambda: turned([(-3 + 6 * k / 24, 0.05 + abs(math.cos(math.pi * k / 24)) ** 2 * (1 if 0 < k < 24 else 0)) for k in range(25)], 12),
    "hedgehog": lambda: spiked(BALL, 7, 8.0),
    "torus": lambda: torus(16, 8),
    "two_balls": lambda: together(BALL, shifted(BALL, 9.0)),
    "balls_touching": lambda: replaced(together(BALL, BALL), [tuple(len(BALL[0]) - 1 if v == len(BALL[0]) else v for v in c)
                                                              for c in together(BALL, shifted(BALL, 2.0))[1]]),
    "bitten": lambda: replaced(BALL, BALL[1][1:]),
    "inside_out": lambda: flipped(BALL, 1),
    "one_turned": lambda: flipped(BALL, 1000),
    "closed_twin": lambda: replaced(BALL, BALL[1] + BALL[1][:1]),
    "closed_far": lambda: shifted(BALL, 1e8),
    "closed_huge": lambda: scaled(BALL, 1e100),
    "closed_tiny": lambda: scaled(BALL, 1e-100),
}

# solids
SOLIDS = {
    "tet": lambda: ([(0.0, 0, 0), (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)], [(0, 1, 2, 3)]),
    "two_tets": lambda: ([(0.0, 0, 0), (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0), (1.0, 1, 1)], [(0, 1, 2, 3), (1, 2, 3, 4)]),
    "hub": lambda: coned(octahedron()),
    "hedge_cone": lambda: coned(BALL),
    "cube2": lambda: bricks((1, 1, 1)),
    "cube3": lambda: bricks((2, 2, 2)),
    "cube4": lambda: CUBE,
    "cube5": lambda: bricks((4, 4, 4)),
    "cube6": lambda: bricks((5, 5, 5)),
    "cube4_jittered": lambda: jittered(CUBE, 0.2, 5),
    "cube4_far": lambda: shifted(CUBE, 1e8),
    "bar": lambda: bricks((2, 2, 20)),
    "long_bar": lambda: bricks((2, 2, 40)),
    "beam": lambda: bricks((1, 1, 8)),
    "plate": lambda: bricks((5, 5, 2)),
    "thin_plate": lambda: bricks((4, 4, 4), scale=(1.0, 1.0, 0.01)),
    "needle": lambda: bricks((4, 4, 4), scale=(1.0, 1.0, 1000.0)),
    "cube_huge": lambda: scaled(CUBE, 1e100),
    "cube_tiny": lambda: scaled(CUBE, 1e-100),
    "cube_1e30": lambda: scaled(CUBE, 1e30),
    "cavity": lambda: bricks((3, 3, 3), lambda i, j, k: (i, j, k) != (1, 1, 1)),
    "tunnel": lambda: bricks((3, 3, 2), lambda i, j, k: (i, j) != (1, 1)),
    "hinge": lambda: bricks((2, 2, 1), lambda i, j, k: i == j),
    "pieces": lambda: bricks((3, 1, 1), lambda i, j, k: i != 1),
    "one_inverted": lambda: flipped(CUBE, 1000),
    "all_inverted": lambda: flipped(CUBE, 1),
    "solid_twin": lambda: replaced(CUBE, CUBE[1] + CUBE[1][:1]),
    "flat_tet": lambda: replaced(CUBE, points=[p if k != 21 else CUBE[0][22] for k, p in enumerate(CUBE[0])]),
}

ALL = {**{name + ".obj": make for kind in (DISKS, CLOSED) for name, make in kind.items()},
       **{name + ".mesh": make for name, make in SOLIDS.items()}}
