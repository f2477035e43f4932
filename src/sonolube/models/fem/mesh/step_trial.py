"""Trial reading of a STEP file in a process of its own, with limits of time and memory."""

import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput

_SECONDS: Final = 60  # of processor time
_WAIT: Final = 300  # s, for a machine that gives the process a fifth of a processor
_BYTES: Final = 4 * 2**30
_REFUSED: Final = 3  # exit status of the trial where it refuses the file
_TRIAL: Final = (
    "from sonolube.models.fem.mesh.geometry import unguarded_step_geometry;"
    "from sonolube.models.fem.mesh.step_trial import run_trial;"
    "run_trial(unguarded_step_geometry)"
)


def try_step_file(path: Path) -> None:
    """Raise where reading a STEP file refuses it, ends the program, or needs too much time or memory."""
    command = [sys.executable, "-c", _TRIAL, str(path)]
    try:
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_WAIT)
    except subprocess.TimeoutExpired:
        raise InvalidInput(f"{path}: not read within {_WAIT} s; export it anew, with fewer faces") from None
    if ended.returncode == _REFUSED:
        raise InvalidInput(ended.stderr.decode(errors="replace").strip().splitlines()[-1])
    if ended.returncode:
        raise InvalidInput(
            f"{path}: the CAD kernel ends on it without an answer, or needs more than {_SECONDS} s or"
            f" {_BYTES >> 30} GiB: the file is damaged or too large; export it anew"
        )


def run_trial(read: Callable[[Path], object]) -> None:
    """Read the file that the command line of this process names within the limits; print a refusal and exit with it."""
    _limit()
    try:
        read(Path(sys.argv[1]))
    except InvalidInput as refusal:
        sys.stderr.write(f"{refusal}\n")
        sys.exit(_REFUSED)


def _limit() -> None:
    """Limit the time and the memory of this process, where the system can."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (_BYTES, _BYTES))
