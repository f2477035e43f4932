"""Bulk temperature against the heat equation, finite differences and energy conservation."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import quad, trapezoid

from sonolube.errors import InvalidInput
from sonolube.models.thermal import (
    HeatedDisc,
    HeatedPin,
    ThermalSolid,
    disc_track_rise,
    half_space_rise,
    lumped_rise,
    pin_conductance,
    pin_rise,
)

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
PIN = HeatedPin(solid=STEEL, pin_radius=2e-3, length=0.03, convection_coefficient=40.0)
DISC = HeatedDisc(solid=STEEL, thickness=2e-3, track_radius=0.014, disc_radius=0.04, convection_coefficient=15.0)


@pytest.mark.parametrize("depth", [1e-3, 10.0])
def test_a_half_space_has_no_rise_at_time_zero_at_any_depth(depth: float) -> None:
    assert half_space_rise(STEEL, heat_flux=1e4, time=[0.0, 1e-12], depth=depth) == approx([0.0, 0.0], abs=0)


def test_the_heat_stored_in_a_half_space_is_the_heat_supplied() -> None:
    stored = quad(lambda z: float(half_space_rise(STEEL, heat_flux=1e4, time=3.0, depth=z)), 0, 0.1, limit=200)[0]
    assert STEEL.density * STEEL.specific_heat_capacity * stored == approx(3e4, rel=1e-6)


def test_the_surface_of_a_half_space_warms_with_the_square_root_of_time() -> None:
    one, four = half_space_rise(STEEL, heat_flux=1e4, time=[1.0, 4.0])
    assert four == approx(2 * one)
    assert one == approx(2e4 * np.sqrt(STEEL.thermal_diffusivity / np.pi) / 16.2)


def test_the_half_space_satisfies_the_heat_equation() -> None:
    z, t, h, dt = 2e-3, 1.5, 1e-5, 1e-3

    def rise(depth: float, time: float) -> float:
        return float(half_space_rise(STEEL, heat_flux=1e4, time=time, depth=depth))

    curvature = (rise(z + h, t) - 2 * rise(z, t) + rise(z - h, t)) / h**2
    warming = (rise(z, t + dt) - rise(z, t - dt)) / (2 * dt)
    assert warming == approx(STEEL.thermal_diffusivity * curvature, rel=1e-4)


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


def test_the_disc_agrees_with_a_finite_volume_solution() -> None:
    edges = np.linspace(0, DISC.disc_radius, 4001)
    middles, step = (edges[1:] + edges[:-1]) / 2, edges[1]
    through = 2 * np.pi * edges[1:-1] * 16.2 * DISC.thickness / step
    lost = 2 * 15.0 * np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
    heat = np.zeros(middles.size)
    heat[np.searchsorted(edges, DISC.track_radius) - 1 : np.searchsorted(edges, DISC.track_radius) + 1] = 0.5
    diagonal = lost.copy()
    diagonal[1:] += through
    diagonal[:-1] += through
    from scipy.linalg import solveh_banded

    rise = solveh_banded(np.array([np.concatenate([[0.0], -through]), diagonal]), heat)
    assert disc_track_rise(DISC, heat_rate=1.0) == approx(np.interp(DISC.track_radius, middles, rise), rel=1e-3)
    assert lost @ rise == approx(1.0)


def test_a_track_outside_its_disc_is_refused() -> None:
    with raises(InvalidInput, match=r"track_radius 0\.05 m lies outside disc_radius 0\.04 m"):
        HeatedDisc(solid=STEEL, thickness=2e-3, track_radius=0.05, disc_radius=0.04, convection_coefficient=15.0)


@given(time=st.floats(0.0, 1e3), conductance=st.floats(1e-3, 1.0), capacity=st.floats(0.1, 100.0))
def test_a_lumped_body_conserves_energy(time: float, conductance: float, capacity: float) -> None:
    def rise(t: float) -> float:
        return float(lumped_rise(heat_rate=0.2, thermal_conductance=conductance, heat_capacity=capacity, time=t))

    decay = conductance * time / capacity
    lost = 0.2 * (time - capacity / conductance * -np.expm1(-decay))
    assert capacity * rise(time) + lost == approx(0.2 * time, rel=1e-9, abs=1e-12)
