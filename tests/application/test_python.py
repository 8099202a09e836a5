"""The Python package: runs, results, meshes in and out, exit codes as exceptions, meshio; on one rank the examples, too.

usage: python3 test_python.py EQUIMAP RANKS
"""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

TREE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TREE / "python"))
import equimap  # noqa: E402


def refused(kind, words, *arguments, **options):
    """The exception of a run that must fail, and in what words."""
    try:
        result = equimap.run(*arguments, **options)
    except equimap.EquimapError as problem:
        assert type(problem) is kind and words in problem.message, (type(problem), problem.message)
        return problem
    raise AssertionError(("no exception", arguments, options, result))


def check_run(ranks):
    """Arrays in, a file kept, progress as it comes; what is read is what the file holds."""
    mesh = equimap.generate("hills", 400, seed=3)
    lines = []
    result = equimap.run("disk", (mesh.vertices, mesh.cells), output="map.h5,map.obj", ranks=ranks, threads=1, max_it=4,
                         progress=lines.append)
    assert result.summary["exit_code"] == 4 and result.summary["parallel"]["ranks"] == ranks, result.summary
    assert any("iteration" in line for line in lines) and any("written" in line for line in lines), lines
    with h5py.File("map.h5") as file:
        assert (file["map/coordinates"][:] == result.map).all() and (file["cell/ratio"][:] == result.ratio).all()
        assert (file["mesh/vertices"][:] == mesh.vertices).all() and (file["mesh/cells"][:] == mesh.cells).all()
        assert set(result.history) == set(file["history"]) and len(result.history["energy"]) == 5
        assert (file["cell/quasi_conformal"][:] == result.fields["cell/quasi_conformal"]).all()
    again = equimap.read("map.h5")
    assert (again.map == result.map).all() and again.attributes["command"] == "disk" and again.attributes["folds"] == 0
    for group, figure in (("energy", "final"), ("ratio", "sd"), ("mesh", "checksum"), ("angle_error_deg", "mean")):
        assert abs(again.summary[group][figure] / result.summary[group][figure] - 1.) < 1e-12, (group, figure)
    assert again.summary["status"] == result.summary["status"] == "not converged"
    share = result.image_weights() / result.image_weights().sum() * result.weights().sum() / result.weights()
    assert numpy.abs(share - result.ratio).max() < 1e-12, "the ratios are those of the mesh and the map"
    image = equimap.read("map.obj")
    assert (image.cells == mesh.cells).all() and numpy.abs(image.vertices[:, :2] - result.map).max() < 1e-15
    return mesh, result


def check_options(mesh):
    """Arrays in the place of files, flags, lists."""
    x = mesh.vertices[mesh.cells].mean(1)[:, 0]
    density = 1. + (x > numpy.median(x))
    options = {"max_it": 6, "threads": 1}
    plain, heavy = equimap.run("disk", mesh, **options), equimap.run("disk", mesh, density=density, repair=False, **options)
    share = plain.weights() * density
    wanted = share / share.sum() * heavy.image_weights().sum() / heavy.image_weights()
    assert numpy.abs(wanted * heavy.ratio - 1.).max() < 1e-9, "ratios are of mass, to the last digits of the densities"
    assert numpy.abs(heavy.map - plain.map).max() > .05
    corners = equimap.run("square", mesh, method="fixed-point", max_it=3, threads=1).map
    assert corners.min() == 0. and corners.max() == 1.


def check_register(mesh, result):
    """A result goes with its map, landmarks as an array."""
    found = equimap.run("register", result, (mesh.vertices, mesh.cells), landmarks=numpy.array([[0, 0], [40, 40]]), max_it=6,
                        threads=1, accept=(0, 4, 5))
    assert found.map.shape == mesh.vertices.shape and found.fields["register/cell"].shape == (len(mesh.vertices),)


def check_measure(mesh, result):
    """A map made elsewhere, and the same with a fold."""
    figures = equimap.measure(mesh, result.map)
    assert abs(figures["energy"]["final"] / result.summary["energy"]["final"] - 1.) < 1e-9 and figures["exit_code"] == 0
    folded = result.map.copy()
    folded[(folded ** 2).sum(1).argmin()] = [.9, 0.]  # the middle's vertex goes to the rim
    assert equimap.measure("map.h5", folded)["exit_code"] == 5
    report = equimap.check(mesh)
    assert report["commands"]["disk"] and not report["commands"]["sphere"]


def check_failures(mesh, ranks):
    """Exit codes as exceptions that carry the program's words, said once however many ranks there are."""
    problem = refused(equimap.MeshError, "-prepare auto fills them", "disk", equimap.generate("annulus", 300), output="none.h5", ranks=ranks)
    assert problem.message.count("-prepare auto fills them") == 1 and not os.path.exists("none.h5")
    problem = refused(equimap.NotConverged, "", "disk", mesh, max_it=1, accept=(0,), ranks=ranks, threads=1)
    assert problem.code == 4 and problem.result.map.shape == (len(mesh.vertices), 2)


