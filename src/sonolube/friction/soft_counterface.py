"""Friction of a vibrating face on a soft layer: why a face whose rim moves against its centre slides on felt.

The face vibrates with amplitude a times a mode, 1 at the centre. Each patch of it presses a spring of the layer, and
drags it along. Four assumptions make that a friction ratio, and nothing else enters:

1. The layer is a bed of separate springs. `linear_layer_ratio` has springs of one stiffness; in
   `stiffening_layer_ratio` the pressure falls by a factor of e over a decay length, as that of fibres which touch one
   after the other.
2. The body behind the layer is soft as well, and goes along with a share of the face's mean motion. Against a mode that
   is zero on average it can do nothing.
3. The face is too heavy to follow its own vibration, so the mean force over a period is the load.
4. Layers are softer along the sliding than the way slid in a period: a patch then drags with the least friction
   that it could bear in the period, and with none if it parts from the layer.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import i0e

from sonolube.checks import Floats, require_non_negative, require_positive, require_within

_RINGS = np.polynomial.legendre.leggauss(64)


@dataclass(frozen=True, kw_only=True, slots=True)
class FaceMode:
    """How a circular face moves along its normal, and how far the body below goes along.

    Parameters
    ----------
    rim_displacement_ratio : float
        Displacement of the rim over that of the centre, from -1 to 1: -1 where it moves as far the other way, 1 where
        the face moves as a whole. []
    following : float
        Share of the mean motion of the face that the body behind the layer goes along with: 0 on a rigid body, 1 on one
        much softer than the layer. []

    Notes
    -----
    The displacement falls with the square of the radius, so that equal areas have equal shares of the way from the
    centre's to the rim's.
    """

    rim_displacement_ratio: float = -1.0
    following: float = 1.0

    def __post_init__(self) -> None:
        require_within(-1.0, 1.0, rim_displacement_ratio=self.rim_displacement_ratio)
        require_within(0.0, 1.0, following=self.following)


def stiffening_layer_ratio(mode: FaceMode, *, vibration_amplitude: ArrayLike, decay_length: ArrayLike) -> Floats:
    """Return friction with vibration over friction without, on a layer that stiffens as it is pressed. []

    Parameters
    ----------
    mode : FaceMode
    vibration_amplitude : array_like, any shape
        Amplitude at the centre of the face. [m]
    decay_length : array_like, broadcastable to `vibration_amplitude`
        Length over which the pressure of the layer falls by a factor of e. [m]

    Returns
    -------
    ndarray, the broadcast shape
        The same under every load. For a face that moves as a whole on a rigid body exp(-a/l)/I0(a/l).

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or a length not positive.
    """
    a, length = np.broadcast_arrays(
        require_non_negative(vibration_amplitude=vibration_amplitude), require_positive(decay_length=decay_length)
    )
    motion, area = _patches(mode)
    beta = np.multiply.outer(a / length, motion)
    most = beta.max(axis=-1, keepdims=True)  # keeps both sums from overflowing
    load = (i0e(beta) * np.exp(beta - most)) @ area
    return np.asarray((np.exp(-beta) @ area) * np.exp(-most[..., 0]) / load)


def linear_layer_ratio(mode: FaceMode, *, vibration_amplitude: ArrayLike, static_indentation: ArrayLike) -> Floats:
    """Return friction with vibration over friction without, on a layer of one stiffness. []

    Parameters
    ----------
    mode : FaceMode
    vibration_amplitude : array_like, any shape
        Amplitude at the centre of the face. [m]
    static_indentation : array_like, broadcastable to `vibration_amplitude`
        How far the load alone presses the face in: in proportion to the load. [m]

    Returns
    -------
    ndarray, the broadcast shape
        Falls in proportion to the amplitude until the first patch parts from the layer, then ever more slowly.

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or an indentation not positive.
    """
    a, rest = np.broadcast_arrays(
        require_non_negative(vibration_amplitude=vibration_amplitude),
        require_positive(static_indentation=static_indentation),
    )
    motion, area = _patches(mode)
    reach = np.multiply.outer(a / rest, motion)
    # mean indentation over that at rest; the mean force is convex in it and at least the load at 1: Newton falls to it
    mean = np.ones(a.shape)
    for _ in range(60):
        force, share = _pressed(mean[..., None], reach)
        mean = mean - (force @ area - 1) / (share @ area)
    return np.asarray(np.maximum(mean[..., None] - reach, 0.0) @ area)


def _patches(mode: FaceMode) -> tuple[Floats, Floats]:
    """Return amplitudes of patches against the body below, over that of the centre, and their shares of the area."""
    rim = mode.rim_displacement_ratio
    followed = mode.following * (1 + rim) / 2
    centre, rim = 1 - followed, rim - followed
    node, weight = _RINGS
    # amplitudes are spread evenly between rim and centre; split where they pass zero
    ends = [rim, 0.0, centre] if rim < 0 < centre else [rim, centre]
    amplitudes = [low + (high - low) * (1 + node) / 2 for low, high in pairwise(ends)]
    parts = np.diff(ends) / (centre - rim) if centre > rim else np.ones(1)
    return np.abs(np.concatenate(amplitudes)), np.concatenate([part * weight / 2 for part in parts])


def _pressed(mean: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Return the mean over a period of max(mean - reach cos, 0), and the share of it in which that is positive."""
    still = np.ones(np.broadcast_shapes(mean.shape, reach.shape))
    c = np.clip(np.divide(mean, reach, out=still, where=reach > 0), -1, 1)
    share = 1 - np.arccos(c) / np.pi
    return mean * share + reach * np.sqrt(1 - c**2) / np.pi, share
