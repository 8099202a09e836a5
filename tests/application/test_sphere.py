"""equimap sphere as a user runs it: a closed surface whose vertices and triangles are in no good order; every figure computed
anew; surfaces that no map to the sphere exists for.

usage: python3 test_sphere.py EQUIMAP [RANKS]
"""
import csv
import json
import os
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import evaluate  # noqa: E402
from meshes import read_obj, renumber, write_obj  # noqa: E402
from program import Program  # noqa: E402


def determinants(image, cells):
    """Positive where an image triangle is seen counterclockwise from outside."""
    return numpy.linalg.det(image[cells])


def close(got, wanted, tolerance, what):
    assert abs(got - wanted) <= tolerance * max(abs(wanted), 1e-3), f"{what}: {got!r}, not {wanted!r}"


def check_run(program, vertices, cells, *options, most, density=None):
    """One run; returns the image."""
    result = program.succeed("sphere", "mesh.obj", "-o", "out.h5,out.obj,out.ply", "-summary", "out.json", "-history", "out.csv", *options,
                             codes=(0, 4))
    summary = json.loads(program.read("out.json"))
    with h5py.File(program.file("out.h5"), "r") as file:
        image, ratio = file["/map/coordinates"][...], file["/cell/ratio"][...]
        assert numpy.array_equal(file["/mesh/vertices"][...], vertices) and numpy.array_equal(file["/mesh/cells"][...], cells)
        assert int(file.attrs["complete"]) == 1 and int(file.attrs["exit_code"]) == result.returncode
    assert image.shape == vertices.shape and abs(numpy.linalg.norm(image, axis=1) - 1.0).max() <= 1e-14
    assert (determinants(image, cells) > 0).all(), "folds, or a mirrored map"
    truth = evaluate(vertices, cells, image, density)
    assert numpy.allclose(ratio, truth["cell_ratio"], rtol=1e-8, atol=1e-10)
    assert summary["command"] == "sphere" and summary["folds"] == 0 and summary["exit_code"] == result.returncode
    assert summary["mesh"]["boundary_vertices"] == 0 and summary["parallel"]["ranks"] == program.ranks
    close(summary["mesh"]["measure"], truth["measure"], 1e-12, "measure")
    close(summary["energy"]["final"], truth["energy"], 1e-7, "energy")
    for group in ("ratio", "ratio_error"):
        for name, value in summary[group].items():
            close(value, truth[group][name], 1e-8, f"{group}.{name}")
    close(summary["angle_error_deg"]["mean"], truth["angle_error_deg"]["mean"], 1e-6, "angle error")
    assert truth["energy"] <= most, f"{options}: energy {truth['energy']}"
    with open(program.file("out.csv")) as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == summary["iterations"] + 1
    close(float(rows[0]["energy"]), summary["energy"]["initial"], 1e-15, "first energy")
    written, written_cells = read_obj(program.file("out.obj"))
    assert numpy.array_equal(written_cells, cells) and numpy.array_equal(written, image)
    return image, summary


def check_measure(program, summary):
    """equimap measure finds the same in the files."""
    for name in ("out.h5", "out.obj", "out.ply"):
        program.succeed("measure", "mesh.obj", name, "-summary", "measured.json")
        measured = json.loads(program.read("measured.json"))
        assert measured["folds"] == 0
        for group, key in (("energy", "final"), ("ratio", "sd"), ("angle_error_deg", "mean")):
            close(measured[group][key], summary[group][key], 1e-10, f"{name}: {group}.{key}")


def check_mirrored(program, vertices, cells):
    """A surface that is oriented inwards gets a map that is oriented like it, not folded."""
    write_obj(program, "inward.obj", vertices, cells[:, ::-1])
    program.succeed("sphere", "inward.obj", "-o", "inward.h5", "-max_it", 2, codes=(0, 4))
    with h5py.File(program.file("inward.h5"), "r") as file:
        assert (determinants(file["/map/coordinates"][...], file["/mesh/cells"][...]) > 0).all()


