"""Sweep tables: run, stop, kill, go on, skip, fail, change; the result's table and plots; tables that make no sense; JUBE.

usage: python3 test_sweep.py EQUIMAP
"""
import csv
import importlib.util
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
JOBS = HERE.parents[1] / "jobs"
sys.path[:0] = [str(JOBS), str(HERE.parent / "support")]
import slurm  # noqa: E402
import sweep_plots  # noqa: E402
import sweep_table  # noqa: E402
import sweep_text  # noqa: E402

PATIENCE = 300  # seconds, for what takes a few, or twenty, on an idle machine

HEADER = "name,command,mesh,preset,options,paper,ranks,threads,against,mesh_b\n"
ENDLESS = "method: rgd\nmax_it: 1000000\nenergy_rtol: 0\ncheckpoint_every: 100\n"


def sweep(*arguments, expected=0, **environment):
    done = subprocess.run([sys.executable, JOBS / "sweep.py", *map(str, arguments)], env={**os.environ, **environment},
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == expected, (arguments, done.returncode, done.stdout)
    return done.stdout


def start(table, **environment):
    return subprocess.Popen([sys.executable, JOBS / "sweep.py", table], env={**os.environ, **environment},
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)


def wait_for(path, process):
    """Until a run that goes on for ever has come as far as a checkpoint."""
    end = time.monotonic() + PATIENCE
    while not path.exists() and process.poll() is None and time.monotonic() < end:
        time.sleep(.05)
    if not path.exists():
        end_all(process)
        raise AssertionError(process.communicate()[0])


def lines_of(name):
    with open(name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_table(path, *rows):
    pathlib.Path(path).write_text("# a comment\n" + HEADER + "".join(row + "\n" for row in rows), encoding="utf-8")


def last_iteration(folder):
    return int(lines_of(folder / "history.csv")[-1]["iteration"])


def check_run():
    """Rows that finish, one that fails, one without a mesh; a second time, nothing is run again."""
    write_table("t.csv", "paper,disk,hills:400,disk-fixed-point,-max_it 20,,1,1,", "default,disk,hills:400,,,disk-ncg,2,2,",
                "wrong,disk,hills:400,,-method nonsense,,1,1,", "absent,disk,nowhere,,,,1,1,",
                "sphere,sphere,head:300,001/table2-david-head,-max_it 12,,1,1,",
                "noise,sphere,head:300,001/table7-david-head,-max_it 12,,1,1,sphere")
    said = sweep("t.csv", expected=1)
    assert "4 finished" in said and "failed: row 3, wrong: equimap: " in said and "nonsense" in said, said
    assert "no mesh: row 4, absent: nowhere" in said, said
    lines = {(line["name"], line["iterations"]): line for line in lines_of("sweep-t/sweep.csv")}
    paper = lines["paper", "20"]
    assert float(paper["paper.energy"]) == 4.77e-3 and float(paper["energy"]) > 0. and paper["folds"] == "0"
    assert 300 < int(paper["vertices"]) < 500 and (paper["ranks"], paper["method"]) == ("1", "fixed-point")
    default = [line for line in lines.values() if line["name"] == "default"][0]
    assert float(default["paper.energy"]) == 8.30e-4 and (default["ranks"], default["threads"]) == ("2", "2")
    assert float(lines["sphere", "10"]["paper.energy"]) == 4.04e-3, "what the paper has after ten of a hundred iterations"
    assert float(lines["sphere", "10"]["energy"]) > float(lines["sphere", "12"]["energy"]) > 0.
    noise = lines["noise", "12"]
    assert float(noise["noise_error"]) > 0. and float(noise["paper.noise_error"]) == 4.47e-3
    if importlib.util.find_spec("matplotlib"):
        for name in ("energy", "time"):
            assert pathlib.Path(f"sweep-t/{name}.png").read_bytes().startswith(b"\x89PNG")
    text = pathlib.Path("sweep-t/sweep.txt").read_text()
    assert "4 rows: " in text and "against the papers: " in text and "hills:400, " in text, text
    assert all(any(name in line and line.count("e-") > 1 for line in text.splitlines()) for name in ("paper", "sphere")), text
    before = pathlib.Path("sweep-t/paper/outcome.json").stat().st_mtime_ns
    said = sweep("t.csv", "--no-collect", expected=1)
    assert said.count("(before)") == 5 and "begins" not in said, said
    assert pathlib.Path("sweep-t/paper/outcome.json").stat().st_mtime_ns == before
    assert "row 3, wrong: begins" in sweep("t.csv", "--retry", "--rows", "3", "--no-collect", expected=1)
    assert not list(pathlib.Path("sweep-t").glob("*/checkpoint*")), "finished rows need none"


def check_change():
    """A row that has changed is run anew, and only that."""
    write_table("t.csv", "paper,disk,hills:400,disk-fixed-point,-max_it 21,,1,1,", "default,disk,hills:400,,,disk-ncg,2,2,")
    said = sweep("t.csv", "--no-collect")
    assert "row 1, paper: begins" in said and "row 2, default: converged" in said and last_iteration(
        pathlib.Path("sweep-t/paper")) == 21, said
    assert "2 finished" in sweep("t.csv", "--list")


def check_register():
    """A row with two meshes, and one with a mesh and the target; what --dry-run shows is what is run; pandas opens the table."""
    pathlib.Path("pairs.csv").write_text("a,b\n0,0\n")
    write_table("r.csv", "pair,register,hills:300,,-landmarks pairs.csv -max_it 9,,1,1,,hills:500",
                "plain,disk,hills:300,,-max_it 3,,1,1,,", "absent,register,hills:300,,,,1,1,,nowhere")
    shown = sweep("r.csv", "--dry-run")
    assert not pathlib.Path("sweep-r").exists() and "# row 3, absent: no mesh: hills:300, nowhere" in shown, shown
    lines = [line for line in shown.splitlines() if not line.startswith("#")]
    assert [" generate " in line for line in lines] == [True, True, False, False], shown
    subprocess.run("\n".join(lines[:2]), shell=True, check=True, stdout=subprocess.DEVNULL)
    said = sweep("r.csv")
    assert "2 finished, 1 no mesh" in said and "# row 2, plain: finished" in sweep("r.csv", "--dry-run"), said
    logs = [pathlib.Path(f"sweep-r/{name}/log.txt").read_text().splitlines()[0] for name in ("pair", "plain")]
    assert [line.split(" && OMP_NUM_THREADS=1 ")[1] for line in lines[2:]] == [log[2:] for log in logs], (shown, logs)
    pair = lines_of("sweep-r/sweep.csv")[0]
    assert (pair["mesh"], pair["mesh_b"]) == ("hills:300", "hills:500") and float(pair["landmark_error"]) < .1, pair
    assert float(pair["dissimilarity"]) > 0. and "hills:300 to hills:500" in pathlib.Path("sweep-r/sweep.txt").read_text()
    assert not list(pathlib.Path("sweep-r").glob("*/checkpoint*"))
    documented = sweep("--columns")
    assert all(f"    {column} " in documented for column in ("mesh_b", "preset", "paper"))
    for column in pair:
        assert column.startswith("paper.") or column == "against" or column in documented, f"{column} is not explained"
    if importlib.util.find_spec("pandas"):
        import pandas
        frame = pandas.read_csv("sweep-r/sweep.csv", index_col="name")
        assert frame.loc["plain", "iterations"] == 3 and frame["energy"].dtype == float and len(frame) == 2, frame


def check_series():
    """What the plots join by a line: sizes of one shape under the same options that ended alike, and nothing else."""
    def run(name, mesh, options="", status="converged"):
        row = sweep_table.Row(1, name, "disk", mesh, "", "", options.split(), "", 1, 1, {})
        return sweep_plots.Run(row, {"command": "disk", "method": "lm", "status": status}, [], {})

    runs = [run("h-1-x", "hills:100", "-max_it 9"), run("h-2-x", "hills:200", "-max_it 9"), run("h-1-y", "hills:100", "-max_it 8"),
            run("h-3-x", "hills:300", "-max_it 9", "not converged"), run("bunny", "bunny"), run("lion", "lion"), run("lion2", "lion")]
    series = {name: len(members) for name, members in sweep_plots.series_of(runs).items()}
    assert series == {"h-*-x": 2, "h-1-y": 1, "h-3-x": 1, "bunny": 1, "lion": 1, "lion2": 1}, series


def check_text():
    """A summary of hundreds of rows: what they come to in a few lines, then a line per row, none too long to read."""
    lines = []
    for k in range(300):
        fixed = {"row": k, "name": f"mesh{k % 50}-way{k // 50}", "command": "disk", "method": ("lm", "ncg")[k % 2], "ranks": 1, "threads": 2,
                 "status": "converged" if k % 3 else "not converged", "mesh": f"mesh{k % 50}", "mesh_b": "", "vertices": 1000 + k}
        lines.append((fixed, {"energy": 1e-3 * (k + 1), "sd": .1, "folds": k == 7, "iterations": k, "seconds": .5 * k}, {}))
    head, *tables = sweep_text.page(lines, ["  failed: row 301, x: no"]).split("\n\n")
    assert head.splitlines() == ["300 rows: 100 not converged, 200 converged", "with folds: mesh7-way0", "  failed: row 301, x: no"], head
    ways = [line.split() for line in tables[0].splitlines()[1:]]
    assert ways == [["disk", "lm", "150", "100", "0", "1.500e-01", "2.990e-01", "74.5", "149.0"],
                    ["disk", "ncg", "150", "100", "1", "1.510e-01", "3.000e-01", "75.0", "149.5"]], tables[0]
    rows = "\n".join(tables[1:]).splitlines()
    assert len(rows) == 1 + 50 * 7 and max(map(len, rows)) < 130 and "mesh49, 1,049 vertices" in rows, rows[:9]


def check_stop(kind, code, ranks=1, everywhere=False):
    """Stopped, or killed, in the middle of a row: the row goes on from its checkpoint when the sweep is started again.
    Batch systems signal every process of a job, the sweep's own the last here."""
    folder = pathlib.Path("sweep-s/long")
    pathlib.Path("s.yaml").write_text(ENDLESS)
    write_table("s.csv", f"long,sphere,head:600,,-options_file s.yaml,,{ranks},1,", "next,disk,hills:400,,-max_it 2,,1,1,")
    process = start("s.csv")
    wait_for(folder / "checkpoint.h5", process)
    if kind == signal.SIGKILL:
        end_all(process)
    for pid in slurm.descendants(process.pid) if everywhere else ():
        os.kill(pid, kind)
    if kind != signal.SIGKILL:
        process.send_signal(kind)
    said = process.communicate(timeout=PATIENCE)[0]
    assert process.returncode == code, (process.returncode, said)
    assert "row 2, next: begins" not in said and sweep_table.read_json(folder / "outcome.json")["exit_code"] == (
        75 if code == 75 else None), said
    assert ("interrupted: row 1" if code == 75 else "begun: row 1") in sweep("s.csv", "--list", expected=75)
    pathlib.Path("s.yaml").write_text(ENDLESS.replace("1000000", "10"))  # it has more behind it: the end
    said = sweep("s.csv", "--no-collect")
    assert "row 1, long: goes on" in said and "2 finished" in said, said
    assert last_iteration(folder) >= 10
    assert sweep_table.read_json(folder / "outcome.json")["attempts"] == 2
    shutil.rmtree("sweep-s")


def end_all(process):
    """Kill a sweep and what it has begun, which has a session of its own and would outlive it."""
    begun = slurm.descendants(process.pid)
    for pid in (process.pid, *begun):
        os.kill(pid, signal.SIGKILL)


def check_launcher():
    """A launcher that is ended by the request to stop returns a code of its own: the row is interrupted, it has not failed."""
    launcher = pathlib.Path("frail")
    launcher.write_text('#!/bin/sh\ntrap "kill -9 \\$!; exit 1" USR1\n"$@" & wait\n')
    launcher.chmod(0o755)
    write_table("f.csv", "long,sphere,head:600,,-options_file s.yaml,,1,1,")
    pathlib.Path("s.yaml").write_text(ENDLESS)
    process = start("f.csv", EQUIMAP_MPIRUN=str(launcher.resolve()))
    wait_for(pathlib.Path("sweep-f/long/checkpoint.h5"), process)
    process.send_signal(signal.SIGUSR1)
    said = process.communicate(timeout=PATIENCE)[0]
    assert process.returncode == 75 and "interrupted: row 1" in said, (process.returncode, said)


def check_mistakes():
    """Said in a line, with exit code 2, before anything is run."""
    cases = {
        HEADER + "a,register,m,,,,1,1,,\n": "register wants two meshes",
        HEADER + "a,disk,m,,,,1,1,,n\n": "register wants two meshes",
        "name,command\nx,disk\n": "no column mesh",
        HEADER: "has no rows",
        HEADER + "a,disk,m,,,,1,1,\na,disk,m,,,,1,1,\n": "two rows are called a",
        HEADER + "a,disk,m,,,,none,1,\n": "ranks is 'none'",
        HEADER + "a/b,disk,m,,,,1,1,\n": "'a/b' is no name",
        HEADER + "a,disk,m,no-such,,,1,1,\n": "no preset 'no-such'",
        HEADER + "a,disk,m,,-x 'y,,1,1,\n": "cannot be understood",
        HEADER + "a,disk,nowhere,,,,1,1,\n": "none of the meshes is there",
    }
    for content, complaint in cases.items():
        pathlib.Path("m.csv").write_text(content)
        said = sweep("m.csv", expected=2)
        assert complaint in said and "Traceback" not in said, (content, said)
    assert "cannot read the table" in sweep("absent.csv", expected=2)


def check_tables():
    """The tables of the tree can be read, and their presets are there and hold figures."""
    for table in sorted((JOBS / "tables").glob("*.csv")):
        for row in sweep_table.read_table(table):
            sweep_table.find_preset(row.preset)
            assert not row.paper or sweep_table.published(sweep_table.find_preset(row.paper)), (table, row)
            against = row.others.get("against")
            assert not against or against in [other.name for other in sweep_table.read_table(table)], row


def check_jube():
    """The same table under JUBE."""
    if not shutil.which("jube"):
        print("JUBE is not there (Debian: jube): left out")
        return
    write_table("j.csv", "one,disk,hills:400,,-max_it 3,,1,1,", "absent,disk,nowhere,,,,1,1,")
    here = pathlib.Path.cwd()
    environment = {**os.environ, "EQUIMAP_TABLE": str(here / "j.csv"), "EQUIMAP_RESULTS": str(here / "sweep-j"),
                   "EQUIMAP_MESHES": str(here)}
    done = subprocess.run(["jube", "run", JOBS / "sweep.xml", "-o", here / "jube-runs", "-r", "--hide-animation"], env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0 and "not converged" in done.stdout and "no mesh" in done.stdout, done.stdout
    assert lines_of("sweep-j/sweep.csv")[0]["name"] == "one"


def main():
    check_run()
    check_change()
    check_register()
    check_series()
    check_text()
    check_stop(signal.SIGUSR1, 75)
    check_stop(signal.SIGINT, 75)
    check_stop(signal.SIGTERM, 75, ranks=2, everywhere=True)
    check_stop(signal.SIGKILL, -signal.SIGKILL)
    check_launcher()
    check_mistakes()
    check_tables()
    check_jube()
    print("sweep: run, stopped, killed, gone on with, changed; wrong tables refused")


if __name__ == "__main__":
    os.environ["EQUIMAP"] = os.path.abspath(sys.argv[1])
    for name in ("EQUIMAP_MESHES", "EQUIMAP_RESULTS", "EQUIMAP_MPIRUN"):
        os.environ.pop(name, None)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
        os.chdir("/")
