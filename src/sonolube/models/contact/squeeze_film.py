"""Squeeze-film levitation: mean pressure and gap of a gas film between parallel faces of which one vibrates."""

import math

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange, warn_of_range

AIR_VISCOSITY = 1.82e-5
"""Dynamic viscosity of air at 20 degC. [Pa s]"""

STANDARD_ATMOSPHERE = 101325.0
"""Standard atmospheric pressure. [Pa]"""

MINIMUM_SQUEEZE_NUMBER = 100.0
"""Squeeze number below which leakage at the rim reduces the load by an eighth or more. []"""


def squeeze_number(
    *,
    face_radius: ArrayLike,
    film_thickness: ArrayLike,
    frequency: ArrayLike,
    viscosity: ArrayLike = AIR_VISCOSITY,
    ambient_pressure: ArrayLike = STANDARD_ATMOSPHERE,
) -> Floats:
    r"""Squeeze number of a gas film under a circular face. []

    Parameters
    ----------
    face_radius : array_like, any shape
        Radius of the face. [m]
    film_thickness : array_like, broadcastable to `face_radius`
        Mean thickness of the film. [m]
    frequency : array_like, broadcastable to `face_radius`
        Frequency of the vibration. [Hz]
    viscosity : array_like, broadcastable to `face_radius`
        Dynamic viscosity of the gas. [Pa s]
    ambient_pressure : array_like, broadcastable to `face_radius`
        Pressure around the face. [Pa]

    Returns
    -------
    ndarray, the broadcast shape
        High where leakage within a period is negligible.

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    .. math:: \sigma = \frac{12 \mu \omega R^2}{p_a h^2}

    Examples
    --------
    >>> from sonolube.models.contact import squeeze_number
    >>> air = {"viscosity": 1.8e-5, "ambient_pressure": 101e3}
    >>> round(float(squeeze_number(face_radius=5e-3, film_thickness=10e-6, frequency=20e3, **air)), 1)
    67.2
    """
    R, h = require_positive(face_radius=face_radius), require_positive(film_thickness=film_thickness)
    omega = 2 * math.pi * require_positive(frequency=frequency)
    mu, p_a = require_positive(viscosity=viscosity), require_positive(ambient_pressure=ambient_pressure)
    return np.asarray(12 * mu * omega * R**2 / (p_a * h**2))


def squeeze_film_pressure(
    *, vibration_amplitude: ArrayLike, film_thickness: ArrayLike, ambient_pressure: ArrayLike
) -> Floats:
    r"""Mean excess pressure of a gas film at high squeeze number. [Pa]

    Parameters
    ----------
    vibration_amplitude : array_like, any shape
        Amplitude of the vibration along the normal, uniform over the face. [m]
    film_thickness : array_like, broadcastable to `vibration_amplitude`
        Mean thickness of the film. [m]
    ambient_pressure : array_like, broadcastable to `vibration_amplitude`
        Pressure around the face. [Pa]

    Returns
    -------
    ndarray, the broadcast shape
        5/4 p_a (a/h)^2 for small amplitudes.

    Raises
    ------
    InvalidInput
        If a thickness or pressure is not positive, or an amplitude negative or as large as the thickness.

    Notes
    -----
    .. math:: \bar p - p_a = p_a \left[ \sqrt{\frac{1 + \frac32 (a/h)^2}{1 - (a/h)^2}} - 1 \right]

    Isothermal gas, smooth parallel faces much wider than the gap, and the limit of high squeeze number. In the interior
    p h is constant over the period; the condition at the rim, where p is the ambient pressure, makes its square the
    mean of h^3 over the mean of h.

    See Also
    --------
    levitation_gap : The gap at which this pressure carries a load.

    References
    ----------
    .. [1] E. O. J. Salbu, J. Basic Eng. 86, 355 (1964). doi:10.1115/1.3653080
    .. [2] W. E. Langlois, Q. Appl. Math. 20, 131 (1962).
    """
    a = require_non_negative(vibration_amplitude=vibration_amplitude)
    h = require_positive(film_thickness=film_thickness)
    if np.any(a >= h):
        raise InvalidInput("vibration_amplitude must be smaller than film_thickness, or the faces touch")
    excursion = np.square(a / h)
    p_a = require_positive(ambient_pressure=ambient_pressure)
    return np.asarray(p_a * (np.sqrt((1 + 1.5 * excursion) / (1 - excursion)) - 1))


