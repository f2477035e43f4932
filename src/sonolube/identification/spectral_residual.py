"""Residuals of a model's admittance against a measured spectrum, for least squares."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import UnknownName

LOG_COMPLEX = "log-complex"
LINEAR_MAGNITUDE = "linear-magnitude"


def _log_complex(model: Complexes, measured: Complexes) -> Floats:
    """Logarithms of the magnitude ratio, then phase differences in rad, shape (2n,)."""
    ratio = np.log(model / measured)  # principal branch: phase differences lie between -pi and pi
    return np.concatenate([ratio.real, ratio.imag])


def _linear_magnitude(model: Complexes, measured: Complexes) -> Floats:
    """Differences of the magnitudes over the largest measured one, shape (n,)."""
    magnitude = np.abs(measured)
    return np.asarray((np.abs(model) - magnitude) / magnitude.max())


RESIDUALS: Mapping[str, Callable[[Complexes, Complexes], Floats]] = MappingProxyType(
    {LOG_COMPLEX: _log_complex, LINEAR_MAGNITUDE: _linear_magnitude}
)


def residual_named(name: str) -> Callable[[Complexes, Complexes], Floats]:
    r"""Residual function of a name, which takes a model's admittance and the measured one.

    Parameters
    ----------
    name : str
        "log-complex" or "linear-magnitude".

    Returns
    -------
    callable

    Raises
    ------
    UnknownName
        If it is none of `RESIDUALS`.

    Notes
    -----
    For the model's admittance :math:`Y_i` and the measured one :math:`\hat Y_i`, "log-complex" is

    .. math:: \left(\operatorname{Re} \ln \frac{Y_i}{\hat Y_i},\ \operatorname{Im} \ln \frac{Y_i}{\hat Y_i}\right),

    which gives every point the same relative weight, and "linear-magnitude" is

    .. math:: \frac{|Y_i| - |\hat Y_i|}{\max_j |\hat Y_j|},

    in which points about the resonance have nearly all the weight.
    """
    if name not in RESIDUALS:
        raise UnknownName.among(RESIDUALS, kind="residual", name=name)
    return RESIDUALS[name]
