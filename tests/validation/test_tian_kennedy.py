"""Flash temperatures of Tian and Kennedy, J. Tribol. 116, 167 (1994), against moving points of heat summed here.

A point of Q that moves along x makes Q/(2 pi k r) exp(-Pe (r + x)), lengths in radii; the constants are c and Pe_0 of
c/sqrt(pi (Pe_0 + Pe)), times flux and radius over conductivity.
"""

from collections.abc import Callable

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from sonolube.checks import Floats
from sonolube.models.thermal import (
    EllipticSource,
    HertzianSource,
    ThermalSolid,
    flash_rise,
    high_peclet_rise,
    low_peclet_rise,
)

UNIT = ThermalSolid(thermal_conductivity=1.0, density=1.0, specific_heat_capacity=1.0)
CIRCLE = EllipticSource(half_length=1.0, half_width=1.0)
HERTZ = HertzianSource(half_length=1.0, half_width=1.0)
Flux = Callable[[Floats], Floats]
PECLET = [0.0, 0.1, 1.0, 5.0, 30.0]


def even(square: Floats) -> Floats:
    return np.ones_like(square)


def of_hertz(square: Floats) -> Floats:
    return 1.5 * np.sqrt(1 - square)


def summed(x: float, y: float, peclet: float, flux: Flux) -> float:
    """Return the rise at a point of the unit circle, its points summed in polar coordinates about that point."""
    nodes, weights = np.polynomial.legendre.leggauss(160)
    angle, per_angle = np.pi * nodes**3, 3 * np.pi * nodes**2 * weights  # dense where the wake lies
    along, across = np.cos(angle), np.sin(angle)
    inward = x * along + y * across
    edge = np.sqrt(np.maximum(1 - x * x - y * y + inward**2, 0.0)) - inward
    nodes, weights = np.polynomial.legendre.leggauss(40)
    share = (1 - nodes) / 2
    r = edge[:, np.newaxis] * (1 - share**2)  # dense at the edge, where the flux of Hertz has a root
    square = (x + r * along[:, np.newaxis]) ** 2 + (y + r * across[:, np.newaxis]) ** 2
    heat = flux(np.clip(square, 0, 1)) * np.exp(-peclet * r * (1 - along[:, np.newaxis]))
    return float(per_angle @ (heat @ (share * weights) * edge)) / (2 * np.pi)


def brute(peclet: float, flux: Flux) -> tuple[float, float]:
    """Return peak and mean over the circle."""
    peak = max(summed(x, 0.0, peclet, flux) for x in np.linspace(-0.98, 0.3, 33))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = np.sqrt(1 - nodes**2)
    rows = [
        h * w * sum(v * summed(h * x, y, peclet, flux) for x, v in zip(nodes, weights, strict=True))
        for y, h, w in zip(nodes, half, weights, strict=True)
    ]
    return peak, sum(rows) / np.pi


@pytest.mark.parametrize("peclet", PECLET)
@pytest.mark.parametrize(("source", "flux", "off"), [(CIRCLE, even, (0.025, 0.04)), (HERTZ, of_hertz, (0.015, 0.05))])
def test_the_interpolation_stays_near_the_sum_of_moving_points(
    peclet: float, source: EllipticSource | HertzianSource, flux: Flux, off: tuple[float, float]
) -> None:
    peak, mean = brute(peclet, flux)
    rise = flash_rise(UNIT, source, heat_flux=1.0, sliding_speed=2 * peclet)
    assert rise.peak_temperature_rise == approx(peak, rel=off[0])
    assert rise.mean_temperature_rise == approx(mean, rel=off[1])


@pytest.mark.parametrize("peclet", [0.0, 0.1, 1.0, 10.0, 1000.0])
def test_the_peak_of_the_parabolic_source_has_their_constants(peclet: float) -> None:
    rise = flash_rise(UNIT, HERTZ, heat_flux=1.0, sliding_speed=2 * peclet)
    assert rise.peak_temperature_rise == approx(2.32 / np.sqrt(np.pi * (1.234 + peclet)), rel=1e-3)


def test_a_fast_parabolic_source_is_hottest_where_half_spaces_say() -> None:
    # along a chord of half length one, heat that entered t ago adds q/(k sqrt(pi kappa t)) to its point
    def behind(s: float) -> float:
        return float(quad(lambda w: 3 * np.sqrt(max(1 - (s - w * w) ** 2, 0.0)), 0, np.sqrt(s + 1))[0] / np.sqrt(2))

    peak = -minimize_scalar(lambda s: -behind(s), bounds=(0, 1), method="bounded", options={"xatol": 1e-9}).fun
    half_chord = np.sqrt(1 - np.linspace(-1, 1, 200_001) ** 2)
    middle = np.polynomial.legendre.leggauss(60)
    mean_of_chord = sum(w * behind(s) for s, w in zip(*middle, strict=True)) / 2
    mean = mean_of_chord * np.mean(half_chord**2.5) / np.mean(half_chord)  # flux and root of the length, by the length
    rise = high_peclet_rise(UNIT, HERTZ, heat_flux=1.0, sliding_speed=2.0)  # Pe = 1
    assert rise.peak_temperature_rise == approx(peak / np.sqrt(np.pi), rel=1e-8)
    assert rise.mean_temperature_rise == approx(mean / np.sqrt(np.pi), rel=1e-4)


@pytest.mark.parametrize("aspect", [0.25, 1.0, 3.0])
def test_a_resting_hertzian_ellipse_is_the_sum_over_its_points(aspect: float) -> None:
    source = HertzianSource(half_length=1.0, half_width=aspect)
    angles = (np.arange(2000) + 0.5) * 2 * np.pi / 2000
    rim = aspect / np.hypot(aspect * np.cos(angles), np.sin(angles))
    rise = low_peclet_rise(UNIT, source, heat_flux=1.0)
    # each ray from the centre adds the quarter ellipse of flux over it
    assert rise.peak_temperature_rise == approx(3 / 2 * np.pi / 4 * rim.mean(), rel=1e-6)
    assert rise.mean_temperature_rise == approx(3 / 4 * float(rise.peak_temperature_rise))
