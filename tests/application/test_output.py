"""What cannot be written is refused before the run, and a refused run leaves every file as it was.

usage: python3 test_output.py EQUIMAP [RANKS]
"""
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support.program import Program


def main(program):
    program.succeed("generate", "patch", "-n", "300", "-o", "patch.obj")
    mesh = program.read("patch.obj")
    old = {name: program.write(name, f"old {name}\n") and program.read(name) for name in ("a.h5", "a.json", "a.csv")}

    def refuse(code, *arguments):
        result = program.run("disk", *arguments)
        assert result.returncode == code, (arguments, result.returncode, result.stdout, result.stderr)
        assert len(program.messages(result)) == 1 and "iteration" not in result.stdout, (arguments, result.stderr)
        assert program.read("patch.obj") == mesh and all(program.read(name) == old[name] for name in old), arguments

    os.symlink("patch.obj", program.file("link.obj"))
    results = ("-summary", "a.json", "-history", "a.csv")
    refuse(6, "patch.obj", "-o", "nowhere/a.h5", *results)
    refuse(6, "patch.obj", "-o", "a.h5", "-summary", "nowhere/a.json", "-history", "a.csv")
    refuse(6, "patch.obj", "-o", "a.h5", "-summary", "a.json", "-history", "nowhere/a.csv")
    refuse(6, "absent.obj", "-o", "a.h5", *results)
    refuse(2, "patch.obj", "-o", "a.h5,patch.obj", *results)
    refuse(2, "patch.obj", "-o", "link.obj", *results)
    refuse(2, "patch.obj", "-o", "a.docx", *results)
    refuse(2, "patch.obj", "-o", "a.h5", "-summary", "-history", "a.csv")
    refuse(2, "patch.obj", "-o", "a.h5", "-summary", "a.json", "-history")

    program.succeed("disk", "-history", "a.csv", "patch.obj", "-summary", "a.json", "-o", "a.h5", codes=(0, 4))
    assert program.read("a.csv").startswith(b"iteration,energy,") and b"patch.obj" not in program.read("a.csv")
    print("output: nine refused before the run, three files written")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "1", folder))
