"""Inputs as users brought them: plain grids to the square, ears with and without -repair, an STL file's cylinder and a bent bar to
the sphere, a disk of six vertices that no discrete map keeps the angles of, a spiral, triangle strips and parametric nodes.

usage: python3 test_field.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from meshes import write_obj  # noqa: E402
from program import Program  # noqa: E402


def write(program, name, points, cells):
    write_obj(program, name, numpy.array(points, float), numpy.array(cells))


def grid(nx, ny):
    """All diagonals alike: two corners are cut off by a triangle each."""
    points = [(x, y, 0) for y in range(ny) for x in range(nx)]
    cells = []
    for y in range(ny - 1):
        for x in range(nx - 1):
            p, q = y * nx + x, (y + 1) * nx + x
            cells += [(p, p + 1, q), (p + 1, q + 1, q)]
    return points, cells


def with_ears(n):
    """A sheet with an ear in the middle of each side."""
    points, cells = grid(n, n)
    half = n // 2
    number = lambda x, y: y * n + x  # noqa: E731
    for one, other, tip in [((half, 0), (half + 1, 0), (half + 0.5, -0.8)), ((n - 1, half), (n - 1, half + 1), (n - 0.2, half + 0.5)),
                            ((half + 1, n - 1), (half, n - 1), (half + 0.5, n - 0.2)), ((0, half + 1), (0, half), (-0.8, half + 0.5))]:
        cells.append((number(*other), number(*one), len(points)))
        points.append((*tip, 0))
    return points, cells


def cylinder(n):
    """As computer-aided design makes it: no vertex between the rims, caps as fans."""
    angle = 2 * numpy.pi * numpy.arange(n) / n
    points = [(numpy.cos(a), numpy.sin(a), z) for z in (0.0, 2.0) for a in angle] + [(0, 0, 0), (0, 0, 2)]
    cells = []
    for k in range(n):
        m = (k + 1) % n
        cells += [(k, m, n + m), (k, n + m, n + k), (m, k, 2 * n), (n + k, n + m, 2 * n + 1)]
    return points, cells


def bent_bar(n):
    """A bar of square section along most of a circle, ends closed by two triangles each."""
    points, cells = [], []
    for k in range(n + 1):
        a = 1.5 * numpy.pi * k / n
        points += [(r * numpy.cos(a), r * numpy.sin(a), z) for r, z in ((3, 0), (3.6, 0), (3.6, 0.6), (3, 0.6))]
    for k in range(n):
        for c in range(4):
            p, q = 4 * k + c, 4 * k + (c + 1) % 4
            cells += [(p, q, q + 4), (p, q + 4, p + 4)]
    cells += [(0, 2, 1), (0, 3, 2), (4 * n, 4 * n + 1, 4 * n + 2), (4 * n, 4 * n + 2, 4 * n + 3)]
    return points, [(a, c, b) for a, b, c in cells]


def energy(program, command, name, *options, codes=(0,)):
    done = program.succeed(command, name, "-o", "out.h5", "-summary", "out.json", *options, codes=codes)
    summary = json.loads(program.read("out.json"))
    assert summary["folds"] == 0 and summary["exit_code"] == done.returncode
    return summary["energy"]["final"], done.stdout


def check_square(program):
    """Corners where the boundary is sharp; a minimum that is reached is convergence, whatever its value."""
    for nx, ny in ((5, 3), (9, 5)):
        write(program, "grid.obj", *grid(nx, ny))
        plain, _ = energy(program, "square", "grid.obj")
        mended, text = energy(program, "square", "grid.obj", "-repair")
        assert plain < 1e-6 and mended <= plain * (1 + 1e-6), (nx, ny, plain, mended)
        assert "cells split" in text and "without splits" in text, text
    write(program, "two.obj", [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    assert energy(program, "square", "two.obj")[0] < 1e-28
    write(program, "ears.obj", *with_ears(9))
    refused = program.run("square", "ears.obj", "-o", "refused.h5")
    assert refused.returncode == 3 and "on one side of the square" in refused.stderr, (refused.returncode, refused.stderr)
    assert "PETSC ERROR" not in refused.stderr and not os.path.exists(program.file("refused.h5"))


def check_repair(program):
    """What -repair leads to is no worse for the file's own triangles than none; with ears no map is much better than poor."""
    plain, _ = energy(program, "disk", "ears.obj", codes=(4,))
    mended, text = energy(program, "disk", "ears.obj", "-repair", codes=(0, 4))
    assert "the file's own cells" in text and mended <= plain * (1 + 1e-6), (plain, mended)


