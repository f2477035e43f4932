"""Moving heat sources against independent quadratures of point sources."""

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import dblquad
from scipy.special import k0e, k1e

from sonolube.checks import Floats
from sonolube.models.thermal import (
    EllipticSource,
    RectangularSource,
    ThermalSolid,
    low_peclet_rise,
    moving_rectangle_rise,
)

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
HALF = 1e-4
FLUX = 1e6


def band_rise(place: Floats, *, speed: float) -> Floats:
    """Rise around a band of infinite width, by the antiderivative of exp(-u) K0(abs u) (DLMF 10.43.9)."""
    per_length = speed / (2 * STEEL.thermal_diffusivity)

    def antiderivative(u: Floats) -> Floats:
        s = np.abs(u)
        return np.asarray(np.where(u < 0, -s * (k0e(s) + k1e(s)), s * np.exp(-2 * s) * (k0e(s) - k1e(s))))

    integral = antiderivative(per_length * (place + HALF)) - antiderivative(per_length * (place - HALF))
    return FLUX / (np.pi * STEEL.thermal_conductivity * per_length) * integral


def test_a_fast_band_peaks_at_its_trailing_edge_at_jaegers_limit() -> None:
    # 2 q/k sqrt(2 kappa b/(pi V))
    places = np.linspace(-HALF, HALF, 2001)[1:-1]
    rise = band_rise(places, speed=20.0)
    limit = 2 * FLUX / STEEL.thermal_conductivity * np.sqrt(2 * STEEL.thermal_diffusivity * HALF / (np.pi * 20.0))
    assert np.argmax(rise) < 40
    assert rise.max() == approx(limit, rel=0.01)


def test_a_wide_moving_rectangle_agrees_with_the_moving_band() -> None:
    wide = RectangularSource(half_length=HALF, half_width=200 * HALF)
    place = np.array([-0.7e-4, 0.4e-4])
    rectangle = moving_rectangle_rise(STEEL, wide, heat_flux=FLUX, sliding_speed=0.2, distance_ahead=place)
    assert rectangle == approx(band_rise(place, speed=0.2), rel=1e-6)


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
