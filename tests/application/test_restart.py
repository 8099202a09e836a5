"""Runs that are interrupted and go on: test_restart.py PROGRAM [RANKS [KILLS | pairs | overhead | methods]]. With KILLS: only so many
runs that are killed at random moments, on 1, 2 and 3 ranks in turn; pairs: only runs that begin on 1, 2 or 3 ranks and end on 1, 2
or 3; overhead: only what checkpoints cost; methods: only every method of every command.
Where one rank writes what another reads the figures agree to the solver's tolerance; on the same number of ranks to the last
bit."""
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

MESHES = (("disk", "hills.obj"), ("square", "patch.obj"), ("sphere", "head.obj"), ("conformal", "hills.obj"), ("conformal", "head.obj"),
          ("ball", "blob.msh"))
ENDLESS = ("-energy_rtol", 0, "-ratio_tol", 0)


def history(program, name):
    """All columns but the clock."""
    with open(program.file(name)) as stream:
        rows = list(csv.reader(stream))
    clock = rows[0].index("seconds")
    return [row[:clock] + row[clock + 1:] for row in rows]


def coordinates(program, name):
    with h5py.File(program.file(name), "r") as result:
        return result["/map/coordinates"][...]


def energy(program, name):
    return json.loads(program.read(name))["energy"]["final"]


def check_same(program, name, reference, what=""):
    assert history(program, name + ".csv") == history(program, reference + ".csv"), f"{what} {name}: another history than {reference}"
    assert numpy.array_equal(coordinates(program, name + ".h5"), coordinates(program, reference + ".h5")), f"{what} {name}: another map"


def outputs(name):
    return ("-o", name + ".h5", "-history", name + ".csv", "-summary", name + ".json", "-quiet")


def check_readable(program, name):
    """What lies there under its name is whole."""
    for candidate in (name, name + ".previous"):
        if os.path.exists(program.file(candidate)):
            with h5py.File(program.file(candidate), "r") as state:
                assert state.attrs["complete"] == 1 and len(state["/map/coordinates"]) > 0


def remove(program, *names):
    for name in names:
        for candidate in (name, name + ".previous"):
            if os.path.exists(program.file(candidate)):
                os.remove(program.file(candidate))


