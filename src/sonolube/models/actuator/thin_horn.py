r"""Thin half-wave horns in closed form: resonant length, displacement gain and node.

With plane cross-sections of area S and without lateral inertia the displacement u follows Webster's equation

.. math:: (S u')' + k^2 S u = 0, \qquad k = \frac{2\pi f}{c_0}, \qquad u' = 0 \text{ at free ends}
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from sonolube.checks import require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class ThinHorn:
    """Resonant half-wave horn: length, displacement gain and node.

    Parameters
    ----------
    length : float
        Length of the horn, or of the thick part of a stepped one. [m]
    displacement_gain : float
        Displacement of the thin end over that of the thick end. []
    node_position : float
        Distance of the displacement node from the thick end. [m]
    """

    length: float
    displacement_gain: float
    node_position: float


def thin_exponential_horn(*, radius: float, end_radius: float, frequency: float, wave_speed: float) -> ThinHorn:
    r"""Resonant exponential horn, or uniform bar where both radii are equal.

    Parameters
    ----------
    radius, end_radius : float
        Radii of the thick and the thin end. [m]
    frequency : float
        Resonance. [Hz]
    wave_speed : float
        Speed of axial waves in its material. [m/s]

    Returns
    -------
    ThinHorn

    Raises
    ------
    InvalidInput
        If a value is not positive or the end not the thinner.

    Notes
    -----
    With the ratio N of the radii, which is also the gain,

    .. math:: f = \frac{c_0}{2L} \sqrt{1 + \left(\frac{\ln N}{\pi}\right)^2}

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
    r"""Resonant conical horn.

    Parameters
    ----------
    radius, end_radius : float
        Radii of the thick and the thin end. [m]
    frequency : float
        Resonance. [Hz]
    wave_speed : float
        Speed of axial waves in its material. [m/s]

    Returns
    -------
    ThinHorn

    Raises
    ------
    InvalidInput
        If a value is not positive or the end not the thinner.

    Notes
    -----
    With the ratio N of the radii

    .. math::

        \tan kL = \frac{kL}{1 + (kL)^2 N/(N - 1)^2}, \qquad
        G = N \left|\cos kL - \frac{N - 1}{N kL} \sin kL\right|

    References
    ----------
    .. [1] L. G. Merkulov, Sov. Phys. Acoust. 3, 246 (1957).
    """
    n = _ratio(radius, end_radius)
    k = _wavenumber(frequency, wave_speed)
    if n == 1:
        return ThinHorn(length=float(np.pi / k), displacement_gain=1.0, node_position=float(np.pi / (2 * k)))
    shape = n / (n - 1) ** 2

    def frequency_equation(x: float) -> float:
        return float(np.sin(x) * (1 + shape * x**2) - x * np.cos(x))

    x = brentq(frequency_equation, np.pi, 1.5 * np.pi, xtol=1e-14)
    taper = (1 - 1 / n) / x  # (N - 1)/(N kL)
    gain = n * abs(np.cos(x) - taper * np.sin(x))
    return ThinHorn(length=float(x / k), displacement_gain=float(gain), node_position=float(np.arctan2(1.0, taper) / k))


def thin_stepped_horn(
    *, radius: float, end_radius: float, end_length: float, frequency: float, wave_speed: float
) -> ThinHorn:
    r"""Resonant stepped horn with a given length of its thin part.

    Parameters
    ----------
    radius, end_radius : float
        Radii of the thick and the thin part. [m]
    end_length : float
        Length of the thin part, below half a wavelength. [m]
    frequency : float
        Resonance. [Hz]
    wave_speed : float
        Speed of axial waves in its material. [m/s]

    Returns
    -------
    ThinHorn

    Raises
    ------
    InvalidInput
        If the thin part is half a wavelength or longer, a value is not positive or the end not the thinner.

    Notes
    -----
    With the areas S and lengths L of the thick part and :math:`S_1, L_1` of the thin one, :math:`N^2 = S/S_1`,

    .. math:: S \tan kL + S_1 \tan kL_1 = 0, \qquad G = N^2\, \frac{\sin kL}{\sin kL_1}

    For two quarter-wave parts the gain is N squared.

    References
    ----------
    .. [1] L. G. Merkulov, Sov. Phys. Acoust. 3, 246 (1957).

    Examples
    --------
    >>> from sonolube.models.actuator import thin_stepped_horn
    >>> radii = {"radius": 20e-3, "end_radius": 10e-3}
    >>> horn = thin_stepped_horn(**radii, end_length=62.5e-3, frequency=20e3, wave_speed=5000.0)
    >>> round(horn.displacement_gain, 3), round(1e3 * horn.length, 3)  # two quarter waves: (20/10)^2
    (4.0, 62.5)
    """
    n = _ratio(radius, end_radius)
    k = _wavenumber(frequency, wave_speed)
    thin = k * float(require_positive(end_length=end_length))
    if thin >= np.pi:
        raise InvalidInput(f"end_length must be below half a wavelength, {np.pi / k:.4g} m, got {end_length!r} m")
    thick = np.pi - np.arctan2(np.sin(thin), n**2 * np.cos(thin))
    gain = n**2 * np.sin(thick) / np.sin(thin)
    node = np.pi / 2 if thick >= np.pi / 2 else thick + thin - np.pi / 2
    return ThinHorn(length=float(thick / k), displacement_gain=float(gain), node_position=float(node / k))


def _ratio(radius: float, end_radius: float) -> float:
    """Ratio N of the radii, checked to be at least one."""
    require_positive(radius=radius)
    require_within(0.0, radius, end_radius=require_positive(end_radius=end_radius))
    return radius / end_radius


def _wavenumber(frequency: float, wave_speed: float) -> float:
    """Wavenumber k in rad/m."""
    return float(2 * np.pi * require_positive(frequency=frequency) / require_positive(wave_speed=wave_speed))
