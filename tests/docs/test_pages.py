"""Man pages and completion hold what --help holds, and the documentation names options that there are.

usage: python3 test_pages.py EQUIMAP
"""
import json
import os
import re
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.join(HERE, "..", "..")
sys.path.insert(0, os.path.join(HERE, "..", "support"))
from program import Program  # noqa: E402

# Options of other programs that the pages speak of, and PETSc's own.
FOREIGN = {"n", "c", "t", "j", "R", "L", "S", "B", "q", "std", "np", "LE", "i", "options_file", "log_view", "h", "linear_ksp_type",
           "linear_pc_type", "linear_mat_type"}


def options_of(program, command):
    answer = json.loads(program.succeed(command, "--help=json").stdout)
    return [option for section in answer["sections"] for option in section["options"]]


def check_man(pages, command, options):
    """A page per command, with every option, that the formatter takes without a complaint."""
    name = os.path.join(pages, "man1", f"equimap-{command}.1" if command else "equimap.1")
    with open(name, encoding="utf-8") as stream:
        text = stream.read()
    assert re.search(r"\.SH NAME\nequimap\S* \\- \S", text), name
    for option in options:
        bold = ".B \\-" + option["name"].replace("-", "\\-")
        assert re.search("^" + re.escape(bold) + "( |$)", text, re.M), f"{name}: nothing about -{option['name']}"
    if shutil.which("groff"):
        result = subprocess.run(["groff", "-man", "-Tutf8", "-ww", name], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert not result.stderr and len(result.stdout) > 500, f"{name}: {result.stderr}"


def complete(pages, *words):
    """What bash offers for the last of the words."""
    script = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _equimap; printf "%s\\n" "${COMPREPLY[@]}"'
    result = subprocess.run(["bash", "-c", script, "bash", os.path.join(pages, "completion", "equimap"), *words],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=True, cwd=HERE)
    assert not result.stderr, result.stderr
    return result.stdout.split()


def check_completion(pages, options):
    assert set(options) <= set(complete(pages, "equimap", "")), "a command is missing"
    assert complete(pages, "equimap", "help", "meas") == ["measure"]
    for command, own in options.items():
        offered = complete(pages, "equimap", command, "-")
        assert offered == ["-" + option["name"] for option in own], f"{command}: {offered}"
    assert complete(pages, "equimap", "disk", "--max_i") == ["--max_it"]
    assert complete(pages, "equimap", "disk", "x.obj", "-linear_solver", "chol") == ["cholmod"]
    assert complete(pages, "equimap", "disk", "-method", "fix") == ["fixed-point"]
    assert complete(pages, "equimap", "generate", "star") == ["starfish"]
    assert complete(pages, "equimap", "disk", "test_pag") == ["test_pages.py"]
    assert complete(pages, "equimap", "disk", "-repair", "test_pag") == ["test_pages.py"]
    assert complete(pages, "equimap", "disk", "-o", "test_pag") == ["test_pages.py"]


def check_named(options):
    """What stands behind a dash in code is an option of some command."""
    known = FOREIGN | {option["name"] for own in options.values() for option in own}
    for page in ("README.md", "docs/manual.md", "docs/clusters.md", "docs/accuracy.md", "docs/methods.md"):
        with open(os.path.join(TOP, page), encoding="utf-8") as stream:
            text = stream.read()
        for code in re.findall(r"`[^`]+`|^    .*$", text, re.M):
            if re.match(r"`?\s*(jobs/|cmake|apptainer|sbatch|ctest|apt|spack|mpicc|srun|jube|OMPI|#)", code):
                continue
            for name in re.findall(r"(?<![\w\-.)])-([A-Za-z][\w\-]*)", code):
                assert name.endswith("_") or name.startswith("linear_") or name.replace("-", "_") in known, f"{page}: there is no option -{name}: {code.strip()}"


def main():
    program = Program(sys.argv[1], 1, HERE)
    pages = os.path.join(os.path.dirname(program.path), "pages")
    if not os.listdir(os.path.join(pages, "man1")):
        print("the build could not run the program")
        sys.exit(77)
    usage = program.succeed("--help").stdout
    commands = list(dict.fromkeys(re.findall(r"^  equimap (\w+) ", usage, re.M)))
    options = {command: options_of(program, command) for command in commands}
    assert len(commands) >= 11, commands
    check_man(pages, "", [])
    for command in commands:
        check_man(pages, command, options[command])
    check_completion(pages, options)
    check_named(options)
    print(f"{len(commands)} commands, {sum(map(len, options.values()))} options")


main()
