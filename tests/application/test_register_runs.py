"""equimap register as a long run, and with meshes that are not quite right: -repair, densities, copies of its meshes beside its
checkpoints, requests to stop between its steps.

usage: python3 test_register_runs.py EQUIMAP [RANKS]
"""
import json
import os
import shutil
import signal
import sys
import tempfile
import time

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import boundary_edges, triangle_areas  # noqa: E402
from meshes import read_obj, renumber, write_obj  # noqa: E402
from program import Program  # noqa: E402
from test_register import check_location, deform, rotation  # noqa: E402
from test_repair import make_mesh  # noqa: E402


def result(program, name, path="/map/coordinates"):
    with h5py.File(program.file(name), "r") as file:
        return file[path][...]


def summary(program, name):
    return json.loads(program.read(name))


def fingerprint(cells):
    return [tuple(sorted(cell)) for cell in cells.tolist()]


def check_repair(program):
    """A copy of a mesh with ears, twins, turned triangles and a lost vertex: all that comes out is in the files' numbers."""
    points, cells, _, _ = make_mesh()
    vertices, cells = numpy.array(points), numpy.array(cells)
    moved, other_cells, place = renumber(vertices @ rotation(5).T + 3.0, cells, 6)
    write_obj(program, "a.obj", vertices, cells)
    write_obj(program, "b.obj", moved, other_cells)
    program.write("number.csv", "number\n" + "".join(f"{c}\n" for c in range(len(other_cells))))
    run = ("register", "a.obj", "b.obj", "-o", "out.h5", "-transfer", "coordinates,b:number.csv", "-frames", 2)
    refused = program.succeed(*run, codes=(3,))
    assert "a.obj b.obj -repair -o OUT" in refused.stderr and not os.path.exists(program.file("out.h5"))
    told = program.succeed(*run, "-repair", "-summary", "out.json").stdout
    assert "A: repair: 2 twins" in told and "B: repair: 2 twins" in told and "A: warning: 1 vertex belongs to no" in told, told
    assert summary(program, "out.json")["repair"]["cells_split"] == 8 and summary(program, "out.json")["folds"] == 0
    used = numpy.unique(cells)
    with h5py.File(program.file("out.h5"), "r") as file:
        image, inverse = file["/map/coordinates"][...], file["/inverse/coordinates"][...]
        assert len(image) == len(inverse) == len(vertices) and len(file["/repaired/vertices"]) == len(vertices) + 4
        assert abs(image[used] - moved[place[used]]).max() < 1e-5 and abs(inverse[place[used]] - vertices[used]).max() < 1e-5
        check_used(file, "register", used, moved, other_cells, image)
        check_used(file, "inverse", place[used], vertices, cells, inverse)
        assert abs(file["/transfer/to_b/coordinates"][...][place[used]] - vertices[used]).max() < 1e-5
        number, kept = file["/transfer/to_a/number"][...].astype(int), sorted(set(file["/repaired/parent"][...]))
        names = [fingerprint(place[cells]), fingerprint(other_cells)]
        assert all(names[0][c] == names[1][number[c]] for c in kept), "a cell has the number of another"
        assert abs(file["/morph/frame_001"][...][used] - image[used]).max() < 1e-12 and len(file["/mesh/cells"]) == len(cells)
    for name in "ab":
        program.succeed("disk", f"{name}.obj", "-repair", "-o", f"{name}.h5", "-quiet", "-ratio_tol", "3e-3", "-lm_inner", 0)
    program.succeed("register", "a.h5", "b.h5", "-repair", "-o", "again.h5", "-quiet")  # /repaired has the added vertices
    assert abs(result(program, "again.h5")[used] - image[used]).max() < 1e-5
    program.succeed("register", "a.h5", "b.h5", "-repair", "-map_a", "a.h5", "-o", "again.obj", "-quiet")


def check_used(file, group, used, vertices, cells, points):
    """Cell and barycentric coordinates of the vertices that have a place."""
    cell, weight = file[f"/{group}/cell"][...][used], file[f"/{group}/barycentric"][...][used]
    assert cell.min() >= 0 and weight.min() >= 0.0 and abs(weight.sum(axis=1) - 1.0).max() < 1e-12
    assert abs((weight[:, :, None] * vertices[cells[cell]]).sum(axis=1) - points[used]).max() < 1e-9


def check_densities(program):
    """Each mesh has its own: shares of the image are shares of mass."""
    vertices, cells = make_hills(program)
    for name, axis in (("a", 0), ("b", 1)):
        program.write(f"{name}.csv", "density\n" + "".join(f"{1 + 4 * x!r}\n" for x in vertices[cells[:, 0], axis].tolist()))
    density = [1 + 4 * vertices[cells[:, 0], axis] for axis in (0, 1)]
    program.succeed("register", "hills.obj", "deformed.obj", "-density_a", "a.csv", "-density_b", "b.csv", "-o", "out.h5", "-quiet")
    for path, points, weight in (("/register/target", vertices, density[0]), ("/inverse/target", deform(vertices), density[1])):
        share = triangle_areas(result(program, "out.h5", path), cells)
        mass = triangle_areas(points, cells) * weight
        ratio = share / share.sum() * mass.sum() / mass
        assert ratio.std() < 2e-2, f"{path}: {ratio.std()}"


