"""Timed runs of the program on generated meshes: what measure.py and work.py share."""
import csv
import json
import os
import pathlib
import platform
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "jobs"))
from sweep_launch import environment, find_program, launcher  # noqa: E402, F401

MAP_WRITTEN = (0, 4, 5)  # converged, stopped before, folds remain


def numbers(text):
    """1,2,4 as a list."""
    return [int(part) for part in text.split(",")]


def machine():
    """Processor and node: what seconds depend on."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model} ({os.cpu_count()} cores, {platform.node()})"


def make_mesh(program, folder, shape, size):
    """A generated mesh, made once and kept."""
    mesh = os.path.join(folder, f"{shape}-{size}.h5")
    if not os.path.exists(mesh):
        part = os.path.join(folder, f"part-{shape}-{size}.h5")
        subprocess.run([program, "generate", shape, "-n", str(size), "-o", part], env=environment(1), check=True,
                       stdout=subprocess.DEVNULL)
        os.replace(part, mesh)
    return mesh


def run_once(program, command, mesh, stem, ranks=1, threads=1, options=()):
    """The summary of a run."""
    words = [program, command, mesh, "-o", stem + ".h5", "-summary", stem + ".json", "-quiet", "-threads", str(threads), *options]
    done = subprocess.run([*launcher(ranks), *words], env=environment(threads), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode not in MAP_WRITTEN:
        sys.exit(f"{' '.join(words)} ended with exit code {done.returncode}:\n{done.stdout[-2000:]}")
    with open(stem + ".json", encoding="utf-8") as file:
        return json.load(file)


def flatten(tree, prefix=""):
    """The figures of a summary under names joined by dots."""
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flatten(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def write_table(rows, name):
    with open(name, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, fieldnames=list(dict.fromkeys(key for row in rows for key in row)), restval="")
        table.writeheader()
        table.writerows(rows)