def check_sphere(program):
    """The default compares starts, goes on with another residual, and tries other starts itself where ratios are off by a tenth: it is
    no worse than any of them, or that good."""
    good = 0.1 ** 2 * 4 * numpy.pi
    write(program, "cylinder.obj", *cylinder(120))
    assert energy(program, "sphere", "cylinder.obj")[0] <= 1e-3
    write(program, "bar.obj", *bent_bar(30))
    default, text = energy(program, "sphere", "bar.obj", codes=(0, 4))
    single = [energy(program, "sphere", "bar.obj", "-start", start, codes=(0, 4))[0] for start in ("tutte", "cascade")]
    assert default <= max(min(single) * (1 + 1e-3), good), (default, single)
    assert "with the mixed residual" in text and "once more from -start" in text, text
    balanced, text = energy(program, "sphere", "bar.obj", "-balance", ".01")
    assert balanced <= 1e-2 and "once more from -start" in text, (balanced, text)


def check_barrier(program):
    """Where all starts end far from equal areas Newton steps with a barrier go on, and never to a worse map."""
    program.succeed("generate", "starfish", "-n", 100, "-o", "star.obj")
    default, text = energy(program, "sphere", "star.obj")
    before = [float(line.split()[1].rstrip(":")) for line in text.splitlines() if "on with Newton steps and a barrier" in line]
    assert before and default < .8 * before[0], (default, before)
    refused = program.run("sphere", "star.obj", "-method", "newton", "-newton_barrier", -1)
    assert refused.returncode == 2 and "give 0 or more" in refused.stderr, (refused.returncode, refused.stderr)


def check_coarse(program):
    """Neighbours on the boundary run together: said, and no abort."""
    points = [(0.703, -0.978, -0.594),
              (0.673, -0.484, -0.822),
              (-0.095, 0.865, -2.955),
              (0.953, -0.875, -1.097),
              (-0.29, 0.187, 2.523),
              (-0.723, -0.204, 0.0)]
    write(program, "six.obj", points, [(2, 1, 3), (0, 1, 5), (1, 0, 3), (4, 2, 5), (1, 4, 5), (4, 1, 2)])
    done = program.run("conformal", "six.obj", "-o", "six.h5")
    said = done.stdout + done.stderr
    assert done.returncode in (3, 4) and "PETSC ERROR" not in said and "run together" in said, (done.returncode, said)



def check_spiral(program):
    """A long strip is no hard surface: every triangle can keep its area."""
    turns, across = 60, 3
    angle, width = numpy.meshgrid(2 * numpy.pi * numpy.arange(turns + 1) / turns, numpy.arange(across + 1) / (3.3 * across), indexing="ij")
    radius = 1 + angle / (2 * numpy.pi) + width
    points = numpy.stack([radius * numpy.cos(angle), radius * numpy.sin(angle), 0 * angle], axis=-1).reshape(-1, 3)
    first = [i * (across + 1) + j for i in range(turns) for j in range(across)]
    write(program, "spiral.obj", points, [cell for a in first for cell in ((a, a + 1, a + across + 2), (a, a + across + 2, a + across + 1))])
    for target in ("disk", "square"):
        assert energy(program, target, "spiral.obj")[0] < 1e-3, target


def check_files(program):
    """Vertices of no triangle without numbers, triangle strips, nodes with parameters: the same surface, the same map."""
    points, cells = grid(9, 7)
    points = [(x, y, 0.3 * numpy.sin(x) * numpy.cos(y)) for x, y, _ in points]
    write(program, "plain.obj", points, cells)
    plain, _ = energy(program, "disk", "plain.obj")
    write(program, "loose.obj", [*points, (numpy.nan, 0, 0)], cells)
    strips = [index for y in range(6) for index in [*(k for x in range(9) for k in (y * 9 + x, (y + 1) * 9 + x)), -1]]
    program.write("strips.ply", "\n".join(
        ["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property double {axis}" for axis in "xyz"), "element tristrips 1",
         "property list int int vertex_indices", "end_header", *(f"{x!r} {y!r} {float(z)!r}" for x, y, z in points),
         " ".join(map(str, [len(strips), *strips])), ""]))
    program.write("nodes.msh", "\n".join(
        ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$ParametricNodes", str(len(points)),
         *(f"{k + 1} {x!r} {y!r} {float(z)!r} 2 1 {x / 8!r} {y / 6!r}" for k, (x, y, z) in enumerate(points)), "$EndParametricNodes",
         "$Elements", str(len(cells)), *(f"{k + 1} 2 2 1 1 {a + 1} {b + 1} {c + 1}" for k, (a, b, c) in enumerate(cells)), "$EndElements", ""]))
    for name in ("loose.obj", "strips.ply", "nodes.msh"):
        other, _ = energy(program, "disk", name)
        assert abs(other - plain) <= 1e-6 * plain, (name, other, plain)


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        check_square(program)
        check_repair(program)
        check_sphere(program)
        check_barrier(program)
        check_coarse(program)
        check_spiral(program)
        check_files(program)
    return 0


sys.exit(main())