def check_noise(program, vertices, cells):
    """The map is that of the noisy mesh, which the result holds, the same on any number of ranks."""
    found = []
    for ranks in {1, program.ranks}:
        program.succeed("sphere", "mesh.obj", "-o", "noisy.h5", "-noise", 0.005, "-seed", 3, "-max_it", 2, codes=(0, 4), ranks=ranks)
        with h5py.File(program.file("noisy.h5"), "r") as file:
            found.append((file["/mesh/vertices"][...], int(file.attrs["mesh_checksum"])))
            image, ratio = file["/map/coordinates"][...], file["/cell/ratio"][...]
            assert "-noise" in str(file.attrs["options"]) and "-seed" in str(file.attrs["options"])
    noisy = found[0][0]
    assert all(numpy.array_equal(noisy, other) and checksum == found[0][1] for other, checksum in found)
    spread = numpy.sqrt(((noisy - vertices) ** 2).sum(1).mean())
    assert 0.0045 < spread < 0.0055, f"noise of {spread}"
    assert numpy.allclose(ratio, evaluate(noisy, cells, image)["cell_ratio"], rtol=1e-8, atol=1e-10)
    refused = program.run("sphere", "mesh.obj", "-o", "refused.h5", "-noise", -1)
    assert refused.returncode == 2 and "-noise" in refused.stderr, refused.stderr


def check_hessian(program):
    """Eigenvalues in summary and result, or, built without SLEPc, a refusal before any work."""
    result = program.run("sphere", "mesh.obj", "-o", "hessian.h5", "-summary", "hessian.json", "-hessian_eigenvalues", 4)
    if result.returncode == 2:
        assert "SLEPc" in result.stderr and not os.path.exists(program.file("hessian.h5")), result.stderr
        return
    values = json.loads(program.read("hessian.json"))["hessian_eigenvalues"]
    with h5py.File(program.file("hessian.h5"), "r") as file:
        assert numpy.allclose(file["/map/hessian_eigenvalues"][...], values, rtol=1e-14)
    assert len(values) == 4 and values == sorted(values) and -1e-2 < values[0] <= 1e-9, values
    assert "smallest eigenvalues" in result.stdout and result.returncode == 0
    assert program.run("sphere", "mesh.obj", "-o", "refused.h5", "-hessian_eigenvalues", -1).returncode == 2


def check_refused(program, name, *words):
    """Exit code 3, one message that says why, no result."""
    result = program.run("sphere", name, "-o", "refused.h5")
    messages = " ".join(program.messages(result)) + result.stderr
    assert result.returncode == 3, f"{name}: exit code {result.returncode}\n{result.stdout}{result.stderr}"
    for word in words:
        assert word in messages, f"{name}: nothing about {word}: {messages}"
    assert not os.path.exists(program.file("refused.h5")) and "PETSC ERROR" not in result.stderr


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "head", "-n", 600, "-seed", 5, "-o", "head.obj", ranks=1)
        vertices, cells, _ = renumber(*read_obj(program.file("head.obj")), 1)
        write_obj(program, "mesh.obj", vertices, cells)
        density = 0.5 + numpy.random.RandomState(2).rand(len(cells))
        program.write("density.csv", "cell,density\n" + "".join(f"{c},{value!r}\n" for c, value in enumerate(density.tolist())))
        _, summary = check_run(program, vertices, cells, "-method", "fixed-point", most=0.5)
        check_run(program, vertices, cells, "-density", "density.csv", "-max_it", 6, most=0.1, density=density)
        _, summary = check_run(program, vertices, cells, most=1e-6)
        assert summary["status"] == "converged", summary["message"]
        check_measure(program, summary)
        check_mirrored(program, vertices, cells)
        check_noise(program, vertices, cells)
        check_hessian(program)
        write_obj(program, "open.obj", vertices, cells[1:])
        check_refused(program, "open.obj", "sphere", "boundary")
        program.succeed("generate", "torus", "-n", 300, "-o", "torus.obj", ranks=1)
        check_refused(program, "torus.obj", "sphere", "handle")
        refused = program.run("sphere", "mesh.obj", "-o", "refused.h5", "-start", "harmonic")
        assert refused.returncode == 2 and "-start harmonic" in refused.stderr, refused.stderr
        assert "-max_it" in program.succeed("sphere", "--help").stdout
    return 0


sys.exit(main())
