"""Starting the program, and what becomes of its exit code."""
import subprocess
import tempfile
import warnings

from .errors import OF_CODE, EquimapError, InternalError
from .launch import environment, find_program, launcher

def end(process):
    """Ask a run to stop, and see that it does."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def start(arguments, ranks=1, program=None, progress=None):
    """Run the program to its end: its exit code, what it printed, and its own complaints, without their "equimap: ".

    `progress` is called with every line as it comes; True prints them."""
    tell = print if progress is True else progress
    program = program or find_program()
    if not program:
        raise FileNotFoundError("the program equimap is not there: build it, or say where it is with EQUIMAP or program=")
    command = [*launcher(ranks), str(program), *map(str, arguments)]
    lines = []
    with tempfile.TemporaryFile("w+", errors="replace") as errors:
        with subprocess.Popen(command, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors,
                              universal_newlines=True, errors="replace") as process:
            try:
                for line in process.stdout:
                    lines.append(line)
                    if tell:
                        tell(line.rstrip("\n"))
                code = process.wait()
            finally:
                end(process)
        errors.seek(0)
        said = errors.read()
    return code, "".join(lines) + said, complaints_of(said)


def complaints_of(said):
    """The program's own messages among what came on its error output; each begins with its name, and ends where another, an
    empty line, or the launcher's words begin."""
    found, inside = [], False
    for line in said.splitlines():
        if line.startswith("equimap: "):
            found.append(line[len("equimap: "):])
            inside = True
        elif not line.strip() or line.startswith(("---", "[", "mpirun", "srun")):
            inside = False
        elif inside:
            found[-1] += "\n" + line
    return found


def failure(code, output, complaints):
    """The exception for an exit code."""
    if code in OF_CODE:
        kind = OF_CODE[code]
    else:
        kind = InternalError if code < 0 else EquimapError
    message = "\n".join(complaints) or "\n".join(output.strip().splitlines()[-5:])
    return kind(message or "equimap ended with exit code %d and said nothing" % code, code, output)


def call(arguments, ranks=1, program=None, progress=None, accept=(0,)):
    """Run the program and insist on an exit code; what it complains of all the same becomes a warning. The code."""
    code, output, complaints = start(arguments, ranks, program, progress)
    if code not in accept:
        raise failure(code, output, complaints)
    for line in complaints if code == 0 else ():
        warnings.warn("equimap: " + line, stacklevel=3)
    return code
