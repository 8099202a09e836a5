"""What a run writes is true: the result file, every other format, summary and history against figures computed anew, on a
mesh whose vertices and triangles are in no good order, with and without a density.

usage: python3 test_result.py EQUIMAP [RANKS]
"""
import base64
import csv
import json
import os
import re
import sys
import tempfile
import xml.etree.ElementTree

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import boundary_edges, evaluate, triangle_areas  # noqa: E402
from meshes import read_obj, renumber, write_obj  # noqa: E402
from program import Program  # noqa: E402


def close(got, wanted, tolerance=1e-9, what=""):
    assert abs(got - wanted) <= tolerance * max(abs(wanted), 1e-3), f"{what}: {got!r}, not {wanted!r}"


def check_file(path, vertices, cells, density, truth_of):
    """The result file in input order; returns its coordinates and their figures."""
    with h5py.File(path, "r") as result:
        image = result["/map/coordinates"][...]
        assert image.shape == (len(vertices), 2) and image.dtype == numpy.float64, image.shape
        assert numpy.array_equal(result["/mesh/vertices"][...], vertices)
        assert numpy.array_equal(result["/mesh/cells"][...], cells) and result["/mesh/cells"].dtype == numpy.int64
        assert ("/cell/density" in result) == (density is not None)
        truth = truth_of(image)
        assert numpy.allclose(result["/cell/ratio"][...], truth["cell_ratio"], rtol=1e-8, atol=1e-10)
        assert numpy.allclose(result["/vertex/ratio"][...], truth["vertex_ratio"], rtol=1e-8, atol=1e-10)
        attributes = {name: value for name, value in result.attrs.items()}
        for name in ("version", "git_commit", "options", "method", "mesh_file", "mesh_checksum", "ranks", "threads", "status", "date"):
            assert name in attributes, f"no attribute {name}"
        assert int(attributes["complete"]) == 1 and attributes["format_version"] == 2
        assert attributes["command"] in ("disk", "square") and attributes["status"] in ("converged", "not converged")
        assert attributes["folds"] == 0 and isinstance(attributes["ratio_outliers"], numpy.int64)
        close(attributes["ratio_weighted_sd"], truth["ratio_weighted"]["sd"], 1e-8, "weighted sd")
        history = {name: result["/history/" + name][...] for name in result["/history"]}
    return image, truth, history


def check_summary(summary, truth, program, code):
    mesh = summary["mesh"]
    assert summary["exit_code"] == code and summary["parallel"]["ranks"] == program.ranks, summary["parallel"]
    assert mesh["boundary_vertices"] == truth["boundary_vertices"] and summary["folds"] == truth["folds"] == 0
    close(mesh["measure"], truth["measure"], what="measure")
    close(summary["energy"]["final"], truth["energy"], 1e-7, "energy")
    assert summary["energy"]["final"] < summary["energy"]["initial"]
    for group in ("ratio", "ratio_error", "ratio_weighted"):
        for name, value in summary[group].items():
            close(value, truth[group][name], 1e-8, f"{group}.{name}")
    for name, value in summary["angle_error_deg"].items():
        close(value, truth["angle_error_deg"]["p50" if name == "median" else name], 1e-6, f"angle {name}")
    seconds, work = summary["seconds"], summary["work"]
    assert 0 <= sum(seconds[name] for name in seconds if name != "total") <= 1.001 * seconds["total"], seconds
    assert work["evaluations"] > 0 and work["factorizations"] >= work["coupled_factorizations"] > 0 and work["solves"] > 0
    memory = summary["memory_bytes"]
    assert 0 < memory["max_per_rank"] <= memory["total"] <= program.ranks * memory["max_per_rank"]


def check_history(path, history, summary):
    with open(path) as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == summary["iterations"] + 1 == len(history["energy"])
    assert [int(row["iteration"]) for row in rows] == list(range(len(rows)))
    for name in ("energy", "sd", "step", "gradient_norm", "seconds"):
        assert [float(row[name]) for row in rows] == history[name].tolist(), name
    for name in ("folds", "evaluations", "factorizations", "coupled_factorizations", "solves"):
        assert [int(row[name]) for row in rows] == history[name].tolist(), name
    close(float(rows[0]["energy"]), summary["energy"]["initial"], 1e-15, "first energy")
    close(float(rows[-1]["energy"]), summary["energy"]["final"], 1e-9, "last energy")
    close(float(rows[-1]["sd"]), summary["ratio"]["sd"], 1e-9, "last sd")


