"""The batch scripts under a Slurm that is started on the loopback by this test: a job that is warned before its time limit,
two that are preempted, with a warning and without, one that is stopped too often, one that is cancelled, a sweep as a job
array, submit.py. Skipped (77) where Slurm is absent.

usage: python3 test_slurm.py EQUIMAP
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
JOBS = HERE.parents[1] / "jobs"
sys.path.insert(0, str(HERE.parent / "support"))
import slurm  # noqa: E402

# Gradient descent that takes hours; with the second options a run ends after the iterations that it has behind it.
ENDLESS = "method: rgd\nmax_it: 100000000\nenergy_rtol: 0\ncheckpoint_every: 100\n"
FINITE = ENDLESS.replace("100000000", "10")


class Run:
    """A batch job that maps a small mesh, for ever until it is let off."""

    def __init__(self, cluster, name, *options, **environment):
        self.cluster, self.name = cluster, name
        self.folder = pathlib.Path(name)
        self.folder.mkdir()
        (self.folder / "options.yaml").write_text(ENDLESS)
        self.job = cluster.submit("-J", name, "-o", f"{name}/log", *options, JOBS / "run.slurm", "sphere", "head.obj",
                                  "-o", f"{name}/map.h5", "-options_file", f"{name}/options.yaml", "-history",
                                  f"{name}/history.csv", **environment)

    def log(self):
        path = self.folder / "log"
        return path.read_text(errors="replace") if path.exists() else ""

    def checkpoint(self):
        return self.folder / "map.checkpoint.h5"

    def await_checkpoint(self):
        self.cluster.await_true(self.checkpoint().exists, lambda: f"{self.name}: no checkpoint\n{self.log()}")

    def let_off(self):
        """The next attempt will come to an end. The present one has read its options."""
        (self.folder / "options.yaml").write_text(FINITE)

    def check_second_attempt(self, *said):
        """The job goes back into the queue, for the reason given, and ends by itself, from the checkpoint of the first attempt."""
        self.cluster.wait_for_requeue(self.job)
        self.cluster.release(self.job)
        job = self.cluster.wait(self.job, "COMPLETED", "FAILED")
        log = self.log()
        assert job["ExitCode"] in ("0:0", "4:0") and job["Restarts"] == "1", (job["ExitCode"], job["Restarts"], log)
        for words in (*said, "going on from ", "restart from ", "attempt 2"):
            assert words in log, (words, log)
        assert (self.folder / "map.h5").exists() and (self.folder / "history.csv").exists()


def check_waits(cluster):
    """A time limit and two preemptions, while each other's time passes. Slurm looks at the clock every thirty seconds: it
    warns the first job after thirty to sixty of its two minutes."""
    runs = (limited, warned, unwarned) = (
        Run(cluster, "limited", "-p", "steady", "-n", "1", "-t", "2", "--signal=B:USR1@60"),
        Run(cluster, "warned", "-p", "low", "-n", "1", "-t", "10"),
        Run(cluster, "unwarned", "-p", "lowest", "-n", "2", "-t", "10"))
    for run in runs:
        run.await_checkpoint()
        run.let_off()
    # The one that takes their place needs both, whether or not the first has gone already.
    urgent = cluster.submit("-J", "urgent", "-p", "high", "-n", "5", "-t", "1", "-o", "urgent.log", "--wrap", "sleep 3")
    back = "back into the queue (1 of at most 20)"
    warned.check_second_attempt("told to stop (USR1)", back)
    unwarned.check_second_attempt("told to stop (TERM)", "stopped on request", "stopped; Slurm has put it back into the queue")
    cluster.wait(urgent, "COMPLETED")
    limited.check_second_attempt("told to stop (USR1)", back)


def check_ends(cluster):
    """What may not go back into the queue, and what is cancelled, says so, and keeps its checkpoint and its exit code."""
    capped = Run(cluster, "capped", "-p", "steady", "-n", "1", "-t", "30", EQUIMAP_REQUEUES="0")
    cancelled = Run(cluster, "cancelled", "-p", "steady", "-n", "2", "-t", "30")
    for run in (capped, cancelled):
        run.await_checkpoint()
    cluster.run("scancel", "--batch", "--signal=USR1", capped.job)
    cluster.run("scancel", cancelled.job)
    for run, state, said in ((capped, "FAILED", "enough (EQUIMAP_REQUEUES=0)"), (cancelled, "CANCELLED", "stopped; cancelled")):
        job = cluster.wait(run.job, "FAILED", "CANCELLED", "PENDING")
        assert (job["JobState"], job["ExitCode"], job["Restarts"]) == (state, "75:0", "0"), (job, run.log())
        assert "stopped on request" in run.log() and said in run.log(), run.log()
        assert run.checkpoint().exists()


def check_array(cluster):
    """A row that is stopped goes back into the queue, and not the others with it, and goes on from its checkpoint."""
    pathlib.Path("s.yaml").write_text(ENDLESS)
    pathlib.Path("s.csv").write_text("name,command,mesh,options\n" + "".join(
        f"{name},sphere,head.obj,-options_file s.yaml\n" for name in ("one", "two")))
    array = cluster.submit("--array=1-2", "-p", "steady", "-n", "1", "-t", "30", "-o", "row%a.log", JOBS / "sweep.slurm", "s.csv")
    one, two = f"{array}_1", f"{array}_2"  # the second has the number of the array as its own
    for name in ("one", "two"):
        cluster.await_true(pathlib.Path(f"sweep-s/{name}/checkpoint.h5").exists, f"row {name}: no checkpoint")
    pathlib.Path("s.yaml").write_text(FINITE)
    cluster.run("scancel", "--batch", "--signal=USR1", two)
    cluster.wait_for_requeue(two)
    other = cluster.job(one)
    assert (other["JobState"], other["Restarts"]) == ("RUNNING", "0"), other
    cluster.release(two)
    assert cluster.wait(two, "COMPLETED", "FAILED")["ExitCode"] == "0:0", pathlib.Path("row2.log").read_text()
    assert "two: goes on" in pathlib.Path("row2.log").read_text()
    cluster.run("scancel", one)
    assert cluster.wait(one, "CANCELLED", "PENDING", "COMPLETED", "FAILED")["JobState"] == "CANCELLED"
    said = cluster.run(JOBS / "sweep.py", "s.csv", "--list", check=False).stdout
    assert "interrupted: row 1" in said and "1 finished" in said, said


def check_sweep(cluster):
    """submit.py: a table becomes a job array and a job that collects; what cannot work is not submitted."""
    pathlib.Path("t.csv").write_text("name,command,mesh,options,ranks\n" "one,sphere,head.obj,-max_it 5,1\n"
                                     "two,sphere,head.obj,-max_it 6,2\n" "gone,disk,nowhere,,1\n")

    def submit(*words, expected=0):
        done = cluster.run(sys.executable, JOBS / "submit.py", *words, check=False)
        assert done.returncode == expected, (words, done.stdout)
        return done.stdout

    said = submit("--time", "30", "--queue", "steady", "--sweep", "t.csv", "--results", "swept")
    array, collect = re.findall(r"^(\d+)$", said, re.MULTILINE)
    assert "--array=1-2%4" in said and f"afterany:{array}" in said, said
    cluster.wait(collect, "COMPLETED", "FAILED")
    table = pathlib.Path("swept/sweep.csv").read_text()
    assert "\n1,one," in table and "\n2,two," in table, table

    said = submit("--time", "30", "--queue", "steady", "sphere", "head.obj", "-o", "sent.h5", "-max_it", "4")
    cluster.wait(re.findall(r"^(\d+)$", said, re.MULTILINE)[0], "COMPLETED", "FAILED")
    assert pathlib.Path("sent.h5").exists()
    for words, complaint in ((("--threads", "64"), "no node has more than"), (("--queue", "none"), "no such partition"),
                             (("--time", "90"), "the partition allows 60 minutes"), (("--memory", "9000G"), "no node has more")):
        said = submit(*words, "sphere", "head.obj", "-o", "sent.h5", expected=2)
        assert complaint in said and "nothing was submitted" in said, said


def main(program):
    missing = slurm.missing()
    if missing:
        print(f"skipped: there is no Slurm here: {', '.join(missing)} missing (Debian: slurm-wlm munge)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([program, "generate", "head", "-n", "600", "-o", "head.obj"], check=True, stdout=subprocess.DEVNULL)
        with slurm.Cluster(pathlib.Path(folder) / "cluster", cpus=6) as cluster:
            cluster.environment.update(EQUIMAP=program, EQUIMAP_JOBS=str(JOBS), OMPI_MCA_mpi_yield_when_idle="1")
            check_waits(cluster)
            check_ends(cluster)
            check_array(cluster)
            check_sweep(cluster)
        os.chdir("/")
    print("slurm: warned before the limit, preempted, stopped for good, cancelled, swept, submitted")
    return 0


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1])))
