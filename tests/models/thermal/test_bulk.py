"""Bulk temperature against the heat equation, finite differences and energy conservation."""

import numpy as np
from pytest import approx
from scipy.integrate import trapezoid

from sonolube.models.thermal import HeatedPin, ThermalSolid, pin_conductance, pin_rise

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
PIN = HeatedPin(solid=STEEL, pin_radius=2e-3, length=0.03, convection_coefficient=40.0)


def test_the_pin_satisfies_the_fin_equation_with_a_cold_end() -> None:
    x, h = 0.01, 1e-4
    left, here, right = pin_rise(PIN, heat_rate=0.5, depth=[x - h, x, x + h])
    m_squared = 2 * 40.0 / (16.2 * 2e-3)
    assert (left - 2 * here + right) / h**2 == approx(m_squared * here, rel=1e-5)
    assert pin_rise(PIN, heat_rate=0.5, depth=PIN.length) == approx(0.0, abs=1e-12)


def test_the_heat_into_a_pin_leaves_through_its_side_and_its_cold_end() -> None:
    places = np.linspace(0, PIN.length, 4001)
    rise = pin_rise(PIN, heat_rate=0.5, depth=places)
    into_air = 40.0 * 2 * np.pi * 2e-3 * trapezoid(rise, places)
    into_holder = 16.2 * PIN.cross_section * (rise[-2] - rise[-1]) / (places[1] - places[0])
    assert into_air + into_holder == approx(0.5, rel=1e-5)


def test_a_pin_without_convection_has_a_linear_profile() -> None:
    bare = HeatedPin(solid=STEEL, pin_radius=2e-3, length=0.03, convection_coefficient=0.0)
    assert pin_conductance(bare) == approx(16.2 * bare.cross_section / 0.03)
    assert pin_rise(bare, heat_rate=1.0, depth=0.015) == approx(pin_rise(bare, heat_rate=1.0) / 2)
