"""The batch scripts under a real Slurm, started on the loopback by this test: a job that is warned before its time limit, one
that is preempted, one that is stopped too often, a sweep as a job array, submit.py. Skipped (77) where Slurm is absent.

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

    def __init__(self, cluster, name, *options, script=JOBS / "run.slurm", **environment):
        self.cluster, self.name = cluster, name
        self.folder = pathlib.Path(name)
        self.folder.mkdir()
        (self.folder / "options.yaml").write_text(ENDLESS)
        cluster.environment.update(environment)
        self.job = cluster.submit("-J", name, "-o", f"{name}/log", *options, script, "sphere", "head.obj", "-o", f"{name}/map.h5",
                                  "-options_file", f"{name}/options.yaml", "-history", f"{name}/history.csv")

    def log(self):
        path = self.folder / "log"
        return path.read_text(errors="replace") if path.exists() else ""

    def await_checkpoint(self):
        self.cluster.await_true((self.folder / "map.checkpoint.h5").exists, 40, lambda: f"{self.name}: no checkpoint\n{self.log()}")

    def let_off(self):
        """The next attempt will come to an end. The present one has read its options."""
        (self.folder / "options.yaml").write_text(FINITE)

    def await_requeue(self, seconds):
        """Wait until the job is back in the queue, and spare it the two minutes that Slurm keeps it there."""
        self.cluster.await_true(lambda: self.cluster.job(self.job)["Restarts"] == "1", seconds,
                                lambda: f"{self.name} does not go back into the queue\n{self.log()}")
        self.cluster.await_true(lambda: self.cluster.job(self.job)["JobState"] != "COMPLETING", 20, f"{self.name} hangs")
        self.cluster.run("scontrol", "update", f"JobId={self.job}", "StartTime=now", check=False)

    def check_second_attempt(self):
        """It has ended by itself, from the checkpoint of the first."""
        job = self.cluster.wait(self.job, 60, ("COMPLETED", "FAILED"))
        log = self.log()
        assert job["ExitCode"] in ("0:0", "4:0"), (job["ExitCode"], log)
        assert "going on from " in log and "restart from " in log and "attempt 2" in log, log
        assert (self.folder / "map.h5").exists() and (self.folder / "history.csv").exists()


def check_waits(cluster):
    """A time limit and a preemption, while each other's time passes."""
    limited = Run(cluster, "limited", "-p", "steady", "-n", "1", "-t", "1", "--signal=B:USR1@55")
    preempted = Run(cluster, "preempted", "-p", "low", "-n", "2", "-t", "10")
    limited.await_checkpoint()
    preempted.await_checkpoint()
    limited.let_off()
    preempted.let_off()
    urgent = cluster.submit("-J", "urgent", "-p", "high", "-n", "3", "-t", "1", "-o", "urgent.log", "--wrap", "sleep 3")
    preempted.await_requeue(40)
    cluster.wait(urgent, 30)
    preempted.check_second_attempt()
    limited.await_requeue(60)
    limited.check_second_attempt()
    assert "told to stop (USR1)" in limited.log() and "back into the queue (1 of at most 20)" in limited.log(), limited.log()


def check_cap(cluster):
    """A job that may not go back into the queue says so, and keeps its checkpoint and its exit code."""
    run = Run(cluster, "capped", "-p", "steady", "-n", "1", "-t", "5", EQUIMAP_REQUEUES="0")
    del cluster.environment["EQUIMAP_REQUEUES"]
    run.await_checkpoint()
    cluster.run("scancel", "--batch", "--signal=USR1", run.job)
    job = cluster.wait(run.job, 30, ("FAILED",))
    assert job["ExitCode"] == "75:0" and "enough (EQUIMAP_REQUEUES=0)" in run.log(), (job["ExitCode"], run.log())
    assert (run.folder / "map.checkpoint.h5").exists()


def check_sweep(cluster):
    """submit.py: a table becomes a job array and a job that collects; what cannot work is not submitted."""
    pathlib.Path("t.csv").write_text("name,command,mesh,options,ranks\n" "one,sphere,head.obj,-max_it 5,1\n"
                                     "two,sphere,head.obj,-max_it 6,2\n" "gone,disk,nowhere,,1\n")

    def submit(*words, expected=0):
        done = cluster.run(sys.executable, JOBS / "submit.py", *words, check=False)
        assert done.returncode == expected, (words, done.stdout)
        return done.stdout

    said = submit("--time", "5", "--queue", "steady", "--sweep", "t.csv", "--results", "swept")
    array, collect = re.findall(r"^(\d+)$", said, re.MULTILINE)
    assert "--array=1-2%4" in said and f"afterany:{array}" in said, said
    cluster.wait(collect, 60, ("COMPLETED", "FAILED"))
    table = pathlib.Path("swept/sweep.csv").read_text()
    assert "\n1,one," in table and "\n2,two," in table, table

    said = submit("--time", "5", "--queue", "steady", "sphere", "head.obj", "-o", "sent.h5", "-max_it", "4")
    cluster.wait(re.findall(r"^(\d+)$", said, re.MULTILINE)[0], 60, ("COMPLETED", "FAILED"))
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
        with slurm.Cluster(pathlib.Path(folder) / "cluster", cpus=5) as cluster:
            cluster.environment.update(EQUIMAP=program, EQUIMAP_JOBS=str(JOBS))
            check_waits(cluster)
            check_cap(cluster)
            check_sweep(cluster)
        os.chdir("/")
    print("slurm: warned before the limit, preempted, stopped for good, swept, submitted")
    return 0


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1])))
