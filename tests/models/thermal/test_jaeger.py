"""Moving heat sources against independent quadratures of point sources."""

import mpmath
import numpy as np
import pytest
from pytest import approx
from scipy.integrate import dblquad, quad
from scipy.special import k0

from sonolube.models.thermal import (
    EllipticSource,
    RectangularSource,
    ThermalSolid,
    low_peclet_rise,
    moving_band_rise,
    moving_rectangle_rise,
)

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
HALF = 1e-4
FLUX = 1e6


@pytest.mark.parametrize("speed", [1e-3, 0.1, 3.0])
@pytest.mark.parametrize("place", [-2e-4, -1e-4, 0.0, 0.5e-4, 1.2e-4])
def test_the_moving_band_agrees_with_quadrature_of_jaegers_integral(speed: float, place: float) -> None:
    per_length = speed / (2 * STEEL.thermal_diffusivity)

    def line(source: float) -> float:
        u = per_length * (place - source)
        return float(np.exp(-u) * k0(abs(u)))

    inner = [place] if abs(place) < HALF else None
    integral = quad(line, -HALF, HALF, points=inner, limit=400)[0]
    expected = FLUX / (np.pi * STEEL.thermal_conductivity) * integral
    rise = moving_band_rise(STEEL, heat_flux=FLUX, half_length=HALF, sliding_speed=speed, distance_ahead=place)
    assert rise == approx(expected, rel=1e-6)


@pytest.mark.parametrize("u", [-300.0, -2.5, -2.0, -1.999, -0.1, -1e-6, 0.0, 1e-6, 0.1, 1.999, 2.0, 2.5, 8.0])
def test_the_antiderivative_agrees_with_multiprecision_quadrature(u: float) -> None:
    slow = mpmath.quad(lambda t: mpmath.exp(-t) * mpmath.besselk(0, abs(t)), [0, u / 16, u / 4, u])
    # of a band from 0 to 2 b, u = V x/(2 kappa), seen from its nearer or farther end
    speed, b = 0.1, STEEL.thermal_diffusivity * max(abs(u), 1e-9) / 0.1
    at = b if u > 0 else -b
    rise = moving_band_rise(STEEL, heat_flux=1.0, half_length=b, sliding_speed=speed, distance_ahead=at)
    per_length = speed / (2 * STEEL.thermal_diffusivity)
    fast = float(np.sign(u) * rise * np.pi * STEEL.thermal_conductivity * per_length)
    assert fast == approx(float(slow), rel=1e-10, abs=1e-13)


def test_a_fast_band_peaks_at_its_trailing_edge_at_jaegers_limit() -> None:
    # 2 q/k sqrt(2 kappa b/(pi V))
    places = np.linspace(-HALF, HALF, 2001)
    rise = moving_band_rise(STEEL, heat_flux=FLUX, half_length=HALF, sliding_speed=20.0, distance_ahead=places)
    limit = 2 * FLUX / STEEL.thermal_conductivity * np.sqrt(2 * STEEL.thermal_diffusivity * HALF / (np.pi * 20.0))
    assert np.argmax(rise) < 40
    assert rise.max() == approx(limit, rel=0.01)


def test_a_wide_moving_rectangle_agrees_with_the_moving_band() -> None:
    wide = RectangularSource(half_length=HALF, half_width=200 * HALF)
    place = np.array([-0.7e-4, 0.4e-4])
    rectangle = moving_rectangle_rise(STEEL, wide, heat_flux=FLUX, sliding_speed=0.2, distance_ahead=place)
    band = moving_band_rise(STEEL, heat_flux=FLUX, half_length=HALF, sliding_speed=0.2, distance_ahead=place)
    assert rectangle == approx(band, rel=1e-6)


@pytest.mark.parametrize("speed", [0.0, 0.05, 0.4])
def test_a_moving_square_is_the_superposition_of_moving_point_sources(speed: float) -> None:
    # a point of Q moving along x: Q/(2 pi k r) exp(-V (r + x)/(2 kappa))
    x, y = 1.4 * HALF, 0.3 * HALF  # outside, where nothing is singular
    per_length = speed / (2 * STEEL.thermal_diffusivity)

    def point(b: float, a: float) -> float:
        r = np.hypot(x - a, y - b)
        return float(np.exp(-per_length * (r + x - a)) / r)

    total = dblquad(point, -HALF, HALF, -HALF, HALF)[0] * FLUX / (2 * np.pi * STEEL.thermal_conductivity)
    square = RectangularSource(half_length=HALF, half_width=HALF)
    rise = moving_rectangle_rise(
        STEEL, square, heat_flux=FLUX, sliding_speed=speed, distance_ahead=x, transverse_distance=y
    )
    assert rise == approx(total, rel=1e-6)


def test_a_square_heated_for_a_short_time_warms_like_a_half_space() -> None:
    square = RectangularSource(half_length=HALF, half_width=HALF)
    early = moving_rectangle_rise(STEEL, square, heat_flux=FLUX, sliding_speed=0.0, duration=2e-5)
    half_space = 2 * FLUX * np.sqrt(STEEL.thermal_diffusivity * 2e-5 / np.pi) / STEEL.thermal_conductivity
    assert early == approx(half_space, rel=1e-6)


def test_the_transient_rise_of_a_stationary_square_approaches_the_steady_state() -> None:
    square = RectangularSource(half_length=HALF, half_width=HALF)
    late = moving_rectangle_rise(STEEL, square, heat_flux=FLUX, sliding_speed=0.0, duration=1e3)
    assert late == approx(low_peclet_rise(STEEL, square, heat_flux=FLUX).peak_temperature_rise, rel=1e-2)


def test_a_disc_and_a_square_of_equal_area_have_nearly_equal_mean_rises() -> None:
    side = HALF * np.sqrt(np.pi) / 2
    disc, square = (
        low_peclet_rise(STEEL, source, heat_flux=FLUX).mean_temperature_rise
        for source in (
            EllipticSource(half_length=HALF, half_width=HALF),
            RectangularSource(half_length=side, half_width=side),
        )
    )
    assert disc == approx(square, rel=0.02)
