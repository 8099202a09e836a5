"""The batch scripts of PBS and LSF with stand-ins for qsub and bsub, and what submit.py says and refuses.

usage: python3 test_batch.py EQUIMAP
"""
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
JOBS = HERE.parents[1] / "jobs"
sys.path.insert(0, str(HERE.parent / "support"))
import slurm  # noqa: E402

PATIENCE = 150  # seconds, for what takes a few on an idle machine
ENDLESS = "method: rgd\nmax_it: 100000000\nenergy_rtol: 0\ncheckpoint_every: 100\n"
COMMAND = "sphere head.obj -o {name}.h5 -options_file {name}.yaml"


def stamp(path):
    return os.stat(path).st_mtime_ns if path and os.path.exists(path) else None


def script(name, *arguments, expected, until=None, told=signal.SIGTERM, **environment):
    """Run a batch script as its system would; tell it, and the launcher, to stop once the file `until` has been written."""
    before = stamp(until)
    with open("said", "w+", encoding="utf-8") as said:
        process = subprocess.Popen([JOBS / name, *arguments], env={**os.environ, **environment}, stdout=said,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        end = time.monotonic() + PATIENCE
        try:
            while until and stamp(until) in (None, before) and process.poll() is None and time.monotonic() < end:
                time.sleep(.05)
            if until:
                os.killpg(process.pid, told)
            code = process.wait(max(1, end - time.monotonic()))
        except subprocess.TimeoutExpired:
            code = "does not end"
            for pid in (*slurm.descendants(process.pid), process.pid):
                os.kill(pid, signal.SIGKILL)
        said.seek(0)
        text = said.read()
    assert code == expected, (name, code, text)
    return text


def write_options(name, text=ENDLESS):
    pathlib.Path(f"{name}.yaml").write_text(text)


def stand_in(name, does):
    """A command that the batch scripts call."""
    path = pathlib.Path("bin") / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!/bin/sh\n{does}\n")
    path.chmod(0o755)


def check_pbs():
    """Stopped on request, when its time is up or by its own clock, the job submits itself again with all that it was given;
    deleted, it does not."""
    write_options("pbs")
    given = {"EQUIMAP_COMMAND": COMMAND.format(name="pbs"), "EQUIMAP_JOBS": str(JOBS), "PBS_JOBID": "1.server",
             "EQUIMAP_QSUB": "-N equimap -l select=1:ncpus=1:mpiprocs=1", "EQUIMAP_RANKS": "1"}
    # to every process of the job, two ranks and their mpirun among them
    said = script("run.pbs", expected=75, until="pbs.checkpoint.h5", **{**given, "EQUIMAP_RANKS": "2"})
    assert "stopped on request" in said and "told to stop (TERM)" in said and "stopped; ended by PBS" in said, said
    assert not os.path.exists("qsub.log")
    said = script("run.pbs", expected=75, until="pbs.checkpoint.h5", told=signal.SIGUSR1, **given)
    assert "told to stop (USR1)" in said and "back into the queue (1 of at most 20)" in said, said
    noted = pathlib.Path("qsub.log").read_text()
    assert "-V -N equimap -l select=1:ncpus=1:mpiprocs=1" in noted and "EQUIMAP_ATTEMPT=1" in noted, noted
    said = script("run.pbs", expected=75, EQUIMAP_ATTEMPT="1", EQUIMAP_WALLTIME="00:00:03", EQUIMAP_REQUEUES="1", **given)
    assert "going on from pbs.checkpoint.h5" in said and "stopped by -wall_time 3" in said, said
    assert "enough (EQUIMAP_REQUEUES=1)" in said and pathlib.Path("qsub.log").read_text() == noted, said
    said = script("run.pbs", expected=75, until="pbs.checkpoint.h5", EQUIMAP_WALLTIME="00:01:00", **given)
    assert "told to stop (TERM)" in said and "back into the queue (1 of at most 20)" in said, said
    write_options("pbs", ENDLESS.replace("100000000", "10"))
    said = script("run.pbs", expected=4, EQUIMAP_ATTEMPT="2", **given)
    assert "restart from " in said and "ended with exit code 4" in said, said
    pathlib.Path("t.csv").write_text("name,command,mesh,options\none,sphere,head.obj,-max_it 3\ntwo,sphere,head.obj,-max_it 4\n")
    script("sweep.pbs", expected=0, PBS_ARRAY_INDEX="2", EQUIMAP_TABLE="t.csv", EQUIMAP_SWEEP="--results pbs-swept",
           EQUIMAP_JOBS=str(JOBS), PBS_JOBID="2[2].server")
    assert os.listdir("pbs-swept") == ["two"]


def check_launcher():
    """A launcher that is ended by the request returns a code of its own: the run has stopped all the same, and only then."""
    write_options("frail")
    given = {"EQUIMAP_COMMAND": COMMAND.format(name="frail"), "EQUIMAP_JOBS": str(JOBS), "PBS_JOBID": "3.server"}
    stand_in("frail", 'trap "kill -9 \\$!; sleep .2; exit 1" USR1; "$@" & wait')
    said = script("run.pbs", expected=75, until="frail.checkpoint.h5", told=signal.SIGUSR1, EQUIMAP_MPIRUN="frail", **given)
    assert "launcher ended with code 1" in said and "back into the queue" in said, said
    said = script("run.pbs", expected=1, EQUIMAP_MPIRUN="false", **given)
    assert "ended with exit code 1" in said and "back into the queue" not in said, said


def check_slurm():
    """What test_slurm.py cannot bring about: a time limit without a warning, and a preemption that ends mpirun's daemons on other
    nodes and says nothing to the script."""
    stand_in("scontrol", 'echo "$*" >>scontrol.log; [ "$1" = requeue ] || echo "JobId=9 $SHOWN Restarts=0 "')
    stand_in("ends", "exit $ENDS_WITH")
    given = {"EQUIMAP_JOBS": str(JOBS), "EQUIMAP_MPIRUN": "ends", "SLURM_JOB_ID": "9", "SLURM_JOB_NODELIST": "n[1-2]"}
    preempted = "JobState=RUNNING Reason=None PreemptTime=2026-01-01T00:00:00"
    for shown, code, expected, requeued in (
            ("JobState=RUNNING Reason=None PreemptTime=None", 75, 75, True),
            ("JobState=RUNNING Reason=None PreemptTime=None", 205, 205, False),
            (preempted, 205, 75, True),
            (preempted, 5, 5, False),
            ("JobState=COMPLETING Reason=TimeLimit", 75, 75, True),
            ("JobState=COMPLETING Reason=None", 75, 75, False)):
        pathlib.Path("scontrol.log").write_text("")
        said = script("run.slurm", *shlex.split(COMMAND.format(name="slurm")), expected=expected, SHOWN=shown, ENDS_WITH=str(code),
                      **given)
        assert ("back into the queue (1 of at most 20)" in said) == requeued, (shown, code, said)
        assert ("requeue 9\n" in pathlib.Path("scontrol.log").read_text()) == requeued, (shown, code, said)
    # a row of a sweep has failed by that, and is run again
    given.update(SLURM_ARRAY_JOB_ID="7", SLURM_ARRAY_TASK_ID="2", SHOWN=preempted, EQUIMAP_RESULTS="slurm-swept")
    said = script("sweep.slurm", "t.csv", expected=75, ENDS_WITH="205", **given)
    assert "failed: row 2" in said and "requeue 7_2\n" in pathlib.Path("scontrol.log").read_text(), said
    said = script("sweep.slurm", "t.csv", expected=0, SLURM_RESTART_COUNT="1", **{**given, "EQUIMAP_MPIRUN": ""})
    assert "1 finished" in said, said


def check_lsf():
    """Code 75, for which LSF requeues the job, as long as there is a turn left; 1 afterwards."""
    write_options("lsf")
    words = shlex.split(COMMAND.format(name="lsf"))
    given = {"LSB_JOBID": "7", "LSB_DJOB_NUMPROC": "1", "EQUIMAP_JOBS": str(JOBS), "EQUIMAP_REQUEUES": "1"}
    said = script("run.lsf", *words, expected=75, until="lsf.checkpoint.h5", **given)
    assert "back into the queue (1 of at most 1)" in said, said
    said = script("run.lsf", *words, "-wall_time", "2", expected=1, **given)
    assert "attempt 2" in said and "going on from " in said and "enough (EQUIMAP_REQUEUES=1)" in said, said
    write_options("lsf", ENDLESS.replace("100000000", "10").replace("energy_rtol: 0", "energy_target: 1e6"))
    said = script("run.lsf", *words, expected=0, **given)
    assert "restart from " in said, said
    assert not list(pathlib.Path(".").glob("lsf.checkpoint*")), "a run that has converged needs no checkpoint"
    # register has several checkpoints
    words, given = ("register", "head.obj", "head.obj", "-o", "reg.h5", "-options_file", "lsf.yaml"), {**given, "LSB_JOBID": "8"}
    write_options("lsf")
    script("run.lsf", *words, "-wall_time", "2", expected=75, **given)
    write_options("lsf", ENDLESS.replace("100000000", "3").replace("energy_rtol: 0", "energy_target: 1e6"))
    said = script("run.lsf", *words, expected=0, **given)
    assert "going on from reg.checkpoint.h5" in said and "restart from 'reg.checkpoint.h5.1'" in said, said
    assert not list(pathlib.Path(".").glob("reg.checkpoint*")) and pathlib.Path("reg.h5").exists()
    script("sweep.lsf", "t.csv", "--results", "lsf-swept", expected=0, LSB_JOBINDEX="1", **given)
    assert os.listdir("lsf-swept") == ["one"]


def submit(*words, expected=0):
    done = subprocess.run([sys.executable, JOBS / "submit.py", *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=60, check=False)
    assert done.returncode == expected and "Traceback" not in done.stdout, (words, done.returncode, done.stdout)
    return done.stdout


def check_submit():
    """What is said to each system, and what never gets there."""
    run = ("sphere", "head.obj", "-o", "map.h5", "-max_it", "3")
    resources = ("--dry-run", "--ranks", "4", "--threads", "2", "--nodes", "2", "--time", "2:30:00", "--memory", "8G",
                 "--queue", "long", "--account", "maps")
    said = submit("--system", "pbs", *resources, *run)
    assert "select=2:ncpus=4:mpiprocs=2:ompthreads=2:mem=8192mb -l walltime=2:30:00 -q long -A maps" in said, said
    assert "EQUIMAP_COMMAND='sphere head.obj -o map.h5 -max_it 3'" in said, said
    said = submit("--system", "lsf", *resources, *run)
    assert "-n 4 -W 2:30 -wt 3 -wa USR1 -r -Q 75" in said and "-q long -P maps" in said, said
    said = submit("--system", "pbs", "--time", "10", "--sweep", "t.csv", "--results", "sent")
    assert "qsub -V -J 1-2 " in pathlib.Path("qsub.log").read_text() and "4711" in said, said
    assert "fewer would be faster" in submit("--system", "lsf", "--dry-run", "--ranks", "8", "--", *run)
    said = submit("--system", "lsf", "--dry-run", "register", "head.obj", "head.obj", "-o", "map.h5")
    assert "run.lsf register head.obj head.obj -o map.h5" in said, said
    os.makedirs("closed")
    wrong = {
        ("--dry-run", "sphere", "absent.obj", "-o", "m.h5"): "cannot read absent.obj",
        ("--dry-run", "disk", "head.obj", "-o", "m.h5"): "cannot be mapped to the disk",
        ("--dry-run", "sphere", "head.obj"): "no output named",
        ("--dry-run", "sphere", "head.obj", "-o", "no/where/m.h5"): "no/where",
        ("--dry-run", "sphere", "head.obj", "-o", "head.obj"): "head.obj",
        ("--dry-run", "sphere", "head.obj", "-o", "m.h5", "-maxit", "3"): "unknown option -maxit",
        ("--dry-run", "sphere", "head.obj", "-o", "m.h5", "-method", "best"): "best",
        ("--dry-run", "--time", "1", *run): "no time between",
        ("--dry-run", "--nodes", "3", "--ranks", "2", *run): "more nodes than ranks",
        ("--dry-run", "--time", "soon", *run): "'soon' is no time",
        ("--dry-run", "--memory", "lots", *run): "'lots' is no amount of memory",
        ("--dry-run", "--sweep", "absent.csv"): "cannot read the table",
        ("--dry-run", "register", "head.obj", "absent.obj", "-o", "m.h5"): "cannot read absent.obj",
        ("--dry-run", "generate", "head", "-o", "m.h5"): "'generate' is not of it",
        ("--dry-run",): "--sweep TABLE",
        (*run,): "no bsub",
    }
    for words, complaint in wrong.items():
        said = submit("--system", "lsf", *words, expected=2)
        assert complaint in said, (words, said)
    assert not os.path.exists("m.h5") and not os.path.exists("map.h5")


def main(program):
    subprocess.run([program, "generate", "head", "-n", "600", "-o", "head.obj"], check=True, stdout=subprocess.DEVNULL)
    stand_in("qsub", 'echo "$0 $*" >>qsub.log; env | grep ^EQUIMAP_ >>qsub.log; echo 4711')
    os.environ.update(EQUIMAP=program, PATH=f"{os.getcwd()}/bin:{os.environ['PATH']}")
    check_pbs()
    check_launcher()
    check_slurm()
    check_lsf()
    check_submit()
    print("batch: PBS and LSF stopped, gone on with and capped; submit.py says what it should and refuses what it must")


if __name__ == "__main__":
    path = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main(path)
        os.chdir("/")
