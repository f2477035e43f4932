"""Paths of surface points in harmonic motion: ellipses, their axes, their tilt and the sense in which they turn."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite_complex


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TrajectoryEllipse:
    """Ellipses on which points move.

    Parameters
    ----------
    major_semi_axis : ndarray, shape (...)
        Longer half axis. [m]
    minor_semi_axis : ndarray, shape (...)
        Shorter half axis, positive where the point turns from the axial towards the normal direction, negative where
        it turns the other way, zero on a straight line. [m]
    inclination : ndarray, shape (...)
        Angle from the axial direction to the long axis, within a quarter turn to either side. [rad]
    phase : ndarray, shape (...)
        Lag of the normal displacement behind the axial one, within half a turn to either side. [rad]
    """

    major_semi_axis: Floats
    minor_semi_axis: Floats
    inclination: Floats
    phase: Floats


def trajectory_ellipse(*, axial_displacement: ArrayLike, normal_displacement: ArrayLike) -> TrajectoryEllipse:
    """Return the ellipses of points whose displacements are Re[u exp(i omega t)] and Re[v exp(i omega t)].

    Parameters
    ----------
    axial_displacement : array_like of complex
        Amplitude u along the surface. [m]
    normal_displacement : array_like of complex, broadcast against `axial_displacement`
        Amplitude v along its normal. [m]

    Returns
    -------
    TrajectoryEllipse

    Raises
    ------
    InvalidInput
        If an amplitude is not finite.

    Notes
    -----
    The motion is the sum of two circular ones, of radii abs(u + i v)/2 and abs(u - i v)/2, that turn against each
    other: the half axes are their sum and difference.
    """
    u, v = np.broadcast_arrays(
        require_finite_complex(axial_displacement=axial_displacement),
        require_finite_complex(normal_displacement=normal_displacement),
    )
    forward, backward = (u + 1j * v) / 2, (u - 1j * v) / 2  # of exp(i omega t), and the conjugate of the other's
    tilt = (np.angle(forward) - np.angle(backward)) / 2
    return TrajectoryEllipse(
        major_semi_axis=np.abs(forward) + np.abs(backward),
        minor_semi_axis=np.abs(forward) - np.abs(backward),
        inclination=np.asarray((tilt + np.pi / 2) % np.pi - np.pi / 2),
        phase=np.asarray(np.angle(u * v.conj())),
    )
