"""Lubricated friction: the Stribeck curve, and what vibration and a boundary lubricant do alone and together."""

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput

_FILMS_BEGIN_TO_CARRY = 0.1  # share of the load on films where boundary lubrication ends


class Regime(StrEnum):
    """What carries the load of a lubricated contact."""

    BOUNDARY = "boundary"
    MIXED = "mixed"
    HYDRODYNAMIC = "hydrodynamic"


class Method(StrEnum):
    """How a contact is lubricated."""

    DRY = "dry"
    ULTRASONIC = "ultrasonic"
    LUBRICANT = "lubricant"
    COMBINED = "combined"


@dataclass(frozen=True, kw_only=True, slots=True)
class StribeckCurve:
    """Friction of a lubricated contact from boundary lubrication to a full film.

    Parameters
    ----------
    boundary_coefficient : float
        Coefficient of friction where asperities carry all the load. []
    transition_hersey_number : float
        Hersey number at which films carry all but 1/e of it. [m]
    film_slope : float
        Coefficient of friction of a full film per Hersey number. [1/m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the curve has no minimum.

    Notes
    -----
    mu = mu_b exp(-He/He_t) + c He: asperities give way to films, whose friction is viscous. Empirical.

    References
    ----------
    .. [1] R. Stribeck, Z. Ver. Dtsch. Ing. 46, 1341 (1902).
    .. [2] M. D. Hersey, J. Wash. Acad. Sci. 4, 542 (1914).
    """

    boundary_coefficient: float
    transition_hersey_number: float
    film_slope: float

    def __post_init__(self) -> None:
        require_positive(
            boundary_coefficient=self.boundary_coefficient,
            transition_hersey_number=self.transition_hersey_number,
            film_slope=self.film_slope,
        )
        if self.film_slope * self.transition_hersey_number >= self.boundary_coefficient:
            raise InvalidInput("film_slope times transition_hersey_number must lie below boundary_coefficient")

    @property
    def lowest_friction_at(self) -> float:
        """Hersey number of the lowest friction, where the film becomes full, in m."""
        ratio = self.boundary_coefficient / (self.film_slope * self.transition_hersey_number)
        return float(self.transition_hersey_number * np.log(ratio))


def hersey_number(*, dynamic_viscosity: ArrayLike, sliding_speed: ArrayLike, nominal_pressure: ArrayLike) -> Floats:
    """Return viscosity times speed over pressure. [m]

    Parameters
    ----------
    dynamic_viscosity : array_like
        Viscosity of the lubricant. [Pa s]
    sliding_speed : array_like, broadcast against `dynamic_viscosity`
        Speed of the sliding. [m/s]
    nominal_pressure : array_like, broadcast against them
        Load over nominal area. [Pa]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed is negative, another value not positive, or a value not finite.
    """
    eta = require_positive(dynamic_viscosity=dynamic_viscosity)
    return eta * require_non_negative(sliding_speed=sliding_speed) / require_positive(nominal_pressure=nominal_pressure)


