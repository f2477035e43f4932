"""Uniform moving circle and ellipse against closed limits, reductions of another kind and direct double integrals."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad
from scipy.special import ellipk, i0e
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.thermal import (
    FLASH_MODELS,
    EllipticSource,
    HertzianSource,
    ThermalSolid,
    contact_rise,
    flash_rise,
    high_peclet_rise,
    moving_ellipse_rise,
)
from sonolube.models.thermal.moving_ellipse import _rise_on_chord, mean_rise, peak_rise

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
DOT = EllipticSource(half_length=1e-4, half_width=1e-4)
FLUX = 1e6


def speed_at(peclet: float) -> float:
    return peclet * 2 * STEEL.thermal_diffusivity / DOT.half_length


def direct_rise(place: float, peclet: float, aspect: float) -> float:
    """Rise on the middle chord by integrating exp(-Pe (R + x - x'))/(2 pi R) over the ellipse, y' = |x - x'| sinh t."""

    def across(x: float) -> float:
        ahead = place - x
        farthest = np.arcsinh(aspect * np.sqrt(1 - x**2) / abs(ahead))
        return float(quad(lambda t: np.exp(-peclet * (abs(ahead) * np.cosh(t) + ahead)), 0, farthest, epsrel=1e-9)[0])

    behind, ahead = quad(across, -1, place, limit=200)[0], quad(across, place, 1, limit=200)[0]
    return float((behind + ahead) / np.pi)


@pytest.mark.parametrize("aspect", [0.1, 0.5, 1.0, 3.0, 10.0])
def test_at_rest_the_rise_is_that_of_the_elliptic_integral(aspect: float) -> None:
    short, long = sorted((1.0, aspect))
    centre = 2 / np.pi * ellipk(1 - (short / long) ** 2) * short
    assert peak_rise(peclet=0.0, aspect=aspect) == approx(centre, rel=1e-12)
    assert mean_rise(peclet=0.0, aspect=aspect) == approx(8 / (3 * np.pi) * centre, rel=1e-12)


@pytest.mark.parametrize("aspect", [0.3, 1.0, 4.0])
def test_a_fast_source_has_the_rise_of_a_half_space_heated_for_the_time_of_passage(aspect: float) -> None:
    source = EllipticSource(half_length=1e-4, half_width=aspect * 1e-4)
    fast = {"heat_flux": FLUX, "sliding_speed": speed_at(1e8)}
    exact, limit = moving_ellipse_rise(STEEL, source, **fast), high_peclet_rise(STEEL, source, **fast)
    assert exact.peak_temperature_rise == approx(limit.peak_temperature_rise, rel=1e-6)
    assert exact.mean_temperature_rise == approx(limit.mean_temperature_rise, rel=1e-6)


@pytest.mark.parametrize("peclet", [0.01, 0.3, 1.0, 5.0, 40.0, 1e3, 1e6])
def test_the_mean_over_a_circle_is_one_integral_with_a_bessel_function(peclet: float) -> None:
    # over all pairs of points at the distance d, whose directions integrate to 2 pi exp(-Pe d) I0(Pe d)
    def pairs(d: float) -> float:
        return float((2 * np.arccos(d / 2) - d / 2 * np.sqrt(4 - d**2)) * i0e(peclet * d))

    edges = np.unique([0.0, 2.0, *np.minimum(2.0, 10.0 ** np.arange(-8, 1))])
    integral = sum(quad(pairs, a, b, epsabs=0, epsrel=1e-11)[0] for a, b in pairwise(edges))
    assert mean_rise(peclet=peclet, aspect=1.0) == approx(integral / np.pi, rel=1e-9)


@pytest.mark.parametrize(("peclet", "aspect"), [(0.5, 1.0), (5.0, 1.0), (1.0, 0.3), (2.0, 3.0)])
def test_the_peak_is_the_highest_of_direct_double_integrals_on_the_middle_chord(peclet: float, aspect: float) -> None:
    places = np.linspace(-0.9, -0.05, 12)
    rises = np.array([direct_rise(place, peclet, aspect) for place in places])
    peak = peak_rise(peclet=peclet, aspect=aspect)
    best = min(max(int(np.argmax(rises)), 1), places.size - 2)
    near = np.polynomial.Polynomial.fit(places[best - 1 : best + 2], rises[best - 1 : best + 2], 2)
    assert rises.max() <= peak * (1 + 1e-8)
    assert peak == approx(near(near.deriv().roots()[0]), rel=2e-3)


@pytest.mark.parametrize(
    ("place", "peclet", "aspect"), [(-0.4, 0.5, 1.0), (-0.8, 5.0, 1.0), (0.3, 1.0, 0.3), (-0.6, 2.0, 3.0)]
)
def test_the_rise_on_the_chord_is_the_direct_double_integral(place: float, peclet: float, aspect: float) -> None:
    found = _rise_on_chord(np.array([place]), peclet=peclet, aspect=aspect)[0]
    assert found == approx(direct_rise(place, peclet, aspect), rel=1e-7)


@pytest.mark.parametrize(("peclet", "aspect"), [(1.0, 1.0), (3.0, 0.5)])
def test_the_mean_over_an_ellipse_is_that_of_the_rise_by_arbitrary_precision(peclet: float, aspect: float) -> None:
    # The mean over pairs of points a distance r apart in the direction p, by tanh-sinh quadrature.
    def direction(p: mpmath.mpf) -> mpmath.mpf:
        reach = mpmath.sqrt(mpmath.cos(p) ** 2 + (aspect * mpmath.sin(p)) ** 2)
        slope = peclet * (reach + mpmath.cos(p))
        pairs = mpmath.quad(
            lambda r: (2 * mpmath.acos(r / 2) - r / 2 * mpmath.sqrt(4 - r**2)) * mpmath.exp(-slope * r), [0, 2]
        )
        return pairs * aspect / reach

    with mpmath.workdps(12):
        expected = mpmath.quad(direction, [0, mpmath.pi], maxdegree=4) / mpmath.pi**2
    assert mean_rise(peclet=peclet, aspect=aspect) == approx(float(expected), rel=1e-8)


def test_the_published_interpolation_is_off_by_what_its_documentation_says() -> None:
    peclet = np.geomspace(0.03, 100, 36)
    speeds = peclet * speed_at(1.0)
    exact = moving_ellipse_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=speeds)
    published = flash_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=speeds)
    peak = published.peak_temperature_rise / exact.peak_temperature_rise - 1
    mean = published.mean_temperature_rise / exact.mean_temperature_rise - 1
    assert (peak.max(), peak.min()) == approx((0.023, -0.007), abs=5e-4)
    assert peclet[np.argmax(peak)] == approx(0.6, rel=0.25)
    assert mean.min() == approx(-0.038, abs=5e-4)
    assert peclet[np.argmin(mean)] == approx(0.8, rel=0.25)
    for aspect, error in ((0.3, 0.16), (4.0, -0.12)):
        source = EllipticSource(half_length=1e-4, half_width=aspect * 1e-4)
        exact = moving_ellipse_rise(STEEL, source, heat_flux=FLUX, sliding_speed=speeds)
        published = flash_rise(STEEL, source, heat_flux=FLUX, sliding_speed=speeds)
        both = np.array(published) / np.array(exact) - 1
        assert both.flat[np.argmax(np.abs(both))] == approx(error, abs=0.01)


