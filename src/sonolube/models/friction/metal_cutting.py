"""Metal cutting under vibration: fraction of the time in which an edge cuts, by its motion alone.

A tool that vibrates along the cutting direction, as in turning; edges that vibrate along the feed, as of a drill.
"""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput

_MOST_FEEDS = 1e5  # that an amplitude may have: so many earlier edges are looked at, twice


def tool_contact_fraction(*, cutting_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    r"""Fraction of the period in which a tool cuts that vibrates along the cutting direction. []

    Parameters
    ----------
    cutting_speed : array_like
        Mean speed of the tool along the work. [m/s]
    vibration_velocity : array_like, broadcast against `cutting_speed`
        Peak velocity of the vibration, 2 pi f a, which is the critical cutting speed; zero for none. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 from the critical speed on.

    Raises
    ------
    InvalidInput
        If a speed is not positive, a vibration negative, or a value not finite.

    Notes
    -----
    The tool leaves the chip where its velocity over the work is zero, and meets it again where it was. With the
    cutting speed :math:`\zeta = v/(2\pi f a) < 1` and :math:`\delta = \arccos\zeta`, the phase psi without contact is
    the root between 2 delta and 2 pi of

    .. math:: \sin(\psi - \delta) + \sin\delta = \zeta\psi , \qquad q = 1 - \frac{\psi}{2\pi} ,

    by bisection; q is :math:`\sqrt{\zeta/\pi}` for slow cutting. A cutting force that depends neither on the speed nor
    on the vibration while it acts has q times its value on average: the spindle gives q of the power, the vibration
    the rest, and the work on a length of chip remains. Waves in the tool and the chip, friction on the faces, and a
    softer metal are left out.

    See Also
    --------
    feed_contact_fraction : A tool that vibrates along the feed, as a drill along its axis.

    References
    ----------
    .. [1] R. C. Skelton, Turning with an oscillating tool, Int. J. Mach. Tool Des. Res. 8, 239 (1968).
       doi:10.1016/0020-7357(68)90014-0

    Examples
    --------
    >>> from sonolube.models.friction import tool_contact_fraction
    >>> tool_contact_fraction(cutting_speed=[0.1, 0.5, 2.0], vibration_velocity=1.257).round(3).tolist()
    [0.164, 0.409, 1.0]
    """
    speed = require_positive(cutting_speed=cutting_speed)
    ratio = speed / np.maximum(require_non_negative(vibration_velocity=vibration_velocity), speed)
    lag = np.arccos(ratio)
    low, high = 2 * lag, np.full_like(lag, 2 * np.pi)
    for _ in range(60):
        middle = (low + high) / 2
        is_apart = np.sin(middle - lag) + np.sin(lag) > ratio * middle
        low, high = np.where(is_apart, middle, low), np.where(is_apart, high, middle)
    return np.where(ratio < 1, 1 - low / (2 * np.pi), 1.0)


def feed_contact_fraction(
    *, feed_per_edge: ArrayLike, vibration_amplitude: ArrayLike, phase_per_edge: ArrayLike
) -> Floats:
    r"""Fraction of the time in which an edge cuts that vibrates along the feed, as of a drill along its axis. []

    Parameters
    ----------
    feed_per_edge : array_like
        Feed by which each edge cuts deeper than the one before it, without vibration. [m]
    vibration_amplitude : array_like, broadcast against `feed_per_edge`
        Amplitude of the vibration along the feed, up to 1e5 times the feed per edge; zero for none. [m]
    phase_per_edge : array_like, broadcast against them
        Phase of the vibration from one edge to the next at the same place of the work: 2 pi f/(z n) of z edges and n
        turns per second. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 up to the amplitude that is half of the feed per edge, at any phase.

    Raises
    ------
    InvalidInput
        If a feed is not positive, an amplitude negative or beyond its range, or a value not finite.

    Notes
    -----
    An edge cuts where it is deeper than every edge before it. The one j places before, at the phase
    :math:`j\varphi` behind and the depth :math:`j s` above, is the deeper one where

    .. math:: -2 a \sin\frac{j\varphi}{2} \cos\left( \theta - \frac{j\varphi}{2} \right) > j s ,

    an arc of the phase theta. The fraction is 1 less the union of these arcs over j < 2a/s; with opposite phases from
    edge to edge (phi an odd multiple of pi) it is :math:`1 - \arccos(s/2a)/\pi`, and with equal ones 1. The mean
    thickness of the chip is the feed at any amplitude, so that a force in proportion to it has the same mean.

    A stiff tool whose flank keeps clear of the cut: :math:`2\pi f a < v \tan\gamma` at the cutting speed v and the
    clearance angle gamma. Otherwise, as for most ultrasonic drills, the flank presses on the work and this law does
    not hold. Edges are taken to follow one another in the same track.

    See Also
    --------
    tool_contact_fraction : A tool that vibrates along the cutting direction.

    Examples
    --------
    A feed of 20 um per edge, opposite phases:

    >>> import numpy as np
    >>> from sonolube.models.friction import feed_contact_fraction
    >>> edges = {"feed_per_edge": 20e-6, "phase_per_edge": np.pi}
    >>> feed_contact_fraction(vibration_amplitude=[5e-6, 10e-6, 20e-6], **edges).round(3).tolist()
    [1.0, 1.0, 0.667]
    """
    feed = require_positive(feed_per_edge=feed_per_edge)
    amplitude = require_non_negative(vibration_amplitude=vibration_amplitude)
    relative, phase = np.broadcast_arrays(amplitude / feed, require_finite(phase_per_edge=phase_per_edge))
    if (relative > _MOST_FEEDS).any():
        raise InvalidInput(
            f"vibration_amplitude must be at most {_MOST_FEEDS:g} times feed_per_edge, got {float(relative.max()):g}",
            key="vibration_amplitude",
        )
    kept = [_kept(float(a), float(phi)) for a, phi in zip(relative.flat, phase.flat, strict=True)]
    return np.array(kept).reshape(relative.shape)


def _kept(amplitude: float, phase: float) -> float:
    """Fraction of the phase outside the arcs in which an earlier edge has cut deeper; amplitude in feeds per edge."""
    edges = np.arange(1, int(2 * amplitude) + 1)
    chord = 2 * amplitude * np.sin(edges * phase / 2)
    is_deeper = np.abs(chord) > edges
    edges, chord = edges[is_deeper], chord[is_deeper]
    half = np.arccos(edges / np.abs(chord))
    start = (edges * phase / 2 + np.pi * (chord > 0) - half) % (2 * np.pi)
    begins, ends = np.concatenate([start - 2 * np.pi, start]), np.concatenate([start - 2 * np.pi, start])
    ends = ends + 2 * np.concatenate([half, half])
    order = np.argsort(begins)
    begins, ends = begins[order], ends[order]
    reached = np.maximum.accumulate(np.concatenate([[0.0], ends[:-1]])) if ends.size else ends
    covered = np.minimum(ends, 2 * np.pi) - np.maximum(begins, reached)
    return float(1 - np.sum(np.maximum(covered, 0.0)) / (2 * np.pi))
