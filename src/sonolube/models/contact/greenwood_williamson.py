r"""Greenwood-Williamson integrals: force, area and number of asperities in contact over a distribution of heights.

With the normalized separation h = d/R_q, the density phi of summit heights, and an asperity that carries the force f on
the area a at the interference w, the sums over all asperities are

.. math::

    F_n(h) &= \eta A_n \int_0^\infty f(w)\, \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q} \\
    A_r(h) &= \eta A_n \int_0^\infty a(w)\, \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q} \\
    n(h) &= \eta A_n \int_0^\infty \phi\!\left( h + \frac{w}{R_q} \right) \frac{\mathrm{d}w}{R_q}

They are computed by Gauss-Legendre quadrature on panels that end at the breakpoints of the asperity law, however small
the critical interference. Under exponential heights every integral is its value at zero separation times
exp(-lambda h); under other height distributions it is tabulated once, as a spline of its logarithm.

References
----------
.. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sonolube.checks import Floats
from sonolube.models.contact.asperity import AsperityLaw
from sonolube.models.contact.height_distribution import ExponentialHeights, HeightDistribution
from sonolube.models.contact.pair import ContactPair
from sonolube.models.contact.single_asperity import asperity_area, asperity_force, critical_interference
from sonolube.models.surfaces import Roughness

# In units of the standard deviation of the heights: upper limit of the quadrature, and range and step of the tables.
MAXIMUM_INTERFERENCE = 48
TABLE_RANGE = (-6.0, 36.0)
TABLE_STEP = 0.05

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class SeparationFunction(Protocol):
    """A positive quantity as a function of the normalized separation."""

    def value(self, h: Floats) -> Floats:
        """Quantity f at these separations."""

    def decay_rate(self, h: Floats) -> Floats:
        """Logarithmic decay rate -d ln f/dh at these separations."""

    def inverse(self, value: Floats) -> Floats:
        """Separations at which a monotonically falling quantity has these values."""


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


@dataclass(frozen=True, kw_only=True, slots=True)
class GreenwoodWilliamsonIntegrals:
    """Sums over all asperities of a rough contact, as functions of the separation over R_q.

    `lowest` and `highest` bound the separations over R_q for which the functions hold.
    """

    lowest: float
    highest: float
    force: SeparationFunction
    area: SeparationFunction
    count: SeparationFunction
    elastic_load_fraction: SeparationFunction
    elastic_area_fraction: SeparationFunction


def greenwood_williamson_integrals(
    *, roughness: Roughness, pair: ContactPair, nominal_area: float, heights: HeightDistribution, asperity: AsperityLaw
) -> GreenwoodWilliamsonIntegrals:
    """Force, area and number of all asperities of a rough contact as functions of the separation."""
    deviation = heights.standard_deviation
    w, per_height = _per_height(roughness, pair, nominal_area, heights, asperity)
    if isinstance(heights, ExponentialHeights):
        logs = _log_integrals(heights, np.zeros(1), w, per_height)[0]
        rates = heights.decay * np.array([1, 1, 1, 0, 0])
        functions: list[SeparationFunction] = [ExponentialDecay(*line) for line in np.stack([logs, rates], 1).tolist()]
        # at most exp(600) times the values at zero separation: far beyond any meaning, and short of overflow
        lowest, highest = -600 / heights.decay, math.inf
    else:
        h = deviation * np.arange(TABLE_RANGE[0], TABLE_RANGE[1] + TABLE_STEP / 2, TABLE_STEP)
        functions = [LogSpline(h, column) for column in _log_integrals(heights, h, w, per_height).T]
        lowest, highest = float(h[0]), float(h[-1])
    names = ("force", "area", "count", "elastic_load_fraction", "elastic_area_fraction")
    return GreenwoodWilliamsonIntegrals(lowest=lowest, highest=highest, **dict(zip(names, functions, strict=True)))


def log_normal_force_function(
    *, roughness: Roughness, pair: ContactPair, nominal_area: float, heights: HeightDistribution, asperity: AsperityLaw
) -> Callable[[Floats], Floats]:
    """Function for the logarithm of the force of all asperities at a few separations, without a table.

    Of separations over R_q, shape (n,): that of the table to 1e-10, for forces in N.
    """
    w, per_height = _per_height(roughness, pair, nominal_area, heights, asperity)
    return lambda h: _log_integrals(heights, h, w, per_height)[:, 0]


def _per_height(
    roughness: Roughness, pair: ContactPair, nominal_area: float, heights: HeightDistribution, asperity: AsperityLaw
) -> tuple[Floats, Floats]:
    """Interferences over R_q, and what summits at each add to the integrals per density of the heights.

    The columns are elastic and plastic force, elastic and plastic area, and number.
    """
    Rq, Rs = roughness.rms_height, roughness.summit_radius
    w_c = critical_interference(asperity, pair, summit_radius=Rs) / Rq
    deviation = heights.standard_deviation
    w, weights = _quadrature([each * w_c for each in asperity.breakpoints], standard_deviation=deviation)
    force = asperity_force(asperity, pair, summit_radius=Rs, interference=w * Rq)
    area = asperity_area(asperity, pair, summit_radius=Rs, interference=w * Rq)
    summits = roughness.summit_density * nominal_area * weights
    elastic, plastic = w < w_c, w >= w_c
    integrands = [force * elastic, force * plastic, area * elastic, area * plastic, np.ones_like(w)]
    return w, summits[:, None] * np.stack(integrands, axis=1)


def _log_integrals(heights: HeightDistribution, h: Floats, w: Floats, per_height: Floats) -> Floats:
    """Logarithms of force, area, count and elastic fractions of force and area, one row per separation."""
    # relative to the density at the separation itself, which underflows far out
    log_at_h = heights.log_density(h)
    density = np.exp(heights.log_density(h[:, None] + w) - log_at_h[:, None])
    elastic_force, plastic_force, elastic_area, plastic_area, count = (density @ per_height).T
    force, area = elastic_force + plastic_force, elastic_area + plastic_area
    logs: Floats = np.log(np.stack([force, area, count, elastic_force / force, elastic_area / area], axis=1))
    logs[:, :3] += log_at_h[:, None]
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
