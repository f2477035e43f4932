"""The CAD kernel, an optional part, imported when first needed."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from tempfile import TemporaryFile
from threading import RLock
from typing import Any

from sonolube.errors import SonolubeError

MILLIMETRE = 1e-3
"""The CAD kernel's unit, in m."""

_STREAMS = (1, 2)  # standard output and error
_ONE_AT_A_TIME = RLock()  # the streams belong to the process, not to a thread


class MissingPackage(SonolubeError, ImportError):
    """A package that finite elements need and that is not installed."""


def cad_kernel() -> Any:
    """Return the CAD kernel, `netgen.occ`.

    Raises
    ------
    MissingPackage
        If netgen-mesher is not installed.
    """
    try:
        return import_module("netgen.occ")
    except ImportError:
        raise MissingPackage("bodies and their meshes need netgen-mesher: pip install sonolube[fem]") from None


@contextmanager
def captured_output() -> Iterator[list[str]]:
    """Keep what the CAD kernel prints on its own off standard output and error while inside.

    Yields
    ------
    list of str
        The lines it printed, each once, filled on leaving.
    """
    lines: list[str] = []
    with _ONE_AT_A_TIME, TemporaryFile() as file:
        _flush()
        own = [os.dup(stream) for stream in _STREAMS]
        try:
            for stream in _STREAMS:
                os.dup2(file.fileno(), stream)
            yield lines
        finally:
            _flush()
            for stream, kept in zip(_STREAMS, own, strict=True):
                os.dup2(kept, stream)
                os.close(kept)
            file.seek(0)
            printed = file.read().decode(errors="replace").splitlines()
            lines += dict.fromkeys(line.strip() for line in printed if line.strip())


def _flush() -> None:
    """Write out what Python and C hold back, or it would appear on the wrong side."""
    sys.stdout.flush()
    sys.stderr.flush()
    with suppress(AttributeError, OSError, TypeError):  # where C has no library under this name
        ctypes.CDLL(None).fflush(None)
