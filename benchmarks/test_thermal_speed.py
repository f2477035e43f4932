"""Speed of the closed forms of heat, lubrication and forming: a million points each."""

from collections.abc import Callable

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.friction import (
    BoundaryLubricant,
    StribeckCurve,
    acoustic_softening_ratio,
    best_lubrication_method,
    lubrication_coefficients,
    stribeck_coefficient,
    superposed_mean_stress,
)
from sonolube.models.thermal import (
    EllipticSource,
    HeatedPin,
    ThermalSolid,
    contact_rise,
    flash_rise,
    pin_rise,
    superimposed_heat_rate,
)

POINTS = 1_000_000
STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
DOT = EllipticSource(half_length=1e-4, half_width=1e-4)
PIN = HeatedPin(solid=STEEL, pin_radius=2e-3, length=0.03, convection_coefficient=40.0)
LUBRICANT = BoundaryLubricant(film_coefficient=0.1, full_asperity_pressure=200e6)
CURVE = StribeckCurve(boundary_coefficient=0.12, transition_hersey_number=2e-9, film_slope=1e6)

DRAWN = np.random.default_rng(1)
HEAT, SPEED, SHARE = (DRAWN.uniform(low, high, POINTS) for low, high in ((1e5, 1e6), (0.01, 1.0), (0.01, 1.0)))

FORMS: dict[str, Callable[[], object]] = {
    "flash_rise": lambda: flash_rise(STEEL, DOT, heat_flux=HEAT, sliding_speed=SPEED),
    "contact_rise": lambda: contact_rise(STEEL, STEEL, DOT, heat_rate=SHARE, sliding_speed=SPEED),
    "pin_rise": lambda: pin_rise(PIN, heat_rate=SHARE, depth=0.01 * SPEED),
    "superimposed_heat_rate": lambda: superimposed_heat_rate(
        friction_force=SHARE, sliding_speed=SPEED, vibration_velocity=SHARE
    ),
    "stribeck_coefficient": lambda: stribeck_coefficient(CURVE, hersey_number=1e-8 * SHARE),
    "lubrication_coefficients": lambda: lubrication_coefficients(
        LUBRICANT, friction_coefficient=0.2, friction_ratio=SHARE, nominal_pressure=1e8 * SPEED
    ),
    "superposed_mean_stress": lambda: superposed_mean_stress(
        yield_strength=1e8, youngs_modulus=70e9, strain_amplitude=1e-2 * SHARE
    ),
    "acoustic_softening_ratio": lambda: acoustic_softening_ratio(acoustic_intensity=HEAT, reference_intensity=1e6),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_million_points_of_a_closed_form(benchmark: BenchmarkFixture, name: str) -> None:
    benchmark(FORMS[name])


def test_a_hundred_thousand_choices_of_a_method(benchmark: BenchmarkFixture) -> None:
    found = lubrication_coefficients(
        LUBRICANT, friction_coefficient=0.2, friction_ratio=SHARE[:100_000], nominal_pressure=1e8 * SPEED[:100_000]
    )
    assert benchmark(best_lubrication_method, found, smallest_gain=0.04).shape == (100_000,)
