"""Rough contact and its Greenwood-Williamson integrals: force, area and number of all asperities.

An asperity is Hertz's sphere times the ratios of an asperity law. The integrals are computed by Gauss-Legendre
quadrature on panels that end at the breakpoints of the law, however small the critical interference. Under exponential
heights every integral is its value at zero separation times exp(-lambda h); under other height distributions it is
tabulated once, as a spline of its logarithm.

References
----------
.. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.asperity import AsperityLaw, ChangEtsionBogy
from sonolube.models.contact.elastic_bodies import ContactPair
from sonolube.models.contact.height_distribution import ExponentialHeights, HeightDistribution
from sonolube.models.surfaces import Roughness


def critical_interference(law: AsperityLaw, pair: ContactPair, *, summit_radius: float) -> float:
    r"""Critical interference, at which an asperity begins to yield. [m]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]

    Returns
    -------
    float
        Infinite for a law without yielding.

    Raises
    ------
    InvalidInput
        If the radius is not positive.

    Notes
    -----
    .. math:: w_c = \left( \frac{\pi p_Y}{2 E^*} \right)^2 R_s \tag{D 3.1}

    with the pressure p_Y of `AsperityLaw.yield_pressure`.

    References
    ----------
    .. [1] D 3.1, which has p_Y = C_nu (1 - nu^2) Y_0.
    """
    require_positive(summit_radius=summit_radius)
    strain = math.pi * law.yield_pressure(pair) / (2 * pair.effective_modulus)
    return strain * strain * summit_radius


def asperity_force(law: AsperityLaw, pair: ContactPair, *, summit_radius: float, interference: ArrayLike) -> Floats:
    r"""Normal force on one asperity at an interference. [N]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]
    interference : array_like, any shape
        Overlap of the undeformed summit with the other surface. [m]

    Returns
    -------
    ndarray, shape of `interference`

    Raises
    ------
    InvalidInput
        If the radius is not positive, or an interference is negative or not finite.

    Notes
    -----
    .. math:: f = \tfrac43 E^* \sqrt{R_s}\, w^{3/2}\, r_f(w/w_c)

    See Also
    --------
    asperity_area : Contact area of the same asperity.
    """
    w = require_non_negative(interference=interference)
    ratio = w / critical_interference(law, pair, summit_radius=summit_radius)
    hertz = 4 / 3 * pair.effective_modulus * math.sqrt(summit_radius) * w**1.5
    return hertz * law.force_ratio(pair, ratio)


def asperity_area(law: AsperityLaw, pair: ContactPair, *, summit_radius: float, interference: ArrayLike) -> Floats:
    r"""Contact area of one asperity at an interference. [m2]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]
    interference : array_like, any shape
        Overlap of the undeformed summit with the other surface. [m]

    Returns
    -------
    ndarray, shape of `interference`

    Raises
    ------
    InvalidInput
        If the radius is not positive, or an interference is negative or not finite.

    Notes
    -----
    .. math:: a = \pi R_s w\, r_a(w/w_c)

    See Also
    --------
    asperity_force : Normal force on the same asperity.
    """
    w = require_non_negative(interference=interference)
    ratio = w / critical_interference(law, pair, summit_radius=summit_radius)
    return math.pi * summit_radius * w * law.area_ratio(pair, ratio)


# In units of the standard deviation of the heights: upper limit of the quadrature, and range and step of the tables.
MAXIMUM_INTERFERENCE = 48
TABLE_RANGE = (-6.0, 36.0)
TABLE_STEP = 0.05

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True, kw_only=True, slots=True)
class RoughContact:
    """Contact of two rough surfaces: roughness, materials, nominal area, height distribution and asperity law.

    Parameters
    ----------
    roughness : Roughness
        Combined roughness of both surfaces.
    pair : ContactPair
    nominal_area : float
        Area over which the bodies face each other. [m2]
    heights : HeightDistribution
        Exponential by default.
    asperity : AsperityLaw
        That of Chang, Etsion and Bogy by default.
    decay_length : float or None
        Length over which the normal force falls by a factor of e, where it is known otherwise than by the roughness,
        such as from the stiffness of a worn contact; for exponential heights only. R_q/lambda where None. [m]

    Raises
    ------
    InvalidInput
        If area or decay length is not positive and finite, or heights that are not exponential have a decay length.

    Notes
    -----
    The pair is replaced by one surface with the roughness of both against a smooth flat. Its asperities are spheres of
    one radius that do not interact, so the real area must stay far below the nominal one. Separations are measured from
    the mean of the summit heights. `contact_caveats` returns the reasons against applying the model to a contact.

    With a `decay_length` l the heights are those of a surface whose rms height is lambda l (`height_scale`): load,
    area and number of contacts fall by a factor of e over l. `roughness` stays what was measured, often before wear.

    See Also
    --------
    sonolube.models.contact.PerssonContact : Contact from the power spectrum, without asperities.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    .. [2] A. A. Polycarpou and I. Etsion, J. Tribol. 121, 234 (1999). doi:10.1115/1.2833926
    """

    roughness: Roughness
    pair: ContactPair
    nominal_area: float
    heights: HeightDistribution = field(default_factory=ExponentialHeights)
    asperity: AsperityLaw = field(default_factory=ChangEtsionBogy)
    decay_length: float | None = None

    def __post_init__(self) -> None:
        require_positive(nominal_area=self.nominal_area)
        if self.decay_length is not None:
            require_positive(decay_length=self.decay_length)
            if not isinstance(self.heights, ExponentialHeights):
                raise InvalidInput(
                    f"decay_length is for exponential heights, got {self.heights.name} heights, whose decay length"
                    " varies with the separation: leave it out or use exponential heights"
                )

    @property
    def height_scale(self) -> float:
        """Rms height of the height distribution: the measured one, or lambda l where the decay length is given. [m]"""
        if self.decay_length is None or not isinstance(self.heights, ExponentialHeights):
            return self.roughness.rms_height
        return self.heights.decay * self.decay_length


@dataclass(frozen=True, slots=True)
class ExponentialDecay:
    """A quantity that decays exponentially with the normalized separation."""

    log_at_zero: float
    rate: float

    def value(self, h: Floats) -> Floats:
        """Quantity f at these separations."""
        return np.exp(self.log_at_zero - self.rate * h)

    def decay_rate(self, h: Floats) -> Floats:
        """Logarithmic decay rate -d ln f/dh at these separations."""
        return np.full_like(h, self.rate)

    def inverse(self, value: Floats) -> Floats:
        """Separations at which the quantity has these values."""
        return (self.log_at_zero - np.log(value)) / self.rate


class LogSpline:
    """A quantity whose logarithm is interpolated by a spline of degree seven."""

    def __init__(self, h: Floats, log_values: Floats) -> None:
        from scipy.interpolate import PPoly, make_interp_spline

        self._h, self._log_values = h, log_values
        self._log = PPoly.from_spline(make_interp_spline(h, log_values, k=7))
        self._slope = self._log.derivative()

    def value(self, h: Floats) -> Floats:
        """Quantity f at these separations."""
        log_value: Floats = self._log(h)
        return np.exp(log_value)

    def decay_rate(self, h: Floats) -> Floats:
        """Logarithmic decay rate -d ln f/dh at these separations."""
        slope: Floats = self._slope(h)
        return -slope

    def inverse(self, value: Floats) -> Floats:
        """Separations at which the quantity has these values, by Newton's method from the table."""
        target = np.log(value)
        h: Floats = np.interp(-target, -self._log_values, self._h)
        for _ in range(2):
            h -= (self._log(h) - target) / self._slope(h)
        return h


