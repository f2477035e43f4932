"""Flash temperature against the integrals it approximates and published constants."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy import special
from scipy.integrate import dblquad

from sonolube.errors import InvalidInput
from sonolube.models.thermal import (
    EllipticSource,
    HertzianSource,
    RectangularSource,
    ThermalSolid,
    blok_partition,
    contact_rise,
    flash_rise,
    high_peclet_rise,
    low_peclet_rise,
    moving_rectangle_rise,
    peclet_number,
)

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
BRASS = ThermalSolid(thermal_conductivity=110.0, density=8500.0, specific_heat_capacity=380.0)
DOT = EllipticSource(half_length=1e-4, half_width=1e-4)
SQUARE = RectangularSource(half_length=1e-4, half_width=1e-4)
FLUX = 1e6
speeds = st.floats(1e-4, 100.0)


def speed_at(peclet: float) -> float:
    return peclet * 2 * STEEL.thermal_diffusivity / DOT.half_length


@pytest.mark.parametrize("peclet", [0.01, 0.3, 1.0, 5.0, 40.0])
def test_the_circular_source_has_the_constants_of_tian_and_kennedy(peclet: float) -> None:
    # J. Tribol. 116, 167: maximum 2/sqrt(pi (1.273 + Pe)), mean 1.22/sqrt(pi (0.6575 + Pe)), times q a/k
    unit = FLUX * DOT.half_length / STEEL.thermal_conductivity
    rise = flash_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=speed_at(peclet))
    assert rise.peak_temperature_rise / unit == approx(2 / np.sqrt(np.pi * (1.273 + peclet)), rel=1e-3)
    assert rise.mean_temperature_rise / unit == approx(1.22 / np.sqrt(np.pi * (0.6575 + peclet)), rel=1e-3)


@pytest.mark.parametrize("peclet", [0.01, 0.3, 1.0, 5.0, 40.0])
def test_the_square_source_has_the_peak_constant_of_tian_and_kennedy(peclet: float) -> None:
    # maximum 2/sqrt(pi (1.011 + Pe)), times q b/k, b half a side
    unit = FLUX * SQUARE.half_length / STEEL.thermal_conductivity
    rise = flash_rise(STEEL, SQUARE, heat_flux=FLUX, sliding_speed=speed_at(peclet))
    assert rise.peak_temperature_rise / unit == approx(2 / np.sqrt(np.pi * (1.011 + peclet)), rel=1e-3)


@pytest.mark.parametrize("peclet", [0.0, 0.1, 1.0, 10.0, 100.0])
def test_the_interpolation_is_within_four_percent_of_the_integral_over_a_square(peclet: float) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(16)
    places = 1e-4 * nodes
    inside = moving_rectangle_rise(
        STEEL,
        SQUARE,
        heat_flux=FLUX,
        sliding_speed=speed_at(peclet),
        distance_ahead=places,
        transverse_distance=places[:, np.newaxis],
    )
    mean = weights @ inside @ weights / 4
    axis = moving_rectangle_rise(
        STEEL, SQUARE, heat_flux=FLUX, sliding_speed=speed_at(peclet), distance_ahead=np.linspace(-1e-4, 1e-4, 101)
    )
    rise = flash_rise(STEEL, SQUARE, heat_flux=FLUX, sliding_speed=speed_at(peclet))
    assert rise.peak_temperature_rise == approx(axis.max(), rel=0.04)
    assert rise.mean_temperature_rise == approx(mean, rel=0.04)


@pytest.mark.parametrize("aspect", [0.3, 1.0, 4.0])
def test_a_stationary_rectangle_is_the_superposition_of_point_sources(aspect: float) -> None:
    source = RectangularSource(half_length=1e-4, half_width=aspect * 1e-4)
    # a point source of Q gives Q/(2 pi k r); lengths in units of half_length
    centre = 4 * dblquad(lambda y, x: 1 / np.hypot(x, y), 0, 1, 0, aspect)[0] / (2 * np.pi)
    pairs = dblquad(lambda y, x: (2 - x) * (2 * aspect - y) / np.hypot(x, y), 0, 2, 0, 2 * aspect)[0]
    mean = 4 * pairs / (2 * np.pi) / (4 * aspect)
    rise = low_peclet_rise(STEEL, source, heat_flux=FLUX)
    unit = FLUX * 1e-4 / STEEL.thermal_conductivity
    assert rise.peak_temperature_rise / unit == approx(centre, rel=1e-6)
    assert rise.mean_temperature_rise / unit == approx(mean, rel=1e-6)


@pytest.mark.parametrize("aspect", [0.25, 3.0])
def test_the_centre_of_a_stationary_ellipse_is_the_superposition_of_point_sources(aspect: float) -> None:
    angles = (np.arange(20_000) + 0.5) * 2 * np.pi / 20_000
    radius = aspect / np.hypot(aspect * np.cos(angles), np.sin(angles))  # of the rim, half length one
    source = EllipticSource(half_length=1e-4, half_width=aspect * 1e-4)
    rise = low_peclet_rise(STEEL, source, heat_flux=FLUX)
    unit = FLUX * 1e-4 / STEEL.thermal_conductivity
    assert rise.peak_temperature_rise / unit == approx(radius.mean(), rel=1e-6)


def test_a_stationary_disc_has_the_peak_and_mean_of_carslaw_and_jaeger() -> None:
    rise = low_peclet_rise(STEEL, DOT, heat_flux=FLUX)
    unit = FLUX * DOT.half_length / STEEL.thermal_conductivity
    assert (rise.peak_temperature_rise, rise.mean_temperature_rise) == approx((unit, 8 / (3 * np.pi) * unit))


def test_at_high_peclet_number_each_point_warms_like_a_half_space_for_the_time_of_passage() -> None:
    # 2 q/k sqrt(kappa t/pi) at the end of each chord of a disc, averaged over chords by brute force
    y = (np.arange(200_000) + 0.5) / 200_000
    chord = 2 * np.sqrt(1 - y**2)
    passage = chord * DOT.half_length / 5.0
    ends = 2 * FLUX / STEEL.thermal_conductivity * np.sqrt(STEEL.thermal_diffusivity * passage / np.pi)
    rise = high_peclet_rise(STEEL, DOT, heat_flux=FLUX, sliding_speed=5.0)
    assert rise.peak_temperature_rise == approx(ends.max(), rel=1e-5)
    assert rise.mean_temperature_rise == approx(np.average(2 / 3 * ends, weights=chord), rel=1e-5)


@given(speed=speeds, heat=st.floats(1e-3, 10.0))
def test_the_heat_partition_equalises_the_mean_temperatures_of_both_bodies(speed: float, heat: float) -> None:
    shared = contact_rise(STEEL, BRASS, DOT, heat_rate=heat, sliding_speed=speed)
    pin = low_peclet_rise(STEEL, DOT, heat_flux=shared.heat_partition * heat / DOT.area)
    disc = flash_rise(BRASS, DOT, heat_flux=(1 - shared.heat_partition) * heat / DOT.area, sliding_speed=speed)
    assert 0 < shared.heat_partition < 1
    assert pin.mean_temperature_rise == approx(disc.mean_temperature_rise)
    assert shared.mean_temperature_rise == approx(pin.mean_temperature_rise)
    assert shared.peak_temperature_rise == approx(max(pin.peak_temperature_rise, disc.peak_temperature_rise))
    assert shared.peak_temperature_rise >= shared.mean_temperature_rise


def test_bodies_at_rest_divide_the_heat_in_proportion_to_conductivity() -> None:
    assert contact_rise(STEEL, STEEL, DOT, heat_rate=1.0, sliding_speed=0.0).heat_partition == approx(0.5)
    share = blok_partition(STEEL, BRASS, DOT, sliding_speed=0.0)
    assert share == approx(16.2 / (16.2 + 110.0))


@given(speed=speeds)
def test_the_fraction_into_the_moving_body_rises_with_speed(speed: float) -> None:
    slow, fast = blok_partition(STEEL, STEEL, DOT, sliding_speed=[speed, 2 * speed])
    assert fast < slow < 0.5


def test_the_peclet_number_follows_jaegers_definition() -> None:
    # 1 m/s x 0.1 mm over twice 4.05 mm2/s
    assert peclet_number(STEEL, DOT, sliding_speed=1.0) == approx(1e-4 / 8.1e-6)


def test_a_negative_flux_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"heat_flux must not be negative, got -1\.0 W/m2"):
        flash_rise(STEEL, DOT, heat_flux=-1.0, sliding_speed=1.0)


@pytest.mark.parametrize("ratio", [1e-6, 0.01, 0.3, 0.999999, 1.0, 1 / 0.3, 1e4])
def test_the_rise_of_a_stationary_ellipse_has_the_elliptic_integral_of_a_library(ratio: float) -> None:
    source = EllipticSource(half_length=1e-3, half_width=ratio * 1e-3)
    short, long = min(1.0, ratio), max(1.0, ratio)
    expected = 2 / np.pi * special.ellipkm1((short / long) ** 2) * short
    assert source.peak_low_peclet == approx(expected, rel=1e-12)
    hertzian = HertzianSource(half_length=1e-3, half_width=ratio * 1e-3)
    assert hertzian.peak_low_peclet == approx(3 * np.pi / 8 * expected, rel=1e-12)
