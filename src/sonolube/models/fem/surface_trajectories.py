"""Elliptical trajectories of surface points in harmonic vibration: semi-axes, inclination, sense and phase."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite_complex


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TrajectoryEllipse:
    """Elliptical trajectories of points, of any number.

    Parameters
    ----------
    major_semi_axis : ndarray, shape (...)
        Major semi-axis. [m]
    minor_semi_axis : ndarray, shape (...)
        Minor semi-axis, positive where the point rotates from the axial towards the normal direction, negative in the
        opposite sense, zero on a straight line. [m]
    inclination : ndarray, shape (...)
        Angle from the axial direction to the major axis, between -pi/2 and pi/2. [rad]
    phase : ndarray, shape (...)
        Phase lag of the normal displacement behind the axial one, between -pi and pi. [rad]
    """

    major_semi_axis: Floats
    minor_semi_axis: Floats
    inclination: Floats
    phase: Floats


def trajectory_ellipse(*, axial_displacement: ArrayLike, normal_displacement: ArrayLike) -> TrajectoryEllipse:
    r"""Ellipses described by points with the displacements Re[u exp(i omega t)] and Re[v exp(i omega t)].

    Parameters
    ----------
    axial_displacement : array_like of complex
        Complex amplitude u along the surface. [m]
    normal_displacement : array_like of complex, broadcast against `axial_displacement`
        Complex amplitude v along its normal. [m]

    Returns
    -------
    TrajectoryEllipse

    Raises
    ------
    InvalidInput
        If an amplitude is not finite.

    Notes
    -----
    The motion is the sum of two circular motions of opposite sense, whose radii give the semi-axes

    .. math:: a, b = \tfrac12 |u + i v| \pm \tfrac12 |u - i v|

    and whose phases give the inclination :math:`\psi = \tfrac12 [\arg(u + i v) - \arg(u - i v)]`.
    """
    u, v = np.broadcast_arrays(
        require_finite_complex(axial_displacement=axial_displacement),
        require_finite_complex(normal_displacement=normal_displacement),
    )
    forward, backward = (u + 1j * v) / 2, (u - 1j * v) / 2
    angle = (np.angle(forward) - np.angle(backward)) / 2
    return TrajectoryEllipse(
        major_semi_axis=np.abs(forward) + np.abs(backward),
        minor_semi_axis=np.abs(forward) - np.abs(backward),
        inclination=np.asarray((angle + np.pi / 2) % np.pi - np.pi / 2),
        phase=np.asarray(np.angle(u * v.conj())),
    )