def leakage_factor(*, squeeze_number: ArrayLike) -> Floats:
    r"""Mean excess pressure of a film that leaks at the rim of a circular face over that at high squeeze number. []

    Parameters
    ----------
    squeeze_number : array_like, any shape
        Of the film, sigma. []

    Returns
    -------
    ndarray, shape of `squeeze_number`
        From 0 for slow vibrations to 1, which it approaches as 1 - sqrt(2/sigma).

    Raises
    ------
    InvalidInput
        If a number is not positive and finite.

    Notes
    -----
    Reynolds's equation of an isothermal gas to the second order in the amplitude over the gap. With
    :math:`\kappa = \sqrt{\mathrm{i}\sigma}` and :math:`r = I_1(\kappa)/I_0(\kappa)`

    .. math::

        g = \frac45 \left[ \frac32 \left( 1 - \mathrm{Re} \frac{2 r}{\kappa} \right)
            - \frac14 \left( 1 - 2\, \mathrm{Re} \frac{2 r}{\kappa}
            + \frac{2}{\sigma}\, \mathrm{Im}\, \kappa r \right) \right]

    References
    ----------
    .. [1] W. E. Langlois, Q. Appl. Math. 20, 131 (1962), for the equation.
    """
    from scipy.special import ive

    sigma = require_positive(squeeze_number=squeeze_number)
    kappa = np.sqrt(1j * sigma)
    r = ive(1, kappa) / ive(0, kappa)
    mean, square = (2 * r / kappa).real, 2 * (kappa * r).imag / sigma
    # the sum cancels to sigma^2 for slow vibrations
    return np.asarray(np.maximum(0.8 * (1.5 * (1 - mean) - 0.25 * (1 - 2 * mean + square)), 0.0))


def levitation_amplitude(
    *, normal_load: ArrayLike, film_thickness: ArrayLike, face_radius: ArrayLike, ambient_pressure: ArrayLike
) -> Floats:
    r"""Amplitude at which a gas film of a thickness carries a load on a circular face. [m]

    Parameters
    ----------
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    film_thickness : array_like, broadcastable to `normal_load`
        Mean thickness of the film. [m]
    face_radius : array_like, broadcastable to `normal_load`
        Radius of the face. [m]
    ambient_pressure : array_like, broadcastable to `normal_load`
        Pressure around the face. [Pa]

    Returns
    -------
    ndarray, the broadcast shape
        Below the thickness for any load.

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    The inverse of `levitation_gap` in the limit of high squeeze number.
    """
    load, h = require_positive(normal_load=normal_load), require_positive(film_thickness=film_thickness)
    R, p_a = require_positive(face_radius=face_radius), require_positive(ambient_pressure=ambient_pressure)
    square = np.square(1 + load / (math.pi * R**2 * p_a))
    return np.asarray(h * np.sqrt((square - 1) / (1.5 + square)))


def levitation_gap(
    *,
    normal_load: ArrayLike,
    vibration_amplitude: ArrayLike,
    face_radius: ArrayLike,
    frequency: ArrayLike,
    viscosity: ArrayLike = AIR_VISCOSITY,
    ambient_pressure: ArrayLike = STANDARD_ATMOSPHERE,
) -> Floats:
    r"""Mean film thickness at which a gas film carries a load on a circular face. [m]

    Parameters
    ----------
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    vibration_amplitude : array_like, broadcastable to `normal_load`
        Amplitude of the vibration along the normal, uniform over the face. [m]
    face_radius : array_like, broadcastable to `normal_load`
        Radius of the face. [m]
    frequency : array_like, broadcastable to `normal_load`
        Frequency of the vibration. [Hz]
    viscosity : array_like, broadcastable to `normal_load`
        Dynamic viscosity of the gas. [Pa s]
    ambient_pressure : array_like, broadcastable to `normal_load`
        Pressure around the face. [Pa]

    Returns
    -------
    ndarray, the broadcast shape
        Above the amplitude for any load; the film exists only where it is thicker than the roughness.

    Raises
    ------
    InvalidInput
        If an argument is not positive.
    OutsideRange
        If the load is so low that the film would be thicker than a tenth of the radius of the face.

    Warns
    -----
    ModelRangeWarning
        Where the squeeze number is below `MINIMUM_SQUEEZE_NUMBER`: leakage at the rim reduces the load.

    Notes
    -----
    The inverse of `squeeze_film_pressure`: with :math:`s = 1 + F_N/(\pi R^2 p_a)`,

    .. math:: h = a \sqrt{\frac{\frac32 + s^2}{s^2 - 1}}

    References
    ----------
    .. [1] E. O. J. Salbu, J. Basic Eng. 86, 355 (1964). doi:10.1115/1.3653080
    """
    load, a = require_positive(normal_load=normal_load), require_positive(vibration_amplitude=vibration_amplitude)
    R, p_a = require_positive(face_radius=face_radius), require_positive(ambient_pressure=ambient_pressure)
    square = np.square(1 + load / (math.pi * R**2 * p_a))
    h = a * np.sqrt((1.5 + square) / (square - 1))
    if np.any(h > 0.1 * R):
        raise OutsideRange(f"normal_load {np.min(load):.3g} N is too low: a film thicker than a tenth of face_radius")
    sigma = squeeze_number(
        face_radius=R, film_thickness=h, frequency=frequency, viscosity=viscosity, ambient_pressure=p_a
    )
    if np.any(sigma < MINIMUM_SQUEEZE_NUMBER):
        warn_of_range(
            f"squeeze number {sigma.min():.3g} is below {MINIMUM_SQUEEZE_NUMBER:g}: gas leaks at the rim, and the film "
            "is thinner than computed"
        )
    return np.asarray(h)
