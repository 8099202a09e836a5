"""Where the program is, and how it is started: launch.py of the Python package, by itself, for the package wants NumPy, which
a login node may not have."""
import importlib.util
import pathlib

LAUNCH = pathlib.Path(__file__).resolve().parent.parent / "python" / "equimap" / "launch.py"
spec = importlib.util.spec_from_file_location("launch", LAUNCH)
launch = importlib.util.module_from_spec(spec)
spec.loader.exec_module(launch)
environment, find_program, launcher = launch.environment, launch.find_program, launch.launcher
