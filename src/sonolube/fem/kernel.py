"""The optional parts that finite elements stand on, imported when first needed."""

from importlib import import_module
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
    return _part("netgen.occ", "netgen-mesher")


def elements() -> Any:
    """Return the library of elements and quadratures, `skfem`.

    Raises
    ------
    MissingPart
        If scikit-fem is not installed.
    """
    return _part("skfem", "scikit-fem")


def _part(module: str, package: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        raise MissingPart(f"finite elements need {package}; install it with: pip install sonolube[fem]") from None
