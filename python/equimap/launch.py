"""Where the program is, and how it is started: the part that needs nothing but Python, which the scripts of jobs/ use as well."""
import os
import pathlib
import shlex
import shutil

HERE = pathlib.Path(__file__).resolve().parent


def find_program():
    """The program's path: the environment's EQUIMAP, build/equimap of the tree, bin/ of the installation that this package
    belongs to, or the one on the PATH; None if it is in none of these."""
    if os.environ.get("EQUIMAP"):
        return os.environ["EQUIMAP"]
    for place in (HERE.parents[1] / "build" / "equimap", HERE.parents[3] / "bin" / "equimap"):
        if place.is_file() and os.access(place, os.X_OK):
            return str(place)
    return shutil.which("equimap")


def launcher(ranks):
    """How ranks are started: by mpirun, or by what EQUIMAP_MPIRUN names (%n stands for their number)."""
    if os.environ.get("EQUIMAP_MPIRUN"):
        return shlex.split(os.environ["EQUIMAP_MPIRUN"].replace("%n", str(ranks)))
    if ranks == 1:
        return []
    return ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]


def environment(threads=None):
    """Ours, for a run with so many threads per rank."""
    result = dict(os.environ, **({"OMP_NUM_THREADS": str(threads)} if threads else {}))
    if hasattr(os, "geteuid") and os.geteuid() == 0:  # Open MPI refuses root unless told twice
        result.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return result