def make_hills(program):
    program.succeed("generate", "hills", "-n", 300, "-o", "hills.obj", ranks=1)
    vertices, cells = read_obj(program.file("hills.obj"))
    write_obj(program, "deformed.obj", deform(vertices), cells)
    pairs = numpy.random.RandomState(3).choice(len(vertices), 5, replace=False)
    program.write("pairs.csv", "a,b\n" + "".join(f"{i},{i}\n" for i in pairs))
    return vertices, cells


def move(program, names, away):
    for name in names:
        os.rename(*(program.file(name + end) for end in (("", ".away") if away else (".away", ""))))


def check_goes_on(program, run, files, kept, *options):
    """A run that was stopped goes on without its files, named or not; with them gone and the copies too it is refused."""
    program.succeed(*run, *options, "-quiet", "-o", "whole.h5")
    remove_checkpoints(program)
    program.succeed(*run, *options, "-wall_time", "1e-9", "-checkpoint", "run.ck.h5", "-quiet", "-o", "part.h5", codes=(75,))
    with h5py.File(program.file("run.ck.h5.1"), "r") as state:
        assert state.attrs["kept_mesh"].decode() == ",".join(kept), state.attrs["kept_mesh"]
    kept = [name for name in kept if name != "target"]
    written = [os.stat(program.file(name)).st_mtime_ns for name in kept]
    shutil.copy(program.file("run.ck.h5.1"), program.file("then.h5.1"))
    move(program, files, True)
    for words, old in ((run, "run.ck.h5"), (run[:1], "then.h5")):  # named as before, and not at all
        told = program.succeed(*words, *options, "-restart", old, "-checkpoint", "run.ck.h5", "-o", "on.h5").stdout
        assert all(f"the run's own copy, './{name}'" in told for name in kept[:len(files)]), told
        difference = abs(result(program, "on.h5") - result(program, "whole.h5")).max()
        assert difference == 0.0 if program.ranks == 1 else difference < 2e-2, f"{words}: {difference}"
    assert written == [os.stat(program.file(name)).st_mtime_ns for name in kept], "written twice"
    return kept, (*run[:1], *options, "-restart", "run.ck.h5", "-quiet", "-o", "refused.h5")


def remove_checkpoints(program):
    for name in os.listdir(program.folder):
        if ".ck." in name or name.startswith("then."):
            os.remove(program.file(name))


def spoil(program, name, place):
    """Flip a bit of one of the dataset's numbers."""
    with h5py.File(program.file(name), "r") as file:
        at = file[place].id.get_offset() + 8 * 4
    content = bytearray(program.read(name))
    content[at] ^= 1
    program.write(name, bytes(content))


def check_kept_meshes(program):
    """Copies of both meshes, with maps that were read; the files may go. Foreign and damaged ones are refused."""
    vertices, cells = make_hills(program)
    files, both = ("hills.obj", "deformed.obj"), ("run.ck.a.mesh.h5", "run.ck.b.mesh.h5")
    kept, lone = check_goes_on(program, ("register", *files), files, both, "-landmarks", "pairs.csv")
    move(program, files, False)
    before = [program.read(name) for name in kept]
    foreign = program.succeed("register", "deformed.obj", "hills.obj", *lone[1:], "-checkpoint", "run.ck.h5", codes=(7,))
    assert "checksum" in foreign.stderr and [program.read(name) for name in kept] == before, "the right meshes are written over"
    spoil(program, kept[1], "/mesh/vertices")
    assert "damaged" in program.succeed(*lone, codes=(7,)).stderr
    os.remove(program.file(kept[1]))
    assert "name the mesh" in program.succeed(*lone, codes=(7,)).stderr
    assert not os.path.exists(program.file("refused.h5"))

    for name, mesh in (("a.h5", "hills.obj"), ("b.h5", "deformed.obj")):
        program.succeed("disk", mesh, "-o", name, "-quiet", "-ratio_tol", "3e-3", "-lm_inner", 0)
    shutil.copy(program.file("b.h5"), program.file("map.h5"))
    run = ("register", "a.h5", "deformed.obj")
    kept, lone = check_goes_on(program, run, ("a.h5", "map.h5"), both, "-landmarks", "pairs.csv", "-map_b", "map.h5")
    spoil(program, kept[0], "/map/coordinates")
    assert "map's checksum" in program.succeed(*lone, codes=(7,)).stderr

    inner = numpy.setdiff1d(numpy.arange(len(vertices)), boundary_edges(cells))
    program.write("places.csv", "a,x,y\n%d,.3,.2\n%d,-.3,.1\n" % (inner[20], inner[-20]))
    check_goes_on(program, ("register", "hills.obj", "target"), ("hills.obj",), ("run.ck.a.mesh.h5", "target"), "-landmarks", "places.csv")
    move(program, ("hills.obj",), False)


