"""Whatever is wrong: the right exit code, one message from one rank that says what, no hang, no damage.

usage: python3 test_bad_input.py EQUIMAP [RANKS]
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

USAGE, MESH, IO = 2, 3, 6

FAN = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .4 .3\n"
FAN_FACES = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def shifted(faces, by):
    return "".join("f " + " ".join(str(int(v) + by) for v in line.split()[1:]) + "\n" for line in faces.splitlines())


def write_meshes(program):
    """The good mesh, and every kind of bad one."""
    program.succeed("generate", "hills", "-n", 300, "-o", "good.obj", ranks=1)
    for suffix in ("ply", "vtu", "off", "msh", "h5"):
        program.succeed("convert", "good.obj", "good." + suffix, ranks=1)
        content = program.read("good." + suffix)
        program.write("cut." + suffix, content[: len(content) * 2 // 3])
    lines = program.read("good.obj").decode().splitlines(keepends=True)
    program.write("cut.obj", "".join(lines)[:-4])  # ends within the last face
    program.write("empty.obj", "")
    program.write("empty.ply", "")
    program.write("garbage.obj", bytes((37 * i * i + 11) % 256 for i in range(5000)))
    program.write("garbage.ply", b"ply\n" + bytes((91 * i * i + 7) % 256 for i in range(3000)))
    program.write("quads.obj", FAN + "f 1 2 3 4\n")
    program.write("points.obj", FAN)
    program.write("nan.obj", FAN.replace(".5 .4 .3", "nan .4 .3") + FAN_FACES)
    program.write("infinite.obj", FAN.replace(".5 .4 .3", "1e400 .4 .3") + FAN_FACES)
    program.write("index.obj", FAN + FAN_FACES + "f 1 2 77\n")
    program.write("closed.obj", TETRAHEDRON)
    program.write("two.obj", FAN + FAN.replace("v ", "v 5") + FAN_FACES + shifted(FAN_FACES, 5))
    program.write("edge.obj", FAN + "v 1 1 1\nv 2 2 2\n" + FAN_FACES + "f 1 5 6\nf 5 1 7\n")
    program.write("vertex.obj", FAN + "v 9 9 9\nv 9 8 9\n" + FAN_FACES + "f 5 6 7\n")
    program.write("flat.obj", FAN.replace(".5 .4 .3", ".5 0 0") + FAN_FACES)
    program.write("flipped.obj", FAN + FAN_FACES.replace("f 2 3 5", "f 3 2 5"))
    for shape in ("annulus", "moebius", "torus", "sphere", "ball"):
        program.succeed("generate", shape, "-n", 300, "-o", shape + ".msh", ranks=1)
    program.write("short.csv", "density\n1\n2\n")
    program.write("zero.csv", "density\n" + "0\n" * sum(line.startswith("f ") for line in lines))
    program.write("words.csv", "density\n" + "much\n" * sum(line.startswith("f ") for line in lines))


# arguments, exit code, a word that the message must hold
CASES = [
    (["disk", "missing.obj"], IO, "missing.obj"),
    (["disk", "."], IO, "."),
    (["disk", "empty.obj"], IO, "empty.obj"),
    (["disk", "empty.ply"], IO, "empty.ply"),
    (["disk", "cut.obj"], IO, "line"),
    (["disk", "cut.ply"], IO, "cut.ply"),
    (["disk", "cut.vtu"], IO, "cut.vtu"),
    (["disk", "cut.off"], IO, "cut.off"),
    (["disk", "cut.msh"], IO, "cut.msh"),
    (["disk", "cut.h5"], IO, "cut.h5"),
    (["disk", "garbage.obj"], IO, "garbage.obj"),
    (["disk", "garbage.ply"], IO, "garbage.ply"),
    (["disk", "index.obj"], (IO, MESH), "77"),
    (["disk", "points.obj"], MESH, "points.obj"),
    (["disk", "nan.obj"], (IO, MESH), "nan.obj"),
    (["disk", "infinite.obj"], (IO, MESH), "infinite.obj"),
    (["disk", "closed.obj"], MESH, "closed"),
    (["square", "sphere.msh"], MESH, "closed"),
    (["disk", "two.obj"], MESH, "2 pieces"),
    (["disk", "edge.obj"], MESH, "edge"),
    (["disk", "vertex.obj"], MESH, "ver"),
    (["disk", "flat.obj"], MESH, "area"),
    (["disk", "flipped.obj"], MESH, "turn"),
    (["disk", "annulus.msh"], MESH, "boundar"),
    (["disk", "moebius.msh"], MESH, "orient"),
    (["disk", "torus.msh"], MESH, "closed"),
    (["disk", "ball.msh"], MESH, "tri"),
    (["disk"], USAGE, "mesh"),
    (["disk", "good.obj", "good.off"], USAGE, "2"),
    (["disk", "good.obj", "-max_iter", "3"], USAGE, "-max_iter"),
    (["disk", "good.obj", "-checkfoo"], USAGE, "-checkfoo"),  # PETSc has options that begin so
    (["disk", "good.obj", "-start_foo", "3"], USAGE, "-start_foo"),
    (["disk", "good.obj", "-ksp_rtol", "1e-3"], USAGE, "-ksp_rtol"),  # there is no solver without a prefix
    (["disk", "good.obj", "-method", "magic"], USAGE, "magic"),
    (["disk", "good.obj", "-start", "magic"], USAGE, "magic"),
    (["ball", "missing.msh", "-method", "magic"], USAGE, "magic"),  # options first: the mesh may take minutes to read
    (["disk", "good.obj", "-max_it", "-7"], USAGE, "-max_it"),
    (["disk", "good.obj", "-threads", "0"], USAGE, "-threads"),
    (["square", "good.obj", "-corners", "1,2,3"], USAGE, "-corners"),
    (["square", "good.obj", "-corners", "0,1,1,2"], USAGE, "-corners"),
    (["square", "good.obj", "-corners", "0,1,2,150"], USAGE, "-corners"),
    (["square", "good.obj", "-corners", "0,1,2,99999"], USAGE, "-corners"),
    (["disk", "good.obj", "-density", "missing.csv"], IO, "missing.csv"),
    (["disk", "good.obj", "-density", "short.csv"], MESH, "short.csv"),
    (["disk", "good.obj", "-density", "zero.csv"], MESH, "zero.csv"),
    (["disk", "good.obj", "-density", "words.csv"], IO, "words.csv"),
    (["nosuch", "good.obj"], USAGE, "nosuch"),
    (["measure", "good.obj"], USAGE, "measure"),
    (["measure", "good.obj", "missing.h5"], IO, "missing.h5"),
    (["measure", "good.obj", "closed.obj"], MESH, "closed.obj"),
    (["convert", "good.obj", "good.docx"], USAGE, "docx"),
    (["generate", "nosuch", "-o", "x.obj"], USAGE, "nosuch"),
    (["check", "missing.obj"], IO, "missing.obj"),
]
# where the output is what is wrong
OUTPUTS = [
    (None, USAGE, "-o"),
    ("no/such/folder/x.h5", IO, "no/such/folder"),
    ("x.docx", USAGE, "docx"),
    ("x", USAGE, "x"),
    ("/proc/x.h5", IO, "/proc"),
]


def check(program, arguments, codes, word):
    """One failing run: code, message, and nothing in the folder has changed."""
    before = {name: program.read(name) for name in os.listdir(program.folder)}
    result = program.run(*arguments)
    after = {name: program.read(name) for name in os.listdir(program.folder)}
    said = " ".join(arguments)
    codes = codes if isinstance(codes, tuple) else (codes,)
    messages = program.messages(result)
    problems = []
    if result.returncode not in codes:
        problems.append(f"exit code {result.returncode}, not {codes}")
    if len(messages) != 1:
        problems.append(f"{len(messages)} messages")
    if word.lower() not in result.stderr.lower():
        problems.append(f"no word of '{word}'")
    if "PETSC ERROR" in result.stderr:
        problems.append("PETSc's trace for a user's mistake")
    if before != after:
        problems.append(f"files changed: {sorted(set(before) ^ set(after)) or 'content'}")
    if problems:
        print(f"{said}: {'; '.join(problems)}\n{result.stdout[-500:]}{result.stderr[:1500]}", flush=True)
    return not problems


def check_foreign(program):
    """PETSc's own places may hold options for other programs: they are named, and refused on our command line only."""
    program.environment["PETSC_OPTIONS"] = "-ksp_rtol 1e-3"
    foreign = program.run("disk", "good.obj", "-o", "new.h5", "-dry_run")
    ours = program.run("disk", "good.obj", "-o", "new.h5", "-dry_run", "-ksp_rtol", "1e-3")
    del program.environment["PETSC_OPTIONS"]
    passed = foreign.returncode == 0 and foreign.stderr.count("-ksp_rtol of PETSC_OPTIONS") == 1 and ours.returncode == USAGE
    if not passed:
        print(f"PETSC_OPTIONS: exit codes {foreign.returncode}, {ours.returncode}\n{foreign.stderr[:1500]}", flush=True)
    return passed


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        write_meshes(program)
        program.write("old.ply", "an older result")
        passed = []
        for arguments, codes, word in CASES:
            output = ["-o", "new.h5,old.ply"] if arguments[0] in ("disk", "square", "ball") else []
            passed.append(check(program, arguments + output, codes, word))
        for output, codes, word in OUTPUTS:
            passed.append(check(program, ["disk", "good.obj"] + (["-o", output] if output else []), codes, word))
        passed.append(check_foreign(program))
    print(f"{sum(passed)} of {len(passed)} cases as they should be")
    return 0 if all(passed) else 1


sys.exit(main())
