"""Impedance matching between amplifier and actuator: reactive networks of one or two elements."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange

AdmittanceFunction = Callable[[Floats], NDArray[np.complexfloating[Any, Any]]]
"""Function from frequencies in Hz to the complex admittance of an actuator in S."""

_WIDEST = 0.5  # of the frequency, to either side, up to which a band edge is searched


@dataclass(frozen=True, kw_only=True, slots=True)
class MatchingNetwork:
    """Matching network of up to two reactive elements between amplifier and actuator; None for absent elements.

    Parameters
    ----------
    series_inductance : float or None
        Inductor in series. [H]
    series_capacitance : float or None
        Capacitor in series, instead. [F]
    shunt_inductance : float or None
        Inductor in parallel. [H]
    shunt_capacitance : float or None
        Capacitor in parallel, instead. [F]
    shunt_at_source : bool
        Whether the shunt element is on the amplifier's side of the series one.

    Raises
    ------
    InvalidInput
        If a value is not positive, or both a capacitor and an inductor are in the same place.
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
                raise InvalidInput(f"{place}_inductance and {place}_capacitance are alternatives: give one of them")


def parallel_inductor(*, admittance: complex, frequency: float) -> MatchingNetwork:
    r"""Shunt inductor that compensates the capacitance of an actuator at one frequency: unity power factor.

    Parameters
    ----------
    admittance : complex
        Admittance of the loaded actuator at that frequency. [S]
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    MatchingNetwork

    Raises
    ------
    InvalidInput
        If the actuator is not capacitive at that frequency.

    Notes
    -----
    .. math:: L_p = \frac{1}{\omega\, \mathrm{Im}\, Y}

    Examples
    --------
    >>> from sonolube.models.actuator import parallel_inductor
    >>> from sonolube.text.units import format_si
    >>> network = parallel_inductor(admittance=2e-3 + 0.05j, frequency=22e3)
    >>> format_si(network.shunt_inductance, "H")
    '145 uH'
    """
    y, omega = _capacitive(admittance, frequency)
    return MatchingNetwork(**_shunt(-y.imag, omega))


def series_inductor(*, admittance: complex, frequency: float) -> MatchingNetwork:
    r"""Series inductor that compensates the reactance of an actuator at one frequency: unity power factor.

    Parameters
    ----------
    admittance : complex
        Admittance of the loaded actuator at that frequency. [S]
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    MatchingNetwork
        The voltage on the actuator is that of the amplifier times `voltage_gain`.

    Raises
    ------
    InvalidInput
        If the actuator is not capacitive at that frequency.

    Notes
    -----
    .. math:: L_s = -\frac{\mathrm{Im}(1/Y)}{\omega}
    """
    y, omega = _capacitive(admittance, frequency)
    return MatchingNetwork(**_series(-(1 / y).imag, omega))


def l_match(*, admittance: complex, frequency: float, source_resistance: float) -> MatchingNetwork:
    r"""L-section of two elements that transforms an actuator's admittance to a resistance at one frequency.

    Parameters
    ----------
    admittance : complex
        Admittance of the loaded actuator at that frequency. [S]
    frequency : float
        Frequency of the drive. [Hz]
    source_resistance : float
        Input resistance of the matched network. [ohm]

    Returns
    -------
    MatchingNetwork
        Of the two solutions, the one with an inductor in series.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the actuator draws no real power at that frequency.

    Notes
    -----
    For an input resistance R below the parallel resistance 1/G of the actuator, a shunt element at the actuator lowers
    the resistance to R and a series element cancels the remaining reactance:

    .. math:: \mathrm{Re}\frac{1}{G + iB} = R, \qquad B = \sqrt{G/R - G^2}

    Otherwise the series element comes first, with the reactance X that makes :math:`\mathrm{Re}\,1/(R_a + iX) = 1/R`
    for the series resistance :math:`R_a` of the actuator, and the shunt element is at the amplifier.

    References
    ----------
    .. [1] D. M. Pozar, Microwave Engineering, 4th ed., Wiley (2012), section 5.1.
    """
    y = complex(require_finite_complex(admittance=admittance))
    r = float(require_positive(source_resistance=source_resistance))
    omega = 2 * math.pi * float(require_positive(frequency=frequency))
    if y.real <= 0:
        raise InvalidInput(f"admittance must have a positive real part to be matched, got {y:.4g} S")
    if y.real * r <= 1:
        # the positive root leaves a capacitive reactance, which a series inductor cancels
        susceptance = math.sqrt(max(y.real / r - y.real**2, 0.0))  # 0 but for rounding where 1/G is R
        rest = 1 / complex(y.real, susceptance)
        return MatchingNetwork(**_series(-rest.imag, omega), **_shunt(susceptance - y.imag, omega))
    z = 1 / y
    reactance = math.sqrt(max(z.real * r - z.real**2, 0.0))  # the positive root, of a series inductor
    across = -(1 / complex(z.real, reactance)).imag
    return MatchingNetwork(**_series(reactance - z.imag, omega), **_shunt(across, omega), shunt_at_source=True)


