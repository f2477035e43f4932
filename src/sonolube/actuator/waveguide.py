"""The waveguide: a bar that stands in half waves, whose sides bulge as it shortens."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class BarWaveguide:
    """A prismatic bar with free ends in an odd longitudinal mode, its centre a node.

    Parameters
    ----------
    length : float
        Length of the bar. [m]
    thickness : float
        Thickness of the bar, across the surface that slides. [m]
    poisson_ratio : float
        Poisson's ratio of its material. []
    axial_amplitude : float
        Amplitude of its ends along its axis. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    mode : int
        Number of half waves along the bar, odd.
    phase : float
        Lag of the normal motion behind the axial one; a quarter turn as D prints it. [rad]

    Raises
    ------
    InvalidInput
        If a length or frequency is not positive, the amplitude negative, or the mode even.

    Notes
    -----
    For bars thin against a quarter wave. Without losses the lateral strain follows the axial one at once: phase 0, and
    every point moves on a straight line. D 3.25 prints a sine where 3.22 has a cosine, which makes the paths ellipses.

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
    phase: float = np.pi / 2

    def __post_init__(self) -> None:
        require_positive(length=self.length, thickness=self.thickness, frequency=self.frequency)
        require_non_negative(axial_amplitude=self.axial_amplitude)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)
        require_finite(phase=self.phase)
        _require_odd(self.mode)

    @property
    def wave_number(self) -> float:
        """Phase per length along the bar. [rad/m]"""
        return self.mode * np.pi / self.length


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfaceTrajectory:
    """The path of surface points over one period.

    Parameters
    ----------
    axial_displacement : ndarray, shape (..., samples)
        Displacement along the bar. [m]
    normal_displacement : ndarray, shape (..., samples)
        Displacement along the normal of the sliding surface, positive into the bar. [m]
    """

    axial_displacement: Floats
    normal_displacement: Floats


def axial_displacement(waveguide: BarWaveguide, *, position: ArrayLike, time: ArrayLike) -> Floats:
    """Return the displacement along the bar. [m]

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

    References
    ----------
    .. [1] D 3.22.
    """
    turn = 2 * np.pi * waveguide.frequency * require_finite(time=time)
    return waveguide.axial_amplitude * np.cos(turn) * np.sin(_wave_phase(waveguide, position))  # D 3.22


def normal_displacement(waveguide: BarWaveguide, *, position: ArrayLike, time: ArrayLike) -> Floats:
    """Return the displacement of the sliding surface along its normal, positive into the bar. [m]

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
        Positive where the bar is thinner than at rest, and its gap to the counterpart wider.

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or a value is not finite.

    Notes
    -----
    The strain across is minus Poisson's ratio times the strain along (D 3.24 omits the sign), and acts over half the
    thickness.

    References
    ----------
    .. [1] D 3.25.
    """
    turn = 2 * np.pi * waveguide.frequency * require_finite(time=time) - waveguide.phase
    return _bulge(waveguide) * np.cos(turn) * np.cos(_wave_phase(waveguide, position))  # D 3.25


def normal_amplitude(waveguide: BarWaveguide, *, position: ArrayLike = 0.0) -> Floats:
    """Return the amplitude of the sliding surface along its normal. [m]

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like, any shape
        Position along the bar, from its centre. [m]

    Returns
    -------
    ndarray, shape of `position`
        At the centre B = n pi D A nu/(2 L), its greatest value.

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or is not finite.

    References
    ----------
    .. [1] D 3.25.
    """
    return _bulge(waveguide) * np.abs(np.cos(_wave_phase(waveguide, position)))


def in_plane_amplitude(waveguide: BarWaveguide, *, position: ArrayLike) -> Floats:
    """Return the amplitude of the sliding surface along the bar. [m]

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

    References
    ----------
    .. [1] D 3.22.
    """
    return waveguide.axial_amplitude * np.abs(np.sin(_wave_phase(waveguide, position)))


def surface_trajectory(waveguide: BarWaveguide, *, position: ArrayLike, samples: int = 361) -> SurfaceTrajectory:
    """Return the closed path of surface points over one period.

    Parameters
    ----------
    waveguide : BarWaveguide
    position : array_like, shape (...)
        Position along the bar, from its centre. [m]
    samples : int
        Points of each path, of which the last falls on the first.

    Returns
    -------
    Locus

    Raises
    ------
    InvalidInput
        If a position lies beyond the ends, or there are fewer than two samples.
    """
    if samples < 2:
        raise InvalidInput(f"samples must be at least 2, got {samples!r}")
    places = require_finite(position=position)[..., np.newaxis]
    times = np.linspace(0.0, 1.0, samples) / waveguide.frequency
    return SurfaceTrajectory(
        axial_displacement=axial_displacement(waveguide, position=places, time=times),
        normal_displacement=normal_displacement(waveguide, position=places, time=times),
    )


def free_bar_frequency(*, length: ArrayLike, wave_speed: ArrayLike, mode: int = 1) -> Floats:
    """Return the frequency at which a bar with free ends stands in a number of half waves. [Hz]

    Parameters
    ----------
    length : array_like
        Length of the bar. [m]
    wave_speed : array_like, broadcast against `length`
        Speed of axial waves in it. [m/s]
    mode : int
        Number of half waves along the bar, odd.

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length or speed is not positive, or the mode even.

    References
    ----------
    .. [1] D 3.20, which admits every n although the condition above it, cos(omega L/2c) = 0, holds for odd n alone.
    """
    _require_odd(mode)
    return mode * require_positive(wave_speed=wave_speed) / (2 * require_positive(length=length))


def _bulge(waveguide: BarWaveguide) -> float:
    strain = waveguide.wave_number * waveguide.axial_amplitude  # D 3.23
    return waveguide.poisson_ratio * strain * waveguide.thickness / 2


def _wave_phase(waveguide: BarWaveguide, position: ArrayLike) -> Floats:
    half = waveguide.length / 2
    return waveguide.wave_number * require_within(-half, half, position=position)


def _require_odd(mode: int) -> None:
    require_positive(mode=mode)
    if mode % 2 != 1:
        raise InvalidInput(
            f"mode must be odd, got {mode!r}: a bar held at its centre has a node there, which even modes have not"
        )