def test_the_contact_takes_the_model_it_is_given() -> None:
    speed = speed_at(1.0)
    published = contact_rise(STEEL, STEEL, DOT, heat_rate=1.0, sliding_speed=speed)
    exact = contact_rise(
        STEEL, STEEL, DOT, heat_rate=1.0, sliding_speed=speed, moving_rise=FLASH_MODELS.named("quadrature")
    )
    disc = mean_rise(peclet=1.0, aspect=1.0)
    assert exact.heat_partition == approx(disc / (disc + 8 / (3 * np.pi)), rel=1e-9)
    assert published.heat_partition < exact.heat_partition
    assert FLASH_MODELS.named("tian_kennedy_1994") is flash_rise


def test_speeds_keep_their_shape_and_other_sources_are_refused() -> None:
    found = moving_ellipse_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=[[0.1, 1.0], [0.1, 0.0]])
    assert found.mean_temperature_rise.shape == (2, 2)
    same(found.mean_temperature_rise[0, 0], found.mean_temperature_rise[1, 0])
    assert np.shape(moving_ellipse_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=1.0).peak_temperature_rise) == ()
    hertz = HertzianSource(half_length=1e-4, half_width=1e-4)
    with raises(InvalidInput, match="source must be an EllipticSource, got a HertzianSource; use flash_rise"):
        moving_ellipse_rise(STEEL, hertz, heat_flux=FLUX, sliding_speed=1.0)
