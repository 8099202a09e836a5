"""The program's exit codes as exceptions."""


class EquimapError(Exception):
    """The program did not end as asked for: `code`, its exit code, `message`, its own words, and `output`, all that it
    printed."""

    code = None

    def __init__(self, message, code=None, output=""):
        super().__init__(message)
        self.message = message
        self.code = self.code if code is None else code
        self.output = output


class InternalError(EquimapError):
    """Exit code 1, or a program that was ended by a signal."""
    code = 1


class UsageError(EquimapError):
    """Exit code 2: a wrong option or argument."""
    code = 2


class MeshError(EquimapError):
    """Exit code 3: the mesh cannot be mapped; the message says what is wrong with it, and where."""
    code = 3


class NotConverged(EquimapError):
    """Exit code 4: stopped before convergence; `result` holds the map. Raised only where `accept` leaves 4 out."""
    code = 4
    result = None


class FoldsRemain(EquimapError):
    """Exit code 5: folds remain; `result` holds the map."""
    code = 5
    result = None


class FileError(EquimapError):
    """Exit code 6: reading or writing failed."""
    code = 6


class CheckpointError(EquimapError):
    """Exit code 7: the checkpoint is damaged, or of another mesh or problem."""
    code = 7


class Stopped(EquimapError):
    """Exit code 75: stopped on request; run again with `restart=` the checkpoint."""
    code = 75


OF_CODE = {kind.code: kind for kind in (InternalError, UsageError, MeshError, NotConverged, FoldsRemain, FileError,
                                        CheckpointError, Stopped)}
