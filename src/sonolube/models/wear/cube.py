"""Wear rates by the cube model of Dong (2015), with and without normal vibration, and wear models by name."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.models.contact.contact_motion import ContactMotion, load_balanced_motion
from sonolube.models.contact.period_mean import (
    richardson_period_mean,
    sampled_separating_mean,
    separating_half_period_mean,
)
from sonolube.models.contact.rough import RoughContact, real_contact_area, separation
from sonolube.variants import VariantTable


def cube_wear_rate(contact: RoughContact, *, normal_load: ArrayLike) -> Floats:
    r"""Volume lost per sliding distance by the cube model of Dong (2015). [m2]

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
    .. math:: W = \frac{A_r\, d}{2 D}, \qquad D = \sqrt{A_n} \tag{D 3.26}

    Half the volume of the cube, the real contact area A_r times the separation d, is lost whenever the bodies slide by
    the length D of the nominal contact. D 3.27 prints 4 sqrt(A_n)/pi for that distance; the wear rates of D Table 3.4
    are those of sqrt(A_n).

    See Also
    --------
    vibrating_cube_wear_rate : The same under normal vibration.

    References
    ----------
    .. [1] D 3.26 and 3.27.
    """
    d = separation(contact, normal_load=normal_load)
    return _wear_rate(contact, require_positive(separation=d))


def vibrating_cube_wear_rate(
    contact: RoughContact, *, normal_load: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    r"""Volume lost per sliding distance by the cube model under a sinusoidal normal vibration. [m2]

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
        If no separation in the range of the height distribution carries a load.

    Notes
    -----
    .. math:: W' = \frac1\pi \int_0^\pi \frac{A_r(d')\, d'}{2 D}\, \mathrm{d}\theta, \qquad d' = d + a \sin\theta

    The average of `cube_wear_rate` over the half period in which the displacement is positive, as for the friction of
    the model. D 3.28 prints the average over the full period, which gives an increase of wear by vibration; the tables
    of D follow from this one.

    See Also
    --------
    half_period_wear_ratio : Ratio to the wear without vibration, for any motion of the gap.

    References
    ----------
    .. [1] D 3.28 and 3.29.
    """
    return separating_half_period_mean(
        lambda gap: _wear_rate(contact, gap),
        separation=separation(contact, normal_load=normal_load),
        vibration_amplitude=vibration_amplitude,
    )


def full_period_wear_ratio(contact: RoughContact, motion: ContactMotion) -> Floats:
    r"""Ratio of wear rates with and without vibration by the cube model over the full period. []

    Parameters
    ----------
    contact : RoughContact
    motion : ContactMotion
        Its vibration is taken about the gap at rest; the mean of the motion has no effect.

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the range of the height distribution.

    Notes
    -----
    .. math:: \frac{W'}{W} = \frac1T \int_0^T \frac{A_r(d + x)\, (d + x)}{A_r(d)\, d}\, \mathrm{d}t,
              \qquad \langle x \rangle = 0

    The ratio exceeds 1.

    See Also
    --------
    half_period_wear_ratio : Average over the separating half period, by which the tables of D were computed.
    load_balanced_wear_ratio : The same average about the mean gap at which the mean force equals the load.

    References
    ----------
    .. [1] D 3.28.
    """
    return _period_wear_ratio(contact, _about_rest(motion))


def half_period_wear_ratio(contact: RoughContact, motion: ContactMotion) -> Floats:
    r"""Ratio of wear rates with and without vibration by the cube model over the separating half period. []

    Parameters
    ----------
    contact : RoughContact
    motion : ContactMotion
        Its vibration is taken about the gap at rest; the mean of the motion has no effect.

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the range of the height distribution.

    Notes
    -----
    .. math:: \frac{W'}{W} = \frac2T \int_{x > 0} \frac{A_r(d + x)\, (d + x)}{A_r(d)\, d}\, \mathrm{d}t,
              \qquad \langle x \rangle = 0

    for a sine; of other motions the average over the time with x > 0. The tables of D follow from this average about
    the gap at rest. A dead load raises the mean gap of a vibration, for which the average over half a period, that of
    wider gaps, stands already; with both a computed motion would count the rise twice.

    See Also
    --------
    vibrating_cube_wear_rate : The wear rate under a sine about the separation at rest, whose ratio is this one.

    References
    ----------
    .. [1] D 3.15 for friction, and Table 3.4.
    """
    d, at_rest = _separation_and_rate(contact, motion)
    return richardson_period_mean(
        lambda sampled: sampled_separating_mean(
            lambda x: _wear_rate(contact, d + x) / at_rest, displacement=sampled.displacement
        ),
        _about_rest(motion),
    )


def load_balanced_wear_ratio(contact: RoughContact, motion: ContactMotion) -> Floats:
    r"""Ratio of wear rates with and without vibration by the cube model about the load-balanced mean gap. []

    Parameters
    ----------
    contact : RoughContact
    motion : ContactMotion
        The mean of the motion has no effect.

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the motion leaves the range of the height distribution.

    Notes
    -----
    The average of `full_period_wear_ratio` under `load_balanced_motion`. With exponential heights the area is
    proportional to the force, so that its mean remains that at rest; for a sine of amplitude a and the decay length l

    .. math:: \frac{W'}{W} = 1 + \frac1d \left[ l \ln I_0\!\left( \frac al \right)
              - a\, \frac{I_1(a/l)}{I_0(a/l)} \right]
    """
    return _period_wear_ratio(contact, load_balanced_motion(contact, motion))


def _about_rest(motion: ContactMotion) -> ContactMotion:
    """Motion without the shift of its mean gap; its forces, which wear does not take, stay as they are."""
    return replace(motion, displacement=motion.displacement - np.mean(motion.displacement))


def _period_wear_ratio(contact: RoughContact, motion: ContactMotion) -> Floats:
    """Mean wear rate over a motion as it is, over that at rest. []"""
    d, at_rest = _separation_and_rate(contact, motion)
    return richardson_period_mean(
        lambda sampled: np.asarray(np.mean(_wear_rate(contact, d + sampled.displacement) / at_rest)), motion
    )


def _separation_and_rate(contact: RoughContact, motion: ContactMotion) -> tuple[Floats, Floats]:
    """Separation [m] and the wear rate [m2] at rest."""
    d = separation(contact, normal_load=motion.normal_load)
    return d, _wear_rate(contact, require_positive(separation=d))


def _wear_rate(contact: RoughContact, d: Floats) -> Floats:
    """Half the volume of the cube over the length of the nominal contact. [m2]"""
    rate: Floats = real_contact_area(contact, separation=d) * d / (2 * np.sqrt(contact.nominal_area))  # D 3.26, 3.27
    return rate


WEAR_MODELS: VariantTable[Callable[[RoughContact, ContactMotion], Floats]] = VariantTable(
    "wear model",
    {
        "dong_2015_full_period": "sonolube.models.wear.cube:full_period_wear_ratio",
        "dong_2015_half_period": "sonolube.models.wear.cube:half_period_wear_ratio",
        "dong_2015_load_balanced": "sonolube.models.wear.cube:load_balanced_wear_ratio",
    },
)
"""Wear models by name; a new model takes its file and one line here."""

DEFAULT_WEAR_MODEL = "dong_2015_half_period"
"""Model by which the wear tables of the dissertation were computed."""