def input_admittance(network: MatchingNetwork, *, admittance: ArrayLike, frequency: ArrayLike) -> Complexes:
    """Complex input admittance of a matching network with an actuator. [S]

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Admittance of the actuator. [S]
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
    """Complex ratio of the voltage on the actuator to that of the amplifier. []

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Admittance of the actuator. [S]
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
    """Power factor at the input of a matching network under a sinusoidal voltage. []

    Parameters
    ----------
    network : MatchingNetwork
    admittance : array_like
        Admittance of the actuator. [S]
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
    total = input_admittance(network, admittance=admittance, frequency=frequency)
    return np.asarray(total.real / np.abs(total))


def matched_band(
    network: MatchingNetwork, actuator: AdmittanceFunction, *, frequency: float, least_power_factor: float = 0.9
) -> tuple[float, float]:
    """Frequency band around the matched frequency in which the power factor stays above a bound, in Hz.

    Parameters
    ----------
    network : MatchingNetwork
    actuator : callable
        Function from an array of frequencies in Hz to complex admittances.
    frequency : float
        Frequency at which the network is matched. [Hz]
    least_power_factor : float
        Lower bound of the power factor. []

    Returns
    -------
    low, high : float
        Between half and one and a half of the matched frequency.

    Raises
    ------
    InvalidInput
        If the frequency is not positive, or the bound not between 0 and 1.
    OutsideRange
        If the power factor is not above the bound at the frequency itself.
    """
    f = float(require_positive(frequency=frequency))
    bound = float(require_within(0.0, 1.0, least_power_factor=least_power_factor))

    def excess(at: float) -> float:
        frequencies = np.atleast_1d(at)
        factor = matched_power_factor(network, admittance=actuator(frequencies), frequency=frequencies)
        return float(factor[0]) - bound

    if excess(f) <= 0:
        raise OutsideRange(
            f"the power factor at {f:g} Hz is {excess(f) + bound:.3g}, not above {bound:g}; match there first, or "
            "lower least_power_factor"
        )
    return _band_edge(excess, f, -1), _band_edge(excess, f, 1)


def _band_edge(excess: Callable[[float], float], f: float, side: int) -> float:
    """First zero of a function on one side of a frequency, by steps that grow geometrically and Brent's method."""
    near, step = f, 1e-4
    while step < _WIDEST:
        far = f * (1 + side * step)
        if excess(far) < 0:
            return float(brentq(excess, near, far, xtol=1e-9 * f))
        near, step = far, 1.1 * step
    return f * (1 + side * _WIDEST)


def _capacitive(admittance: complex, frequency: float) -> tuple[complex, float]:
    """Admittance and angular frequency, checked to be capacitive."""
    y = complex(require_finite_complex(admittance=admittance))
    omega = 2 * math.pi * float(require_positive(frequency=frequency))
    if y.imag <= 0:
        raise InvalidInput(
            f"admittance must be capacitive for an inductor to compensate it, got {y:.4g} S: near a resonance the"
            " motion can make it inductive; use a capacitor there"
        )
    return y, omega


def _elements(network: MatchingNetwork, frequency: ArrayLike) -> tuple[Complexes, Complexes]:
    """Impedance of the series element and admittance of the shunt element."""
    s = 2j * np.pi * require_positive(frequency=frequency)
    return (
        _immittance(s, rising=network.series_inductance, falling=network.series_capacitance),
        _immittance(s, rising=network.shunt_capacitance, falling=network.shunt_inductance),
    )


def _immittance(s: NDArray[np.complexfloating[Any, Any]], *, rising: float | None, falling: float | None) -> Complexes:
    """Immittance s r of an element that rises with the frequency, or 1/(s f) of one that falls; zero without either."""
    if falling is not None:
        return np.asarray(1 / (s * falling))
    return np.asarray(s * (rising or 0.0))


def _series(reactance: float, omega: float) -> dict[str, Any]:
    """Series element of a reactance, as a keyword of the network."""
    return _element(reactance, omega, rising="series_inductance", falling="series_capacitance")


def _shunt(susceptance: float, omega: float) -> dict[str, Any]:
    """Shunt element of a susceptance, as a keyword of the network."""
    return _element(susceptance, omega, rising="shunt_capacitance", falling="shunt_inductance")


def _element(value: float, omega: float, *, rising: str, falling: str) -> dict[str, Any]:
    """Element of an immittance by the keyword for its sign; none where it is zero."""
    if value == 0:
        return {}
    return {rising: value / omega} if value > 0 else {falling: -1 / (omega * value)}
