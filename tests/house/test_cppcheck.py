"""What cppcheck finds in src/: its errors and warnings, but for those that it is wrong about here.

usage: python3 test_cppcheck.py SOURCE      skipped (77) where cppcheck is not installed

PETSc's macros are shown to it in a form that it understands (petsc_for_cppcheck.h). SILENT: it does not see that a function
fills what its argument points to, that `any` says whether a structure has been filled, or that bytes were allocated as
numbers; a structure of main's that points to another one of main's frame is no leak.
"""
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SILENT = ("missingInclude", "missingIncludeSystem", "uninitvar", "legacyUninitvar", "uninitStructMember", "invalidPointerCast",
          "autoVariables:*/app/main.c", "autovarInvalidDeallocation:*/hierarchy/relax.c")
PLANTED = """#include <stdlib.h>
PetscErrorCode Planted(PetscInt n)
{
  PetscReal a[3] = {0.0};
  char *lost = malloc(4);

  PetscFunctionBegin;
  if (n == 3) a[n] = 1.0;
  PetscCall(Planted(lost[0]));
  PetscFunctionReturn(a[0] > 0.0);
}
"""


def check(*folders):
    """The complaints, a line each."""
    command = ["cppcheck", "--enable=warning,portability", "--std=c11", "--quiet", f"-j{os.cpu_count()}", "--template={file}:{line}: {id}: {message}",
               f"--include={os.path.join(HERE, 'petsc_for_cppcheck.h')}", *(f"--suppress={name}" for name in SILENT), *folders]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True).stderr.splitlines()


def main():
    if not shutil.which("cppcheck"):
        print("skipped: cppcheck is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "planted.c"), "w") as file:
            file.write(PLANTED)
        found = "\n".join(check(folder))
        assert "arrayIndexOutOfBounds" in found and "uninitdata" in found, f"a planted fault is not found: {found}"
    source = os.path.join(sys.argv[1], "src")
    complaints = check(f"-I{source}", f"-I{os.path.join(sys.argv[1], 'include')}", source)
    print("\n".join(complaints) or "cppcheck has no complaint")
    return 1 if complaints else 0


sys.exit(main())
