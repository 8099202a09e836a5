"""MATLAB files of the papers' authors become meshes and maps, and results MATLAB files.

usage: python3 test_mat.py EQUIMAP
"""
import pathlib
import subprocess
import sys

import h5py
import numpy

try:
    import scipy.io
except ImportError:
    print("no SciPy")
    sys.exit(77)

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "support"), str(TOP / "tests" / "zoo")]
from program import run_in_folder  # noqa: E402
from shapes import bricks, grid, moved  # noqa: E402


def convert(*arguments, expected=0):
    done = subprocess.run([sys.executable, TOP / "jobs" / "mat.py", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == expected and "Traceback" not in done.stderr, done.stderr
    return done.stdout + done.stderr


def read(name):
    with h5py.File(name) as file:
        return file["mesh/vertices"][:], file["mesh/cells"][:]


def main(program):
    points, cells = (numpy.array(x) for x in moved(grid(9, 8), lambda x, y, z: (x, y, 0.2 * numpy.sin(4 * x))))
    flat = points[:, 0] + 1j * points[:, 1]
    scipy.io.savemat("face.mat", {"V": points, "F": cells + 1.0, "uv": flat.reshape(-1, 1), "note": "a face", "label": numpy.ones((len(points), 1))})
    convert("face.mat", "face.h5", "--map", "uv")
    found, corners = read("face.h5")
    assert (found == points).all() and (corners == cells).all()
    assert (numpy.loadtxt("face.csv", delimiter=",", skiprows=1) == points[:, :2]).all()
    assert "energy" in program.succeed("measure", "face.h5", "face.csv").stdout

    solid, tets = (numpy.array(x) for x in bricks((2, 2, 2)))
    scipy.io.savemat("ball.mat", {"mesh": {"P": solid.astype(float), "T": (tets + 1).astype("uint32"), "F": numpy.array([[1, 2, 3]])}})
    convert("ball.mat", "ball.h5")
    assert (read("ball.h5")[1] == tets).all() and (read("ball.h5")[0] == solid).all()

    with h5py.File("new.mat", "w", userblock_size=512) as file:  # as of MATLAB 7.3: HDF5, axes the other way round
        file["V"], file["F"] = points.T, (cells + 1).T.astype(float)
    with open("new.mat", "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM")
    convert("new.mat", "new.h5")
    assert (read("new.h5")[1] == cells).all()

    program.succeed("disk", "face.h5", "-o", "map.h5", "-quiet")
    convert("map.h5", "map.mat")
    back = scipy.io.loadmat("map.mat")
    with h5py.File("map.h5") as file:
        assert (back["F"] == cells + 1).all() and (back["V"] == points).all() and (back["f"] == file["map/coordinates"][:]).all()
    scipy.io.savemat("none.mat", {"V": points, "F": cells + 100.0})
    assert "it has V 72x3, F" in convert("none.mat", "x.h5", expected=1)
    assert "no file" in convert("gone.mat", "x.h5", expected=1)
    print("mat: surfaces, solids and maps in, results out")


if __name__ == "__main__":
    run_in_folder(main)
