"""The meshes of a sweep's rows: files, or generated on demand. Used by sweep.py and submit.py."""
import os
import subprocess

from sweep_launch import environment
from sweep_table import TARGET, TableError, find_mesh, generated


def place_of_mesh(args, name):
    """The file of a mesh as the table names it, generated if it is one of ours; None if it is not there."""
    shape = generated(name)
    if name == TARGET:
        return name
    return args.results / "meshes" / f"{shape[0]}-{shape[1]}.h5" if shape else find_mesh(name, args.meshes)


def places_of(args, row):
    """The row's mesh, of register both; None if one is not there."""
    places = [place_of_mesh(args, name) for name in row.meshes]
    return None if None in places else places


def are_there(places):
    return all(place == TARGET or place.exists() for place in places)


def generator(args, name, place):
    """The command that makes a mesh like hills:20000."""
    shape, vertices = generated(name)
    return [args.program, "generate", shape, "-n", str(vertices), "-o", str(place)]


def generate(args, row):
    """The row's meshes; those like hills:20000 are made unless they are there, and several rows may want one at once."""
    places = places_of(args, row)
    for name, mesh in zip(row.meshes, places or ()):
        if not generated(name) or mesh.exists():
            continue
        mesh.parent.mkdir(parents=True, exist_ok=True)
        part = mesh.with_name(f"part-{os.getpid()}-{mesh.name}")
        done = subprocess.run(generator(args, name, part), env=environment(1), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False)
        if done.returncode:
            raise TableError(f"row {row.number}: cannot generate {name}: {done.stdout.strip()[-200:]}")
        os.replace(part, mesh)
        for suffix in (".xmf", ".map.xmf"):
            part.with_suffix(suffix).unlink(missing_ok=True)
    return places
