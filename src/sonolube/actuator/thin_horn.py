"""Horns as thin bars: the half-wave length that rings at a frequency, the gain and the node, in closed form.

With plane sections and no lateral inertia, (S u')' + k^2 S u = 0, k = 2 pi f/c_0, and free ends, u' = 0.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from sonolube.checks import require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class ThinHorn:
    """A half-wave horn.

    Parameters
    ----------
    length : float
        Length of the horn, or of its thick part where it is stepped. [m]
    displacement_gain : float
        Displacement of the thin end over that of the thick one. []
    node_position : float
        Place of the node, from the thick end. [m]
    """

    length: float
    displacement_gain: float
    node_position: float


def thin_exponential_horn(*, radius: float, end_radius: float, frequency: float, wave_speed: float) -> ThinHorn:
    """Return the exponential horn, or the plain bar where both radii are one.

    Parameters
    ----------
    radius, end_radius : float
        Radii at its beginning and end. [m]
    frequency : float
        Frequency at which it shall ring. [Hz]
    wave_speed : float
        Of its material. [m/s]

    Returns
    -------
    ThinHorn

    Notes
    -----
    f = c_0/(2 L) sqrt(1 + (ln N/pi)^2) and gain N, the ratio of the radii.

    References
    ----------
    .. [1] L. G. Merkulov, Sov. Phys. Acoust. 3, 246 (1957).
    .. [2] E. Eisner, J. Acoust. Soc. Am. 35, 1367 (1963). doi:10.1121/1.1918700
    """
    n = _ratio(radius, end_radius)
    k = _wavenumber(frequency, wave_speed)
    length = float(np.hypot(np.pi, np.log(n)) / k)
    # u = exp(a x) (cos q x - a/q sin q x), a = ln N/L, q = pi/L
    return ThinHorn(
        length=length, displacement_gain=n, node_position=float(np.arctan2(np.pi, np.log(n)) * length / np.pi)
    )


def thin_conical_horn(*, radius: float, end_radius: float, frequency: float, wave_speed: float) -> ThinHorn:
    """Return the conical horn.

    Parameters
    ----------
    radius, end_radius : float
        Radii at its beginning and end. [m]
    frequency : float
        Frequency at which it shall ring. [Hz]
    wave_speed : float
        Of its material. [m/s]

    Returns
    -------
    ThinHorn

    Notes
    -----
    tan kL = kL/(1 + (kL)^2 N/(N - 1)^2), N the ratio of the radii.

    References
    ----------
    .. [1] L. G. Merkulov, Sov. Phys. Acoust. 3, 246 (1957).
    """
    n = _ratio(radius, end_radius)
    k = _wavenumber(frequency, wave_speed)
    if n == 1:
        return ThinHorn(length=float(np.pi / k), displacement_gain=1.0, node_position=float(np.pi / (2 * k)))
    shape = n / (n - 1) ** 2

    def mismatch(x: float) -> float:
        return float(np.sin(x) * (1 + shape * x**2) - x * np.cos(x))

    x = brentq(mismatch, np.pi, 1.5 * np.pi, xtol=1e-14)
    taper = (1 - 1 / n) / x  # (N - 1)/(N kL)
    gain = n * abs(np.cos(x) - taper * np.sin(x))
    return ThinHorn(length=float(x / k), displacement_gain=float(gain), node_position=float(np.arctan2(1.0, taper) / k))


def thin_stepped_horn(
    *, radius: float, end_radius: float, end_length: float, frequency: float, wave_speed: float
) -> ThinHorn:
    """Return the stepped horn whose thin part has a given length.

    Parameters
    ----------
    radius, end_radius : float
        Radii of the thick and the thin part. [m]
    end_length : float
        Length of the thin part, below half a wave. [m]
    frequency : float
        Frequency at which it shall ring. [Hz]
    wave_speed : float
        Of its material. [m/s]

    Returns
    -------
    ThinHorn

    Raises
    ------
    InvalidInput
        If the thin part is half a wave or longer.

    Notes
    -----
    S tan kL + S_1 tan kL_1 = 0; with quarter waves on both sides the gain is that of the areas, N^2.

    References
    ----------
    .. [1] L. G. Merkulov, Sov. Phys. Acoust. 3, 246 (1957).
    """
    n = _ratio(radius, end_radius)
    k = _wavenumber(frequency, wave_speed)
    thin = k * float(require_positive(end_length=end_length))
    if thin >= np.pi:
        raise InvalidInput(f"end_length must be below half a wave, {np.pi / k:.4g} m, got {end_length!r} m")
    thick = np.pi - np.arctan2(np.sin(thin), n**2 * np.cos(thin))
    gain = n**2 * np.sin(thick) / np.sin(thin)
    node = np.pi / 2 if thick >= np.pi / 2 else thick + thin - np.pi / 2
    return ThinHorn(length=float(thick / k), displacement_gain=float(gain), node_position=float(node / k))


def _ratio(radius: float, end_radius: float) -> float:
    require_positive(radius=radius)
    require_within(0.0, radius, end_radius=require_positive(end_radius=end_radius))
    return radius / end_radius


def _wavenumber(frequency: float, wave_speed: float) -> float:
    return float(2 * np.pi * require_positive(frequency=frequency) / require_positive(wave_speed=wave_speed))
