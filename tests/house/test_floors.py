"""Hold the folders of src/ to the order of src/FLOORS: no file includes a header of a folder above its own, no file calls
a function that is defined in a folder above, the files of a folder do not call each other in a circle.

usage: python3 test_floors.py SOURCE OBJECT...

SOURCE is the root of the source tree, OBJECT... the object files of library and program. Calls are read from their symbol
tables. known_violations.txt, beside this script, lists what is not mended yet; a line of it that is no longer true fails
the test, too.
"""
import os
import re
import subprocess
import sys

KNOWN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "known_violations.txt")
INCLUDE = re.compile(r'^\s*#\s*include\s+["<]([^">]+)[">]', re.MULTILINE)


def lines_of(path):
    """Lines that are neither empty nor comments."""
    with open(path) as file:
        return [line.strip() for line in file if line.strip() and not line.startswith("#")]


def read_floors(source):
    """Folders in their order, and the folder of each public header."""
    floors, public = [], {}
    for line in lines_of(os.path.join(source, "src", "FLOORS")):
        words = line.split()
        floors.append(words[0])
        public.update({word: words[0] for word in words[1:] if word.endswith(".h")})
    return floors, public


def walk_sources(source, public):
    """(folder, path) of every source file and every public header."""
    root = os.path.join(source, "src")
    for folder in sorted(os.listdir(root)):
        if os.path.isdir(os.path.join(root, folder)):
            for name in sorted(os.listdir(os.path.join(root, folder))):
                if name.endswith((".c", ".h")):
                    yield folder, os.path.join("src", folder, name)
    for name, folder in public.items():
        yield folder, os.path.join("include", "equimap", name)


def find_includes(source, floors, public):
    """{(lower folder, upper folder): examples} of includes that look up."""
    found = {}
    for folder, path in walk_sources(source, public):
        with open(os.path.join(source, path), errors="replace") as file:
            for header in INCLUDE.findall(file.read()):
                parts = header.split("/")
                target = public.get(parts[-1]) if parts[0] == "equimap" else parts[0] if len(parts) == 2 else folder
                if target in floors and floors.index(target) > floors.index(folder):
                    found.setdefault((folder, target), []).append(f"{path} includes {header}")
    return found


def read_symbols(objects):
    """{(folder, file): (defined, undefined)} of object files .../FOLDER/FILE.c.o."""
    symbols = {}
    listing = subprocess.run(["nm", "-A"] + objects, capture_output=True, text=True, check=True).stdout
    for line in listing.splitlines():
        path, entry = line.rsplit(":", 1)
        folder, name = path.replace(os.sep, "/").split("/")[-2:]
        kind, symbol = entry.split()[-2:]
        defined, undefined = symbols.setdefault((folder, re.sub(r"\.(o|obj)$", "", name)), (set(), set()))
        if kind == "U":
            undefined.add(symbol)
        elif kind.isupper():
            defined.add(symbol)
    return symbols


def find_uses(symbols):
    """{user: {used: [symbols]}} between files."""
    owner = {symbol: file for file, (defined, _) in symbols.items() for symbol in defined}
    uses = {file: {} for file in symbols}
    for file, (_, undefined) in symbols.items():
        for symbol in sorted(undefined):
            if symbol in owner and owner[symbol] != file:
                uses[file].setdefault(owner[symbol], []).append(symbol)
    return uses


def find_calls(uses, floors):
    """{(lower folder, upper folder): examples} of calls that run upward."""
    found = {}
    for user, targets in uses.items():
        for used, names in targets.items():
            if floors.index(used[0]) > floors.index(user[0]):
                found.setdefault((user[0], used[0]), []).append(
                    f"{'/'.join(user)} uses {', '.join(names)} of {'/'.join(used)}")
    return found


def reachable(uses, start):
    """Files of its folder that `start` uses, directly or through others."""
    seen, todo = set(), [start]
    while todo:
        for used in uses[todo.pop()]:
            if used[0] == start[0] and used not in seen:
                seen.add(used)
                todo.append(used)
    return seen


def find_circles(uses):
    """{(folder,): descriptions} of files that use each other in a circle."""
    reach = {file: reachable(uses, file) for file in uses}
    found, done = {}, set()
    for file in sorted(uses):
        ring = sorted(other for other in reach[file] if file in reach[other])
        if not ring or file in done:
            continue
        done.update(ring)
        found.setdefault((file[0],), []).append("circle of " + ", ".join(name for _, name in ring))
        for user in ring:
            for used in ring:
                if used in uses[user]:
                    found[file[0],].append(f"  {user[1]} uses {', '.join(uses[user][used])} of {used[1]}")
    return found


def find_violations(source, objects):
    """{line as in the list of known ones: examples}."""
    floors, public = read_floors(source)
    present = {folder for folder, _ in walk_sources(source, public)}
    headers = set(os.listdir(os.path.join(source, "include", "equimap")))
    found = {f"missing {folder}": ["src/FLOORS does not name it: give it a place there"]
             for folder in sorted(present - set(floors))}
    if found:
        return found
    on_disk = {folder for folder in os.listdir(os.path.join(source, "src"))}
    found.update({f"absent {folder}": ["src/FLOORS names it, but there is no such folder"]
                  for folder in floors if folder not in on_disk})
    found.update({f"header {name}": ["include/equimap has it, but it has no line in src/FLOORS"]
                  for name in sorted(headers - set(public))})
    uses = find_uses(read_symbols(objects))
    assert uses, "no object files"
    for word, some in (("include", find_includes(source, floors, public)), ("call", find_calls(uses, floors)),
                       ("circle", find_circles(uses))):
        found.update({" ".join((word,) + key): examples for key, examples in some.items()})
    return found


def main():
    found = find_violations(sys.argv[1], sys.argv[2:])
    known = set(lines_of(KNOWN)) if os.path.exists(KNOWN) else set()
    for line in sorted(set(found) - known):
        print(f"{line}: not allowed by src/FLOORS")
        print("\n".join("    " + example for example in found[line]))
    for line in sorted(known - set(found)):
        print(f"{line}: mended; take the line out of {os.path.basename(KNOWN)}")
    if set(found) != known:
        sys.exit(1)
    print(f"{len(known)} known violations" if known else "every folder looks down only")


if __name__ == "__main__":
    main()
