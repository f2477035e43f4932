"""Resonance frequencies of a structure pressed against a contact of given stiffness, and the stiffness from one."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.dynamics.linear import modes, poles
from sonolube.models.dynamics.structure import Structure, with_contact_spring

_OSCILLATING = 1e-9  # imaginary part of a pole over its modulus, above rounding
_WIDENING, _MAX_WIDENINGS = 1.5, 20  # of the bracket of a stiffness
_RELATIVE_ERROR = 1e-12


def contact_resonances(structure: Structure, *, normal_stiffness: ArrayLike) -> Floats:
    r"""Resonance frequencies of a structure with a spring at its contact, by its poles. [Hz]

    Parameters
    ----------
    structure : Structure
        With its contact free.
    normal_stiffness : array_like, any shape
        Stiffness of the contact; zero leaves it free. [N/m]

    Returns
    -------
    ndarray, shape of `normal_stiffness` with (n,) appended
        In order of frequency; zero for a mode that does not oscillate: a rigid-body or overdamped one.

    Raises
    ------
    InvalidInput
        If a stiffness is negative.

    See Also
    --------
    stiffness_at_resonance : the inverse.
    sonolube.models.dynamics.modes : natural modes without damping.

    Notes
    -----
    The frequencies are :math:`|\lambda_i|/2\pi` of the complex pairs of roots of

    .. math:: \det\left[\lambda^2 M + \lambda C + K + k_n\,c c^T\right] = 0 ,

    those to which a resonance curve is fitted whatever the damping. Pairs are numbered from the highest frequency
    downwards, since at a soft contact the lowest modes do not oscillate.

    Examples
    --------
    >>> from sonolube.models.dynamics import contact_resonances
    >>> from sonolube.rig import read_rig
    >>> tribometer = read_rig("examples/rigs/tribometer.toml").structure
    >>> contact_resonances(tribometer, normal_stiffness=[0.0, 1.5e6]).round(0).tolist()  # free, and pressed
    [[0.0, 153.0, 21997.0], [100.0, 168.0, 22005.0]]
    """
    stiffness = require_non_negative(normal_stiffness=normal_stiffness)
    found = np.zeros((stiffness.size, structure.coordinates))
    for row, k in zip(found, stiffness.ravel(), strict=True):
        exponents = poles(with_contact_spring(structure, normal_stiffness=float(k)))
        upper = exponents[exponents.imag > _OSCILLATING * np.abs(exponents)]
        row[structure.coordinates - upper.size :] = np.sort(np.abs(upper)) / (2 * np.pi)
    return found.reshape(*stiffness.shape, structure.coordinates)


def stiffness_at_resonance(structure: Structure, *, mode: int, frequency: float) -> float:
    r"""Stiffness of the contact at which a mode of a structure pressed against it has a given frequency. [N/m]

    Parameters
    ----------
    structure : Structure
        With its contact free.
    mode : int
        Number of the mode in order of frequency, from 0, rigid-body modes included.
    frequency : float
        Resonance frequency in contact. [Hz]

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If there is no such mode, or the frequency is not positive.
    OutsideRange
        If the frequency is not above that of the free mode, or no stiffness raises the mode so far.

    See Also
    --------
    contact_resonances : the frequencies of a given stiffness.

    Notes
    -----
    Without damping :math:`k_n = -1/G(\omega)` with the receptance of the free contact

    .. math:: G(\omega) = \sum_i \frac{(c^T\phi_i)^2}{\omega_i^2 - \omega^2} ,

    which is where the search for the root of `contact_resonances` begins. To first order a mode of modal mass m at the
    contact and frequency :math:`f_0` moves by

    .. math:: f - f_0 = \frac{k_n}{8\pi^2 m f_0} .

    Examples
    --------
    >>> from sonolube.models.dynamics import contact_resonances, stiffness_at_resonance
    >>> from sonolube.rig import read_rig
    >>> tribometer = read_rig("examples/rigs/tribometer.toml").structure
    >>> pressed = contact_resonances(tribometer, normal_stiffness=1.5e6)
    >>> round(1e-6 * stiffness_at_resonance(tribometer, mode=1, frequency=float(pressed[1])), 3)
    1.5
    """
    target = float(require_positive(frequency=frequency))
    if not 0 <= mode < structure.coordinates:
        raise InvalidInput(f"mode must lie between 0 and {structure.coordinates - 1}, got {mode}")
    start = _undamped(structure, target)

    def above(log_stiffness: float) -> float:
        return float(contact_resonances(structure, normal_stiffness=np.exp(log_stiffness))[mode]) - target

    lower = upper = np.log(start)
    for _ in range(_MAX_WIDENINGS):
        if above(lower) < 0:
            break
        lower -= _WIDENING
    else:
        free = float(contact_resonances(structure, normal_stiffness=0.0)[mode])
        raise OutsideRange(
            f"frequency {target:.8g} Hz is not above the {free:.8g} Hz of mode {mode} without contact: a contact"
            " raises it; compare the same mode in both spectra"
        )
    for _ in range(_MAX_WIDENINGS):
        if above(upper) > 0:
            break
        upper += _WIDENING
    else:
        limit = float(contact_resonances(structure, normal_stiffness=np.exp(upper))[mode])
        raise OutsideRange(
            f"frequency {target:.8g} Hz is above the {limit:.8g} Hz that mode {mode} reaches on a rigid contact:"
            " take the next mode, or correct the structure"
        )
    from scipy.optimize import brentq

    return float(np.exp(brentq(above, lower, upper, xtol=_RELATIVE_ERROR, rtol=_RELATIVE_ERROR)))


def _undamped(structure: Structure, frequency: float) -> float:
    """Stiffness by the receptance without damping; that of inertia at the frequency where it has the wrong sign."""
    natural = modes(structure)
    participation = (structure.contact_vector @ natural.shapes) ** 2
    squares = (2 * np.pi * natural.natural_frequency) ** 2
    omega = (2 * np.pi * frequency) ** 2
    with np.errstate(divide="ignore"):
        stiffness = -1 / float(np.sum(participation / (squares - omega)))
    if np.isfinite(stiffness) and stiffness > 0:
        return stiffness
    moving = float(participation.sum())
    if moving == 0:
        raise InvalidInput("structure must have a mode that moves its contact")
    return omega / moving
