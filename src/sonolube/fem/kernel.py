"""The CAD kernel, an optional part, imported when first needed."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from sonolube.errors import SonolubeError

MILLIMETRE = 1e-3
"""The CAD kernel's unit, in m."""


class MissingPart(SonolubeError, ImportError):
    """A package that finite elements need and that is not installed."""


def cad() -> Any:
    """Return the CAD kernel, `netgen.occ`.

    Raises
    ------
    MissingPart
        If netgen-mesher is not installed.
    """
    try:
        return import_module("netgen.occ")
    except ImportError:
        raise MissingPart("bodies and their meshes need netgen-mesher: pip install sonolube[fem]") from None


@contextmanager
def silenced() -> Iterator[None]:
    """Keep standard output free of what the CAD kernel prints there on its own, while inside."""
    sys.stdout.flush()
    own = os.dup(1)
    try:
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
        yield
    finally:
        os.dup2(own, 1)
        os.close(own)
