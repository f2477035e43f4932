"""Sums over all asperities: the law of one, weighed with the distribution of heights.

Each sum is one integral over the interference, taken by Gauss-Legendre quadrature on panels that follow the joints of
the asperity law, however small the critical interference. Under an exponential height law every sum is the one at
zero separation times exp(-lambda h); under any other it is tabulated once, as a spline of its logarithm.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from sonolube.checks import Floats
from sonolube.contact.asperity import AsperityLaw, asperity_area, asperity_force, critical_interference
from sonolube.contact.height_distribution import ExponentialHeights, HeightDistribution
from sonolube.contact.pair import ContactPair
from sonolube.surfaces import Roughness

# In units of the spread of the heights: how deep the quadrature reaches, and what the tables cover and how finely.
DEEPEST_INTERFERENCE = 48
TABLE_RANGE = (-6.0, 36.0)
TABLE_STEP = 0.05

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class SumCurve(Protocol):
    """A positive quantity as a function of the normalized separation."""

    def value(self, h: Floats) -> Floats:
        """Return the quantity at these separations."""

    def decay(self, h: Floats) -> Floats:
        """Return by what share the quantity falls per normalized separation."""

    def inverse(self, value: Floats) -> Floats:
        """Return the separations at which the quantity has these values; for falling quantities only."""


@dataclass(frozen=True, slots=True)
class ExponentialCurve:
    """A quantity that falls exponentially."""

    log_at_zero: float
    rate: float

    def value(self, h: Floats) -> Floats:
        """Return the quantity at these separations."""
        return np.exp(self.log_at_zero - self.rate * h)

    def decay(self, h: Floats) -> Floats:
        """Return by what share the quantity falls per normalized separation."""
        return np.full_like(h, self.rate)

    def inverse(self, value: Floats) -> Floats:
        """Return the separations at which the quantity has these values."""
        return (self.log_at_zero - np.log(value)) / self.rate


class SplineCurve:
    """A quantity whose logarithm is a spline of the seventh degree through a table."""

    def __init__(self, h: Floats, log_values: Floats) -> None:
        self._h, self._log_values = h, log_values
        self._log = PPoly.from_spline(make_interp_spline(h, log_values, k=7))
        self._slope = self._log.derivative()

    def value(self, h: Floats) -> Floats:
        """Return the quantity at these separations."""
        log_value: Floats = self._log(h)
        return np.exp(log_value)

    def decay(self, h: Floats) -> Floats:
        """Return by what share the quantity falls per normalized separation."""
        slope: Floats = self._slope(h)
        return -slope

    def inverse(self, value: Floats) -> Floats:
        """Return the separations at which the quantity has these values, by Newton's method from the table."""
        wanted = np.log(value)
        h: Floats = np.interp(-wanted, -self._log_values, self._h)
        for _ in range(2):
            h -= (self._log(h) - wanted) / self._slope(h)
        return h


@dataclass(frozen=True, kw_only=True, slots=True)
class AsperitySums:
    """What all asperities carry together, as functions of the separation in units of Rq.

    `lowest` and `highest` bound the separations for which the curves hold.
    """

    lowest: float
    highest: float
    force: SumCurve
    area: SumCurve
    count: SumCurve
    elastic_load_fraction: SumCurve
    elastic_area_fraction: SumCurve


def asperity_sums(
    *,
    roughness: Roughness,
    pair: ContactPair,
    nominal_area: float,
    heights: HeightDistribution,
    asperity: AsperityLaw,
) -> AsperitySums:
    """Return the sums over all asperities of a rough contact.

    Parameters
    ----------
    roughness : Roughness
    pair : ContactPair
    nominal_area : float
        Area over which the summits are scattered. [m2]
    heights : HeightDistribution
    asperity : AsperityLaw

    Returns
    -------
    AsperitySums
    """
    Rq, Rs = roughness.rms_height, roughness.summit_radius
    w_c = critical_interference(asperity, pair, summit_radius=Rs) / Rq
    w, weights = _quadrature([joint * w_c for joint in asperity.joints], spread=heights.spread)
    force = asperity_force(asperity, pair, summit_radius=Rs, interference=w * Rq)
    area = asperity_area(asperity, pair, summit_radius=Rs, interference=w * Rq)
    summits = roughness.summit_density * nominal_area * weights
    elastic, plastic = w < w_c, w >= w_c
    integrands = [force * elastic, force * plastic, area * elastic, area * plastic, np.ones_like(w)]
    per_height = summits[:, None] * np.stack(integrands, axis=1)

    if isinstance(heights, ExponentialHeights):
        logs = _log_sums(heights, np.zeros(1), w, per_height)[0]
        rates = heights.decay * np.array([1, 1, 1, 0, 0])
        curves: list[SumCurve] = [ExponentialCurve(*line) for line in zip(logs.tolist(), rates.tolist(), strict=True)]
        # at most exp(600) times the sums at zero separation: far beyond any meaning, and short of overflow
        lowest, highest = -600 / heights.decay, math.inf
    else:
        h = heights.spread * np.arange(TABLE_RANGE[0], TABLE_RANGE[1] + TABLE_STEP / 2, TABLE_STEP)
        curves = [SplineCurve(h, column) for column in _log_sums(heights, h, w, per_height).T]
        lowest, highest = float(h[0]), float(h[-1])
    total_force, total_area, count, load_fraction, area_fraction = curves
    return AsperitySums(
        lowest=lowest,
        highest=highest,
        force=total_force,
        area=total_area,
        count=count,
        elastic_load_fraction=load_fraction,
        elastic_area_fraction=area_fraction,
    )


def _log_sums(heights: HeightDistribution, h: Floats, w: Floats, per_height: Floats) -> Floats:
    """Logarithms of force, area, count and of the elastic shares of force and area; one row per separation."""
    # relative to the density at the separation itself, which underflows far out
    log_at_h = heights.log_density(h)
    density = np.exp(heights.log_density(h[:, None] + w) - log_at_h[:, None])
    elastic_force, plastic_force, elastic_area, plastic_area, count = (density @ per_height).T
    force, area = elastic_force + plastic_force, elastic_area + plastic_area
    logs: Floats = np.log(np.stack([force, area, count, elastic_force / force, elastic_area / area], axis=1))
    logs[:, :3] += log_at_h[:, None]
    return logs


def _quadrature(joints: Iterable[float], *, spread: float) -> tuple[Floats, Floats]:
    """Interferences and their weights, in units of Rq, on panels that end at each joint."""
    deepest = DEEPEST_INTERFERENCE * spread
    inside = [joint for joint in joints if joint < deepest]
    finest = min([spread / 1024, *inside])
    # The laws are sums of powers, smooth on panels whose ends differ by a factor of up to four.
    graded = np.geomspace(finest, spread, 1 + math.ceil(math.log(spread / finest, 4)))
    edges = np.unique([0.0, *inside, *graded, *(spread * np.arange(2, DEEPEST_INTERFERENCE + 1))])
    # In the square root of the interference Hertz's law is a polynomial, down to zero.
    roots = np.sqrt(edges)
    middle, half = (roots[1:] + roots[:-1]) / 2, (roots[1:] - roots[:-1]) / 2
    u = middle[:, None] + half[:, None] * _NODES
    return np.square(u).ravel(), (2 * u * half[:, None] * _WEIGHTS).ravel()
