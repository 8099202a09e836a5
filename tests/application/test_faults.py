"""Whatever fails in the middle of a run: an allocation, a rank, a disk, a number; signals in every phase; two runs on one
checkpoint; a limit of memory. The end is one message with the exit code that belongs to it, nothing half written, no hang.

usage: EQUIMAP_FAULTS=LIBRARY python3 test_faults.py EQUIMAP [RANKS [every]]    every: each allocation, phase and sum, which takes hours
LIBRARY is made of tests/support/fault.c."""
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from evaluate import triangle_areas  # noqa: E402
from meshes import read_obj  # noqa: E402
from program import Program  # noqa: E402

ENDLESS = ("-method", "rgd", "-max_it", 100000, "-energy_rtol", 0, "-ratio_tol", 0)
COMMANDS = {
    "disk": ("disk", "hills.obj", "-o", "out.obj"),
    "checkpoint": ("disk", "hills.obj", "-o", "out.h5", "-checkpoint", "run.ck", "-max_it", 2),
    "square": ("square", "hills.obj", "-o", "out.ply"),
    "sphere": ("sphere", "head.obj", "-o", "out.vtu"),
    "conformal": ("conformal", "head.obj", "-o", "out.off"),
    "ball": ("ball", "blob.msh", "-o", "out.msh", "-max_it", 3),
    "register": ("register", "hills.obj", "hills.obj", "-o", "out.obj", "-landmarks", "pairs.csv"),
    "check": ("check", "head.obj"),
    "measure": ("measure", "hills.obj", "map.obj", "-summary", "out.json"),
    "convert": ("convert", "blob.msh", "out.vtu"),
    "generate": ("generate", "hills", "-n", 60, "-o", "out.gii"),
    "report": ("report", "map.h5", "-o", "out.html"),
}


class Faults(Program):
    """The program with a library in front of it that makes something fail."""

    def __init__(self, equimap, library, ranks, folder):
        super().__init__(equimap, ranks, folder)
        self.library = os.path.abspath(library)
        for shape, name in (("hills", "hills.obj"), ("head", "head.obj"), ("blob", "blob.msh")):
            self.succeed("generate", shape, "-n", 60, "-seed", 2, "-o", name, ranks=1)
        self.succeed("disk", "hills.obj", "-o", "map.obj,map.h5", "-quiet", ranks=1)
        self.write("pairs.csv", "a,b\n3,3\n9,9\n")
        self.given = set(os.listdir(folder))

    def fault(self, arguments, ranks=None, timeout=180, **fault):
        """Run with a fault; what lay there from the run before is removed first."""
        self.clear()
        before = dict(self.environment)
        self.environment.update({f"FAULT_{name.upper()}": str(value) for name, value in fault.items()}, LD_PRELOAD=self.library)
        try:
            return self.run(*arguments, ranks=ranks, timeout=timeout)
        finally:
            self.environment = before

    def clear(self):
        for name in self.made():
            os.remove(self.file(name))

    def made(self):
        return sorted(set(os.listdir(self.folder)) - self.given)

    def count(self, arguments, ranks=None):
        """Places where memory is asked for, phases, sums over ranks."""
        result = self.fault(arguments, ranks, report=self.file("counts"))
        assert result.returncode in (0, 3, 4, 5), result.stderr
        return [int(word) for word in self.read("counts").split()[:3]]

    def unfinished(self):
        return [name for name in self.made() if ".tmp" in name or name.endswith(".lock")]


def is_sound(program, name):
    """A file under its own name is whole."""
    path = program.file(name)
    if name.endswith(".json"):
        json.loads(program.read(name))
    elif h5py.is_hdf5(path):
        with h5py.File(path, "r") as file:
            assert file.attrs["complete"] == 1, name
    else:
        assert os.path.getsize(path) > 0, name


def check_end(program, what, result, codes):
    """One message, a code that belongs to it, whole files or none. An error that the program could do without is none."""
    text = f"{what}: exit code {result.returncode}\n{result.stdout}{result.stderr}"
    assert result.returncode in codes, text
    if result.returncode in (1, 2, 3, 6, 7):
        own = [line for line in result.stderr.splitlines() if line.startswith("equimap: ") and " warning: " not in line]
        assert 1 <= len(own) <= program.ranks, text
        made = [name for name in program.made() if name.startswith("out.")]  # what was whole before something else failed stays
        assert not made or (result.returncode in (1, 6) and not any(name in re.findall(r"[\w.]+", own[0]) for name in made)), f"{text}{made}"
    left = [name for name in program.unfinished() if program.ranks == 1 or not name.endswith(".lock")]  # of a rank that was ended
    assert not left, f"{what}: {left}"
    for name in program.made():
        if name not in program.unfinished():
            is_sound(program, name)


