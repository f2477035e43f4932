"""Wear rates by Archard's law and by the cube model of Dong (2015), with and without normal vibration."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.contact.half_period_mean import separating_half_period_mean, separating_mean
from sonolube.contact.motion import GapMotion, converged_mean, load_balanced_motion
from sonolube.contact.rough import RoughContact, real_contact_area, separation
from sonolube.variants import VariantTable


@dataclass(frozen=True, kw_only=True, slots=True)
class ArchardWear:
    """Archard's law for one pair of materials.

    Parameters
    ----------
    wear_coefficient : float
        Share of contacts that shed a particle, K. []
    hardness : float
        Indentation hardness of the softer body. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    For steady wear in one regime: K changes by orders of magnitude where mild wear turns severe. [1]_

    References
    ----------
    .. [1] J. F. Archard, J. Appl. Phys. 24, 981 (1953). doi:10.1063/1.1721448
    """

    wear_coefficient: float
    hardness: float

    def __post_init__(self) -> None:
        require_positive(wear_coefficient=self.wear_coefficient, hardness=self.hardness)


def archard_wear_rate(law: ArchardWear, *, normal_load: ArrayLike) -> Floats:
    """Return the volume lost per sliding distance after Archard. [m2]

    Parameters
    ----------
    law : ArchardWear
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.

    References
    ----------
    .. [1] D 1.6.
    """
    load = require_non_negative(normal_load=normal_load)
    return law.wear_coefficient * load / law.hardness  # D 1.6


def cube_wear_rate(contact: RoughContact, *, normal_load: ArrayLike) -> Floats:
    """Return the volume lost per sliding distance in the cube model. [m2]

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is not positive, not finite, or so high that no separation remains.

    Notes
    -----
    Half the cube, A_r d, breaks off each time the bodies slide once along the nominal contact. D 3.27 prints
    4 sqrt(A_n)/pi for that distance; the wear rates of D Table 3.4 are those of sqrt(A_n).

    References
    ----------
    .. [1] D 3.26 and 3.27.
    """
    d = separation(contact, normal_load=normal_load)
    return _wear_rate(contact, require_positive(separation=d))


def vibrating_cube_wear_rate(
    contact: RoughContact, *, normal_load: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    """Return the volume lost per sliding distance in the cube model under normal vibration. [m2]

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    vibration_amplitude : array_like, broadcast against `normal_load`
        Amplitude of the vibration along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a load is not positive, or an amplitude negative.
    OutsideRange
        If no separation of the height law's range carries a load.

    Notes
    -----
    `cube_wear_rate` averaged over the half period in which the displacement is positive, as the friction of the model
    is. D 3.28 prints the mean over the whole period, by which vibration would raise the wear; its tables hold this one.

    References
    ----------
    .. [1] D 3.28 and 3.29.
    """
    return separating_half_period_mean(
        lambda gap: _wear_rate(contact, gap),
        separation=separation(contact, normal_load=normal_load),
        vibration_amplitude=vibration_amplitude,
    )


def full_period_wear_ratio(contact: RoughContact, motion: GapMotion) -> Floats:
    """Return the ratio of wear with and without vibration by the cube model averaged over the full period. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the height law's range.

    Notes
    -----
    About an unmoved mean the ratio exceeds 1: vibration would raise the wear.

    References
    ----------
    .. [1] D 3.28.
    """
    d, at_rest = _separation_and_rate(contact, motion)
    return converged_mean(
        lambda sampled: np.asarray(np.mean(_wear_rate(contact, d + sampled.displacement) / at_rest)), motion
    )


def half_period_wear_ratio(contact: RoughContact, motion: GapMotion) -> Floats:
    """Return the ratio of wear with and without vibration by the cube model over the separating half period. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the height law's range.

    Notes
    -----
    By this mean D computed its tables. `vibrating_cube_wear_rate` gives the same for a sine about an unmoved mean.

    References
    ----------
    .. [1] D 3.15 for friction, and Table 3.4.
    """
    d, at_rest = _separation_and_rate(contact, motion)
    return converged_mean(
        lambda sampled: separating_mean(
            lambda x: _wear_rate(contact, d + x) / at_rest, displacement=sampled.displacement
        ),
        motion,
    )


def load_balanced_wear_ratio(contact: RoughContact, motion: GapMotion) -> Floats:
    """Return the ratio of wear with and without vibration by the cube model about the load-balanced mean gap. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion
        Its own mean does not matter.

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the height law's range.

    Notes
    -----
    With the area in proportion to the force, its mean stays that at rest, and the ratio differs from 1 only by how
    much lower the cube is while it carries: 1 + [l ln I0(a/l) - a I1(a/l)/I0(a/l)]/d.
    """
    return full_period_wear_ratio(contact, load_balanced_motion(contact, motion))


WEAR_MODELS: VariantTable[Callable[[RoughContact, GapMotion], Floats]] = VariantTable(
    "wear model",
    {
        "dong_2015_full_period": "sonolube.wear.cube:full_period_wear_ratio",
        "dong_2015_half_period": "sonolube.wear.cube:half_period_wear_ratio",
        "dong_2015_load_balanced": "sonolube.wear.cube:load_balanced_wear_ratio",
    },
)
"""Models of the wear ratio under a given motion of the gap, by name; a new model takes its file and one line here."""

DEFAULT_WEAR_MODEL = "dong_2015_half_period"
"""Model by which the wear tables of the dissertation were computed."""


def specific_wear_rate(*, wear_rate: ArrayLike, normal_load: ArrayLike) -> Floats:
    """Return the volume lost per sliding distance and load. [m2/N]

    Parameters
    ----------
    wear_rate : array_like
        Volume lost per sliding distance. [m2]
    normal_load : array_like, broadcast against `wear_rate`
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a rate is negative, a load not positive, or a value not finite.
    """
    return require_non_negative(wear_rate=wear_rate) / require_positive(normal_load=normal_load)


def mass_loss(*, wear_volume: ArrayLike, density: ArrayLike) -> Floats:
    """Return the mass of a worn volume. [kg]

    Parameters
    ----------
    wear_volume : array_like
        Volume worn away. [m3]
    density : array_like, broadcast against `wear_volume`
        Mass density of the body that lost it. [kg/m3]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a volume is negative, a density not positive, or a value not finite.
    """
    return require_non_negative(wear_volume=wear_volume) * require_positive(density=density)


def vibration_contact_count(*, frequency: ArrayLike, duration: ArrayLike) -> Floats:
    """Return how often a vibration brings the surfaces together. []

    Parameters
    ----------
    frequency : array_like
        Frequency of the vibration. [Hz]
    duration : array_like, broadcast against `frequency`
        Time for which it lasts. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a frequency is not positive, a duration negative, or a value not finite.
    """
    return require_positive(frequency=frequency) * require_non_negative(duration=duration)


def _separation_and_rate(contact: RoughContact, motion: GapMotion) -> tuple[Floats, Floats]:
    d = separation(contact, normal_load=motion.normal_load)
    return d, _wear_rate(contact, require_positive(separation=d))


def _wear_rate(contact: RoughContact, d: Floats) -> Floats:
    rate: Floats = real_contact_area(contact, separation=d) * d / (2 * np.sqrt(contact.nominal_area))  # D 3.26, 3.27
    return rate