def start_reading(program, name, *arguments):
    """Start, with a pipe for a file, and return when the program reads it; then a function that lets it read."""
    content = program.read(name)
    os.rename(program.file(name), program.file(name + ".file"))
    os.mkfifo(program.file(name))
    process = program.start(*arguments)
    pipe = open(program.file(name), "wb")  # waits for the reader

    def let_read():
        pipe.write(content)
        pipe.close()
        text = process.communicate(timeout=60)[0]
        os.rename(program.file(name + ".file"), program.file(name))
        return process.returncode, text

    return process, let_read


def check_stops(program):
    """A request is answered at the next boundary between two steps, and the run goes on later."""
    make_hills(program)
    run = ("register", "hills.obj", "deformed.obj", "-checkpoint", "run.ck.h5", "-o", "out.h5", "-quiet", "-summary", "out.json")
    program.succeed("register", "hills.obj", "deformed.obj", "-o", "whole.h5", "-quiet")
    for name, request in (("hills.obj", "USR1"), ("deformed.obj", "TERM"), ("deformed.obj", "STOP")):
        process, let_read = start_reading(program, name, *run)
        if request == "STOP":
            program.write("STOP", "")
        else:
            os.kill(program.processes(process)[-1], getattr(signal, "SIG" + request))
        code, text = let_read()
        assert code == 75 and request in text and "before the first iteration" in text, (code, text)
        assert not os.path.exists(program.file("out.h5")) and summary(program, "out.json")["exit_code"] == 75
        assert not [entry for entry in os.listdir(program.folder) if entry.startswith("run.ck.h5")], "a checkpoint of nothing"
    program.succeed(*run)  # the file STOP, which is still there, is an old one
    os.remove(program.file("out.h5"))
    timed = program.succeed(*run, "-restart", "run.ck.h5", "-wall_time", "1e-9", codes=(75,))  # only the end is left to do
    assert "after 2 minimisations; to go on: the same command with -restart run.ck.h5\n" in timed.stdout, timed.stdout
    assert timed.stdout.count("to go on") == 1, timed.stdout
    assert not os.path.exists(program.file("out.h5")) and summary(program, "out.json")["exit_code"] == 75
    program.succeed(*run, "-restart", "run.ck.h5")
    difference = abs(result(program, "out.h5") - result(program, "whole.h5")).max()
    assert difference == 0.0 if program.ranks == 1 else difference < 2e-2, difference
    check_map_stops(program)


def check_map_stops(program):
    """The same while a map command reads: what it has then is its start."""
    for request in ("USR1", "STOP"):
        process, let_read = start_reading(program, "hills.obj", "disk", "hills.obj", "-checkpoint", "run.ck", "-o", "map.h5", "-quiet")
        if request == "STOP":
            program.write("STOP", "again")
        else:
            os.kill(program.processes(process)[-1], signal.SIGUSR1)
        code, text = let_read()
        assert code == 75 and "after iteration 0" in text and "-restart run.ck" in text, (code, text)
    program.succeed("disk", "-restart", "run.ck", "-o", "map.h5", "-quiet")
    program.succeed("generate", "blob", "-n", 200, "-o", "blob.msh", ranks=1)
    ball = ("ball", "blob.msh", "-max_it", 2, "-quiet", "-energy_rtol", 0)
    program.succeed(*ball, "-o", "whole.h5", codes=(4,))
    process, let_read = start_reading(program, "blob.msh", *ball, "-checkpoint", "ball.ck", "-o", "map.h5")
    os.kill(program.processes(process)[0], signal.SIGUSR1)
    code, text = let_read()
    assert code == 75 and "after iteration 0" in text, (code, text)
    program.succeed(*ball, "-restart", "ball.ck", "-o", "map.h5", codes=(4,))
    difference = abs(result(program, "map.h5") - result(program, "whole.h5")).max()  # the surface's map, too, is the whole one
    assert difference == 0.0 if program.ranks == 1 else difference < 1e-3, difference


def main():
    equimap, ranks = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1
    for check in (check_repair, check_densities, check_kept_meshes, check_stops):
        begun = time.time()
        with tempfile.TemporaryDirectory() as folder:
            check(Program(equimap, ranks, folder))
        print(f"{check.__name__[6:]}: {time.time() - begun:.1f} s", flush=True)


if __name__ == "__main__":
    main()
