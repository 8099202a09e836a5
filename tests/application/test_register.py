"""equimap register as a user runs it: a copy that is turned and renumbered, a deformed copy with landmarks, spheres met half
way, solids whose maps are given, fields carried along, frames; what it refuses.

usage: python3 test_register.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile
import xml.etree.ElementTree

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import boundary_edges  # noqa: E402
from meshes import read_obj, renumber, write_obj  # noqa: E402
from program import Program  # noqa: E402


def write_h5(program, name, vertices, cells, image=None):
    with h5py.File(program.file(name), "w") as file:
        file["/mesh/vertices"], file["/mesh/cells"] = vertices, cells.astype("int64")
        if image is not None:
            file["/map/coordinates"] = image


def rotation(seed):
    q, _ = numpy.linalg.qr(numpy.random.RandomState(seed).randn(3, 3))
    return q * numpy.linalg.det(q)


def generate(program, shape, count):
    program.succeed("generate", shape, "-n", count, "-o", shape + ".obj", ranks=1)
    return read_obj(program.file(shape + ".obj"))


def run(program, *arguments, codes=(0,)):
    result = program.succeed("register", *arguments, "-o", "out.h5", "-summary", "out.json", codes=codes)
    summary = json.loads(program.read("out.json"))
    assert summary["exit_code"] == result.returncode and summary["command"] == "register"
    return summary, h5py.File(program.file("out.h5"), "r")


def check_location(file, group, vertices_of, vertices, cells, points):
    """Cell and barycentric coordinates lead to the points."""
    cell, weight = file[f"/{group}/cell"][...], file[f"/{group}/barycentric"][...]
    assert weight.shape == (vertices_of, cells.shape[1]) and weight.min() >= 0.0 and abs(weight.sum(axis=1) - 1.0).max() < 1e-12
    assert abs((weight[:, :, None] * vertices[cells[cell]]).sum(axis=1) - points).max() < 1e-9


def check_copy(program, shape, count):
    """A turned and renumbered copy: every vertex finds its own."""
    vertices, cells = generate(program, shape, count)
    moved, other_cells, place = renumber(vertices @ rotation(5).T + 3.0, cells, 6)
    write_obj(program, "copy.obj", moved, other_cells)
    summary, file = run(program, shape + ".obj", "copy.obj", "-quiet", "-transfer", "coordinates,b:coordinates")
    figures = summary["register"]
    assert figures["dissimilarity_rigid"] < 1e-6 < 1e-2 < figures["dissimilarity"], figures
    assert summary["folds"] == 0 and summary["ratio"]["sd"] < 1e-5
    points = file["/map/coordinates"][...]
    assert abs(points - moved[place]).max() < 1e-4, abs(points - moved[place]).max()
    check_location(file, "register", len(vertices), moved, other_cells, points)
    check_location(file, "inverse", len(vertices), vertices, cells, file["/inverse/coordinates"][...])
    assert abs(file["/transfer/to_a/coordinates"][...] - points).max() < 1e-9
    assert abs(file["/transfer/to_b/coordinates"][...] - file["/inverse/coordinates"][...]).max() < 1e-9
    assert figures["transfer"]["to_b"]["coordinates"]["round_trip"] < 1e-5


def check_series(program, count):
    """The time series as a reader of XDMF goes through it: times from 0 to 1, arrays that are there in the size that is told."""
    series = xml.etree.ElementTree.parse(program.file("out.morph.xmf")).getroot().find("Domain").find("Grid")
    assert series.get("CollectionType") == "Temporal"
    frames = series.findall("Grid")
    times = [float(frame.find("Time").get("Value")) for frame in frames]
    assert len(frames) == count and numpy.allclose(times, numpy.linspace(0, 1, count), atol=1e-15), times
    for number, frame in enumerate(frames):
        assert frame.find("Geometry").find("DataItem").text.strip().endswith(f":/morph/frame_{number:03d}")
        for item in frame.iter("DataItem"):
            name, path = item.text.strip().split(":")
            with h5py.File(program.file(name), "r") as file:
                assert " ".join(map(str, file[path].shape)) == item.get("Dimensions"), path
                assert numpy.isfinite(file[path][...]).all() and file[path].dtype == {"Float": "f8", "Int": "i8"}[item.get("NumberType")]


def deform(vertices):
    size = numpy.ptp(vertices, axis=0).max()
    x, y, _ = (vertices / size).T
    return vertices + 0.08 * size * numpy.stack([numpy.sin(3 * y + 1), numpy.sin(3 * x), numpy.sin(2 * x + 3 * y)], axis=1)


def check_landmarks(program):
    """A smoothly deformed copy with twenty known pairs; a field of cells and one of vertices; frames; results as input."""
    vertices, cells = generate(program, "hills", 1500)
    deformed = deform(vertices)
    write_obj(program, "deformed.obj", deformed, cells)
    pairs = numpy.random.RandomState(1).choice(len(vertices), 20, replace=False)
    program.write("pairs.csv", "a,b\n" + "".join(f"{i},{i}\n" for i in pairs))
    program.write("height.csv", "height\n" + "".join(f"{z!r}\n" for z in vertices[:, 0].tolist()))
    program.write("side.csv", "left,right\n" + "".join(f"{int(x < .5)},{int(x >= .5)}\n" for x in vertices[cells[:, 0], 0]))
    summary, file = run(program, "hills.obj", "deformed.obj", "-landmarks", "pairs.csv", "-quiet", "-frames", 4,
                        "-transfer", "height.csv,side.csv", "-history", "out.csv")
    history = program.read("out.csv").decode().split("\n")
    assert history[0].startswith("iteration,") and len(history) == summary["iterations"] + 3
    figures = summary["register"]
    assert summary["folds"] == 0 and summary["energy"]["final"] < 1e-4
    assert figures["landmarks"]["count"] == 20 and figures["landmarks"]["error"]["max"] <= 1e-3
    points = file["/map/coordinates"][...]
    assert abs(points[pairs] - deformed[pairs]).max() < 1e-2
    assert numpy.linalg.norm(points - deformed, axis=1).mean() < .5 * numpy.linalg.norm(vertices - deformed, axis=1).mean()
    side = file["/transfer/to_b/side"][...]
    assert side.shape == (len(cells), 2) and set(numpy.unique(side)) == {0.0, 1.0} and (side.sum(axis=1) == 1.0).all()
    assert (side[:, 0] == (vertices[cells[:, 0], 0] < .5)).mean() > .9
    assert figures["transfer"]["to_b"]["height"]["round_trip"] < .02
    assert sorted(figures["frames"]["folds"]) == ["000", "001", "002", "003"] and figures["frames"]["folds"]["000"] == 0
    for frame in range(4):
        t = frame / 3
        frame_points = (1 - t) * vertices + t * points
        assert abs(file[f"/morph/frame_{frame:03d}"][...] - frame_points).max() < 1e-12
        written, written_cells = read_obj(program.file(f"out.frame{frame:03d}.obj"))
        assert numpy.array_equal(written_cells, cells) and abs(written - frame_points).max() < 1e-12
    check_series(program, 4)
    file.close()
    drawn = program.run("report", "out.h5", "-o", "out.html", ranks=1)
    if "cairo" not in drawn.stderr:  # a build without it draws nothing
        assert drawn.returncode == 0 and b"hills.obj" in program.read("out.html") and b"deformed.obj" in program.read("out.html")
    program.succeed("disk", "hills.obj", "-o", "a.h5", "-quiet", "-ratio_tol", "3e-3")
    program.succeed("disk", "deformed.obj", "-o", "b.h5", "-quiet", "-ratio_tol", "3e-3")
    again, file = run(program, "a.h5", "b.h5", "-landmarks", "pairs.csv", "-quiet", "-landmark_start", "flow")
    assert again["folds"] == 0 and again["register"]["landmarks"]["error"]["max"] <= 1e-3
    assert numpy.linalg.norm(file["/map/coordinates"][...] - points, axis=1).mean() < .05
    file.close()


def check_sphere(program):
    """Closed surfaces: the middles between the landmarks; points of the sphere itself; points of the surface."""
    vertices, cells = generate(program, "head", 1000)
    deformed = deform(vertices)
    write_obj(program, "deformed.obj", deformed, cells)
    chosen = numpy.random.RandomState(2).choice(len(vertices), 8, replace=False)
    program.write("pairs.csv", "a,b\n" + "".join(f"{i},{i}\n" for i in chosen))
    program.write("points.csv", "a,x,y,z\n" + "".join("%d,%r,%r,%r\n" % (i, *deformed[i].tolist()) for i in chosen))
    for options in (["-register_by", "midpoints", "-landmarks", "pairs.csv"], ["-landmarks", "points.csv"]):
        summary, file = run(program, "head.obj", "deformed.obj", "-quiet", "-frames", 3, *options)
        check_series(program, 3)
        assert read_obj(program.file("out.frame002.obj"))[0].shape == vertices.shape
        figures = summary["register"]["landmarks"]
        assert summary["folds"] == 0 and summary["register"]["b"]["folds"] == 0
        assert figures["error"]["max"] <= 2e-3 and figures["space_error"]["max"] <= 2e-2, figures
        check_location(file, "register", len(vertices), deformed, cells, file["/map/coordinates"][...])
        file.close()
    turned = numpy.roll(vertices[chosen] / numpy.linalg.norm(vertices[chosen], axis=1)[:, None], 1, axis=1)
    program.write("target.csv", "a,x,y,z\n" + "".join("%d,%r,%r,%r\n" % (i, *p) for i, p in zip(chosen, turned.tolist())))
    summary, file = run(program, "head.obj", "target", "-quiet", "-landmarks", "target.csv")
    places = file["/map/coordinates"][...]
    assert abs(numpy.linalg.norm(places, axis=1) - 1.0).max() < 1e-12 and summary["folds"] == 0
    assert abs(places[chosen] - turned).max() <= 1e-3 and summary["register"]["landmarks"]["error"]["max"] <= 1e-3
    file.close()


def check_ball(program):
    """Solids with maps from elsewhere: their rotation is found by the pose, and by the shape where the solid is turned."""
    program.succeed("generate", "ball", "-n", 600, "-o", "ball.h5", ranks=1)
    with h5py.File(program.file("ball.h5"), "r") as file:
        vertices, cells = file["/mesh/vertices"][...], file["/mesh/cells"][...]
    solid = vertices * [1.0, 1.3, 1.7] + 0.2 * vertices[:, [1, 2, 0]] ** 2
    write_h5(program, "a.h5", solid, cells, vertices)
    write_h5(program, "b.h5", solid, cells, vertices @ rotation(3).T)
    summary, file = run(program, "a.h5", "b.h5", "-quiet")
    assert summary["register"]["target"] == "ball" and summary["register"]["dissimilarity"] < 1e-9
    assert abs(file["/map/coordinates"][...] - solid).max() < 1e-8 and summary["folds"] == 0
    file.close()
    turned = solid @ rotation(4).T
    write_h5(program, "b.h5", turned, cells, vertices @ rotation(3).T)
    summary, file = run(program, "a.h5", "b.h5", "-quiet", "-frames", 3, "-transfer", "coordinates")
    assert summary["register"]["transfer"]["to_b"]["coordinates"]["round_trip"] < 1e-5
    assert summary["register"]["dissimilarity_rigid"] < 1e-6 and abs(file["/map/coordinates"][...] - turned).max() < 1e-5
    check_series(program, 3)
    program.succeed("check", "out.frame002.vtu", ranks=1)
    file.close()
    summary, file = run(program, "a.h5", "b.h5", "-quiet", "-align", "pose")
    assert summary["register"]["dissimilarity_rigid"] > 1e-2, "the pose of a turned solid is another one"
    file.close()
    check_folded_solid(program, vertices, cells)
    check_solid_landmarks(program, vertices, cells)


def check_published(program):
    """000 section 6: the boundary held where the best rotation puts it, landmarks drawn by (49) or by conjugate gradients."""
    vertices, cells = generate(program, "hills", 600)
    program.succeed("disk", "hills.obj", "-o", "f.h5", "-quiet")
    with h5py.File(program.file("f.h5"), "r") as file:
        places = file["/map/coordinates"][...]
    inside = numpy.flatnonzero(numpy.linalg.norm(places, axis=1) < .7)[::40]
    goals = places[inside] + .03 * numpy.stack([numpy.cos(5 * places[inside, 1]), numpy.sin(4 * places[inside, 0])], axis=1)
    goals = goals @ numpy.array([[0., -1.], [1., 0.]]).T
    program.write("goals.csv", "a,x,y\n" + "".join(f"{v},{x!r},{y!r}\n" for v, (x, y) in zip(inside.tolist(), goals.tolist())))
    rim = numpy.unique(boundary_edges(cells))
    for method, weight in (("fixed-point", 3), ("ncg", .3)):
        summary, file = run(program, "f.h5", "target", "-landmarks", "goals.csv", "-quiet", "-method", method, "-landmark_weight",
                            weight, "-landmark_stages", 1, "-landmark_tol", .02, "-max_it", 60, codes=(0, 4))
        h = file["/register/target"][...]
        figures = summary["register"]
        turned = (h[rim, 0] + 1j * h[rim, 1]) / (places[rim, 0] + 1j * places[rim, 1])
        assert abs(turned - turned[0]).max() < 1e-12 and abs(turned[0] - 1j) < .1, "the boundary is that of f, rotated"
        assert figures["landmarks"]["error"]["max"] <= .02 and summary["folds"] == 0
        assert numpy.linalg.norm(h[inside] - goals, axis=1).max() <= .02
        area = lambda x: numpy.cross(x[cells[:, 1]] - x[cells[:, 0]], x[cells[:, 2]] - x[cells[:, 0]]) / 2.  # noqa: E731
        before, after = area(places), area(h)
        ratio = after / before * before.sum() / after.sum()
        own = after.sum() * (before / before.sum() * (ratio - 1.) ** 2).sum()
        assert abs(figures["h"]["energy"] - own) < 1e-9 and own < .1, (figures["h"], own)
        file.close()


def check_solid_landmarks(program, vertices, cells):
    """Landmarks of solids meet, without folds; the surface's vertices stay on the sphere."""
    inside = numpy.flatnonzero(numpy.linalg.norm(vertices, axis=1) < .7)[::25]
    goals = vertices[inside] + .03 * numpy.sin(4 * vertices[inside][:, [1, 2, 0]])
    with h5py.File(program.file("landmarks.h5"), "w") as file:
        file["/mesh/vertices"], file["/mesh/cells"], file["/map/coordinates"] = vertices, cells.astype("int64"), vertices
    program.write("solid.csv", "a,x,y,z\n" + "".join(f"{v},{x!r},{y!r},{z!r}\n" for v, (x, y, z) in zip(inside.tolist(), goals.tolist())))
    summary, file = run(program, "landmarks.h5", "landmarks.h5", "-landmarks", "solid.csv", "-quiet", "-max_it", 200, codes=(0, 4))
    assert summary["register"]["landmarks"]["error"]["max"] <= 1e-3 and summary["register"]["folds"] == 0, summary["register"]
    places = file["/register/target"][...]
    on_sphere = abs(numpy.linalg.norm(vertices, axis=1) - 1.) < 1e-12
    assert abs(numpy.linalg.norm(places[on_sphere], axis=1) - 1.).max() < 1e-12
    file.close()


