"""Optional CAD kernel (OpenCASCADE through netgen-mesher): import on first use, and capture of its printed output."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from tempfile import TemporaryFile
from threading import RLock
from typing import Any

from sonolube.extras import missing_package

MILLIMETRE = 1e-3
"""Length unit of the CAD kernel, in m."""

_STREAMS = (1, 2)  # file descriptors of standard output and error
_REDIRECTION = RLock()  # file descriptors belong to the process, not to a thread


def cad_kernel() -> Any:
    """Module `netgen.occ`, the CAD kernel."""
    try:
        return import_module("netgen.occ")
    except ImportError:
        raise missing_package("fem") from None


@contextmanager
def captured_output() -> Iterator[list[str]]:
    """Context in which text printed by the CAD kernel is captured instead of reaching standard output and error.

    The distinct lines printed, filled on leaving the context.
    """
    lines: list[str] = []
    with _REDIRECTION, TemporaryFile() as file:
        _flush()
        saved = [os.dup(stream) for stream in _STREAMS]
        try:
            for stream in _STREAMS:
                os.dup2(file.fileno(), stream)
            yield lines
        finally:
            _flush()
            for stream, original in zip(_STREAMS, saved, strict=True):
                os.dup2(original, stream)
                os.close(original)
            file.seek(0)
            printed = file.read().decode(errors="replace").splitlines()
            lines += dict.fromkeys(line.strip() for line in printed if line.strip())


def _flush() -> None:
    """Flush the buffers of Python and of the C library, so that text stays on its side of the redirection."""
    sys.stdout.flush()
    sys.stderr.flush()
    with suppress(AttributeError, OSError, TypeError):  # platforms without a C library of this name
        ctypes.CDLL(None).fflush(None)
