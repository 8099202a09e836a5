"""The commands on the pages for users of other programs, run as they stand, on generated meshes under the pages' names.

usage: python3 test_walks.py EQUIMAP
"""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.join(HERE, "..", "..")
sys.path.insert(0, os.path.join(HERE, "..", "support"))
from program import Program  # noqa: E402

# Per page what its user has: shape, vertices, seed, name.
MESHES = {
    "brains.md": [("head", 700, 1, "lh.white"), ("head", 700, 2, "other.lh.white"), ("head", 700, 1, "S.L.midthickness.surf.gii")],
    "solids.md": [("head", 300, 1, "segment.stl"), ("blob", 400, 2, "other.h5")],
    "textures.md": [("hills", 500, 1, "scan.obj"), ("head", 500, 1, "model.obj")],
}


def commands(page):
    """Lines of code blocks, and code in sentences, that are whole commands."""
    with open(os.path.join(TOP, "docs", page), encoding="utf-8") as stream:
        text = stream.read()
    lines = re.findall(r"^    ((?:equimap|wb_command) .*)$", text, re.M) + re.findall(r"`(equimap \w+ [^`]+ -o [^`]+|equimap convert [^`]+)`", text)
    return [line.split("  #")[0].strip() for line in lines]


def prepare(program, page):
    """The meshes, and what other programs would have made."""
    for shape, vertices, seed, name in MESHES[page]:
        program.succeed("generate", shape, "-n", vertices, "-seed", seed, "-o", name)
    if page == "brains.md":  # FreeSurfer's sphere: the same triangles as lh.white's
        program.succeed("sphere", "lh.white", "-o", "lh.sphere", "-method", "fixed-point", "-quiet", codes=(0, 4))
    if page == "textures.md":  # another program's texture
        program.succeed("conformal", "scan.obj", "-o", "other.h5", "-uv", "textured.obj", "-quiet", codes=(0, 4))


def main():
    count = 0
    for page in MESHES:
        with tempfile.TemporaryDirectory() as folder:
            program = Program(sys.argv[1], 1, folder)
            prepare(program, page)
            for line in commands(page):
                first, *rest = shlex.split(line)
                if first == "wb_command" and not shutil.which(first):
                    continue
                if "-fill" in rest and "built without TetGen" in program.run(*rest).stderr:  # what it would have made
                    program.succeed("generate", "blob", "-n", 400, "-o", "solid.h5")
                elif first == "equimap":
                    program.succeed(*rest, codes=(0, 4))
                else:
                    subprocess.run([first, *rest], cwd=folder, check=True, stdout=subprocess.DEVNULL)
                count += 1
    print(f"{count} commands of {len(MESHES)} pages")
    assert count >= 8


main()
