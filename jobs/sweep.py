#!/usr/bin/env python3
"""Run the rows of a table, and set the papers' figures beside ours.

    jobs/sweep.py TABLE                             on this machine, row by row; then the result's table and its plots
    jobs/sweep.py TABLE --rows 2,5-8                some rows
    jobs/sweep.py TABLE --dry-run                   the command lines; runs nothing
    jobs/sweep.py --columns                         what the columns of a table, and of the result's, mean
    jobs/sweep.py TABLE --list                      how far it has come; runs nothing
    jobs/sweep.py TABLE --collect                   only the result's table and the plots, of what is there
    sbatch --array=1-24%4 jobs/sweep.slurm TABLE    under Slurm; PBS and LSF: sweep.pbs, sweep.lsf; jobs/submit.py helps
    jube run jobs/sweep.xml                         under JUBE: see there

Examples of tables lie in jobs/tables/. Meshes are looked for in --meshes (EQUIMAP_MESHES, or
here), results go to --results (EQUIMAP_RESULTS, or sweep-TABLE), a folder per row with result, summary, history and log.
Rows whose mesh is not there are left out, and listed.

It may be stopped at any time (Ctrl-C, USR1, TERM, a kill) and started again: finished rows are skipped, interrupted ones
go on from their checkpoint, failed ones are listed and, with --retry, run again. A row that has changed in the table, or
whose mesh or preset has, is run anew.

Exit code: 0 all is done, 1 some rows failed, 2 wrong usage, 75 stopped on request: start again to go on.
"""
import argparse
import contextlib
import fcntl
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import time

import sweep_report
import sweep_table
from sweep_launch import environment, find_program, launcher
from sweep_meshes import are_there, generate, generator, places_of
from sweep_table import MAP_WRITTEN, OWN, STOPPED, Store, TableError, find_preset, fingerprint, generated, read_table

HERE = pathlib.Path(__file__).resolve().parent


class Stop:
    """Turns USR1, TERM and Ctrl-C into a USR1 for the run at hand."""

    def __init__(self):
        self.asked = False
        self.child = None
        for number in (signal.SIGUSR1, signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self.take)

    def take(self, number, _):
        self.asked = True
        print(f"sweep: told to stop ({signal.Signals(number).name})", flush=True)
        if self.child and self.child.poll() is None:
            self.child.send_signal(signal.SIGUSR1)


def row_numbers(text):
    """1,4-6 as a set."""
    numbers = set()
    for part in text.split(","):
        first, _, last = part.partition("-")
        numbers.update(range(int(first), int(last or first) + 1))
    return numbers


class Columns(argparse.Action):
    """Say what the columns are, and stop."""

    def __call__(self, parser, *_):
        for module in (sweep_table, sweep_report):
            print(module.__doc__.partition("\n\n")[2].strip("\n") + "\n")
        parser.exit()


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table")
    parser.add_argument("--rows", type=row_numbers, help="numbers from 1, like 2,5-8")
    parser.add_argument("--results", default=os.environ.get("EQUIMAP_RESULTS"))
    parser.add_argument("--meshes", default=os.environ.get("EQUIMAP_MESHES", "."))
    parser.add_argument("--program", default=find_program(), help="default: EQUIMAP, or build/equimap")
    parser.add_argument("--retry", action="store_true", help="run failed rows again")
    parser.add_argument("--no-collect", action="store_true", help="no table and plots at the end")
    parser.add_argument("--dry-run", action="store_true", help="show the command lines of what is left to do; run nothing")
    parser.add_argument("--list", action="store_true", help="say how far it has come; run nothing")
    parser.add_argument("--collect", action="store_true", help="write table and plots; run nothing")
    parser.add_argument("--numbers", action="store_true", help="print the numbers of the rows, for other programs")
    parser.add_argument("--columns", action=Columns, nargs=0, help="say what the columns of a table and of sweep.csv mean")
    args = parser.parse_args()
    args.results = pathlib.Path(args.results or "sweep-" + pathlib.Path(args.table).stem)
    return args


@contextlib.contextmanager
def locked(path):
    """Hold a file's lock; yields False if another process holds it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
            return
        yield True


def command_line(args, row, store, meshes):
    preset = find_preset(row.preset)
    command = [*launcher(row.ranks), args.program, row.command, *map(str, meshes), "-o", str(store.folder / "result.h5"),
               "-summary", str(store.summary_file), "-history", str(store.history_file), "-threads", str(row.threads)]
    command += ["-options_file", str(preset)] if preset else []
    command += ["-checkpoint", str(store.checkpoint)]
    command += ["-restart", str(store.checkpoint)] if store.has_checkpoint() else []
    return command + row.options


@contextlib.contextmanager
def deaf_to_term():
    """What is started here does not hear TERM. Batch systems send it to every process of a job, of which mpirun ends the ranks,
    and itself, at once; deaf, it waits for their checkpoint. The ranks hear it, and mpirun hands on the USR1 of Stop."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})


def wait_for(stop):
    """The exit code of the run at hand. One that was told to stop and has not ended by itself is stopped all the same: its
    launcher was ended by the signal, which may get here a moment later."""
    code = stop.child.wait()
    if code not in OWN:
        time.sleep(1)
        return STOPPED if stop.asked else code
    return code


