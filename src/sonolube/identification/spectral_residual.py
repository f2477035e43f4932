"""Residuals of a model's admittance against a measured spectrum, for least squares."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import UnknownName
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval

_INDUCTIVE_SHARE = 0.05  # of the points
_MOSTLY = 0.5  # of the points
_HARDLY_DETERMINED = 4.0  # upper end of an interval over the lower

LOG_COMPLEX = "log-complex"
LOG_MAGNITUDE = "log-magnitude"
LINEAR_MAGNITUDE = "linear-magnitude"


def _log_complex(model: Complexes, measured: Complexes) -> Floats:
    """Logarithms of the magnitude ratio, then phase differences in rad, shape (2n,)."""
    ratio = np.log(model / measured)  # principal branch: phase differences lie between -pi and pi
    return np.concatenate([ratio.real, ratio.imag])


def _log_magnitude(model: Complexes, measured: Complexes) -> Floats:
    """Logarithms of the magnitude ratio, shape (n,)."""
    return np.asarray(np.log(np.abs(model) / np.abs(measured)))


def _linear_magnitude(model: Complexes, measured: Complexes) -> Floats:
    """Differences of the magnitudes over the largest measured one, shape (n,)."""
    magnitude = np.abs(measured)
    return np.asarray((np.abs(model) - magnitude) / magnitude.max())


RESIDUALS: Mapping[str, Callable[[Complexes, Complexes], Floats]] = MappingProxyType(
    {LOG_COMPLEX: _log_complex, LOG_MAGNITUDE: _log_magnitude, LINEAR_MAGNITUDE: _linear_magnitude}
)


def residual_for(spectrum: ImpedanceSpectrum, name: str) -> str:
    """Name of the residual for a spectrum: "log-magnitude" in place of "log-complex" where no phase was measured."""
    return LOG_MAGNITUDE if name == LOG_COMPLEX and not spectrum.has_phase else name


def caveats_of_spectrum(spectrum: ImpedanceSpectrum, intervals: Mapping[str, ConfidenceInterval]) -> tuple[str, ...]:
    """Warnings about a spectrum of magnitudes only, and about parameters that a spectrum hardly determines."""
    loose = [name for name, found in intervals.items() if not found.upper < _HARDLY_DETERMINED * found.lower]
    named = f"hardly determined: {', '.join(loose)}" if loose else "it determines every parameter"
    if not spectrum.has_phase:
        return (f"the spectrum has no phase, so the fit is to the magnitude of the admittance alone; {named}",)
    return (f"{named}; the spectrum is not that of the model",) if loose else ()


def inductive_caveats(spectrum: ImpedanceSpectrum, fitted: Complexes) -> tuple[str, ...]:
    """Warning about a part of a spectrum that is inductive where the fitted admittance is capacitive."""
    f, inductive = spectrum.frequency, spectrum.admittance.imag < 0
    apart = inductive if np.mean(inductive) > _MOSTLY else inductive & (fitted.imag > 0)
    if not np.mean(apart) > _INDUCTIVE_SHARE:
        return ()
    return (
        f"the impedance is inductive at {np.mean(apart):.0%} of the points, from {f[apart][0]:.6g} to"
        f" {f[apart][-1]:.6g} Hz, where a transducer is capacitive: leads or a coil in series, which the circuit lacks",
    )


def residual_named(name: str) -> Callable[[Complexes, Complexes], Floats]:
    r"""Residual function of a name, which takes a model's admittance and the measured one.

    For the model's admittance :math:`Y_i` and the measured one :math:`\hat Y_i`, "log-complex" is

    .. math:: \left(\operatorname{Re} \ln \frac{Y_i}{\hat Y_i},\ \operatorname{Im} \ln \frac{Y_i}{\hat Y_i}\right),

    which gives every point the same relative weight, "log-magnitude" its first part, and "linear-magnitude" is

    .. math:: \frac{|Y_i| - |\hat Y_i|}{\max_j |\hat Y_j|},

    in which points about the resonance have nearly all the weight.
    """
    if name not in RESIDUALS:
        raise UnknownName.among(RESIDUALS, kind="residual", name=name)
    return RESIDUALS[name]
