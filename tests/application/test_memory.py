"""Memory that whole runs ask for: PETSc's own book-keeping finds none that was written beyond its end or not given back
(-malloc_debug, -malloc_dump); valgrind, where it is installed, no wrong access and no block that is lost.

usage: python3 test_memory.py EQUIMAP [RANKS [valgrind]]
"""
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "support"))
from program import Program  # noqa: E402

RUNS = (
    ("disk", "hills.obj", "-o", "map.h5,map.obj", "-max_it", 3, "-checkpoint", "run.ck", "-checkpoint_every", 1),
    ("disk", "hills.obj", "-o", "out.vtu", "-method", "cascade"),
    ("square", "hills.obj", "-o", "out.ply", "-max_it", 3, "-method", "newton"),
    ("sphere", "head.obj", "-o", "out.gii", "-max_it", 3, "-prepare", "auto"),
    ("conformal", "head.obj", "-o", "out.off"),
    ("ball", "blob.msh", "-o", "out.msh", "-max_it", 3),
    ("cube", "blob.msh", "-o", "out.vtk", "-max_it", 3),
    ("register", "hills.obj", "hills.obj", "-o", "phi.h5", "-landmarks", "pairs.csv"),
    ("resample", "map.h5", "-grid", 8, "-o", "grid.obj"),
    ("measure", "hills.obj", "map.obj", "-summary", "out.json"),
    ("convert", "blob.msh", "out.h5"),
    ("check", "hills.obj"),
    ("report", "map.h5", "-o", "out.html"),
)
UNDER_VALGRIND = ("disk", "sphere", "ball", "measure", "check")


def check_books(program):
    for run in RUNS:
        quiet = () if run[0] in ("resample", "convert", "check", "measure", "report") else ("-quiet",)
        result = program.succeed(*run, *quiet, "-malloc_debug", "-malloc_dump", codes=(0, 4))
        left = [line for line in (result.stdout + result.stderr).splitlines() if " bytes " in line and " at " in line or "PETSC ERROR" in line]
        assert not left, f"{' '.join(str(word) for word in run)}: {left[:10]}"


def check_valgrind(program):
    """On one rank. Libraries keep some memory to their end, which is no loss; what they lose themselves is in valgrind.supp."""
    watch = ["valgrind", "--quiet", "--leak-check=full", "--errors-for-leak-kinds=definite", "--show-leak-kinds=definite", "--error-exitcode=99",
             "--num-callers=30", f"--suppressions={os.path.join(HERE, '..', 'support', 'valgrind.supp')}"]
    tried = set()
    for run in RUNS:
        if run[0] not in UNDER_VALGRIND or run[0] in tried:
            continue
        tried.add(run[0])
        result = subprocess.run(watch + program.command(run, ranks=1), cwd=program.folder, env=program.environment, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, timeout=1800)
        assert result.returncode in (0, 4), f"{run[0]}: {result.returncode}\n{result.stdout[-8000:]}"
    print(f"valgrind: {', '.join(sorted(tried))}")


def main():
    equimap, ranks = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1
    if sys.argv[3:] == ["valgrind"] and not shutil.which("valgrind"):
        print("skipped: valgrind is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        program = Program(equimap, ranks, folder)
        for shape, name in (("hills", "hills.obj"), ("head", "head.obj"), ("blob", "blob.msh")):
            program.succeed("generate", shape, "-n", 60, "-seed", 2, "-o", name, ranks=1)
        program.write("pairs.csv", "a,b\n3,3\n9,9\n")
        if sys.argv[3:] == ["valgrind"]:
            program.succeed("disk", "hills.obj", "-o", "map.obj", "-quiet", "-max_it", 3, codes=(0, 4))
            check_valgrind(program)
        else:
            check_books(program)
            print(f"memory: {len(RUNS)} runs, all of it given back")
    return 0


sys.exit(main())