def kill(program, process):
    """SIGKILL to all ranks at once; False if the run had ended by then."""
    if process.poll() is not None:
        return False
    for number in [*program.processes(process), process.pid]:
        try:
            os.kill(number, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.communicate(timeout=60)
    return True


def await_moment(program, process, seconds, writing):
    """So many seconds, and then, if asked, until the next checkpoint grows under its temporary name; or until the run has ended."""
    end = time.time() + seconds
    while process.poll() is None and (time.time() < end or (writing and not leftovers(program, "run.ck"))):
        time.sleep(0.0005 if time.time() > end else 0.01)


def leftovers(program, name=""):
    return [entry for entry in os.listdir(program.folder) if entry.startswith(name) and entry.endswith(".tmp")]


def check_kills(program, ranks, times, rng):
    """Killed again and again, at any time and while writing, restarted until it ends: as if nothing had happened."""
    method, iterations = (("lbfgs", 30), ("lm", 12), ("rgd", 20))[ranks - 1]
    run = lambda *more: ("disk", "hills.obj", "-method", method, "-max_it", iterations, *ENDLESS, *more)  # noqa: E731
    program.succeed(*run("-max_it", 0, "-checkpoint", "start.ck", *outputs("start")), codes=(4,), ranks=ranks)
    begun = time.time()
    program.succeed(*run("-restart", "start.ck", "-checkpoint", "whole.ck", "-checkpoint_every", 1, *outputs("whole")), codes=(4,),
                    ranks=ranks)
    length = time.time() - begun
    killed = writing = finished = 0
    while killed < times or finished == 0:
        remove(program, "run.ck")
        code = None
        while code is None:
            there = [name for name in ("run.ck", "run.ck.previous") if os.path.exists(program.file(name))]
            process = program.start(*run("-restart", "run.ck" if there else "start.ck", "-checkpoint", "run.ck", "-checkpoint_every",
                                         1, *outputs("run")), ranks=ranks)
            begun = time.time()
            if killed < times:
                await_moment(program, process, rng.uniform(0.1, 0.9) * length, writing=rng.random() < .5)
            if killed < times and kill(program, process):
                killed += 1
                writing += len(leftovers(program, "run.ck")) > 0
                check_readable(program, "run.ck")
                continue
            text = process.communicate(timeout=120)[0]
            code = process.returncode
            length = min(length, time.time() - begun)  # other programs may have held up the first
            assert code == 4, text
        check_same(program, "run", "whole")
        finished += 1
    assert not leftovers(program), f"left behind: {leftovers(program)}"
    print(f"{ranks} ranks, {method}: killed {killed} times, {writing} of them while writing; {finished} finished", flush=True)
    return writing


def check_many_kills(program, times):
    """On 1, 2 and 3 ranks in turn; some of them must have died while writing."""
    assert sum(check_kills(program, ranks, (times + 3 - ranks) // 3, random.Random(ranks)) for ranks in (1, 2, 3)) > 0


def check_overhead(program):
    """Seconds in checkpoints over those of the default method itself, with a mesh of the size of a scan."""
    program.succeed("generate", "hills", "-n", 30000, "-o", "scan.h5")
    for every, most in ((1, .2), (10, .03)):
        program.succeed("disk", "scan.h5", "-max_it", 20, *ENDLESS, "-checkpoint", "run.ck.h5", "-checkpoint_every", every,
                        *outputs("run"), codes=(4,), timeout=1200)
        seconds = json.loads(program.read("run.json"))["seconds"]
        print(f"every {every} iterations: {seconds['checkpoint']:.2f} s of {seconds['minimise']:.1f} s")
        assert seconds["checkpoint"] <= most * seconds["minimise"], f"{every}: {seconds}"


def methods_of(program, command):
    """Those that --help lists, the default first."""
    lines = program.succeed(command, "--help", ranks=1).stdout.splitlines()
    for number, line in enumerate(lines):
        if line.strip().startswith("-method"):
            text = " ".join(word.strip() for word in lines[number + 1:number + 4])
            return text.split("the iteration: ")[1].split("  ")[0].split(" -")[0].replace("auto, ", "").split(", ")
    raise AssertionError(f"{command} --help says nothing of -method")


def check_methods(program, all_of_them=False):
    """Methods go on to the last bit: some on two ranks, one of each kind on three, on one all of the disk; all of every command."""
    coarse = ("ball", "blob.msh", "lbfgs", "-linear_solver", "multigrid", "-lbfgs_refresh", 2)  # coarse spaces older than the metric
    some = (("disk", "hills.obj", "rgd"), ("disk", "hills.obj", "lm"), ("sphere", "head.obj", "lbfgs"), ("ball", "blob.msh", "newton"),
            ("ball", "blob.msh", "ncg"), coarse)
    every = [(command, mesh, method) for command, mesh in MESHES[:None if all_of_them else 1] for method in methods_of(program, command)]
    every += [("disk", "hills.obj", "ncg", "-ncg_refresh", 2), ("disk", "hills.obj", "lm", "-balance", .02),
              ("disk", "hills.obj", "lbfgs", "-lbfgs_refresh", 2, "-lbfgs_memory", 2), ("square", "patch.obj", "ncg", "-ncg_beta", "hager-zhang"),
              ("disk", "shared.h5", "cascade", "-energy_target", 1e-30)]
    every += [coarse] if all_of_them else [run for run in some if run[0] != "disk"]
    if program.ranks == 2:
        some = [some[1], some[3], coarse]
    for command, mesh, method, *options in every if program.ranks == 1 else some:
        run = (command, mesh, "-method", method, *options, *ENDLESS)
        start = program.run(*run, "-max_it", 0, "-checkpoint", "start.ck", *outputs("start"))
        if start.returncode == 2 and "no such method for the" in start.stderr:
            continue  # the command has it for other meshes
        assert start.returncode in (0, 4, 5), f"{command} {method}: {start.stderr}"
        whole = program.run(*run, "-restart", "start.ck", "-max_it", 5, "-checkpoint", "run.ck", "-checkpoint_every", 3, *outputs("whole"))
        if not os.path.exists(program.file("run.ck.previous")):  # it has ended before
            shutil.copy(program.file("run.ck"), program.file("run.ck.previous"))
        again = program.run(*run, "-restart", "run.ck.previous", "-max_it", 5, *outputs("run"))
        assert whole.returncode == again.returncode and whole.returncode in (0, 4, 5), f"{command} {method}: {whole.stderr}{again.stderr}"
        check_same(program, "run", "whole", f"{command} -method {method} {options}")
        work = [json.loads(program.read(name))["work"] for name in ("run.json", "whole.json")]
        assert work[0] == work[1], f"{command} {method}: {work}"
        remove(program, "run.ck", "start.ck")


def check_pairs(program, run, pairs, codes=(0,)):
    """Begun on some ranks and ended on others: the energy of a run that was not interrupted."""
    program.succeed(*run, *outputs("whole"), codes=codes, ranks=1)
    then, worst = energy(program, "whole.json"), 0.
    for begun, ended in pairs:
        if not os.path.exists(program.file(f"on{begun}.ck")):
            program.succeed(*run, "-max_it", 3, "-checkpoint", f"on{begun}.ck", *outputs("part"), codes=(4,), ranks=begun)
        program.succeed(*run, "-restart", f"on{begun}.ck", *outputs("run"), codes=codes, ranks=ended)
        now = energy(program, "run.json")
        assert abs(now - then) <= 1e-8 * then, f"{run[0]} {run[3]}, {begun} -> {ended} ranks: {now!r}, not {then!r}"
        worst = max(worst, abs(now - then) / then)
    print(f"{run[0]} {run[3]}: energies differ by {worst:.1e} at most")
    remove(program, "on1.ck", "on2.ck", "on3.ck")


def check_other_ranks(program):
    """One pair here, and on other ranks another; all of them once a night."""
    check_pairs(program, ("disk", "hills.obj", "-method", "lm", "-balance", ".02"), [(program.ranks, 1 + program.ranks % 2)])


def check_all_pairs(program):
    """On every number of ranks from every number: second-order steps to the minimum, and quasi-Newton steps on the way there."""
    pairs = [(begun, ended) for begun in (1, 2, 3) for ended in (1, 2, 3)]
    check_pairs(program, ("disk", "hills.obj", "-method", "lm", "-balance", ".02"), pairs)
    check_pairs(program, ("disk", "hills.obj", "-method", "lbfgs", "-max_it", 15, *ENDLESS), pairs, codes=(4,))
    check_pairs(program, ("sphere", "head.obj", "-method", "lbfgs", "-max_it", 15, *ENDLESS), pairs, codes=(4,))
    check_pairs(program, ("ball", "blob.msh", "-method", "newton", "-max_it", 6, *ENDLESS), pairs, codes=(4,))


def spoil(program, name, how):
    content = bytearray(program.read(name))
    if how == "emptied":
        content = b""
    elif how == "truncated":
        content = content[:len(content) * 2 // 3]
    elif how == "flipped":
        content[len(content) * 2 // 3] ^= 16
    else:
        content = b"nothing of the kind\n" * 100
    program.write(name, bytes(content))


def check_damage(program):
    """A damaged checkpoint is skipped for the one before it, with a message; two damaged ones, and those of others, are refused."""
    run = ("disk", "hills.obj", "-method", "rgd", "-max_it", 12, *ENDLESS)
    program.succeed(*run, "-checkpoint", "good.ck", "-checkpoint_every", 5, *outputs("whole"), codes=(4,))
    for how in ("emptied", "truncated", "flipped", "foreign"):
        for name in ("good.ck", "good.ck.previous"):
            shutil.copy(program.file(name), program.file(name.replace("good", "bad")))
        spoil(program, "bad.ck", how)
        result = program.succeed(*run, "-restart", "bad.ck", *outputs("run"), codes=(4,))
        assert any("warning" in line and "bad.ck" in line for line in program.messages(result)), f"{how}: {result.stderr}"
        check_same(program, "run", "whole")
        spoil(program, "bad.ck.previous", how)
        remove(program, "run.h5")
        program.succeed(*run, "-restart", "bad.ck", *outputs("run"), codes=(7,))
        assert not os.path.exists(program.file("run.h5"))
    os.remove(program.file("bad.ck"))
    shutil.copy(program.file("good.ck.previous"), program.file("bad.ck.previous"))
    program.succeed(*run, "-restart", "bad.ck", *outputs("run"), codes=(4,))
    check_same(program, "run", "whole")
    program.succeed(*run, "-restart", "nosuch.ck", *outputs("run"), codes=(6,))
    program.succeed(*run, "-restart", "whole.h5", *outputs("run"), codes=(7,))


def write_density(program):
    program.write("density.csv", "cell,density\n" + "".join(f"{c},{1 + c % 2}\n" for c in range(program.cells)))


def check_foreign(program):
    """Another mesh, command, method, density or weight of the angles: refused, and the message says which."""
    run = ("-max_it", 12, *ENDLESS, "-restart", "good.ck", *outputs("run"))
    write_density(program)
    for word, arguments in (("checksum", ("disk", "other.obj", "-method", "rgd")), ("command", ("square", "hills.obj", "-method", "rgd")),
                            ("method", ("disk", "hills.obj", "-method", "ncg")), ("-balance", ("disk", "hills.obj", "-method", "rgd", "-balance", ".1")),
                            ("density", ("disk", "hills.obj", "-method", "rgd", "-density", "density.csv"))):
        result = program.succeed(*arguments, *run, codes=(7,))
        assert word in result.stderr, f"{word}: {result.stderr}"


def check_kept_mesh(program):
    """A run leaves a copy of its mesh beside its checkpoint, once, and goes on from there where the mesh is gone."""
    write_density(program)
    options = ("-method", "rgd", "-max_it", 8, *ENDLESS, "-noise", .001, "-seed", 3)
    named = ("disk", "hills.obj", "-density", "density.csv", *options)
    program.succeed(*named, "-checkpoint", "good.ck.h5", "-checkpoint_every", 3, *outputs("whole"), codes=(4,))
    with h5py.File(program.file("good.ck.h5"), "r") as state:
        assert state.attrs["kept_mesh"] == b"good.ck.mesh.h5", state.attrs["kept_mesh"]
    with h5py.File(program.file("good.ck.mesh.h5"), "r") as kept:
        assert kept.attrs["complete"] == 1 and len(kept["/mesh/cells"]) == len(kept["/cell/density"]) == program.cells
    before, written = program.read("good.ck.mesh.h5"), os.stat(program.file("good.ck.mesh.h5")).st_mtime_ns
    shutil.copy(program.file("good.ck.h5.previous"), program.file("part.ck"))
    cases = (((), named), (("hills.obj",), named), (("density.csv",), named), (("hills.obj", "density.csv"), ("disk", *options)))
    for names, words in cases[3 if program.ranks > 1 else 0:]:
        for name in names:
            os.rename(program.file(name), program.file(name + ".away"))
        program.succeed(*words, "-restart", "part.ck", "-checkpoint", "good.ck.h5", *outputs("run"), codes=(4,))
        check_same(program, "run", "whole", f"without {names}")
        assert os.stat(program.file("good.ck.mesh.h5")).st_mtime_ns == written, "the mesh is written twice"
        for name in names:
            os.rename(program.file(name + ".away"), program.file(name))
    if program.ranks == 2:
        return
    lone = ("disk", *options, "-restart", "good.ck.h5", *outputs("run"))
    result = program.succeed("disk", "other.obj", *lone[1:], "-checkpoint", "good.ck.h5", codes=(7,))
    assert "checksum" in result.stderr and program.read("good.ck.mesh.h5") == before, "the right mesh is written over"
    for how in ("flipped", "truncated"):
        spoil(program, "good.ck.mesh.h5", how)
        program.succeed(*lone, codes=(6, 7))
    program.succeed(*named, "-restart", "good.ck.h5", "-checkpoint", "good.ck.h5", *outputs("run"), codes=(4,))
    program.succeed(*lone, codes=(4,))  # the damaged copy has been replaced
    program.succeed("convert", "other.obj", "good.ck.mesh.h5", ranks=1)
    program.succeed(*lone, codes=(7,))
    os.remove(program.file("good.ck.mesh.h5"))
    assert "name the mesh" in program.succeed(*lone, codes=(7,)).stderr


def check_finished(program):
    """The checkpoint of a run that has come to its end leads to the same end; with more iterations allowed it goes on."""
    run = ("disk", "hills.obj", "-checkpoint", "run.ck")
    program.succeed(*run, *outputs("whole"))
    program.succeed(*run, "-restart", "run.ck", *outputs("run"))
    check_same(program, "run", "whole")
    run = ("disk", "hills.obj", "-method", "rgd", *ENDLESS, "-checkpoint", "run.ck")
    program.succeed(*run, "-max_it", 4, *outputs("run"), codes=(4,))
    program.succeed(*run, "-max_it", 9, "-restart", "run.ck", *outputs("run"), codes=(4,))
    assert len(history(program, "run.csv")) == 11


def wait_for(condition, process, seconds=60):
    for _ in range(int(20 * seconds)):
        if condition():
            return
        assert process.poll() is None, f"ended too early: {process.communicate()[0]}"
        time.sleep(0.05)
    raise AssertionError("waited in vain")


def stop_and_go(program, request, *options, code=75):
    """Start a long run, make the request once it is under way; it must end with the code, and say how to go on."""
    remove(program, "run.ck", "run.h5", "run.json")
    run = ("disk", "hills.obj", "-method", "rgd", "-max_it", 100000, *ENDLESS)
    process = program.start(*run, "-checkpoint", "run.ck", *options, *outputs("run"))
    wait_for(lambda: os.path.exists(program.file("run.ck")), process)
    request(process)
    text = process.communicate(timeout=60)[0]
    assert process.returncode == code, f"exit code {process.returncode}: {text}"
    assert "-restart run.ck" in text and not os.path.exists(program.file("run.h5"))
    summary = json.loads(program.read("run.json"))
    assert summary["exit_code"] == code and "-restart" in summary["message"]
    with h5py.File(program.file("run.ck"), "r") as state:
        assert state.attrs["complete"] == 1
    program.succeed(*run, "-max_it", summary["iterations"] + 3, "-restart", "run.ck", *outputs("run"), codes=(4,))
    assert len(history(program, "run.csv")) == summary["iterations"] + 5


def check_stopping(program):
    """The signals on one rank of several, a file STOP that appears, -wall_time; and without a checkpoint."""
    signal_one = lambda number: lambda process: os.kill(program.processes(process)[-1], number)  # noqa: E731
    stop_and_go(program, signal_one(signal.SIGTERM))
    stop_and_go(program, lambda process: process.send_signal(signal.SIGUSR1))  # a launcher hands it on
    if program.ranks != 2:
        stop_and_go(program, signal_one(signal.SIGUSR1))
        stop_and_go(program, lambda process: program.write("STOP", ""))
        stop_and_go(program, lambda process: os.utime(program.file("STOP")))  # one that is there already waits for a touch
        os.remove(program.file("STOP"))
    stop_and_go(program, lambda process: None, "-wall_time", 4)
    process = program.start("disk", "hills.obj", "-method", "rgd", "-max_it", 100000, *ENDLESS, "-o", "run.h5")
    time.sleep(3)
    signal_one(signal.SIGTERM)(process)
    text = process.communicate(timeout=60)[0]
    assert process.returncode == 4 and "TERM" in text and len(coordinates(program, "run.h5")), text


def check_register(program):
    """A registration is several minimisations: stopped in the second, it goes on there."""
    run = ("register", "hills.obj", "other.obj", "-quiet")
    program.succeed(*run, "-o", "whole.h5", codes=(0, 4, 5))
    process = program.start(*run, "-o", "phi.h5", "-checkpoint", "run.ck", "-checkpoint_every", 1)
    wait_for(lambda: os.path.exists(program.file("run.ck.2")), process)
    os.kill(program.processes(process)[0], signal.SIGUSR1)
    text = process.communicate(timeout=60)[0]
    if process.returncode != 75:  # it was quicker
        assert process.returncode in (0, 4, 5), text
        return
    assert "-restart run.ck\n" in text and not os.path.exists(program.file("phi.h5")), text
    program.succeed(*run, "-o", "phi.h5", "-restart", "run.ck", codes=(0, 4, 5))
    with h5py.File(program.file("phi.h5")) as run, h5py.File(program.file("whole.h5")) as whole:
        difference = numpy.abs(run["/map/coordinates"][...] - whole["/map/coordinates"][...]).max()
    assert difference <= 1e-12, difference


def check_attempts(program):
    """A run of several attempts, stopped in the last, goes on there, bit for bit: by another method, with another weight of angles."""
    program.succeed("generate", "starfish", "-n", 100, "-o", "star.obj")
    check_last_attempt(program, ("sphere", "star.obj"), "newton")
    check_last_attempt(program, ("disk", "hills.obj", "-balance_energy", 1e-4), "lm")
    assert json.loads(program.read("run.json"))["energy"]["final"] <= 1e-4


def check_last_attempt(program, run, method):
    run = (*run, "-checkpoint", "star.ck", "-checkpoint_every", 5)
    program.succeed(*run, *outputs("whole"))
    last = max(int(name.split(".")[2]) for name in os.listdir(program.folder) if name.startswith("star.ck.") and name[8:].isdigit())
    with h5py.File(program.file(f"star.ck.{last}.previous")) as state:
        assert last > 2 and state.attrs["method"].decode() == method, (last, state.attrs["method"])
    os.replace(program.file(f"star.ck.{last}.previous"), program.file(f"star.ck.{last}"))
    program.succeed(*run, "-restart", "star.ck", *outputs("run"))
    check_same(program, "run", "whole")
    remove(program, "star.ck", *(f"star.ck.{k}" for k in range(2, last + 1)))


def check_full_disk(program):
    """The checkpoint does not fit: told once, the run goes on, what was there before is still good."""
    disk = program.file("disk")
    os.mkdir(disk)
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", disk], stderr=subprocess.DEVNULL).returncode:
        print("full disk: not tested, for no file system can be mounted here")
        return
    try:
        run = ("disk", "hills.obj", "-method", "rgd", "-max_it", 12, *ENDLESS)
        program.succeed(*run, "-max_it", 3, "-checkpoint", "disk/run.ck", *outputs("part"), codes=(4,))
        before = program.read("disk/run.ck")
        with open(program.file("disk/filler"), "wb", buffering=0) as filler:
            try:
                while filler.write(b"x" * 4096):
                    pass
            except OSError:
                pass
        result = program.succeed(*run, "-restart", "disk/run.ck", "-checkpoint", "disk/run.ck", "-checkpoint_every", 1, *outputs("run"),
                                 codes=(4,))
        assert len([line for line in program.messages(result) if "No space" in line]) == 1, result.stderr
        assert "the last checkpoint could not be written" in result.stdout, result.stdout
        assert program.read("disk/run.ck") == before
        assert len(history(program, "run.csv")) == 14
        assert sorted(os.listdir(disk)) == ["filler", "run.ck", "run.ck.mesh.h5", "run.ck.previous"], os.listdir(disk)
    finally:
        subprocess.run(["umount", disk], check=True)


def make_meshes(program):
    for shape, name, seed in (("hills", "hills.obj", 5), ("hills", "other.obj", 6), ("patch", "patch.obj", 1), ("head", "head.obj", 2),
                              ("blob", "blob.msh", 1)):
        program.succeed("generate", shape, "-n", 400, "-seed", seed, "-o", name, ranks=1)
    program.succeed("generate", "hills", "-n", 21000, "-o", "shared.h5", ranks=1)  # beyond 20,000 all ranks share a hierarchy's levels
    program.cells = sum(line.startswith(b"f") for line in program.read("hills.obj").splitlines())


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        make_meshes(program)
        if sys.argv[3:]:
            alone = {"pairs": check_all_pairs, "overhead": check_overhead, "methods": lambda program: check_methods(program, True)}
            alone.get(sys.argv[3], lambda program: check_many_kills(program, int(sys.argv[3])))(program)
            return 0
        check_kills(program, program.ranks, 2 if program.ranks == 2 else 4, random.Random(program.ranks))
        checks = [check_methods, check_other_ranks, check_kept_mesh, check_stopping, check_register, check_attempts]
        if program.ranks != 2:  # two, which are in every run, would say what one says
            checks += [check_damage, check_foreign, check_finished, check_full_disk]
        for check in checks:
            begun = time.time()
            check(program)
            print(f"{check.__name__[6:]}: {time.time() - begun:.1f} s", flush=True)
    return 0


sys.exit(main())
