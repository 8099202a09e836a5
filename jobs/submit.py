#!/usr/bin/env python3
"""Submit a run or a sweep to Slurm, PBS or LSF, after a look at everything that could make it fail in the queue.

    jobs/submit.py --ranks 8 --time 2:00:00 sphere scan.ply -o map.h5 -balance .01
    jobs/submit.py --time 1:00:00 --at-once 4 --sweep jobs/tables/000.csv --meshes /data/meshes
    jobs/submit.py --system pbs --queue long --dry-run ...       only look, and show what would be said to the queue

Looked at: the program, the mesh (can be read, and equimap check says yes to the command), the options (all known), the
output and its folder (can be written), ranks, threads, memory and time against each other and, under Slurm, against what
the nodes have. The job writes checkpoints, goes back into the queue when its time is up, at most --requeues times, and goes
on by itself. For a sweep, the unfinished rows become a job array.

Exit code: that of the queue's own command; 2: something was wrong, nothing was submitted.
"""
import argparse
import dataclasses
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

import sweep
from sweep_launch import environment, find_program
from sweep_meshes import are_there, places_of
from sweep_table import TableError, find_preset, read_table

HERE = pathlib.Path(__file__).resolve().parent
SYSTEMS = {"slurm": "sbatch", "pbs": "qsub", "lsf": "bsub"}
LOOKED_AT = ("disk", "square", "sphere", "ball", "cube", "conformal", "register")
SHORTEST = 300  # seconds: two to three minutes are kept for the checkpoint
FEWEST_VERTICES = 1000  # on a rank; below, ranks wait for each other


def seconds_of(text):
    """[[D-]H:]MM:SS or minutes, as schedulers write times."""
    match = re.fullmatch(r"(?:(\d+)-)?(?:(\d+):)?(\d+):(\d+)|(\d+)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is no time; write H:MM:SS, or minutes")
    days, hours, minutes, seconds, only_minutes = (int(part or 0) for part in match.groups())
    return ((days * 24 + hours) * 60 + minutes + only_minutes) * 60 + seconds