def run_row(args, row, store, meshes, stop):
    """Run a row to its end or to a stop, and note how it ended."""
    before = store.outcome()
    mark = fingerprint(row, meshes)
    if before is None or before["fingerprint"] != mark or before["exit_code"] == 7:  # another run's checkpoint
        if before is not None:
            store.clear("lock")
        before = {"attempts": 0, "wall_seconds": 0.}
    command = command_line(args, row, store, meshes)
    # Written before the run as well: if it is killed, its checkpoint is known to be this row's.
    record = {"fingerprint": mark, "exit_code": None, "attempts": before["attempts"] + 1,
              "wall_seconds": before["wall_seconds"], "command": command}
    store.write_outcome(record)
    begin = time.monotonic()
    with open(store.log_file, "a", encoding="utf-8") as log:
        log.write(f"$ {shlex.join(command)}\n")
        log.flush()
        with deaf_to_term() if launcher(row.ranks) else contextlib.nullcontext():
            stop.child = subprocess.Popen(command, env=environment(row.threads), stdin=subprocess.DEVNULL, stdout=log,
                                          stderr=subprocess.STDOUT, start_new_session=True)  # Ctrl-C is for us alone
        if stop.asked:
            stop.child.send_signal(signal.SIGUSR1)
        code = wait_for(stop)
    if code in MAP_WRITTEN:
        store.forget_checkpoint()
    store.write_outcome({**record, "exit_code": code, "wall_seconds": before["wall_seconds"] + time.monotonic() - begin})


def process(args, row, stop):
    """Run a row unless there is nothing to do; its state afterwards."""
    meshes = generate(args, row)
    if meshes is None:
        return "no mesh"
    store = Store(args.results, row)
    with locked(store.folder / "lock") as mine:
        if not mine:
            return "running elsewhere"
        state = store.state(meshes)
        if state == "finished" or (state == "failed" and not args.retry):
            print(f"sweep: row {row.number}, {row.name}: {describe(store)} (before)", flush=True)
            return state
        print(f"sweep: row {row.number}, {row.name}: {'goes on' if store.has_checkpoint() else 'begins'}", flush=True)
        run_row(args, row, store, meshes, stop)
        print(f"sweep: row {row.number}, {row.name}: {describe(store)}", flush=True)
        return store.state(meshes)


def describe(store):
    """The row's end in a line."""
    code, summary = store.outcome()["exit_code"], store.summary()
    if code not in MAP_WRITTEN or not summary:
        return f"exit code {code}: {store.complaint()}"
    return (f"{summary['status']}, energy {summary['energy']['final']:.4e}, {summary['folds']} folds, "
            f"{summary['seconds']['total']:.1f} s")


def state_of(args, row):
    places = places_of(args, row)
    if places is None:
        return "no mesh"
    return Store(args.results, row).state(places) if are_there(places) else "to do"


def show(args, rows):
    """What a sweep would do, as lines for a shell; nothing is run, and what has finished is left out."""
    made = set()
    for row in rows:
        state, store = state_of(args, row), Store(args.results, row)
        print(f"# row {row.number}, {row.name}: {state}" + (f": {', '.join(row.meshes)}" if state == "no mesh" else ""))
        if state in ("no mesh", "finished") or (state == "failed" and not args.retry):
            continue
        places = places_of(args, row)
        for name, place in zip(row.meshes, places):
            if generated(name) and not place.exists() and place not in made:
                made.add(place)
                print(f"mkdir -p {shlex.quote(str(place.parent))} && {shlex.join(generator(args, name, place))}")
        threads = f"OMP_NUM_THREADS={row.threads} "
        print(f"mkdir -p {shlex.quote(str(store.folder))} && {threads}{shlex.join(command_line(args, row, store, places))}")


def unfinished(args, states):
    """A line for each row that is not finished; one for those that have not begun."""
    for state in dict.fromkeys(state for _, state in states if state != "finished"):
        rows = [row for row, other in states if other == state]
        if state == "to do":
            yield f"  to do: {', '.join(str(row.number) for row in rows)}"
            continue
        for row in rows:
            words = {"failed": Store(args.results, row).complaint(), "no mesh": ", ".join(row.meshes)}
            word = words.get(state, "")
            yield f"  {state}: row {row.number}, {row.name}" + (f": {word}" if word else "")


def tell(args, states):
    """How many rows are where; of those that are not finished, which."""
    kinds = [state for _, state in states]
    print(", ".join(f"{kinds.count(state)} {state}" for state in dict.fromkeys(kinds)))
    for line in unfinished(args, states):
        print(line)


def exit_code(states, stop):
    kinds = {state for _, state in states}
    if kinds == {"no mesh"}:
        print("sweep: none of the meshes is there; say where they are with --meshes or EQUIMAP_MESHES", file=sys.stderr)
        return 2
    if stop.asked or kinds & {"interrupted", "begun"}:
        return STOPPED
    return 1 if "failed" in kinds else 0


def main():
    args = arguments()
    rows = read_table(args.table)
    chosen = [row for row in rows if args.rows is None or row.number in args.rows]
    if not chosen:
        raise TableError(f"{args.table} has rows 1 to {len(rows)}: none of those asked for")
    if args.numbers:
        print(",".join(str(row.number) for row in chosen))
        return 0
    for row in chosen:
        find_preset(row.preset), find_preset(row.paper)  # complain before the first run, not after the last
    if not (args.list or args.collect) and not args.program:
        raise TableError("there is no program; build it, or say where it is with --program or EQUIMAP")
    if args.dry_run:
        show(args, chosen)
        return 0
    stop = Stop()
    states = []
    for row in chosen:
        idle = args.list or args.collect or stop.asked
        states.append((row, state_of(args, row) if idle else process(args, row, stop)))
    tell(args, states)
    if not args.list and not args.no_collect:
        everywhere = [(row, state_of(args, row)) for row in rows]
        sweep_report.write(args.results, [row for row, state in everywhere if state == "finished"], unfinished(args, everywhere))
    return exit_code(states, stop)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TableError as problem:
        print(f"sweep: {problem}", file=sys.stderr)
        sys.exit(2)