def check_refusals(mesh):
    """The other exit codes, and arrays that are no mesh."""
    refused(equimap.UsageError, "nonsense", "disk", mesh, method="nonsense", output="none.h5")
    refused(equimap.FileError, "absent.obj", "disk", "absent.obj", output="none.h5")
    pathlib.Path("bad.ck.h5").write_bytes(b"no checkpoint")
    refused(equimap.CheckpointError, "bad.ck.h5", "disk", mesh, restart="bad.ck.h5", checkpoint="bad.ck.h5")
    assert not os.path.exists("none.h5") and equimap.check(equimap.generate("torus", 300))["exit_code"] == 3
    for mistake in ((mesh.vertices, mesh.cells.astype(float)), (mesh.vertices[:, :1], mesh.cells)):
        try:
            equimap.run("disk", mistake)
        except ValueError:
            continue
        raise AssertionError("arrays that are no mesh were taken")


def check_stop(mesh):
    """Stopped with a checkpoint, and gone on with."""
    refused(equimap.Stopped, "", "disk", mesh, checkpoint="run.ck.h5", wall_time=1e-9, threads=1)
    assert equimap.run("disk", mesh, checkpoint="run.ck.h5", restart="run.ck.h5", threads=1, max_it=3).map is not None


def check_meshes(mesh):
    """Written and read again, in our format and in others, to the last bit; an older file survives a failure."""
    solid = equimap.generate("ball", 200)
    for one in (mesh, solid):
        for suffix in ("h5", "vtu"):
            equimap.write("copy." + suffix, one)
            copy = equimap.read("copy." + suffix)
            assert (copy.vertices == one.vertices).all() and (copy.cells == one.cells).all() and copy.map is None
    equimap.write("copy.h5", mesh, {"cell/density": mesh.weights()})
    assert (equimap.read("copy.h5").fields["cell/density"] == mesh.weights()).all()
    try:
        equimap.write("copy.h5", mesh, {"cell/density": [object()]})
    except TypeError:
        assert "cell/density" in equimap.read("copy.h5").fields and not list(pathlib.Path().glob("part-*"))
    else:
        raise AssertionError("a field of objects was written")


def check_meshio(result):
    if not importlib.util.find_spec("meshio"):
        print("meshio is not there (Debian: python3-meshio): left out")
        return
    import meshio
    import equimap.meshio  # noqa: F401

    mesh = meshio.read("map.h5")
    assert (mesh.points == result.vertices).all() and (mesh.cells_dict["triangle"] == result.cells).all()
    assert (mesh.cell_data["ratio"][0] == result.ratio).all() and (mesh.point_data["map"][:, :2] == result.map).all()
    mesh.write("meshio.vtu")  # the fields are such as meshio's other formats take
    mesh.write("meshio.h5")
    again = equimap.read("meshio.h5")
    assert (again.map == result.map).all() and (again.ratio == result.ratio).all() and (again.cells == result.cells).all()
    assert equimap.check(mesh)["mesh"]["vertices"] == len(result.vertices)


def check_examples():
    """The scripts in examples/ run, and what they show is so."""
    environment = {**os.environ, "PYTHONPATH": str(TREE / "python")}
    said = {}
    for name in ("histogram", "resample"):
        done = subprocess.run([sys.executable, TREE / "examples" / (name + ".py")], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=120)
        assert done.returncode == 0, done.stdout
        said[name] = done.stdout
    rows = [line.split() for line in said["histogram"].splitlines() if line.startswith(("fixed-point ", "default "))]
    assert all(abs(float(row[1]) / float(row[2]) - 1.) < 1e-3 for row in rows) and len(rows) == 2, said["histogram"]
    pixels, surface = (float(line.split(":")[1].split()[0]) for line in said["resample"].splitlines() if "mean over" in line)
    assert abs(pixels / surface - 1.) < .01 and "without a value: 0" in said["resample"], said["resample"]
    assert numpy.load("height.npy").shape == (128, 128)


def main(ranks):
    mesh, result = check_run(ranks)
    check_failures(mesh, ranks)
    if ranks == 1:  # the rest does not know how many there are
        check_options(mesh)
        check_register(mesh, result)
        check_refusals(mesh)
        check_measure(mesh, result)
        check_stop(mesh)
        check_meshes(mesh)
        check_meshio(result)
        check_examples()
    assert json.dumps(result.summary)
    print("python: runs, results, failures, meshes")


if __name__ == "__main__":
    os.environ["EQUIMAP"] = os.path.abspath(sys.argv[1])
    os.environ.pop("EQUIMAP_MPIRUN", None)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main(int(sys.argv[2]))
        os.chdir("/")
