"""Trial reading of a STEP file in a process of its own, with limits of time and memory."""

import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.fem.solver.cad import cad_kernel

_SECONDS: Final = 60  # of processor time
_WAIT: Final = 300  # s, for a machine that gives the process a fifth of a processor
_BYTES: Final = 4 * 2**30
_UNREADABLE: Final = 3  # exit status of the trial where the kernel refuses the file


def try_step_file(path: Path) -> None:
    """Raise where the CAD kernel refuses a STEP file, crashes on it, or needs too much time or memory for it.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InvalidInput
        Naming the file and what happened.
    """
    command = [sys.executable, "-c", f"from {__name__} import main; main()", str(path)]
    try:
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_WAIT)
    except subprocess.TimeoutExpired:
        raise InvalidInput(f"{path}: not read within {_WAIT} s; export it anew, with fewer faces") from None
    if ended.returncode == _UNREADABLE:
        said = ended.stderr.decode(errors="replace").strip().splitlines()
        raise InvalidInput(f"{path}: not a STEP file that can be read: {said[-1] if said else 'no reason given'}")
    if ended.returncode:
        raise InvalidInput(
            f"{path}: the CAD kernel ends on it without an answer, or needs more than {_SECONDS} s or"
            f" {_BYTES >> 30} GiB: the file is damaged or too large; export it anew"
        )


def main() -> None:
    """Read the STEP file that the command line names, within the limits."""
    _limit()
    kernel = cad_kernel()
    try:
        list(kernel.OCCGeometry(sys.argv[1]).shape.solids)
    except Exception as failure:  # the kernel raises no narrower class
        sys.stderr.write(f"{failure}\n")
        sys.exit(_UNREADABLE)


def _limit() -> None:
    """Limit the time and the memory of this process, where the system can."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (_BYTES, _BYTES))