def check_allocations(program, runs):
    """An allocation fails, on the last rank: `runs` of each command, spread evenly over all of them; 0: every one."""
    for name, arguments in COMMANDS.items():
        if program.ranks > 1 and name not in ("disk", "checkpoint", "register", "ball"):
            continue
        begun, places = time.time(), program.count(arguments)[0]
        step = max(1, places // runs) if runs else 1
        usual = program.run(*arguments).returncode
        survived = 0
        for k in range(1 + step // 2, places + 1, step):
            result = program.fault(arguments, allocation=k, rank=program.ranks - 1)
            check_end(program, f"{name}, allocation {k} of {places}", result, (1, 6, 7, usual))
            survived += result.returncode == usual
        print(f"allocations: {name}: {places} places, {len(range(1 + step // 2, places + 1, step))} failed, {survived} did no harm, "
              f"{time.time() - begun:.0f} s", flush=True)


def check_terms(program, every):
    """TERM when a phase begins. Of a map, what there is by then goes into a checkpoint; others end at once."""
    run = ("disk", "hills.obj", "-o", "out.h5", "-checkpoint", "run.ck", "-checkpoint_every", 1, "-max_it", 3)
    phases = program.count(run)[1]
    seen = set()
    for k in range(2, phases + 1, 1 if every else 3 * program.ranks):
        result = program.fault(run, signal=f"{int(signal.SIGTERM)}@{k}", rank=program.ranks - 1)
        check_end(program, f"TERM in phase {k}", result, (0, 4, 75))
        seen.add(result.returncode)
        if result.returncode == 75:
            assert "TERM" in result.stdout and "run.ck" in program.made() and "out.h5" not in program.made(), result.stdout
            program.succeed(*run, "-restart", "run.ck", "-quiet", codes=(0, 4))
        assert "out.h5" in program.made()
    assert 75 in seen, seen
    for name in ("convert", "check", "measure"):
        result = program.fault(COMMANDS[name], signal=f"{int(signal.SIGTERM)}@2", ranks=1)
        assert result.returncode == -signal.SIGTERM or result.returncode == 0, f"{name}: {result.returncode}"
        assert not result.stderr and not program.unfinished(), result.stderr


def lives(number):
    try:
        with open(f"/proc/{number}/stat") as stream:
            return stream.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def check_dead_rank(program):
    """One rank is killed: the others end within seconds, and the last checkpoint is good."""
    for victim in (0, program.ranks - 1):
        program.clear()
        process = program.start("disk", "hills.obj", *ENDLESS, "-checkpoint", "run.ck", "-checkpoint_every", 1, "-o", "out.h5", "-quiet")
        end = time.time() + 60
        while not os.path.exists(program.file("run.ck.previous")) and time.time() < end:
            time.sleep(.02)
        ranks = sorted(program.processes(process))
        os.kill(ranks[victim], signal.SIGKILL)
        killed = time.time()
        process.communicate(timeout=60)
        assert process.returncode != 0 and time.time() - killed < 20, (process.returncode, time.time() - killed)
        assert not [number for number in ranks if lives(number)], "a rank lives on"
        assert "out.h5" not in program.made(), program.made()
        is_sound(program, "run.ck")
        on = program.succeed("disk", "hills.obj", "-method", "rgd", "-max_it", 0, "-restart", "run.ck", "-checkpoint", "run.ck", "-o", "out.h5",
                             codes=(0, 4))
        assert "after iteration" in on.stdout and not program.unfinished(), on.stdout


def check_two_runs(program):
    """The second that wants the same checkpoint is told so; the first goes on."""
    program.clear()
    run = ("disk", "hills.obj", *ENDLESS, "-checkpoint", "run.ck", "-quiet", "-o")
    first = program.start(*run, "first.h5")
    end = time.time() + 60
    while not os.path.exists(program.file("run.ck")) and time.time() < end:
        time.sleep(.02)
    refused = program.succeed(*run, "out.h5", codes=(2,))
    assert "another run writes it" in refused.stderr and "out.h5" not in program.made(), refused.stderr
    os.kill(program.processes(first)[0], signal.SIGUSR1)
    text = first.communicate(timeout=60)[0]
    assert first.returncode == 75 and not program.unfinished(), text
    killed = program.start(*run, "first.h5", "-restart", "run.ck")
    while not os.path.exists(program.file("run.ck.lock")) and time.time() < end + 60:
        time.sleep(.02)
    for number in [*program.processes(killed), killed.pid]:
        os.kill(number, signal.SIGKILL)
    killed.communicate(timeout=60)
    program.succeed("disk", "hills.obj", "-method", "rgd", "-max_it", 1, "-restart", "run.ck", "-checkpoint", "run.ck", "-o", "out.h5", "-quiet",
                    codes=(0, 4))  # a lock dies with its process
    assert not program.unfinished(), program.unfinished()


def check_nan(program, every):
    """A sum over all ranks is no number: a method may recover from it, but then its map is right."""
    vertices, cells = read_obj(program.file("hills.obj"))
    for method in ("lm", "lbfgs", "rgd", "fixed-point", "ncg"):
        run = ("disk", "hills.obj", "-method", method, "-max_it", 12, "-o", "out.h5", "-summary", "out.json")
        sums = program.count(run)[2]
        measured = range(sums - 15, sums + 1, 1 if every else 3) if method == "lm" else ()  # the figures of the result are the last
        for k in sorted({*range(1, sums + 1, 1 if every else max(1, sums // 4)), *measured}):
            result = program.fault(run, nan=k)
            text = f"{method}, sum {k} of {sums}: exit code {result.returncode}\n{result.stdout}{result.stderr}"
            assert result.returncode in (0, 1, 4, 5), text
            if result.returncode == 1:
                assert "out.h5" not in program.made() and ("finite" in result.stderr or "equimap: " in result.stderr), text
                continue
            with h5py.File(program.file("out.h5"), "r") as file:
                image = file["/map/coordinates"][...]
            assert numpy.isfinite(image).all(), text
            if result.returncode == 0:
                share = triangle_areas(image, cells) / triangle_areas(vertices, cells)
                share *= triangle_areas(vertices, cells).sum() / triangle_areas(image, cells).sum()
                told = json.loads(program.read("out.json"))
                assert share.min() > 0. and math.isclose(told["ratio"]["sd"] or -1., share.std(), rel_tol=1e-6), text
            assert "null" not in program.read("out.json").decode(), text


def fill(path):
    with open(path, "wb", buffering=0) as filler:
        try:
            while filler.write(b"x" * 4096):
                pass
        except OSError:
            pass


def check_disks(program):
    """A full disk, a read-only one, a limit of file size: for the result, the checkpoint, the summary, the history."""
    disk = program.file("disk")
    os.mkdir(disk)
    outputs = {"-o": ("out.h5", "out.obj", "out.vtu"), "-summary": ("out.json",), "-history": ("out.csv",)}
    for size, options in (("full", "size=64k"), ("read-only", "ro")):
        if subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", disk], stderr=subprocess.DEVNULL).returncode:
            print("disks: not tested, for no file system can be mounted here")
            break
        try:
            if size == "full":
                fill(os.path.join(disk, "filler"))
            there = os.listdir(disk)
            for option, names in outputs.items():
                for name in names:
                    more = () if option == "-o" else ("-o", "good.obj")
                    result = program.run("disk", "hills.obj", option, "disk/" + name, *more, "-quiet")
                    own = program.messages(result)
                    assert result.returncode == 6 and len(own) == 1 and "disk/out" in own[0], f"{size} {name}: {result.returncode} {result.stderr}"
                    assert os.listdir(disk) == there, f"{size} {name}: {os.listdir(disk)}"
        finally:
            subprocess.run(["umount", disk], check=True)
    os.rmdir(disk)
    program.clear()
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))  # noqa: E731
    for name in ("out.h5", "out.obj"):
        result = subprocess.run(program.command(("disk", "hills.obj", "-o", name, "-quiet"), ranks=1), cwd=program.folder, timeout=120,
                                env=program.environment, preexec_fn=limit, stderr=subprocess.PIPE, text=True)
        assert result.returncode == 6 and "File too large" in result.stderr and not program.made(), (name, result, program.made())


def check_memory_limits(program):
    """ulimit -v from what the program itself takes upwards: one message or a result."""
    program.succeed("generate", "hills", "-n", 8000, "-o", "large.obj", ranks=1)
    needed = None
    for mib in (200, 260, 300, 340, 400, 600):
        limit = lambda mib=mib: resource.setrlimit(resource.RLIMIT_AS, (mib << 20, mib << 20))  # noqa: E731
        for name in ("out.h5", "out.obj"):
            if name in program.made():
                os.remove(program.file(name))
        result = subprocess.run(program.command(("disk", "large.obj", "-max_it", 2, "-o", "out.obj", "-quiet"), ranks=1), cwd=program.folder,
                                env=program.environment, preexec_fn=limit, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, timeout=120)
        if result.returncode == 127 or "shared librar" in result.stderr:
            continue  # not even loaded
        assert result.returncode in (0, 1, 4, 6), (mib, result)
        if result.returncode in (1, 6):
            assert len(program.messages(result)) == 1 and "out.obj" not in program.made() and not program.unfinished(), (mib, result)
        elif needed is None:
            needed = mib
    assert needed, "no limit is large enough"
    program.clear()


def main():
    equimap, library = sys.argv[1], os.environ["EQUIMAP_FAULTS"]
    ranks = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    every = sys.argv[3:] == ["every"]
    with tempfile.TemporaryDirectory() as folder:
        program = Faults(equimap, library, ranks, folder)
        checks = [(check_dead_rank,), (check_terms, every), (check_allocations, 0 if every else 3 if ranks == 1 else 2)]
        if ranks == 1:
            checks = [(check_disks,), (check_two_runs,), (check_memory_limits,), (check_nan, every), *checks[1:]]
        for check, *more in checks:
            begun = time.time()
            check(program, *more)
            print(f"{check.__name__[6:]}: {time.time() - begun:.1f} s", flush=True)


main()