def memory_of(text):
    """MiB of 8G, 500M."""
    match = re.fullmatch(r"(\d+)([MG])", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is no amount of memory; write 500M or 8G")
    return int(match[1]) * (1024 if match[2] == "G" else 1)


def count(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}': give a whole number from 1")
    return int(text)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--system", choices=SYSTEMS, help="default: the one whose command is there")
    parser.add_argument("--ranks", type=count, help="default: 1; sweep: the largest of the table")
    parser.add_argument("--threads", type=count, help="of a rank; default: 1; sweep: the largest of the table")
    parser.add_argument("--nodes", type=count, default=1)
    parser.add_argument("--time", type=seconds_of, default=3600, help="H:MM:SS or minutes; default: 1:00:00")
    parser.add_argument("--memory", type=memory_of, help="per node, like 8G; default: the system's")
    parser.add_argument("--queue", help="queue or partition")
    parser.add_argument("--account")
    parser.add_argument("--requeues", type=int, default=20, help="at most so many times back into the queue; 0: never")
    parser.add_argument("--program", default=find_program())
    parser.add_argument("--sweep", metavar="TABLE")
    parser.add_argument("--meshes", default=os.environ.get("EQUIMAP_MESHES", "."), help="sweep: the folder of meshes")
    parser.add_argument("--results", default=os.environ.get("EQUIMAP_RESULTS"), help="sweep: the folder for results")
    parser.add_argument("--at-once", type=count, default=4, help="sweep: so many rows at a time")
    parser.add_argument("--dry-run", action="store_true", help="submit nothing")
    parser.add_argument("words", nargs=argparse.REMAINDER, metavar="COMMAND MESH -o OUT [OPTIONS]")
    args = parser.parse_args()
    args.words = args.words[args.words[:1] == ["--"]:]
    if bool(args.sweep) == bool(args.words):
        parser.error("give either the command to run (sphere scan.ply -o map.h5) or --sweep TABLE")
    return args


def find_system(args):
    """The scheduler to talk to; whether it is there matters only if it is talked to."""
    there = [name for name, command in SYSTEMS.items() if shutil.which(command)]
    system = args.system or (there[0] if there else None)
    if not system or (system not in there and not args.dry_run):
        wanted = SYSTEMS[system] if system else "sbatch, qsub or bsub"
        raise TableError(f"no {wanted} on the path: this machine submits no jobs; --dry-run --system NAME looks only")
    return system


def try_out(program, words):
    """Let the program look at a command: mesh, options, outputs. It maps nothing. Returns what it says."""
    done = subprocess.run([program, *words, "-dry_run"], env=environment(1), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        said = (done.stderr or done.stdout).strip() or f"exit code {done.returncode}"
        raise TableError(f"{shlex.join(words)}\n{said}")
    return done.stdout


def check_resources(args, system, ranks, threads):
    """What can be known to fail, or to waste, before the job is in the queue."""
    if args.time < SHORTEST:
        raise TableError(f"--time: {args.time} s leave no time between the start and the checkpoint; give 5 minutes or more")
    if args.nodes > ranks:
        raise TableError(f"--nodes {args.nodes}: more nodes than ranks ({ranks}); a rank does not reach over nodes")
    cores = -(-ranks // args.nodes) * threads
    if system != "slurm" or not shutil.which("sinfo"):
        return
    shown = subprocess.run(["sinfo", "--noheader", "--format=%c %m %l %D", *(["-p", args.queue] if args.queue else [])],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    kinds = [line.split() for line in shown.stdout.splitlines()]
    if shown.returncode or not kinds:
        raise TableError(f"--queue {args.queue}: Slurm has no such partition" if args.queue else "sinfo shows no nodes")
    whole = [(int(cpus.rstrip("+")), int(memory.rstrip("+")), limit) for cpus, memory, limit, _ in kinds]
    if cores > max(cpus for cpus, _, _ in whole):
        raise TableError(f"{cores} cores on a node are wanted (ranks x threads / nodes), and no node has more than "
                         f"{max(cpus for cpus, _, _ in whole)}; fewer threads, or more --nodes")
    if args.memory and args.memory > max(memory for _, memory, _ in whole):
        raise TableError(f"--memory {args.memory}M: no node has more than {max(memory for _, memory, _ in whole)}M")
    limits = [seconds_of(limit) for _, _, limit in whole if limit != "infinite"]
    if limits and len(limits) == len(whole) and args.time > max(limits):
        raise TableError(f"--time: the partition allows {max(limits) // 60} minutes; take them, the job goes on by itself")


@dataclasses.dataclass
class Job:
    """What is submitted, in no scheduler's words."""
    script: str  # run or sweep
    name: str
    words: list
    ranks: int
    threads: int
    rows: list  # of an array, or none


def clock(seconds):
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"


def number_ranges(numbers):
    """1-3,5 of [1, 2, 3, 5]."""
    ranges = []
    for number in numbers:
        if ranges and ranges[-1][1] == number - 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in ranges)


def for_slurm(args, job):
    words = ["sbatch", "--parsable", "-J", job.name, "-N", str(args.nodes), "-n", str(job.ranks), "-c", str(job.threads),
             "-t", clock(args.time)]
    words += [f"--mem={args.memory}M"] if args.memory else []
    words += ["-p", args.queue] if args.queue else []
    words += ["-A", args.account] if args.account else []
    words += [f"--array={number_ranges(job.rows)}%{args.at_once}"] if job.rows else []
    return [*words, str(HERE / f"{job.script}.slurm"), *job.words], {}


def for_pbs(args, job):
    per_node = -(-job.ranks // args.nodes)
    select = f"select={args.nodes}:ncpus={per_node * job.threads}:mpiprocs={per_node}:ompthreads={job.threads}"
    resources = ["-N", job.name, "-l", select + (f":mem={args.memory}mb" if args.memory else ""),
                 "-l", f"walltime={clock(args.time)}"]
    resources += ["-q", args.queue] if args.queue else []
    resources += ["-A", args.account] if args.account else []
    environment = {"EQUIMAP_QSUB": shlex.join(resources), "EQUIMAP_WALLTIME": clock(args.time),
                   "EQUIMAP_RANKS": str(job.ranks), "OMP_NUM_THREADS": str(job.threads)}
    if job.script == "run":
        environment["EQUIMAP_COMMAND"] = shlex.join(job.words)
    else:
        environment.update(EQUIMAP_TABLE=job.words[0], EQUIMAP_SWEEP=shlex.join(job.words[1:]))
    # PBS knows no lists of numbers: rows that have finished end at once
    array = ["-J", f"1-{max(job.rows)}"] if job.rows and max(job.rows) > 1 else []
    environment.update({"EQUIMAP_ROW": "1"} if job.rows and not array else {})
    return ["qsub", "-V", *array, *resources, str(HERE / f"{job.script}.pbs")], environment


def for_lsf(args, job):
    array = f"[{number_ranges(job.rows)}]%{args.at_once}" if job.rows else ""
    words = ["bsub", "-J", job.name + array, "-n", str(job.ranks), "-W", f"{args.time // 3600}:{args.time // 60 % 60:02d}",
             "-wt", "3", "-wa", "USR1", "-r", "-Q", "75", "-o", f"{job.name}-%J{'-%I' if job.rows else ''}.log"]
    words += ["-R", f"span[ptile={-(-job.ranks // args.nodes)}]"]
    words += ["-R", f"affinity[core({job.threads})]"] if job.threads > 1 else []
    words += ["-M", f"{args.memory}MB"] if args.memory else []
    words += ["-q", args.queue] if args.queue else []
    words += ["-P", args.account] if args.account else []
    return [*words, str(HERE / f"{job.script}.lsf"), *job.words], {"OMP_NUM_THREADS": str(job.threads)}


def check_run(args):
    """The run of a command line: does the program take it?"""
    words = args.words
    if len(words) < 2:
        raise TableError("give a command, a mesh and an output: sphere scan.ply -o map.h5")
    if words[0] not in LOOKED_AT:
        raise TableError(f"what runs long is looked at and submitted ({', '.join(LOOKED_AT)}), '{words[0]}' is not of it")
    said = try_out(args.program, words)
    ranks, threads = args.ranks or 1, args.threads or 1
    vertices = re.search(r"([\d]+) vertices", said)
    if vertices and ranks > 1 and int(vertices[1]) < FEWEST_VERTICES * ranks:
        print(f"submit: {vertices[1]} vertices on {ranks} ranks: they mostly wait for each other; fewer would be faster")
    return Job("run", f"equimap-{words[0]}", words, ranks, threads, [])


def check_sweep(args):
    """The unfinished rows of a table, each looked at like a run of its own."""
    table = str(pathlib.Path(args.sweep).resolve())
    rows = read_table(table)
    args.results = pathlib.Path(args.results or "sweep-" + pathlib.Path(table).stem).resolve()
    args.meshes = str(pathlib.Path(args.meshes).resolve())
    states = [(row, sweep.state_of(args, row)) for row in rows]
    sweep.tell(args, states)
    wanted = [row for row, state in states if state in ("to do", "begun", "interrupted")]
    if not wanted:
        raise TableError("no row is left to run; sweep.py TABLE --retry runs failed ones again")
    if args.at_once < 1:
        raise TableError("--at-once: give 1 or more")
    args.results.mkdir(parents=True, exist_ok=True)
    seen = set()
    for row in wanted:
        places = places_of(args, row)
        preset = find_preset(row.preset)
        words = [row.command, *map(str, places), "-o", str(args.results / "looked-at.h5"),
                 *(["-options_file", str(preset)] if preset else []), *row.options]
        if are_there(places) and tuple(words) not in seen:  # the others are generated by the job
            seen.add(tuple(words))
            try_out(args.program, words)
    ranks, threads = max(row.ranks for row in wanted), max(row.threads for row in wanted)
    words = [table, "--results", str(args.results), "--meshes", args.meshes]
    return Job("sweep", f"sweep-{pathlib.Path(table).stem}", words, args.ranks or ranks, args.threads or threads,
               [row.number for row in wanted])


def submit(args, command, environment):
    """Say it to the queue, or only show it; the queue's answer."""
    for key, value in environment.items():
        print(f"  {key}={shlex.quote(value)}")
    print(f"  {shlex.join(command)}")
    if args.dry_run:
        return ""
    done = subprocess.run(command, env=dict(os.environ, **environment), stdout=subprocess.PIPE, text=True, check=False)
    print(done.stdout.strip())
    if done.returncode:
        sys.exit(done.returncode)
    return done.stdout.strip().split(";")[0]


def main():
    args = arguments()
    if not args.program or not os.access(args.program, os.X_OK):
        raise TableError("there is no program; build it, or say where it is with --program or EQUIMAP")
    args.program = str(pathlib.Path(args.program).resolve())
    system = find_system(args)
    job = check_sweep(args) if args.sweep else check_run(args)
    check_resources(args, system, job.ranks, job.threads)
    common = {"EQUIMAP": args.program, "EQUIMAP_JOBS": str(HERE), "EQUIMAP_REQUEUES": str(args.requeues)}
    command, environment = {"slurm": for_slurm, "pbs": for_pbs, "lsf": for_lsf}[system](args, job)
    answer = submit(args, command, {**common, **environment})
    if not args.sweep:
        return 0
    if system != "slurm":
        print(f"submit: when all have ended: {HERE / 'sweep.py'} {shlex.join(job.words)} --collect")
    else:
        collect = ["sbatch", "--parsable", "-J", f"{job.name}-collect", "-n", "1", "-t", "30",
                   "-d", f"afterany:{answer or 'ARRAY'}", *(["-p", args.queue] if args.queue else []),
                   *(["-A", args.account] if args.account else []), str(HERE / "sweep.slurm"), *job.words, "--collect"]
        submit(args, collect, common)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TableError as problem:
        print(f"submit: {problem}\nsubmit: nothing was submitted", file=sys.stderr)
        sys.exit(2)
