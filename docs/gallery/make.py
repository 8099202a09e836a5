#!/usr/bin/env python3
"""Make the pictures of docs/gallery/ and the page docs/gallery.md: six generated meshes, mapped and drawn.

    docs/gallery/make.py [NAME ...]       all, or some of disk, square, sphere, ball, conformal, register; the page with all

Needs the program (EQUIMAP, or build/equimap) with cairo, and Pillow (Debian: python3-pil), which makes the pictures small.
"""
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

from PIL import Image

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parents[1] / "jobs"))
from sweep_launch import environment, find_program  # noqa: E402

WIDTH = 1000
COLORS = 160
LARGEST = 150000  # bytes of a picture
# name: title, words, the meshes to generate, the run. Commands are shown as they are run.
ITEMS = {
    "disk": ("A hilly square, to the disk",
             "Every patch of the checkerboard holds the same share of the surface. The angle energy of weight .01 makes the map smooth and unique.",
             ["equimap generate hills -n 20000 -o hills.h5"], "equimap disk hills.h5 -o map.h5 -balance .01"),
    "square": ("A rolled sheet, to the square", "Its four corners go to those of the square.",
               ["equimap generate patch -n 10000 -o patch.h5"], "equimap square patch.h5 -o map.h5"),
    "sphere": ("A closed blob, to the sphere", "Areas agree to three digits everywhere, so that no colour shows.",
               ["equimap generate head -n 10000 -o head.h5"], "equimap sphere head.h5 -o map.h5"),
    "ball": ("A bent solid, to the ball", "Volumes of tetrahedra are kept, in the inside as well.",
             ["equimap generate blob -n 10000 -o blob.h5"], "equimap ball blob.h5 -o map.h5"),
    "conformal": ("The same blob, with its angles kept", "Small squares stay squares; areas do not stay what they were.",
                  ["equimap generate head -n 10000 -o head.h5"], "equimap conformal head.h5 -o map.h5"),
    "register": ("Two blobs, point by point",
                 "Each point of the first is sent to one of the second by way of the sphere, such that shares of area are kept.",
                 ["equimap generate head -n 5000 -seed 3 -o a.h5", "equimap generate head -n 8000 -seed 4 -o b.h5"],
                 "equimap register a.h5 b.h5 -o map.h5"),
}


def run(command, program, folder):
    words = shlex.split(command)
    done = subprocess.run([program, *words[1:]], cwd=folder, env=environment(1), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode not in (0, 4):
        sys.exit(f"{command}: exit code {done.returncode}\n{done.stdout}")


def shrink(source, target):
    """A picture of a page in few colours, and of no more bytes than a clone should carry."""
    page = Image.open(source).convert("RGB")
    page = page.resize((WIDTH, page.height * WIDTH // page.width), Image.LANCZOS)
    page.quantize(COLORS, method=Image.MEDIANCUT, dither=Image.NONE).save(target, optimize=True)
    if target.stat().st_size > LARGEST:
        sys.exit(f"{target} has {target.stat().st_size} bytes, more than {LARGEST}")


def make(name, program):
    """Run the commands of an item, draw its picture, and keep its figures beside it."""
    _, _, meshes, command = ITEMS[name]
    with tempfile.TemporaryDirectory() as folder:
        for line in [*meshes, f"{command} -summary run.json", f"equimap report map.h5 -o map.png -width {2 * WIDTH}"]:
            run(line, program, folder)
        shrink(pathlib.Path(folder, "map.png"), HERE / f"{name}.png")
        summary = json.loads(pathlib.Path(folder, "run.json").read_text(encoding="utf-8"))
    angle = summary.get("angle_error_deg", {}).get("mean")
    figures = {"vertices": summary["mesh"]["vertices"], "energy": summary["energy"]["final"], "folds": summary["folds"],
               "seconds": round(summary["seconds"]["total"], 1), **({"angle": angle} if angle is not None else {})}
    print(f"{name}: {figures}, {(HERE / f'{name}.png').stat().st_size} bytes")
    return figures


def section(name, figures):
    title, words, meshes, command = ITEMS[name]
    told = [f"{figures['vertices']:,} vertices", f"{figures['folds']} folds", f"{figures['seconds']} s"]
    if name == "conformal":
        told.insert(1, f"angle error {figures['angle']:.2f}° on average")
    elif name != "register":
        told.insert(1, f"E {figures['energy']:.1e}")
    commands = "\n".join(f"    {line}" for line in [*meshes, command, f"equimap report map.h5 -o {name}.png"])
    return f"## {title}\n\n{words}\n\n{commands}\n\n{', '.join(told)}.\n\n![{title}](gallery/{name}.png)\n"


def main():
    names, program = sys.argv[1:] or list(ITEMS), find_program()
    kept = HERE / "figures.json"
    figures = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    figures.update({name: make(name, program) for name in names})
    kept.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    text = ["# Gallery\n", "Six maps of generated meshes; [gallery/make.py](gallery/make.py) makes this page and its pictures. "
            "Seconds are of one core of a machine that was busy otherwise.\n"]
    text += [section(name, figures[name]) for name in ITEMS if name in figures]
    (HERE.parent / "gallery.md").write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
