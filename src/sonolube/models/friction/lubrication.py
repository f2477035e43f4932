"""Lubricated friction: the Stribeck curve, and friction with vibration, a boundary lubricant, and both combined."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput


class LubricationMethod(StrEnum):
    """Lubrication method of a contact: none, vibration, a lubricant, or both."""

    DRY = "dry"
    ULTRASONIC = "ultrasonic"
    LUBRICANT = "lubricant"
    COMBINED = "combined"


@dataclass(frozen=True, kw_only=True, slots=True)
class StribeckCurve:
    r"""Stribeck curve: coefficient of friction over the Hersey number, from boundary to hydrodynamic lubrication.

    Parameters
    ----------
    boundary_coefficient : float
        Coefficient of friction where asperities carry the whole load, mu_b. []
    transition_hersey_number : float
        Hersey number at which asperities carry 1/e of the load, He_t. [m]
    film_slope : float
        Coefficient of friction of a full film per Hersey number, c. [1/m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the curve has no minimum.

    Notes
    -----
    .. math:: \mu = \mu_b\, e^{-He/He_t} + c\, He

    Empirical: the load passes from the asperities to films with viscous friction.

    References
    ----------
    .. [1] R. Stribeck, Z. Ver. Dtsch. Ing. 46, 1341 (1902).
    .. [2] M. D. Hersey, J. Wash. Acad. Sci. 4, 542 (1914).
    """

    boundary_coefficient: float
    transition_hersey_number: float
    film_slope: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))
        if self.film_slope * self.transition_hersey_number >= self.boundary_coefficient:
            raise InvalidInput("film_slope times transition_hersey_number must be smaller than boundary_coefficient")


def hersey_number(*, dynamic_viscosity: ArrayLike, sliding_speed: ArrayLike, nominal_pressure: ArrayLike) -> Floats:
    r"""Hersey number: viscosity times speed over pressure. [m]

    Parameters
    ----------
    dynamic_viscosity : array_like
        Viscosity of the lubricant. [Pa s]
    sliding_speed : array_like, broadcast against `dynamic_viscosity`
        Sliding speed. [m/s]
    nominal_pressure : array_like, broadcast against them
        Load over nominal area. [Pa]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math:: He = \frac{\eta v}{p}

    Examples
    --------
    >>> from sonolube.models.friction import hersey_number
    >>> from sonolube.text.units import format_si
    >>> format_si(float(hersey_number(dynamic_viscosity=0.1, sliding_speed=0.02, nominal_pressure=1e6)), "m")
    '2 nm'
    """
    eta = require_positive(dynamic_viscosity=dynamic_viscosity)
    return eta * require_non_negative(sliding_speed=sliding_speed) / require_positive(nominal_pressure=nominal_pressure)


def stribeck_coefficient(curve: StribeckCurve, *, hersey_number: ArrayLike) -> Floats:
    """Coefficient of friction on a Stribeck curve. []

    Parameters
    ----------
    curve : StribeckCurve
    hersey_number : array_like, any shape
        Viscosity times speed over pressure. [m]

    Returns
    -------
    ndarray, shape of `hersey_number`

    Raises
    ------
    InvalidInput
        If a number is negative or not finite.
    """
    he = require_non_negative(hersey_number=hersey_number)
    asperities = curve.boundary_coefficient * np.exp(-he / curve.transition_hersey_number)
    return asperities + curve.film_slope * he


@dataclass(frozen=True, kw_only=True, slots=True)
class BoundaryLubricant:
    r"""Boundary lubricant that shares the load with asperities in proportion to the pressure.

    Parameters
    ----------
    film_coefficient : float
        Coefficient of friction of the lubricant film, mu_f. []
    full_asperity_pressure : float
        Nominal pressure at which the asperities carry the whole load, p_1. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    .. math:: \alpha = \min(p/p_1,\, 1), \qquad \mu = \alpha \mu_0 + (1 - \alpha)\, \mu_f

    with the dry coefficient mu_0: the mechanism of D Fig. 4.28 as its simplest law.

    References
    ----------
    .. [1] D 4.2.4.
    """

    film_coefficient: float
    full_asperity_pressure: float

    def __post_init__(self) -> None:
        require_positive(film_coefficient=self.film_coefficient, full_asperity_pressure=self.full_asperity_pressure)


class LubricationCoefficients(NamedTuple):
    """Coefficients of friction of the four lubrication methods.

    Parameters
    ----------
    dry, ultrasonic, lubricant, combined : ndarray
        Dry, with vibration, with a lubricant, with both.
    """

    dry: Floats
    ultrasonic: Floats
    lubricant: Floats
    combined: Floats


def asperity_load_fraction(lubricant: BoundaryLubricant, *, nominal_pressure: ArrayLike) -> Floats:
    r"""Fraction of the load on asperities that penetrate a lubricant film. []

    Parameters
    ----------
    lubricant : BoundaryLubricant
    nominal_pressure : array_like, any shape
        Load over nominal area. [Pa]

    Returns
    -------
    ndarray, shape of `nominal_pressure`

    Raises
    ------
    InvalidInput
        If a pressure is not positive and finite.

    Notes
    -----
    .. math:: \alpha = \min(p/p_1,\, 1)

    Examples
    --------
    >>> from sonolube.models.friction import BoundaryLubricant, asperity_load_fraction
    >>> lubricant = BoundaryLubricant(film_coefficient=0.05, full_asperity_pressure=10e6)
    >>> asperity_load_fraction(lubricant, nominal_pressure=[1e6, 5e6, 20e6]).tolist()
    [0.1, 0.5, 1.0]
    """
    return np.minimum(require_positive(nominal_pressure=nominal_pressure) / lubricant.full_asperity_pressure, 1.0)


def lubrication_coefficients(
    lubricant: BoundaryLubricant,
    *,
    friction_coefficient: ArrayLike,
    friction_ratio: ArrayLike,
    nominal_pressure: ArrayLike,
) -> LubricationCoefficients:
    r"""Coefficients of friction of the four lubrication methods.

    Parameters
    ----------
    lubricant : BoundaryLubricant
    friction_coefficient : array_like
        Coefficient of dry friction. []
    friction_ratio : array_like, broadcast against `friction_coefficient`
        Dry friction with vibration over that without, by any friction model. []
    nominal_pressure : array_like, broadcast against them
        Load over nominal area. [Pa]

    Returns
    -------
    LubricationCoefficients

    Raises
    ------
    InvalidInput
        If a ratio is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math::

        \mu_\text{lubricant} = \alpha \mu + (1 - \alpha)\, \mu_f, \qquad
        \mu_\text{combined} = \alpha R \mu + (1 - \alpha)\, \mu_f

    with the friction ratio R, since vibration acts on the asperities only. For any friction model vibration alone is
    therefore best where R mu < mu_f, at every pressure.

    See Also
    --------
    best_lubrication_method : The method with the lowest coefficient.
    """
    return shared_coefficients(
        friction_coefficient=friction_coefficient,
        friction_ratio=friction_ratio,
        asperity_load_fraction=asperity_load_fraction(lubricant, nominal_pressure=nominal_pressure),
        film_coefficient=lubricant.film_coefficient,
    )


def shared_coefficients(
    *,
    friction_coefficient: ArrayLike,
    friction_ratio: ArrayLike,
    asperity_load_fraction: ArrayLike,
    film_coefficient: ArrayLike,
) -> LubricationCoefficients:
    """Coefficients of friction of the four lubrication methods, by the share of the load on asperities.

    Parameters
    ----------
    friction_coefficient : array_like
        Coefficient of dry friction. []
    friction_ratio : array_like, broadcast against `friction_coefficient`
        Dry friction with vibration over that without. []
    asperity_load_fraction : array_like, broadcast against them
        Share of the load on asperities that penetrate the film. []
    film_coefficient : array_like, broadcast against them
        Coefficient of friction of the film. []

    Returns
    -------
    LubricationCoefficients

    Raises
    ------
    InvalidInput
        If the dry coefficient is not positive, or another value negative.

    See Also
    --------
    lubrication_coefficients : With the share by the pressure, and the equations.
    mixed_lubrication : Share and film by viscosity, speed, load and roughness.
    """
    mu = require_positive(friction_coefficient=friction_coefficient)
    ratio = require_non_negative(friction_ratio=friction_ratio)
    fraction = require_non_negative(asperity_load_fraction=asperity_load_fraction)
    film = (1 - fraction) * require_non_negative(film_coefficient=film_coefficient)
    coefficients = (mu, ratio * mu, fraction * mu + film, fraction * ratio * mu + film)
    return LubricationCoefficients(*np.broadcast_arrays(*coefficients))


def best_lubrication_method(coefficients: LubricationCoefficients, *, smallest_gain: float = 0.0) -> NDArray[np.str_]:
    """Lubrication method with the lowest friction, as values of `LubricationMethod`.

    Parameters
    ----------
    coefficients : LubricationCoefficients
    smallest_gain : float
        Smallest relative reduction of the friction of a lubricated contact that justifies vibration, from 0 to 1.

    Returns
    -------
    ndarray of str

    Raises
    ------
    InvalidInput
        If the gain does not lie between 0 and 1.

    Notes
    -----
    Of two equal methods the one without a lubricant is chosen.
    """
    threshold = 1 - float(require_within(0.0, 1.0, smallest_gain=smallest_gain))
    dry, ultrasonic, lubricant, combined = coefficients
    without_vibration = np.minimum(dry, lubricant)
    best = np.where(dry <= lubricant, str(LubricationMethod.DRY), str(LubricationMethod.LUBRICANT))
    best = np.where(combined < threshold * without_vibration, str(LubricationMethod.COMBINED), best)
    vibration_alone = (ultrasonic <= combined) & (ultrasonic < without_vibration)
    return np.where(vibration_alone, str(LubricationMethod.ULTRASONIC), best)
