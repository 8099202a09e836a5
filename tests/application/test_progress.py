"""What a long run shows: on a terminal one line that renews itself, phases before the first iteration among it, in a log plain
lines at intervals; the time that remains is about what it then takes.

usage: python3 test_progress.py EQUIMAP [RANKS]
"""
import os
import pty
import re
import statistics
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import run_in_folder

RUN = ("disk", "hills.h5", "-o", "map.h5", "-method", "fixed-point", "-energy_rtol", "0", "-ratio_tol", "0", "-threads", "1")
SECONDS = 6  # that a run takes of which the rest is foretold
ROW = re.compile(r" *(\d+)  +\d\.\d+e[-+]\d+  +\d\.\d+e[-+]\d+ +\d+ +[\d.]+ +([\d.]+) s(?: +(\d+) s)?")


def on_terminal(command, environment):
    """What a terminal gets."""
    mother, child = pty.openpty()
    process = subprocess.Popen(command, stdout=child, stderr=child, stdin=subprocess.DEVNULL, env=environment, close_fds=True)
    os.close(child)
    text = b""
    while True:
        try:
            part = os.read(mother, 1 << 16)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        text += part
    os.close(mother)
    assert process.wait() in (0, 4), text
    return text.decode().replace("\r\n", "\n")


def check_terminal(program, iterations):
    """Every iteration renews the line; phases stand there before the first and after the last one."""
    text = on_terminal(program.command([*RUN, "-max_it", iterations]), program.environment)
    lines = text.split("\n")
    if program.ranks > 1:  # a launcher gives its ranks pseudo-terminals, whatever its own output is
        assert "\r" not in text and "\033" not in text, text
        return
    (line,) = [line for line in lines if ROW.search(line)]
    versions = line.split("\r")
    assert all(version.endswith("\033[K") for version in versions if version), line
    rows = [int(ROW.match(version)[1]) for version in versions if ROW.match(version)]
    assert sorted(set(rows)) == list(range(iterations + 1)), rows
    before = text[:text.index("iteration  ")]
    phases = re.findall(r"\r(\w+) \.\.\.\033\[K", before)
    assert phases[:2] == ["Read", "Diagnose"] and "Start" in phases, phases
    assert re.findall(r"\r(\w+) \.\.\.\033\[K", text[text.rindex(" s\033[K"):])[-1:] == ["Write"]


def check_log(program, iterations):
    """Plain lines, not one for every iteration; nothing but the result with -quiet. The seconds that an iteration takes."""
    text = program.succeed(*RUN, "-max_it", iterations, codes=(4,), timeout=300).stdout
    assert "\r" not in text and "\033" not in text and "..." not in text
    rows = [(int(number), float(elapsed), remaining) for number, elapsed, remaining in ROW.findall(text)]
    assert rows[0][0] == 0 and rows[-1][0] == iterations and rows[-1][2] == "", rows
    times = [elapsed for _, elapsed, _ in rows]
    assert all(later - earlier > 1.9 for earlier, later in zip(times[:-1], times[1:-1])), times
    quiet = program.succeed(*RUN, "-max_it", 2, "-quiet", codes=(4,)).stdout
    assert not ROW.search(quiet) and "iteration  " not in quiet
    return (times[-1] - times[0]) / iterations


def check_remaining(program, iterations):
    """On a terminal, where every row is seen: the estimate is that of the time left, within a factor of three for most rows, while
    seconds are left."""
    text = on_terminal(program.command([*RUN, "-max_it", iterations]), program.environment)
    rows = [(float(elapsed), float(remaining)) for _, elapsed, remaining in ROW.findall(text) if remaining]
    end = float(ROW.findall(text)[-1][1])
    factors = [remaining / (end - elapsed) for elapsed, remaining in rows if end - elapsed > 2.]
    assert len(factors) > 20 and 1 / 3 < statistics.median(factors) < 3, (len(factors), statistics.median(factors))


def check_target(program):
    """The estimate is of the way to the tolerance: where that is reached nothing remains."""
    text = on_terminal(program.command(["disk", "hills.h5", "-o", "map.h5", "-max_it", 500, "-ratio_tol", "1e-2"]), program.environment)
    rows = [remaining for _, _, remaining in ROW.findall(text)]
    assert "converged: the ratios are within" in text and rows[-2:] == ["", ""], rows


def main(program):
    program.succeed("generate", "hills", "-n", 8000, "-o", "hills.h5", ranks=1)
    check_terminal(program, 4)
    each = check_log(program, 150)
    if program.ranks == 1:
        check_remaining(program, round(SECONDS / each))
        check_target(program)
    print("progress: one line on a terminal, few in a log, and the time that remains is about right")


if __name__ == "__main__":
    run_in_folder(main)
