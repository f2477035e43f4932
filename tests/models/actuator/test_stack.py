"""Piezoelectric stack: coupling factor, admittance, energy balance, and limits of its drive."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.optimize import brentq

from sonolube.errors import InconsistentCoupling, InvalidInput
from sonolube.models.actuator import PiezoStack, require_allowed_voltage, stack_caveats, stack_force
from sonolube.models.dynamics.chain import LumpedChain, chain_structure
from sonolube.models.dynamics.structure import electrical_admittance

# D Table 3.5: 62 layers of 140 pm/V
STACK = PiezoStack(
    free_capacitance=360e-9,
    free_stroke_per_volt=62 * 140e-12,
    stack_stiffness=2e9,
    stack_damping=30.0,
    stack_mass=0.07,
    lowest_voltage=-20.0,
    highest_voltage=150.0,
    preload=2000.0,
)


def stacks() -> st.SearchStrategy[PiezoStack]:
    def build(capacitance: float, stiffness: float, coupling: float, damping: float) -> PiezoStack:
        return PiezoStack(
            free_capacitance=capacitance,
            free_stroke_per_volt=coupling * np.sqrt(capacitance / stiffness),
            stack_stiffness=stiffness,
            stack_damping=damping,
        )

    return st.builds(build, st.floats(1e-9, 1e-4), st.floats(1e5, 1e10), st.floats(0.01, 0.99), st.floats(0, 1e3))


phasors = st.complex_numbers(max_magnitude=10, allow_nan=False, allow_infinity=False)
frequencies = st.floats(1, 1e6)


def test_the_stack_of_table_3_5_has_a_coupling_factor_of_0_65_not_0_431() -> None:
    assert STACK.derived_coupling_factor == approx(0.65, abs=0.005)


def test_with_its_capacitance_taken_as_the_clamped_one_the_coupling_factor_is_0_54() -> None:
    free = 360e-9 + (62 * 140e-12) ** 2 * 2e9
    stack = replace(STACK, free_capacitance=free)
    assert stack.clamped_capacitance == approx(360e-9)
    assert stack.derived_coupling_factor == approx(0.54, abs=0.005)


def test_an_inconsistent_coupling_factor_gives_a_warning_by_name() -> None:
    with pytest.warns(
        InconsistentCoupling, match=r"coupling_factor is stated as 0\.431, but .* imply 0\.647"
    ) as caught:
        stack = replace(STACK, coupling_factor=0.431)
    assert (
        "coupling_factor is stated as 0.431"
        in stack_caveats(stack, voltage_offset=0, voltage_peak_to_peak=0, elongation=0, frequency=1e3)[0]
    )
    assert len(caught) == 1


@pytest.mark.parametrize("stated", [0.61, 0.69])
def test_a_coupling_factor_off_by_more_than_five_percent_gives_a_warning(stated: float) -> None:
    with pytest.warns(InconsistentCoupling, match="coupling_factor is stated"):
        replace(STACK, coupling_factor=stated)


@pytest.mark.parametrize("stated", [0.62, 0.647, 0.67])
def test_a_coupling_factor_within_five_percent_gives_no_warning(stated: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        replace(STACK, coupling_factor=stated)


@given(stack=stacks(), volts=phasors, elongation=phasors, frequency=frequencies)
def test_electrical_power_equals_mechanical_power_and_dissipation(
    stack: PiezoStack, volts: complex, elongation: complex, frequency: float
) -> None:
    e = 1e-6 * elongation
    s = 2j * np.pi * frequency
    force = stack_force(stack, voltage_amplitude=volts, elongation=e, frequency=frequency)
    current = s * (stack.clamped_capacitance * volts + stack.charge_per_elongation * e)
    electrical = 0.5 * (volts * np.conj(current)).real
    mechanical = 0.5 * (force * np.conj(s * e)).real
    heat = 0.5 * stack.stack_damping * abs(s * e) ** 2
    scale = abs(volts * current) + abs(force * s * e) + heat
    assert electrical == approx(float(mechanical + heat), abs=float(1e-9 * scale) + 1e-290)  # of numbers that underflow


@given(stack=stacks(), light=st.floats(1e-3, 1), heavy=st.floats(1e-3, 10))
def test_resonance_and_antiresonance_between_free_masses_give_the_coupling_factor(
    stack: PiezoStack, light: float, heavy: float
) -> None:
    stack = replace(stack, stack_damping=0.0)
    body = chain_structure(
        LumpedChain(
            masses={"near": light, "far": heavy},
            springs=(),
            dampers=(),
            stack=stack,
            stack_between=("near", "far"),
            contact="near",
        )
    )
    resonance = np.sqrt(stack.stack_stiffness * (1 / light + 1 / heavy)) / (2 * np.pi)

    def susceptance(f: float) -> float:
        return float(electrical_admittance(body, frequency=f).imag)

    antiresonance = brentq(susceptance, resonance * (1 + 1e-7), resonance * 10, xtol=1e-12 * resonance, rtol=1e-12)
    assert np.sqrt(1 - (resonance / antiresonance) ** 2) == approx(stack.derived_coupling_factor, rel=1e-6)


def test_the_force_vanishes_at_the_free_stroke() -> None:
    stroke = 100.0 * STACK.free_stroke_per_volt
    assert stroke == approx(0.868e-6)
    assert stack_force(STACK, voltage_amplitude=100.0, elongation=stroke, frequency=1e-9) == approx(0, abs=1e-6)
    held = stack_force(STACK, voltage_amplitude=100.0, elongation=0.0, frequency=1e3)
    assert held == approx(100.0 * STACK.charge_per_elongation)


def test_the_squared_coupling_factor_is_the_ratio_of_elastic_to_stored_energy() -> None:
    # charged with free ends, then worked down: elastic energy of the free stroke over the energy in the capacitance
    elastic = 0.5 * 2e9 * (100.0 * STACK.free_stroke_per_volt) ** 2
    assert elastic / (0.5 * 360e-9 * 100.0**2) == approx(STACK.derived_coupling_factor**2)


@pytest.mark.parametrize(
    ("volts", "message"),
    [
        ([0.0, 151.0], r"the drive goes up to 151 V; the highest admissible voltage is 150 V"),
        (-21.0, r"the drive goes down to -21 V; the lowest admissible voltage is -20 V"),
        (np.nan, r"stack_voltage must be finite, got nan V"),
    ],
)
def test_a_voltage_beyond_the_limits_is_refused(volts: float, message: str) -> None:
    with raises(InvalidInput, match=message):
        require_allowed_voltage(STACK, stack_voltage=volts)


def test_offset_and_amplitude_together_reach_the_limits() -> None:
    with raises(InvalidInput, match=r"the drive goes up to 160 V"):
        stack_caveats(STACK, voltage_offset=80, voltage_peak_to_peak=160, elongation=0, frequency=22e3)
    with raises(InvalidInput, match=r"the drive goes down to -50 V"):
        stack_caveats(STACK, voltage_offset=0, voltage_peak_to_peak=100, elongation=0, frequency=22e3)


def test_a_stack_without_limits_admits_any_voltage() -> None:
    stack = replace(STACK, lowest_voltage=None, highest_voltage=None)
    assert require_allowed_voltage(stack, stack_voltage=[-1e4, 1e4]) == approx(np.array([-1e4, 1e4]))


def test_tension_beyond_the_preload_at_resonance_is_a_caveat() -> None:
    # an elongation of 2 um in quadrature to 10 V: sqrt(4000^2 + 173.6^2) N and 30 N s/m at 0.276 m/s
    kind = stack_caveats(STACK, voltage_offset=0, voltage_peak_to_peak=20, elongation=-0.9e-6j, frequency=22e3)
    harsh = stack_caveats(STACK, voltage_offset=0, voltage_peak_to_peak=20, elongation=-2e-6j, frequency=22e3)
    assert kind == ()
    assert harsh == (
        "tension in the stack: the vibration causes a tension of up to 4003 N on a preload of 2000 N;"
        " ceramics crack in tension: preload more or drive less",
    )


def test_tension_without_a_stated_preload_is_a_caveat() -> None:
    caveats = stack_caveats(
        replace(STACK, preload=None), voltage_offset=0, voltage_peak_to_peak=20, elongation=-2e-6j, frequency=22e3
    )
    assert caveats == ("the vibration causes a tension in the stack of up to 4003 N and no preload is stated",)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stack_stiffness": 0.0}, r"stack_stiffness must be positive, got 0\.0 N/m"),
        ({"stack_mass": -0.1}, r"stack_mass must not be negative, got -0\.1 kg"),
        ({"preload": -1.0}, r"preload must not be negative, got -1\.0 N"),
        ({"stack_damping": np.nan}, r"stack_damping must be finite, got nan N s/m"),
        ({"lowest_voltage": 200.0}, r"lowest_voltage must lie below highest_voltage, 150\.0 V, got 200\.0 V"),
        (
            {"free_capacitance": 100e-9},
            r"free_capacitance must exceed .* 1\.507e-07 F, .* coupling factor would exceed 1",
        ),
        ({"coupling_factor": 1.2}, r"coupling_factor must lie between 0 and 1, got 1\.2"),
    ],
)
def test_an_impossible_stack_is_refused(changes: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        replace(STACK, **changes)


def test_frequency_zero_is_refused() -> None:
    with raises(InvalidInput, match=r"frequency must be positive, got 0\.0 Hz"):
        stack_force(STACK, voltage_amplitude=1.0, elongation=0.0, frequency=0)