def count_folds(points, cells):
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    return int((numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) <= 0.0).sum())


def check_folded_solid(program, vertices, cells):
    """Two maps without folds, twisted against each other as far as that goes: their composition folds, and says so."""
    def twist(angle):
        angle = angle * (1.0 - numpy.linalg.norm(vertices, axis=1) ** 2)
        x, y, z = vertices.T
        return numpy.stack([numpy.cos(angle) * x - numpy.sin(angle) * y, numpy.sin(angle) * x + numpy.cos(angle) * y, z], axis=1)

    most = max(angle for angle in numpy.arange(0.0, 4.0, 0.05) if count_folds(twist(angle), cells) + count_folds(twist(-angle), cells) == 0)
    write_h5(program, "a.h5", vertices, cells, twist(most))
    write_h5(program, "b.h5", vertices, cells, twist(-most))
    summary, file = run(program, "a.h5", "b.h5", "-quiet", "-align", "none", codes=(5,))
    folds = count_folds(file["/map/coordinates"][...], cells)
    assert folds > 0 and summary["register"]["folds"] == folds and summary["folds"] == folds and "inside out" in summary["message"]
    file.close()


def check_refused(program):
    """Mistakes are told in words, once, before the long run, and leave nothing behind."""
    vertices, cells = generate(program, "hills", 300)
    head, _ = generate(program, "head", 300)
    program.succeed("generate", "ball", "-n", 200, "-o", "ball.h5", ranks=1)
    program.succeed("convert", "hills.obj", "hills.h5", ranks=1)
    write_obj(program, "lonely.obj", numpy.vstack([vertices, [[9.0, 9.0, 9.0]]]), read_obj(program.file("hills.obj"))[1])
    edge = boundary_edges(cells)[0][0]
    point = head[7] / numpy.linalg.norm(head[7])
    for name, text in (("twice", "a,b\n3,4\n3,5\n"), ("twice_b", "a,b\n3,5\n4,5\n"), ("far_a", "a,b\n99999,3\n"), ("far_b", "a,b\n3,99999\n"),
                       ("negative", "a,b\n-1,3\n"), ("between", "a,b\n3.5,3\n"), ("words", "a,b\n3,four\n"), ("headless", "3,4\n"),
                       ("pair", "a,b\n3,4\n"), ("lonely", f"a,b\n{len(vertices)},3\n"), ("ragged", "a,b\n3,4\n5\n"), ("empty", "a,b\n"),
                       ("wide", "a,b,c,d,e\n1,2,3,4,5\n"), ("nowhere", "a,x,y,z\n3,nan,0,1\n"),
                       ("off", "a,x,y,z\n7,%r,%r,%r\n" % tuple((1.1 * point).tolist())), ("flat", "a,x,y\n3,.1,.2\n"),
                       ("edge", f"a,b\n{edge},{numpy.setdiff1d(cells, boundary_edges(cells))[0]}\n"), ("few", "value\n1\n2\n"),
                       ("text", "value\n" + "1\n" * (len(vertices) - 1) + "one\n")):
        program.write(name + ".csv", text)
    both, closed = ("hills.obj", "hills.obj"), ("head.obj", "head.obj")
    landmarks = lambda name: ("-landmarks", name + ".csv")  # noqa: E731
    before = sorted(os.listdir(program.folder))
    cases = (
        (3, "do not correspond", "hills.obj", "head.obj"),
        (3, "do not correspond", "head.obj", "hills.obj"),
        (3, "do not correspond", "hills.obj", "ball.h5"),
        (3, "do not correspond", "ball.h5", "head.obj"),
        (2, "two meshes", "hills.obj"),
        (2, "is a landmark twice", *both, *landmarks("twice")),
        (2, "vertex 5 of B is a landmark twice", *both, *landmarks("twice_b")),
        (2, "vertex 99999 of A", *both, *landmarks("far_a")),
        (2, "vertex 99999 of B", *both, *landmarks("far_b")),
        (2, "vertex -1 of A", *both, *landmarks("negative")),
        (2, "vertex 3.5 of A", *both, *landmarks("between")),
        (2, "no map brings them together", *both, *landmarks("edge")),
        (2, f"vertex {len(vertices)} of A is in no cell", "lonely.obj", "hills.obj", *landmarks("lonely")),
        (6, "line 2", *both, *landmarks("words")),
        (6, "line 3", *both, *landmarks("ragged")),
        (2, "a landmark is a vertex", *both, *landmarks("wide")),
        (2, "no finite number", *closed, *landmarks("nowhere")),
        (6, "no numbers", *both, *landmarks("empty")),
        (6, "header", *both, *landmarks("headless")),
        (6, "missing.csv", *both, *landmarks("missing")),
        (2, "do not lie on the unit sphere", "head.obj", "target", *landmarks("off")),
        (2, "do not lie on the unit sphere", *closed, *landmarks("off"), "-landmark_points", "target"),
        (2, "no vertices", "hills.obj", "target", *landmarks("pair")),
        (2, "three coordinates", *both, *landmarks("flat"), "-landmark_points", "surface"),
        (2, "-transfer nothing", *both, "-transfer", "nothing"),
        (2, "no such dataset", "hills.h5", "hills.obj", "-transfer", "/cell/nothing"),
        (2, "2 rows", *both, "-transfer", "few.csv"),
        (2, "2 rows", *both, "-transfer", "b:few.csv"),
        (6, "numbers are wanted", *both, "-transfer", "text.csv"),
        (6, "missing.csv", *both, "-transfer", "missing.csv"),
        (2, "wants a mesh for B", "hills.obj", "target", *landmarks("flat"), "-transfer", "coordinates"),
        (2, "on the disk only", *closed, *landmarks("pair"), "-method", "fixed-point"),
        (2, "midpoints", *both, "-register_by", "midpoints"),
        (2, "midpoints", *both, "-register_by", "midpoints", *landmarks("flat")),
        (2, "-frames 1", *both, "-frames", 1),
        (2, "a disk has no pose", *both, "-align", "pose"),
        (2, "unknown option", *both, "-landmrks", "x"),
        (3, "do not belong together", *both, "-map_a", "head.obj"),
        (2, "coordinates", *both, "-map_a", "hills.obj"),
    )
    for code, words, *arguments in cases if program.ranks < 3 else cases[::4]:
        result = program.run("register", *arguments, "-quiet", "-o", "refused.h5", "-summary", "refused.json")
        messages = program.messages(result)
        assert result.returncode == code, (arguments, result.returncode, result.stdout, result.stderr)
        assert len(messages) == 1 and words in messages[0], (arguments, result.stderr)
        assert sorted(os.listdir(program.folder)) == before, arguments


def main():
    equimap, ranks = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1
    for check in (lambda p: check_copy(p, "hills", 1000), lambda p: check_copy(p, "head", 1000), check_landmarks, check_published,
                  check_sphere, check_ball, check_refused):
        with tempfile.TemporaryDirectory() as folder:
            check(Program(equimap, ranks, folder))
    print("equimap register: copies, landmarks, spheres, solids, fields, frames, refusals: fine")


if __name__ == "__main__":
    main()
