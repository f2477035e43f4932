"""Networks between amplifier and actuator, which spare the amplifier the reactive part of the current."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from sonolube.checks import (
    Complexes,
    Floats,
    require_finite_complex,
    require_positive,
    require_within,
)
from sonolube.errors import InvalidInput, OutsideRange

AdmittanceFunction = Callable[[Floats], NDArray[np.complexfloating[Any, Any]]]
"""Current per voltage of an actuator at frequencies, complex."""

_WIDEST = 0.5  # of the frequency, how far a band is looked for


@dataclass(frozen=True, kw_only=True, slots=True)
class MatchingNetwork:
    """One or two reactive elements between amplifier and actuator; what is not there is None.

    Parameters
    ----------
    series_inductance : float or None
        Inductor in the line. [H]
    series_capacitance : float or None
        Capacitor in the line, instead. [F]
    shunt_inductance : float or None
        Inductor across the line. [H]
    shunt_capacitance : float or None
        Capacitor across the line, instead. [F]
    shunt_at_source : bool
        Whether that across the line lies on the amplifier's side of the other.

    Raises
    ------
    InvalidInput
        If a value is not positive, or a place holds both kinds.
    """

    series_inductance: float | None = None
    series_capacitance: float | None = None
    shunt_inductance: float | None = None
    shunt_capacitance: float | None = None
    shunt_at_source: bool = False

    def __post_init__(self) -> None:
        places = ("series_inductance", "series_capacitance", "shunt_inductance", "shunt_capacitance")
        given = {name: getattr(self, name) for name in places if getattr(self, name) is not None}
        if given:
            require_positive(**given)
        for place in ("series", "shunt"):
            if f"{place}_inductance" in given and f"{place}_capacitance" in given:
                raise InvalidInput(f"{place}_inductance and {place}_capacitance are one place: give one of them")


def parallel_inductor(*, admittance: complex, frequency: float) -> MatchingNetwork:
    """Return the inductor across the actuator with which it draws real power only, at one frequency.

    Parameters
    ----------
    admittance : complex
        Of the actuator there, with what it drives. [S]
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    MatchingNetwork

    Raises
    ------
    InvalidInput
        If the actuator is not capacitive there.
    """
    y, omega = _capacitive(admittance, frequency)
    return MatchingNetwork(**_shunt(-y.imag, omega))


def series_inductor(*, admittance: complex, frequency: float) -> MatchingNetwork:
    """Return the inductor in the line with which the actuator draws real power only, at one frequency.

    Parameters
    ----------
    admittance : complex
        Of the actuator there, with what it drives. [S]
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    MatchingNetwork
        The actuator's voltage is then the amplifier's, times `voltage_gain`.

    Raises
    ------
    InvalidInput
        If the actuator is not capacitive there.
    """
    y, omega = _capacitive(admittance, frequency)
    return MatchingNetwork(**_series(-(1 / y).imag, omega))


def l_match(*, admittance: complex, frequency: float, source_resistance: float) -> MatchingNetwork:
    """Return two elements with which the actuator looks like a resistance, at one frequency.

    Parameters
    ----------
    admittance : complex
        Of the actuator there, with what it drives. [S]
    frequency : float
        Frequency of the drive. [Hz]
    source_resistance : float
        Resistance to look like. [ohm]

    Returns
    -------
    MatchingNetwork
        With an inductor in the line, of the two networks that there are.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the actuator takes no power there.

    Notes
    -----
    Where the resistance wanted is below that of the actuator seen as elements in parallel, 1/G, one element across it
    lowers it, and one in the line takes out what reactance is left. Else one in the line raises it first.
    """
    y = complex(require_finite_complex(admittance=admittance))
    r = float(require_positive(source_resistance=source_resistance))
    omega = 2 * math.pi * float(require_positive(frequency=frequency))
    if y.real <= 0:
        raise InvalidInput(f"admittance must have a positive real part to be matched, got {y:.4g} S")
    if y.real * r <= 1:
        # Re 1/(G + jB) = R_s; the positive root leaves a capacitive rest, which an inductor in the line takes out
        susceptance = math.sqrt(y.real / r - y.real**2)
        rest = 1 / complex(y.real, susceptance)
        return MatchingNetwork(**_series(-rest.imag, omega), **_shunt(susceptance - y.imag, omega))
    z = 1 / y
    reactance = math.sqrt(z.real * r - z.real**2)  # Re 1/(R + jX) = 1/R_s; positive, so that an inductor does it
    across = -(1 / complex(z.real, reactance)).imag
    return MatchingNetwork(**_series(reactance - z.imag, omega), **_shunt(across, omega), shunt_at_source=True)


def input_admittance(network: MatchingNetwork, *, admittance: ArrayLike, frequency: ArrayLike) -> Complexes:
    """Return what the amplifier sees, complex. [S]

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Of the actuator. [S]
    frequency : array_like, broadcast against `admittance`
        Frequency of the drive. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite, or a frequency not positive.
    """
    y = require_finite_complex(admittance=admittance)
    series, shunt = _elements(network, frequency)
    if network.shunt_at_source:
        return np.asarray(y / (1 + y * series) + shunt)
    loaded = y + shunt
    return np.asarray(loaded / (1 + loaded * series))


def voltage_gain(network: MatchingNetwork, *, admittance: ArrayLike, frequency: ArrayLike) -> Complexes:
    """Return voltage of the actuator over that of the amplifier, complex. []

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Of the actuator. [S]
    frequency : array_like, broadcast against `admittance`
        Frequency of the drive. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite, or a frequency not positive.
    """
    y = require_finite_complex(admittance=admittance)
    series, shunt = _elements(network, frequency)
    loaded = y if network.shunt_at_source else y + shunt
    return np.asarray(1 / (1 + loaded * series))


def matched_power_factor(network: MatchingNetwork, *, admittance: ArrayLike, frequency: ArrayLike) -> Floats:
    """Return the power factor that the amplifier sees under a sine. []

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Of the actuator. [S]
    frequency : array_like, broadcast against `admittance`
        Frequency of the drive. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite, or a frequency not positive.
    """
    seen = input_admittance(network, admittance=admittance, frequency=frequency)
    return np.asarray(seen.real / np.abs(seen))


def matched_band(
    network: MatchingNetwork, actuator: AdmittanceFunction, *, frequency: float, least_power_factor: float = 0.9
) -> tuple[float, float]:
    """Return the frequencies between which the power factor stays above a bound, in Hz.

    Parameters
    ----------
    network : MatchingNetwork
    actuator : callable
        Returns its admittance, complex, at an array of frequencies in Hz.
    frequency : float
        Frequency at which the network matches. [Hz]
    least_power_factor : float
        That bound. []

    Returns
    -------
    pair of float
        Not beyond half and one and a half of the frequency.

    Raises
    ------
    InvalidInput
        If the frequency is not positive, or the bound not between 0 and 1.
    OutsideRange
        If the power factor is not above the bound at the frequency itself.
    """
    f = float(require_positive(frequency=frequency))
    bound = float(require_within(0.0, 1.0, least_power_factor=least_power_factor))

    def above(at: float) -> float:
        here = np.atleast_1d(at)
        return float(matched_power_factor(network, admittance=actuator(here), frequency=here)[0]) - bound

    if above(f) <= 0:
        raise OutsideRange(f"the power factor at {f:g} Hz is {above(f) + bound:.3g}, not above {bound:g}")
    return _edge(above, f, -1), _edge(above, f, 1)


def _edge(above: Callable[[float], float], f: float, side: int) -> float:
    """Return where a function first falls below nought, stepping out with ever wider strides."""
    near, stride = f, 1e-4
    while stride < _WIDEST:
        far = f * (1 + side * stride)
        if above(far) < 0:
            return float(brentq(above, near, far, xtol=1e-9 * f))
        near, stride = far, 1.1 * stride
    return f * (1 + side * _WIDEST)


def _capacitive(admittance: complex, frequency: float) -> tuple[complex, float]:
    y = complex(require_finite_complex(admittance=admittance))
    omega = 2 * math.pi * float(require_positive(frequency=frequency))
    if y.imag <= 0:
        raise InvalidInput(
            f"admittance must be capacitive for an inductor to compensate it, got {y:.4g} S: near a resonance the"
            " motion can make it inductive; a capacitor does it there"
        )
    return y, omega


def _elements(network: MatchingNetwork, frequency: ArrayLike) -> tuple[Complexes, Complexes]:
    """Return impedance in the line and admittance across it."""
    s = 2j * np.pi * require_positive(frequency=frequency)
    series, shunt = np.zeros_like(s), np.zeros_like(s)
    if network.series_inductance is not None:
        series = s * network.series_inductance
    if network.series_capacitance is not None:
        series = 1 / (s * network.series_capacitance)
    if network.shunt_inductance is not None:
        shunt = 1 / (s * network.shunt_inductance)
    if network.shunt_capacitance is not None:
        shunt = s * network.shunt_capacitance
    return np.asarray(series), np.asarray(shunt)


def _series(reactance: float, omega: float) -> dict[str, Any]:
    if reactance == 0:
        return {}
    if reactance > 0:
        return {"series_inductance": reactance / omega}
    return {"series_capacitance": -1 / (omega * reactance)}


def _shunt(susceptance: float, omega: float) -> dict[str, Any]:
    if susceptance == 0:
        return {}
    if susceptance > 0:
        return {"shunt_capacitance": susceptance / omega}
    return {"shunt_inductance": -1 / (omega * susceptance)}
