"""A Slurm of one node, for tests: munged, slurmctld and slurmd on the loopback, with all they keep in a folder of the test's.

    with slurm.Cluster(folder) as cluster:
        job = cluster.submit("-n", "2", "job.sh")
        cluster.wait(job)

The daemons are children of a guard (this file, run as a program), which ends them, and whatever jobs they have begun, when
the test ends: by itself, by an exception, or killed. The guard knows by its standard input, which closes with the test.
"""
import ctypes
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import time

NEEDED = ("munged", "mungekey", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
PATIENCE = 150  # seconds, for anything that takes a few on an idle machine

# The timeouts are those of a busy machine. A job has KillWait seconds between the TERM that ends it and the KILL. Jobs of the
# partition `low` are warned and have GraceTime seconds before they are preempted, those of `lowest` have nothing.

CONFIGURATION = """\
ClusterName=equimap
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
KillWait=60
MessageTimeout=60
TCPTimeout=20
BatchStartTimeout=120
MinJobAge=600
MaxArraySize=1000
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
SlurmctldParameters=preempt_send_user_signal
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=low Nodes={host} MaxTime=60 PriorityTier=1 GraceTime=300 PreemptMode=REQUEUE State=UP
PartitionName=lowest Nodes={host} MaxTime=60 PriorityTier=1 GraceTime=0 PreemptMode=REQUEUE State=UP
PartitionName=steady Nodes={host} Default=YES MaxTime=60 PriorityTier=2 PreemptMode=OFF State=UP
PartitionName=high Nodes={host} MaxTime=60 PriorityTier=2 PreemptMode=OFF State=UP
"""


def missing():
    """The programs that are not there: with any, there is no cluster."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return [name for name in NEEDED if not shutil.which(name, path=path)]


def free_ports(count):
    """Ports of the loopback that nobody listens on, below those that the system gives to connections."""
    found = []
    while len(found) < count:
        port = random.randrange(16000, 32000)
        with socket.socket() as one:
            if port not in found and one.connect_ex(("127.0.0.1", port)):
                found.append(port)
    return found


class Cluster:
    """The cluster as a test sees it."""

    def __init__(self, folder, cpus=2):
        self.folder = pathlib.Path(folder)
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"),
                                PATH=os.environ["PATH"] + ":/usr/sbin:/sbin")
        self.cpus = cpus
        self.guard = None

    def __enter__(self):
        for name in ("state", "spool", "keys"):
            (self.folder / name).mkdir(parents=True, mode=0o700)
        controller_port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=self.folder, cpus=self.cpus,
            user=subprocess.run(["id", "-un"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip(),
            controller_port=controller_port, node_port=node_port))
        self.guard = subprocess.Popen([sys.executable, __file__, str(self.folder)], stdin=subprocess.PIPE,
                                      env=self.environment, start_new_session=True)
        try:
            self.await_true(self.is_idle, "the node does not come up")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.guard.stdin.close()
        self.guard.wait(timeout=PATIENCE)

    def is_idle(self):
        if self.guard.poll() is not None:
            raise RuntimeError(f"the daemons did not start\n{self.logs()}")
        return self.run("sinfo", "--noheader", "--format=%T", check=False).stdout.split()[:1] == ["idle"]

    def logs(self):
        return "\n".join(f"--- {log.name}\n{log.read_text(errors='replace')[-3000:]}" for log in self.folder.glob("*.log"))

    def await_true(self, condition, complaint):
        """Wait until condition() holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise AssertionError(f"{self.logs()}\n{complaint() if callable(complaint) else complaint}")
            time.sleep(.2)

    def run(self, *command, check=True, environment=None):
        done = subprocess.run([str(word) for word in command], env={**self.environment, **(environment or {})},
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert not check or done.returncode == 0, f"{command}: exit code {done.returncode}\n{done.stdout}{self.logs()}"
        return done

    def submit(self, *arguments, **environment):
        """sbatch; the job's number."""
        return self.run("sbatch", "--parsable", *arguments, environment=environment).stdout.split(";")[0].strip()

    def job(self, number):
        """What scontrol knows of a job, key by key."""
        shown = self.run("scontrol", "--oneliner", "show", "job", number).stdout
        return dict(word.split("=", 1) for word in shown.split() if "=" in word)

    def wait(self, number, *states):
        """Wait until the job is in one of the states."""
        self.await_true(lambda: self.job(number)["JobState"] in states,
                        lambda: f"job {number} is not {' or '.join(states)}\n{self.run('scontrol', 'show', 'job', number).stdout}")
        return self.job(number)

    def wait_for_requeue(self, number, times=1):
        """Wait until the job is back in the queue, its processes gone."""
        self.await_true(lambda: self.job(number)["Restarts"] == str(times), f"job {number} does not go back into the queue")
        self.wait(number, "PENDING", "RUNNING", "COMPLETED", "FAILED")

    def release(self, number):
        """Spare a job that is back in the queue the two minutes that Slurm keeps it there, unless they are over."""
        time.sleep(2)  # a node takes no job that was sent in the second of its last end
        self.run("scontrol", "update", f"JobId={number}", "StartTime=now", check=False)


def descendants(root):
    """The processes below one, from /proc."""
    parents = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except (OSError, ValueError):
                pass  # it has just ended
    found, frontier = [], [root]
    while frontier:
        frontier = [pid for pid, parent in parents.items() if parent in frontier]
        found += frontier
    return found


def end_all(folder):
    """End the guard's descendants: kindly, then not."""
    for kind, seconds in ((signal.SIGTERM, 5), (signal.SIGKILL, 10)):
        end = time.monotonic() + seconds
        for pid in descendants(os.getpid()):
            try:
                os.kill(pid, kind)
            except ProcessLookupError:
                pass
        while time.monotonic() < end:
            try:
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
            except ChildProcessError:
                return
            if kind == signal.SIGKILL:  # what a child leaves behind comes to us
                for pid in descendants(os.getpid()):
                    try:
                        os.kill(pid, kind)
                    except ProcessLookupError:
                        pass
            time.sleep(.05)


def guard(folder):
    """Start the daemons, wait for the end of the test, end them."""
    libc = ctypes.CDLL(None)
    libc.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    subprocess.run(["mungekey", "--create", f"--keyfile={folder}/keys/munge.key"], check=True)
    daemons = (["munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={folder}/keys/munge.key",
                f"--log-file={folder}/munged.log", f"--pid-file={folder}/munged.pid", f"--seed-file={folder}/keys/seed"],
               ["slurmctld", "-D", "-c"], ["slurmd", "-D", "-c"])
    with open(f"{folder}/daemons.log", "wb") as log:
        running = []
        for command in daemons:
            running.append(subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                            preexec_fn=lambda: libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)))
            while command[0] == "munged" and not os.path.exists(f"{folder}/munge.socket") and running[0].poll() is None:
                time.sleep(.05)
    sys.stdin.buffer.read()
    end_all(folder)


if __name__ == "__main__":
    guard(sys.argv[1])
