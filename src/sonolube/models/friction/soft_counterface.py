r"""Friction of a vibrating circular face on a soft layer, such as felt, with a layer of independent springs.

The face vibrates along its normal with the amplitude a at its centre and the mode shape phi. Four assumptions determine
the friction ratio:

1. The layer is a bed of independent springs (a Winkler foundation). `linear_layer_ratio` has springs of constant
   stiffness; in `exponential_layer_ratio` the pressure falls by a factor of e over a decay length, as that of fibres
   that come into contact one after another.
2. The body behind the layer follows a fraction chi of the mean motion of the face, so that the layer is deformed by
   phi - chi <phi>, with the mean < > over the area. A mode of zero mean is not followed.
3. The face is too heavy to follow its own vibration, so that the mean force over a period is the load.
4. The layer is so compliant along the sliding direction that the sliding distance within a period is smaller than its
   tangential deflection: the friction of a patch is the smallest that its normal force admits within the period, and
   zero if the patch loses contact.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0

_QUADRATURE = np.polynomial.legendre.leggauss(64)  # over equal areas


@dataclass(frozen=True, kw_only=True, slots=True)
class FaceVibrationMode:
    """Normal mode shape of a circular face, and the fraction of its mean motion that the body behind the layer follows.

    Parameters
    ----------
    rim_displacement_ratio : float
        Displacement of the rim over that of the centre, from -1 to 1: -1 for equal displacements of opposite sign, 1
        for a uniform motion. []
    following_fraction : float
        Fraction chi of the mean motion of the face that the body behind the layer follows: 0 for a rigid body, 1 for
        one much softer than the layer. []

    Raises
    ------
    InvalidInput
        If a value is out of range.

    Notes
    -----
    The displacement varies with the square of the radius, so that it is uniformly distributed over the area.
    """

    rim_displacement_ratio: float = -1.0
    following_fraction: float = 1.0

    def __post_init__(self) -> None:
        require_within(-1.0, 1.0, rim_displacement_ratio=self.rim_displacement_ratio)
        require_within(0.0, 1.0, following_fraction=self.following_fraction)


def exponential_layer_ratio(
    mode: FaceVibrationMode, *, vibration_amplitude: ArrayLike, decay_length: ArrayLike
) -> Floats:
    r"""Friction ratio of a vibrating face on a layer with exponential pressure. []

    Parameters
    ----------
    mode : FaceVibrationMode
    vibration_amplitude : array_like, any shape
        Amplitude at the centre of the face. [m]
    decay_length : array_like, broadcast against `vibration_amplitude`
        Length over which the pressure of the layer falls by a factor of e, l. [m]

    Returns
    -------
    ndarray, the broadcast shape
        Independent of the load; exp(-a/l)/I0(a/l) for a uniform motion on a rigid body.

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or a length not positive.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac{\langle e^{-a |\varphi|/l} \rangle}{\langle I_0(a \varphi/l) \rangle},
              \qquad \varphi = \phi - \chi \langle \phi \rangle

    See Also
    --------
    linear_layer_ratio : A layer of constant stiffness.
    """
    a, length = np.broadcast_arrays(
        require_non_negative(vibration_amplitude=vibration_amplitude), require_positive(decay_length=decay_length)
    )
    motion, area = face_patches(mode)
    beta = np.multiply.outer(a / length, motion)
    largest = beta.max(axis=-1, keepdims=True)  # taken out of both sums against overflow
    load = (scaled_bessel_i0(beta) * np.exp(beta - largest)) @ area
    return np.asarray((np.exp(-beta) @ area) * np.exp(-largest[..., 0]) / load)


def linear_layer_ratio(
    mode: FaceVibrationMode, *, vibration_amplitude: ArrayLike, static_indentation: ArrayLike
) -> Floats:
    r"""Friction ratio of a vibrating face on a layer of constant stiffness. []

    Parameters
    ----------
    mode : FaceVibrationMode
    vibration_amplitude : array_like, any shape
        Amplitude at the centre of the face. [m]
    static_indentation : array_like, broadcast against `vibration_amplitude`
        Indentation under the load alone, delta_0, in proportion to the load. [m]

    Returns
    -------
    ndarray, the broadcast shape
        Falls in proportion to the amplitude until the first patch loses contact, then more slowly.

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or an indentation not positive.

    Notes
    -----
    Until the first patch loses contact

    .. math:: \frac{F_1}{F_0} = 1 - \frac{a}{\delta_0} \langle |\varphi| \rangle, \qquad
              \varphi = \phi - \chi \langle \phi \rangle

    Beyond that the mean indentation is found by Newton's method from the mean force.

    See Also
    --------
    exponential_layer_ratio : A layer that stiffens under pressure.
    """
    a, indentation = np.broadcast_arrays(
        require_non_negative(vibration_amplitude=vibration_amplitude),
        require_positive(static_indentation=static_indentation),
    )
    motion, area = face_patches(mode)
    amplitude = np.multiply.outer(a / indentation, motion)
    return np.asarray(np.maximum(balanced_indentation(amplitude, area)[..., None] - amplitude, 0.0) @ area)


def balanced_indentation(amplitude: Floats, area: Floats) -> Floats:
    """Mean indentation of a linear layer under a vibrating face over that at rest, at which the mean force is the load.

    Amplitudes of patches over the indentation at rest, shape (..., n), and their fractions of the area, shape (n,).
    """
    # the mean force is convex in the indentation and at least the load at 1, so that Newton's method converges
    # monotonically
    mean = np.ones(amplitude.shape[:-1])
    for _ in range(60):
        force, contact_fraction = mean_force(mean[..., None], amplitude)
        mean = mean - (force @ area - 1) / (contact_fraction @ area)
    return mean


def face_patches(mode: FaceVibrationMode) -> tuple[Floats, Floats]:
    """Relative amplitudes of patches over that of the centre, and their fractions of the area."""
    rim = mode.rim_displacement_ratio
    followed = mode.following_fraction * (1 + rim) / 2
    centre, rim = 1 - followed, rim - followed
    node, weight = _QUADRATURE
    # amplitudes are uniformly distributed between rim and centre; split at zero
    ends = [rim, 0.0, centre] if rim < 0 < centre else [rim, centre]
    amplitudes = [low + (high - low) * (1 + node) / 2 for low, high in pairwise(ends)]
    parts = np.diff(ends) / (centre - rim) if centre > rim else np.ones(1)
    return np.abs(np.concatenate(amplitudes)), np.concatenate([part * weight / 2 for part in parts])


def mean_force(mean: Floats, amplitude: Floats) -> tuple[Floats, Floats]:
    """Mean of max(mean - amplitude cos, 0) over a period, and the fraction of it with a positive value."""
    quotient = np.ones(np.broadcast_shapes(mean.shape, amplitude.shape))
    c = np.clip(np.divide(mean, amplitude, out=quotient, where=amplitude > 0), -1, 1)
    fraction = 1 - np.arccos(c) / np.pi
    return mean * fraction + amplitude * np.sqrt(1 - c**2) / np.pi, fraction
