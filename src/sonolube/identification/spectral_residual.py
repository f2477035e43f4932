"""How far a model's admittance lies from a measured spectrum: the choices of what to square and add."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import UnknownName

LOG_COMPLEX = "log-complex"
LINEAR_MAGNITUDE = "linear-magnitude"


def _log_complex(model: Complexes, measured: Complexes) -> Floats:
    ratio = np.log(model / measured)  # the principal branch: phases are compared on the circle
    return np.concatenate([ratio.real, ratio.imag])


def _linear_magnitude(model: Complexes, measured: Complexes) -> Floats:
    magnitude = np.abs(measured)
    return np.asarray((np.abs(model) - magnitude) / magnitude.max())


RESIDUALS: Mapping[str, Callable[[Complexes, Complexes], Floats]] = MappingProxyType(
    {LOG_COMPLEX: _log_complex, LINEAR_MAGNITUDE: _linear_magnitude}
)


def residual_named(name: str) -> Callable[[Complexes, Complexes], Floats]:
    """Return what compares a model's admittance with the measured one.

    Parameters
    ----------
    name : str
        "log-complex": logarithm of the ratio, magnitudes in its real and phases in its imaginary part, so that every
        point counts as much in proportion. "linear-magnitude": difference of magnitudes over the greatest one, so that
        the points about the resonance settle nearly all.

    Returns
    -------
    callable

    Raises
    ------
    UnknownName
        If it is none of `RESIDUALS`.
    """
    if name not in RESIDUALS:
        raise UnknownName.among(RESIDUALS, kind="residual", name=name)
    return RESIDUALS[name]