SeparationFunction = ExponentialDecay | LogSpline
"""A positive quantity as a function of the normalized separation: its value, its rate of decay and its inverse."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GreenwoodWilliamsonIntegrals:
    r"""Sums over all asperities of a rough contact, as functions of the separation over R_q.

    `lowest` and `highest` bound the separations over R_q for which the functions hold.

    Notes
    -----
    With the normalized separation h = d/R_q, the density phi of summit heights, and an asperity that carries the force
    f on the area a at the interference w,

    .. math::

        F_n(h) &= \eta A_n \int_0^\infty f(w)\, \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q} \\
        A_r(h) &= \eta A_n \int_0^\infty a(w)\, \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q} \\
        n(h) &= \eta A_n \int_0^\infty \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q}
    """

    lowest: float
    highest: float
    force: SeparationFunction
    area: SeparationFunction
    count: SeparationFunction


@lru_cache(maxsize=512)
def greenwood_williamson_integrals(contact: RoughContact) -> GreenwoodWilliamsonIntegrals:
    """Force, area and number of all asperities of a rough contact as functions of the separation, computed once."""
    heights, (w, per_height) = contact.heights, _per_height(contact)
    if isinstance(heights, ExponentialHeights):
        logs = _log_integrals(heights, np.zeros(1), w, per_height)[0].tolist()
        functions: list[SeparationFunction] = [ExponentialDecay(log_at_zero, heights.decay) for log_at_zero in logs]
        # at most exp(600) times the values at zero separation: far beyond any meaning, and short of overflow
        lowest, highest = -600 / heights.decay, math.inf
    else:
        h = heights.standard_deviation * np.arange(TABLE_RANGE[0], TABLE_RANGE[1] + TABLE_STEP / 2, TABLE_STEP)
        functions = [LogSpline(h, column) for column in _log_integrals(heights, h, w, per_height).T]
        lowest, highest = float(h[0]), float(h[-1])
    force, area, count = functions
    return GreenwoodWilliamsonIntegrals(lowest=lowest, highest=highest, force=force, area=area, count=count)


def log_normal_force_function(contact: RoughContact) -> Callable[[Floats], Floats]:
    """Function for the logarithm of the force of all asperities at a few separations, without a table.

    Of separations over R_q, shape (n,): that of the table to 1e-10, for forces in N.
    """
    w, per_height = _per_height(contact)
    return lambda h: _log_integrals(contact.heights, h, w, per_height)[:, 0]


def _per_height(contact: RoughContact) -> tuple[Floats, Floats]:
    """Interferences over R_q, and what summits at each add to force, area and number per density of the heights."""
    asperity, pair, Rq, Rs = contact.asperity, contact.pair, contact.height_scale, contact.roughness.summit_radius
    w_c = critical_interference(asperity, pair, summit_radius=Rs) / Rq
    breakpoints = [each * w_c for each in asperity.breakpoints]
    w, weights = _quadrature(breakpoints, standard_deviation=contact.heights.standard_deviation)
    force = asperity_force(asperity, pair, summit_radius=Rs, interference=w * Rq)
    area = asperity_area(asperity, pair, summit_radius=Rs, interference=w * Rq)
    summits = contact.roughness.summit_density * contact.nominal_area * weights
    return w, summits[:, None] * np.stack([force, area, np.ones_like(w)], axis=1)


def _log_integrals(heights: HeightDistribution, h: Floats, w: Floats, per_height: Floats) -> Floats:
    """Logarithms of force, area and number, one row per separation."""
    # relative to the density at the separation itself, which underflows far out
    log_at_h = heights.log_density(h)
    density = np.exp(heights.log_density(h[:, None] + w) - log_at_h[:, None])
    logs: Floats = np.log(density @ per_height) + log_at_h[:, None]
    return logs


def _quadrature(breakpoints: Iterable[float], *, standard_deviation: float) -> tuple[Floats, Floats]:
    """Interferences over R_q and their weights, by Gauss-Legendre rules on panels between breakpoints."""
    limit = MAXIMUM_INTERFERENCE * standard_deviation
    inside = [each for each in breakpoints if each < limit]
    finest = min([standard_deviation / 1024, *inside])
    # The laws are sums of powers, smooth on panels whose ends differ by a factor of up to four.
    graded = np.geomspace(finest, standard_deviation, 1 + math.ceil(math.log(standard_deviation / finest, 4)))
    edges = np.unique([0.0, *inside, *graded, *(standard_deviation * np.arange(2, MAXIMUM_INTERFERENCE + 1))])
    # In the square root of the interference Hertz's law is a polynomial, down to zero.
    roots = np.sqrt(edges)
    middle, half = (roots[1:] + roots[:-1]) / 2, (roots[1:] - roots[:-1]) / 2
    u = middle[:, None] + half[:, None] * _NODES
    return np.square(u).ravel(), (2 * u * half[:, None] * _WEIGHTS).ravel()
