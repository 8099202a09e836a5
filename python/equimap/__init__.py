"""Area-, volume- and angle-preserving maps of meshes: results as NumPy arrays, and runs of the program equimap.

    import equimap

    result = equimap.run("disk", "scan.ply", max_it=20, ranks=2, progress=True)
    result.map, result.ratio, result.history["energy"], result.summary["folds"]
    again = equimap.read("map.h5")
    equimap.write("mesh.obj", (vertices, cells))

`import equimap.meshio` teaches meshio to read and write our HDF5 files. Needs NumPy and h5py; reading results needs no program.
"""
from .errors import (CheckpointError, EquimapError, FileError, FoldsRemain, InternalError, MeshError, NotConverged, Stopped,
                     UsageError)
from .files import Result, read, write
from .launch import find_program
from .runs import check, generate, measure, run

__all__ = ["CheckpointError", "EquimapError", "FileError", "FoldsRemain", "InternalError", "MeshError", "NotConverged", "Result",
           "Stopped", "UsageError", "check", "find_program", "generate", "measure", "read", "run", "write"]
