"""Run equimap as a user does, and check what comes of it."""
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python" / "equimap"))
import launch


def launcher(ranks):
    """The words that start so many ranks: those that CMake found, or without ctest those of the Python package."""
    words = os.environ.get("EQUIMAP_TEST_MPIEXEC")
    return shlex.split(words.replace("%n", str(ranks))) if words else launch.launcher(ranks)


class Program:
    """equimap on a number of ranks, in a folder of its own."""

    def __init__(self, path, ranks, folder):
        self.path = os.path.abspath(path)
        self.ranks = int(ranks)
        self.folder = folder
        self.environment = dict(os.environ)
        if os.geteuid() == 0:
            self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def command(self, arguments, ranks=None):
        ranks = ranks or self.ranks
        return [*(launcher(ranks) if ranks > 1 else []), self.path, *map(str, arguments)]  # one rank: as people run it

    def run(self, *arguments, ranks=None, timeout=120):
        """Run; a run that does not end is a failure of its own."""
        return subprocess.run(self.command(arguments, ranks), cwd=self.folder, env=self.environment, timeout=timeout,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")

    def start(self, *arguments, ranks=None):
        """Start and return at once."""
        return subprocess.Popen(self.command(arguments, ranks), cwd=self.folder, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")

    def processes(self, process):
        """The numbers of the processes that run the program itself: those below a launcher, or the one alone."""
        found = []
        for entry in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{entry}/stat") as stream:
                    name, rest = stream.read().rsplit(")", 1)
            except OSError:
                continue
            if int(rest.split()[1]) == process.pid and name.endswith("(equimap"):
                found.append(int(entry))
        return found or ([process.pid] if process.args[0] == self.path else [])

    def succeed(self, *arguments, codes=(0,), **options):
        """Run, and insist on one of the exit codes."""
        result = self.run(*arguments, **options)
        assert result.returncode in codes, (
            f"{' '.join(map(str, arguments))}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
        return result

    def file(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.file(name), "wb") as stream:
            stream.write(content if isinstance(content, bytes) else content.encode())
        return name

    def read(self, name):
        with open(self.file(name), "rb") as stream:
            return stream.read()

    def messages(self, result):
        """The program's own error messages: each begins with its name."""
        return [line for line in result.stderr.splitlines() if line.startswith("equimap: ")]


def run_in_folder(main):
    """Call `main` with the program of the command line, EQUIMAP [RANKS], in a new folder that is the working folder as well."""
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        os.chdir(folder)
        main(program)
        os.chdir("/")