def stribeck_coefficient(curve: StribeckCurve, *, hersey_number: ArrayLike) -> Floats:
    """Return the coefficient of friction on a Stribeck curve. []

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


def lubrication_regime(curve: StribeckCurve, *, hersey_number: ArrayLike) -> NDArray[np.str_]:
    """Return the regime, by the words of `Regime`.

    Parameters
    ----------
    curve : StribeckCurve
    hersey_number : array_like, any shape
        Viscosity times speed over pressure. [m]

    Returns
    -------
    ndarray of str, shape of `hersey_number`

    Raises
    ------
    InvalidInput
        If a number is negative or not finite.

    Notes
    -----
    Boundary until films carry a tenth of the load, hydrodynamic from the lowest friction on; a convention, for nothing
    marks the change.
    """
    he = require_non_negative(hersey_number=hersey_number)
    begins = -np.log1p(-_FILMS_BEGIN_TO_CARRY) * curve.transition_hersey_number
    below, full = he < begins, he >= curve.lowest_friction_at
    return np.where(full, str(Regime.HYDRODYNAMIC), np.where(below, str(Regime.BOUNDARY), str(Regime.MIXED)))


@dataclass(frozen=True, kw_only=True, slots=True)
class BoundaryLubricant:
    """A lubricant that shares the load with the asperities, more of which touch at a higher pressure.

    Parameters
    ----------
    film_coefficient : float
        Coefficient of friction where only the film carries. []
    full_asperity_pressure : float
        Nominal pressure at which the asperities carry all the load. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    The mechanism of D Fig. 4.28, made the simplest law it allows: a share in proportion to the pressure.

    References
    ----------
    .. [1] D 4.2.4.
    """

    film_coefficient: float
    full_asperity_pressure: float

    def __post_init__(self) -> None:
        require_positive(film_coefficient=self.film_coefficient, full_asperity_pressure=self.full_asperity_pressure)


class MethodCoefficients(NamedTuple):
    """Coefficients of friction of four ways of lubrication.

    Parameters
    ----------
    dry, ultrasonic, lubricant, combined : ndarray
        Without anything, with vibration, with a lubricant, with both.
    """

    dry: Floats
    ultrasonic: Floats
    lubricant: Floats
    combined: Floats


def asperity_load_fraction(lubricant: BoundaryLubricant, *, nominal_pressure: ArrayLike) -> Floats:
    """Return the share of the load that asperities carry through a lubricant. []

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
    """
    return np.minimum(require_positive(nominal_pressure=nominal_pressure) / lubricant.full_asperity_pressure, 1.0)


def method_coefficients(
    lubricant: BoundaryLubricant,
    *,
    friction_coefficient: ArrayLike,
    friction_ratio: ArrayLike,
    nominal_pressure: ArrayLike,
) -> MethodCoefficients:
    """Return the friction of each way of lubrication.

    Parameters
    ----------
    lubricant : BoundaryLubricant
    friction_coefficient : array_like
        Coefficient of dry friction. []
    friction_ratio : array_like, broadcast against `friction_coefficient`
        What vibration leaves of dry friction, by any closure. []
    nominal_pressure : array_like, broadcast against them
        Load over nominal area. [Pa]

    Returns
    -------
    MethodCoefficients

    Raises
    ------
    InvalidInput
        If a ratio is negative, another value not positive, or a value not finite.

    Notes
    -----
    Vibration acts on the asperities alone, so that both together leave alpha R mu + (1 - alpha) mu_f. From this
    follows, whatever the closure, that vibration alone is best where R mu < mu_f, at every pressure.
    """
    mu = require_positive(friction_coefficient=friction_coefficient)
    ratio = require_non_negative(friction_ratio=friction_ratio)
    share = asperity_load_fraction(lubricant, nominal_pressure=nominal_pressure)
    film = (1 - share) * lubricant.film_coefficient
    dry, ultrasonic, alone, both = np.broadcast_arrays(mu, ratio * mu, share * mu + film, share * ratio * mu + film)
    return MethodCoefficients(dry, ultrasonic, alone, both)


def best_method(coefficients: MethodCoefficients, *, smallest_gain: float = 0.0) -> NDArray[np.str_]:
    """Return the way of lubrication to choose, by the words of `Method`.

    Parameters
    ----------
    coefficients : MethodCoefficients
    smallest_gain : float
        Share by which vibration must lower the friction of a lubricated contact to be worth its power.

    Returns
    -------
    ndarray of str

    Raises
    ------
    InvalidInput
        If the gain does not lie between 0 and 1.
    """
    worth = 1 - float(require_within(0.0, 1.0, smallest_gain=smallest_gain))
    dry, ultrasonic, lubricant, combined = coefficients
    still = np.where(dry <= lubricant, str(Method.DRY), str(Method.LUBRICANT))
    wet = np.where(combined < worth * np.minimum(dry, lubricant), str(Method.COMBINED), still)
    alone = (ultrasonic <= combined) & (
        ultrasonic < np.minimum(dry, lubricant)
    )  # of equals, the one without a lubricant
    return np.where(alone, str(Method.ULTRASONIC), wet)