def check_target(command, image, cells):
    edges = {i for edge in boundary_edges(cells) for i in edge}
    boundary = image[sorted(edges)]
    if command == "disk":
        assert numpy.allclose(numpy.linalg.norm(boundary, axis=1), 1.0, atol=1e-14)
        assert numpy.linalg.norm(image, axis=1).max() <= 1.0 + 1e-14
    else:
        assert ((boundary == 0.0) | (boundary == 1.0)).any(axis=1).all() and image.min() == 0.0 and image.max() == 1.0
        for corner in ((0, 0), (1, 0), (1, 1), (0, 1)):
            assert (boundary == corner).all(axis=1).sum() == 1, corner


def fields_of(program):
    with h5py.File(program.file("out.h5"), "r") as result:
        return {"ratio": result["/cell/ratio"][...], "vertex_ratio": result["/vertex/ratio"][...],
                "quasi_conformal": result["/cell/quasi_conformal"][...], "conformal_factor": result["/vertex/conformal_factor"][...]}


def check_vtu(program, name, points, fields):
    """The points and the fields of a VTU file, bit for bit, and no other fields."""
    head, tail = program.read(name).split(b'encoding="base64">\n_', 1)
    arrays = {}
    for element in re.findall(rb"<DataArray [^>]*>", head):
        array = dict(re.findall(rb'(\w+)="([^"]*)"', element))
        if array[b"type"] == b"Float64":
            text = tail[int(array[b"offset"]):]
            size = int.from_bytes(base64.b64decode(text[:12])[:8], "little")
            arrays[array[b"Name"].decode()] = numpy.frombuffer(base64.b64decode(text[:4 * ((8 + size + 2) // 3)])[8:8 + size])
    assert numpy.array_equal(arrays.pop("Points").reshape(points.shape), points), name
    assert set(arrays) == set(fields), (name, set(arrays))
    for field, values in fields.items():
        assert numpy.array_equal(arrays[field], values.ravel()), (name, field)


def check_ratios(program, ratio, weight, summary):
    """Every cell is in one bin of the histogram of ratios, with its share of the measure."""
    with open(program.file("ratios.csv")) as stream:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(stream)]
    edges = numpy.array([row["from"] for row in rows] + [rows[-1]["to"]])
    assert len(rows) == 202 and (numpy.diff(edges) >= 0).all() and [row["to"] for row in rows] == edges[1:].tolist()
    assert 10 * summary["ratio_weighted"]["sd"] <= edges[-2] - 1 <= 25 * summary["ratio_weighted"]["sd"], edges[-2]
    counts = numpy.array([row["cells"] for row in rows])
    assert counts.sum() == len(ratio)
    true, _ = numpy.histogram(ratio, edges)
    assert numpy.abs(numpy.cumsum(true) - numpy.cumsum(counts)).max() <= 2  # rounding at an edge
    shares, _ = numpy.histogram(ratio, edges, weights=weight / weight.sum())
    assert numpy.abs(numpy.cumsum(shares) - numpy.cumsum([row["share"] for row in rows])).max() < 2e-3


def check_xdmf(program, name):
    """Both files beside the result: what they name is there and has the shape that they say."""
    with h5py.File(program.file(name + ".h5"), "r") as result:
        for suffix, grid, points in ((".xmf", "mesh", "/mesh/vertices"), (".map.xmf", "map", "/map/coordinates")):
            root = xml.etree.ElementTree.parse(program.file(name + suffix)).getroot()
            assert [found.get("Name") for found in root.iter("Grid")] == [grid]
            assert root.find(".//Geometry/DataItem").text == f"{name}.h5:{points}"
            for item in root.iter("DataItem"):
                file, path = item.text.split(":")
                assert file == name + ".h5" and result[path].shape == tuple(map(int, item.get("Dimensions").split())), item.text
            assert {found.get("Name") for found in root.iter("Attribute")} >= {"ratio", "vertex_ratio", "quasi_conformal"}


def check_run(program, command, mesh, vertices, cells, density, *options):
    """One run with every output, every figure checked."""
    if density is not None:
        program.write("density.csv", "cell,density\n" + "".join(f"{c},{value!r}\n" for c, value in enumerate(density.tolist())))
        options = (*options, "-density", "density.csv")
    result = program.succeed(command, mesh, "-o", "out.h5,out.obj,out.ply,out.vtu,out.off,out.msh,out.gii", "-summary", "out.json",
                             "-history", "out.csv", "-ratio_histogram", "ratios.csv", "-quiet", *options, codes=(0, 4))
    image, truth, history = check_file(program.file("out.h5"), vertices, cells, density,
                                       lambda image: evaluate(vertices, cells, image, density))
    summary = json.loads(program.read("out.json"))
    assert summary["command"] == command and os.path.basename(summary["mesh"]["file"]) == mesh
    assert (summary["mesh"]["vertices"], summary["mesh"]["cells"]) == (len(vertices), len(cells))
    check_summary(summary, truth, program, result.returncode)
    check_history(program.file("out.csv"), history, summary)
    check_target(command, image, cells)
    written, written_cells = read_obj(program.file("out.obj"))
    assert numpy.array_equal(written_cells, cells) and numpy.array_equal(written[:, :2], image) and not written[:, 2].any()
    check_ratios(program, truth["cell_ratio"], triangle_areas(vertices, cells) * (1.0 if density is None else density), summary)
    check_xdmf(program, "out")
    check_vtu(program, "out.surface.vtu", vertices, {"u": image[:, 0], "v": image[:, 1], **fields_of(program)})
    check_vtu(program, "out.vtu", numpy.c_[image, numpy.zeros(len(image))], {"surface": vertices, **fields_of(program)})
    return image, summary


def check_measure(program, mesh, summary, density):
    """equimap measure says the same of every file that was written."""
    options = ["-density", "density.csv"] if density is not None else []
    for suffix, tolerance in (("h5", 1e-12), ("obj", 1e-12), ("off", 1e-12), ("vtu", 1e-12), ("msh", 1e-12), ("ply", 1e-12), ("gii", 1e-2)):
        program.succeed("measure", mesh, "out." + suffix, "-summary", "measured.json", *options)
        measured = json.loads(program.read("measured.json"))
        for group, name in (("energy", "final"), ("ratio", "sd"), ("ratio", "max"), ("ratio_error", "p95"), ("angle_error_deg", "mean")):
            close(measured[group][name], summary[group][name], tolerance, f"{suffix}: {group}.{name}")


def check_stopping(program):
    """Stopped early: exit code 4, the map is there; -max_it 0: the start."""
    program.succeed("disk", "shuffled.obj", "-o", "start.h5", "-summary", "start.json", "-max_it", 0, codes=(4,))
    summary = json.loads(program.read("start.json"))
    assert summary["exit_code"] == 4 and summary["iterations"] == 0 and summary["energy"]["initial"] == summary["energy"]["final"]
    program.succeed("disk", "shuffled.obj", "-o", "wall.h5", "-summary", "wall.json", "-wall_time", "1e-3", "-energy_rtol", 0, codes=(4,))
    assert "wall_time" in json.loads(program.read("wall.json"))["message"]
    target = program.succeed("disk", "shuffled.obj", "-o", "target.h5", "-summary", "target.json", "-energy_target", "1e-2")
    assert target.returncode == 0 and json.loads(program.read("target.json"))["energy"]["final"] <= 1e-2
    assert "once more" not in target.stdout + target.stderr and "mixed" not in target.stdout + target.stderr, target.stdout
    for name in ("start.h5", "wall.h5", "target.h5"):
        with h5py.File(program.file(name), "r") as result:
            assert numpy.isfinite(result["/map/coordinates"][...]).all()


def check_corners(program, vertices, cells):
    """The corners that the user names are the corners."""
    follower = dict(boundary_edges(cells))
    loop = [min(follower)]
    while follower[loop[-1]] != loop[0]:
        loop.append(follower[loop[-1]])
    corners = [loop[k * len(loop) // 4 + 1] for k in range(4)]
    program.succeed("square", "shuffled.obj", "-o", "corners.h5", "-max_it", 2, "-corners", ",".join(map(str, corners)), codes=(0, 4))
    with h5py.File(program.file("corners.h5"), "r") as result:
        assert result["/map/coordinates"][...][corners].tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]


def check_help(program):
    """Help and version: on standard output, once, exit code 0."""
    assert program.succeed("--version").stdout.startswith("equimap ")
    for arguments, words in ((["--help"], ["disk", "square", "generate"]), (["disk", "--help"], ["-balance", "-max_it", "-density", "-summary"]),
                             (["square", "--help"], ["-corners"])):
        output = program.succeed(*arguments).stdout
        for word in words:
            assert word in output, f"{arguments}: nothing about {word}"
        assert output.count("usage: equimap COMMAND") == (1 if arguments == ["--help"] else 0)
    assert program.run().returncode == 2


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 900, "-seed", 5, "-o", "hills.obj", ranks=1)
        vertices, cells, _ = renumber(*read_obj(program.file("hills.obj")), 1)
        write_obj(program, "shuffled.obj", vertices, cells)
        density = 0.5 + numpy.random.RandomState(2).rand(len(cells))
        for command, weight, options in (("disk", None, ()), ("square", None, ("-balance", "0.02")), ("disk", density, ())):
            _, summary = check_run(program, command, "shuffled.obj", vertices, cells, weight, "-max_it", 8, *options)
            print(f"{command}: energy {summary['energy']['final']:.3e}, every figure as computed anew")
        check_measure(program, "shuffled.obj", summary, density)
        check_stopping(program)
        check_corners(program, vertices, cells)
        check_help(program)
    return 0


sys.exit(main())
