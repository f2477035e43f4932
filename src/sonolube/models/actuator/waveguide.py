"""Bar waveguide in longitudinal resonance: axial motion, and normal motion of its sides by lateral contraction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class BarWaveguide:
    r"""Prismatic bar with free ends in an odd longitudinal mode, with a displacement node at its centre.

    Parameters
    ----------
    length : float
        Length of the bar. [m]
    thickness : float
        Thickness of the bar normal to the sliding surface. [m]
    poisson_ratio : float
        Poisson's ratio of its material. []
    axial_amplitude : float
        Axial displacement amplitude of its ends. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    mode : int
        Number of half wavelengths along the bar, odd.

    Raises
    ------
    InvalidInput
        If a length or frequency is not positive, the amplitude negative, or the mode even.

    Notes
    -----
    Valid for bars that are thin compared with a quarter wavelength. With the length L, thickness D, mode n, axial
    amplitude A, Poisson's ratio :math:`\nu` and the position x from the centre

    .. math::

        u = A \cos(2\pi f t)\, \sin\frac{n \pi x}{L} \quad\text{(D 3.22)}, \qquad
        v = B \cos(2\pi f t - \varphi)\, \cos\frac{n \pi x}{L}, \quad
        B = \frac{n \pi \nu A D}{2 L} \quad\text{(D 3.25)}

    where :math:`\varphi` is the phase lag of the normal behind the axial motion. It is zero without losses, and surface
    points then move on straight lines. D 3.25 prints a sine where D 3.22 has a cosine, a lag of :math:`\pi/2` that
    makes the trajectories ellipses.

    References
    ----------
    .. [1] D 3.17 to 3.25.
    """

    length: float
    thickness: float
    poisson_ratio: float
    axial_amplitude: float
    frequency: float
    mode: int = 1

    def __post_init__(self) -> None:
        require_positive(length=self.length, thickness=self.thickness, frequency=self.frequency)
        require_non_negative(axial_amplitude=self.axial_amplitude)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)
        _require_odd(self.mode)

    @property
    def wave_number(self) -> float:
        """Wavenumber n pi/L. [rad/m]"""
        return self.mode * np.pi / self.length


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfaceTrajectory:
    """Trajectory of surface points over one period.

    Parameters
    ----------
    axial_displacement : ndarray, shape (..., samples)
        Displacement along the bar. [m]
    normal_displacement : ndarray, shape (..., samples)
        Displacement normal to the sliding surface, positive into the bar. [m]
    """

    axial_displacement: Floats
    normal_displacement: Floats


def axial_displacement(waveguide: BarWaveguide, *, position: ArrayLike, time: ArrayLike) -> Floats:
    r"""Axial displacement of a bar waveguide. [m]

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like
        Position along the bar, from its centre. [m]
    time : array_like, broadcast against `position`
        Time. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or a value is not finite.

    Notes
    -----
    .. math:: u = A \cos(2\pi f t)\, \sin\frac{n \pi x}{L} \quad\text{(D 3.22)}

    References
    ----------
    .. [1] D 3.22.
    """
    angle = 2 * np.pi * waveguide.frequency * require_finite(time=time)
    return waveguide.axial_amplitude * np.cos(angle) * np.sin(_wave_phase(waveguide, position))


def normal_displacement(waveguide: BarWaveguide, *, position: ArrayLike, time: ArrayLike, phase: float) -> Floats:
    r"""Normal displacement of the sliding surface by lateral contraction, positive into the bar. [m]

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like
        Position along the bar, from its centre. [m]
    time : array_like, broadcast against `position`
        Time. [s]
    phase : float
        Lag of the normal motion behind the axial one: zero without losses, pi/2 as printed in D 3.25. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Positive where the bar is thinner than at rest, and the gap to the counterbody wider.

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or a value is not finite.

    Notes
    -----
    .. math:: v = B \cos(2\pi f t - \varphi)\, \cos\frac{n \pi x}{L} \quad\text{(D 3.25)}

    The lateral strain is minus Poisson's ratio times the axial strain (D 3.24 omits the sign), over half the thickness.

    References
    ----------
    .. [1] D 3.25.
    """
    angle = 2 * np.pi * waveguide.frequency * require_finite(time=time) - require_finite(phase=phase)
    return _central_amplitude(waveguide) * np.cos(angle) * np.cos(_wave_phase(waveguide, position))


def normal_amplitude(waveguide: BarWaveguide, *, position: ArrayLike = 0.0) -> Floats:
    r"""Normal displacement amplitude of the sliding surface. [m]

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like, any shape
        Position along the bar, from its centre. [m]

    Returns
    -------
    ndarray, shape of `position`
        Greatest at the centre.

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or is not finite.

    Notes
    -----
    .. math:: \hat v = \frac{n \pi \nu A D}{2 L} \left|\cos\frac{n \pi x}{L}\right|

    References
    ----------
    .. [1] D 3.25.
    """
    return _central_amplitude(waveguide) * np.abs(np.cos(_wave_phase(waveguide, position)))


def in_plane_amplitude(waveguide: BarWaveguide, *, position: ArrayLike) -> Floats:
    r"""Axial displacement amplitude of the sliding surface. [m]

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like, any shape
        Position along the bar, from its centre. [m]

    Returns
    -------
    ndarray, shape of `position`

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or is not finite.

    Notes
    -----
    .. math:: \hat u = A \left|\sin\frac{n \pi x}{L}\right|

    References
    ----------
    .. [1] D 3.22.
    """
    return waveguide.axial_amplitude * np.abs(np.sin(_wave_phase(waveguide, position)))


def surface_trajectory(
    waveguide: BarWaveguide, *, position: ArrayLike, phase: float, samples: int = 361
) -> SurfaceTrajectory:
    """Closed trajectory of surface points over one period.

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like, shape (...)
        Position along the bar, from its centre. [m]
    phase : float
        Lag of the normal motion behind the axial one: zero without losses, pi/2 as printed in D 3.25. [rad]
    samples : int
        Number of points of each trajectory, of which the last coincides with the first.

    Returns
    -------
    SurfaceTrajectory

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or there are fewer than two samples.
    """
    if samples < 2:
        raise InvalidInput(f"samples must be at least 2, got {samples!r}")
    points = require_finite(position=position)[..., np.newaxis]
    times = np.linspace(0.0, 1.0, samples) / waveguide.frequency
    return SurfaceTrajectory(
        axial_displacement=axial_displacement(waveguide, position=points, time=times),
        normal_displacement=normal_displacement(waveguide, position=points, time=times, phase=phase),
    )


def free_bar_frequency(*, length: ArrayLike, wave_speed: ArrayLike, mode: int = 1) -> Floats:
    r"""Natural frequency of an odd longitudinal mode of a bar with free ends. [Hz]

    Parameters
    ----------
    length : array_like
        Length of the bar. [m]
    wave_speed : array_like, broadcast against `length`
        Speed of axial waves. [m/s]
    mode : int
        Number of half wavelengths along the bar, odd.

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length or speed is not positive, or the mode even.

    Notes
    -----
    .. math:: f_n = \frac{n c_0}{2 L} \quad\text{(D 3.20)}

    References
    ----------
    .. [1] D 3.20, which admits every n although the condition above it, cos(omega L/2c) = 0, holds for odd n alone.

    Examples
    --------
    >>> from sonolube.models.actuator import free_bar_frequency
    >>> from sonolube.text.units import format_si
    >>> format_si(float(free_bar_frequency(length=0.125, wave_speed=5000.0)), "Hz")  # half a wavelength
    '20 kHz'
    """
    _require_odd(mode)
    return mode * require_positive(wave_speed=wave_speed) / (2 * require_positive(length=length))


def _central_amplitude(waveguide: BarWaveguide) -> float:
    """Normal displacement amplitude B at the centre, in m."""
    strain = waveguide.wave_number * waveguide.axial_amplitude  # D 3.23
    return waveguide.poisson_ratio * strain * waveguide.thickness / 2


def _wave_phase(waveguide: BarWaveguide, position: ArrayLike) -> Floats:
    """Product of wavenumber and position, in rad."""
    half = waveguide.length / 2
    return waveguide.wave_number * require_within(-half, half, position=position)


def _require_odd(mode: int) -> None:
    """Refuse an even mode."""
    require_positive(mode=mode)
    if mode % 2 != 1:
        raise InvalidInput(
            f"mode must be odd, got {mode!r}: a bar held at its centre has a node there, which even modes do not have"
        )
