"""Options are taken or refused, never dropped; help in all its forms; a run alone begins without a daemon.

usage: python3 test_options.py EQUIMAP [RANKS]
"""
import json
import os
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

COMMANDS = ["disk", "square", "sphere", "conformal", "ball", "cube", "register", "check", "measure", "convert", "generate", "report"]

# arguments that are refused with exit code 2, and what the message holds
REFUSED = [
    (["disk", "mesh.obj", "-o", "x.h5", "-balance"], ["-balance needs a value"]),
    (["disk", "mesh.obj", "-balance", "-o", "x.h5"], ["-balance needs a value"]),
    (["disk", "mesh.obj", "-o"], ["-o needs a value"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-summary"], ["-summary needs a value"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-history"], ["-history needs a value"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-max_it", "five"], ["-max_it five", "whole number"]),
    (["disk", "mesh.obj", "-o", "x.h5", "--max_it=5.5"], ["-max_it 5.5", "whole number"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-energy_target", "low"], ["-energy_target low", "number"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-energy_target", "nan"], ["-energy_target nan", "finite"]),
    (["disk", "-repair", "-quiet=mesh.obj", "mesh.obj", "-o", "x.h5"], ["-quiet mesh.obj", "true or false"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-linear_solver", "cholmodd"], ["-linear_solver cholmodd", "did you mean cholmod?"]),
    (["square", "mesh.obj", "-o", "x.h5", "-corners", "1,two,3,4"], ["-corners 1,two,3,4", "whole numbers"]),
    (["conformal", "mesh.obj", "-o", "x.h5", "-fix_points", "nan,0,0,0,1,0,0,0,1"], ["-fix_points nan", "finite"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-max_iter", "5"], ["unknown option -max_iter", "did you mean -max_it?"]),
    (["disk", "mesh.obj", "-o", "x.h5", "--Max-Iter=5"], ["unknown option", "did you mean -max_it?"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-linear_solvr", "mumps"], ["unknown option -linear_solvr", "did you mean -linear_solver?"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-xyzzy"], ["unknown option -xyzzy;"]),
    (["disk", "mesh.obj", "-o", "folder"], ["-o folder is a folder"]),
    (["disk", "mesh.obj", "-o", "x.h5,folder"], ["-o folder is a folder"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-summary", "folder"], ["-summary folder is a folder"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-resume"], ["-resume goes with -checkpoint"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-restart", "auto"], ["-restart auto goes with -checkpoint"]),
    (["convert", "mesh.obj", "x.obj", "-refine"], ["-refine needs a value"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-method", "fixedpoint"], ["-method fixedpoint", "did you mean fixed-point?"]),
    (["disk", "mesh.obj", "-o", "x.h5", "-start", "gaurded"], ["-start gaurded", "did you mean guarded?"]),
    (["disk", "mesh.obj", "-o", "x.vut"], ["x.vut", "did you mean .vtu?"]),
    (["convert", "mesh.obj", "x.ojb"], ["x.ojb", "did you mean .obj?"]),
    (["dsik", "mesh.obj"], ["no command 'dsik'", "did you mean disk?"]),
    (["help", "spere"], ["did you mean sphere?"]),
    (["disk", "--help=roff"], ["--help=roff", "man"]),
]


def check_refused(program):
    for arguments, words in REFUSED if program.ranks == 1 else REFUSED[::4]:  # what is looked at is the same on every rank
        result = program.run(*arguments)
        assert result.returncode == 2, f"{arguments}: exit code {result.returncode}\n{result.stdout}{result.stderr}"
        assert len(program.messages(result)) == 1 and "PETSC ERROR" not in result.stderr, f"{arguments}: {result.stderr}"
        for word in words:
            assert word in result.stderr, f"{arguments}: no word of '{word}'\n{result.stderr}"
        assert not os.path.exists(program.file("x.h5")), f"{arguments}: a result"


def check_spellings(program):
    """Two dashes, an equals sign, dashes in the name: the same run, to the last digit."""
    energies = []
    for spelling in (["-max_it", 2], ["--max_it", 2], ["-max_it=2"], ["--max-it=2"]):
        program.succeed("disk", "mesh.obj", "-o", "y.h5", "--summary=y.json", *spelling, codes=(4,))
        summary = json.loads(program.read("y.json"))
        assert summary["iterations"] == 2, f"{spelling}: {summary['iterations']} iterations"
        energies.append(summary["energy"]["final"])
    assert len(set(energies)) == 1, energies
    program.succeed("disk", "--repair", "mesh.obj", "--dry-run", "-o", "y.h5")  # flags take no value
    program.succeed("disk", "mesh.obj", "-repair", "true", "-dry_run", "-o", "y.h5")  # unless one is given


def check_resume(program):
    """The same command begins, and goes on where it stopped: to the same map as in one go."""
    run = ["disk", "mesh.obj", "-energy_rtol", 0, "-ratio_tol", 0]
    program.succeed(*run, "-o", "whole.h5", "-max_it", 4, codes=(4,))
    for words in (["-resume"], ["-restart", "auto"]):
        checkpoint = words[-1].strip("-") + ".ck"
        for max_it in (2, 4):
            program.succeed(*run, "-o", "resumed.h5", "-max_it", max_it, "-checkpoint", checkpoint, *words, codes=(4,))
        with h5py.File(program.file("whole.h5")) as whole, h5py.File(program.file("resumed.h5")) as resumed:
            assert resumed["history/iteration"][...].tolist() == [0, 1, 2, 3, 4]
            assert abs(whole["map/coordinates"][...] - resumed["map/coordinates"][...]).max() == 0


def check_log_view(program):
    run = ["disk", "mesh.obj", "-o", "y.h5", "-max_it", 1]
    program.succeed(*run, "-log_view", ":profile.txt", codes=(4,))
    assert b"Event" in program.read("profile.txt")
    program.succeed(*run, "-log_view", ":profile.xml:ascii_xml", codes=(4,))
    assert program.read("profile.xml").rstrip().endswith(b"</root>")
    program.write("log.yaml", "log_view: ':other.txt'\n")
    program.succeed(*run, "-options_file", "log.yaml", codes=(4,))
    assert b"Event" in program.read("other.txt")
    assert "Event" in program.succeed("-log_view", *run, codes=(4,)).stdout


def options_of(program, command):
    """From --help=json."""
    answer = json.loads(program.succeed(command, "--help=json").stdout)
    assert answer["command"] == command and answer["purpose"]
    return [option for section in answer["sections"] for option in section["options"]]


def check_help(program):
    for command in COMMANDS:
        text = program.succeed(command, "--help").stdout
        names = [option["name"] for option in options_of(program, command)]
        assert len(set(names)) == len(names), f"{command}: options listed twice"
        assert max(map(len, text.splitlines())) < 100, f"{command} --help: lines of 100 columns and more"
        for name in names:
            assert sum(line.split()[:1] == ["-" + name] and line.startswith("  -") for line in text.splitlines()) == 1, f"{command}: -{name}"
    assert program.succeed("help", "disk").stdout == program.succeed("disk", "-help").stdout
    kinds = {option["name"]: (option["kind"], option["default"]) for option in options_of(program, "square")}
    assert kinds["max_it"][0] == "integer" and kinds["balance"][0] == "real" and kinds["quiet"] == ("flag", "FALSE")
    assert kinds["corners"][0] == "integers" and kinds["o"][0] == "text" and kinds["linear_solver"] == ("choice", "auto")
    assert all(option["purpose"] for option in options_of(program, "disk"))


def check_without_mpi(program):
    """--version and --help do not even look for MPI."""
    program.environment["OMPI_MCA_mca_base_component_path"] = "/nonexistent"
    for arguments in (["--version"], ["--help"], ["help"]):
        result = program.run(*arguments, ranks=1)
        assert result.returncode == 0 and result.stdout.startswith("equimap "), f"{arguments}: {result.stderr}"
    del program.environment["OMPI_MCA_mca_base_component_path"]
    assert program.succeed("--version").stdout.count("equimap ") == 1  # once, on any number of ranks


def check_side_by_side(program):
    """Many runs alone at the same time do not take each other's temporary files away."""
    names = [f"side{k}.h5" for k in range(12)]
    runs = [program.start("disk", "mesh.obj", "-o", name, "-max_it", 0, "-quiet", ranks=1) for name in names]
    for name, run in zip(names, runs):
        output = run.communicate(timeout=120)[0]
        assert run.returncode == 4 and "Error" not in output, f"{name}: exit code {run.returncode}\n{output}"
        assert os.path.getsize(program.file(name)) > 10000, name


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 300, "-o", "mesh.obj", ranks=1)
        os.mkdir(program.file("folder"))
        check_refused(program)
        check_spellings(program)
        check_resume(program)
        check_log_view(program)
        if program.ranks == 1:
            check_help(program)
            check_side_by_side(program)
        check_without_mpi(program)
    print("options as they should be")


main()
