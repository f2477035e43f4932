"""Flextensional actuators and levers against lumped chains and energy conservation."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.actuator import FlextensionalActuator, PiezoStack, equivalent_stack, lever_amplified_stack
from sonolube.models.dynamics.chain import GROUND, LumpedChain, chain_structure
from sonolube.models.dynamics.linear import modes
from sonolube.models.dynamics.structure import electrical_admittance

# D 2.2.2: 52 um at 150 V, 16 kHz, 1.53 uF; force, mass and quality factor, which it does not print, of that order
APA = FlextensionalActuator(
    stroke=52e-6,
    stroke_voltage=150.0,
    blocked_force=190.0,
    resonance_frequency=16e3,
    free_capacitance=1.53e-6,
    actuator_mass=10e-3,
    mechanical_quality_factor=100.0,
)
STACK = PiezoStack(
    free_capacitance=1.53e-6,
    free_stroke_per_volt=60e-9,
    stack_stiffness=80e6,
    stack_damping=100.0,
    stack_mass=3e-3,
    preload=1000.0,
)


def test_four_volts_peak_to_peak_give_a_stroke_of_1_4_micrometres() -> None:
    # E35: half of it at 16 kHz is the vibration velocity of 70 mm/s, where D has 150
    stroke = 4.0 * equivalent_stack(APA).free_stroke_per_volt
    assert stroke == approx(1.39e-6, rel=0.005)
    assert np.pi * 16e3 * stroke == approx(0.070, rel=0.01)


def test_the_equivalent_stack_on_its_effective_mass_has_the_resonance_of_the_data_sheet() -> None:
    held = chain_structure(
        LumpedChain(
            masses={"end": APA.effective_mass},
            springs=(),
            dampers=(),
            stack=equivalent_stack(APA),
            stack_between=("end", GROUND),
            contact="end",
        )
    )
    found = modes(held)
    assert found.natural_frequency == approx(16e3)
    assert found.damping_ratio == approx(1 / 200)


def test_with_both_ends_free_each_end_has_twice_the_effective_mass() -> None:
    free = chain_structure(
        LumpedChain(
            masses={"near": 2 * APA.effective_mass, "far": 2 * APA.effective_mass},
            springs=(),
            dampers=(),
            stack=equivalent_stack(APA),
            stack_between=("near", "far"),
            contact="near",
        )
    )
    assert modes(free).natural_frequency[1] == approx(16e3)


@given(ratio=st.floats(0.1, 30))
def test_a_lever_changes_neither_coupling_factor_nor_energy(ratio: float) -> None:
    out = lever_amplified_stack(STACK, amplification_ratio=ratio)
    assert out.derived_coupling_factor == approx(STACK.derived_coupling_factor)
    assert out.clamped_capacitance == approx(STACK.clamped_capacitance)
    assert out.free_stroke_per_volt == approx(ratio * STACK.free_stroke_per_volt)
    work = out.stack_stiffness * out.free_stroke_per_volt**2
    assert work == approx(STACK.stack_stiffness * STACK.free_stroke_per_volt**2)
    assert out.preload == approx(1000.0 / ratio)


@given(ratio=st.floats(0.1, 30), frequency=st.floats(10, 1e5))
def test_a_mass_at_the_output_of_a_lever_counts_electrically_with_the_square_of_the_ratio(
    ratio: float, frequency: float
) -> None:
    def admittance(stack: PiezoStack, mass: float) -> complex:
        chain = LumpedChain(
            masses={"end": mass}, springs=(), dampers=(), stack=stack, stack_between=("end", GROUND), contact="end"
        )
        return complex(electrical_admittance(chain_structure(chain), frequency=frequency))

    direct = admittance(STACK, 0.05 * ratio**2)
    assert admittance(lever_amplified_stack(STACK, amplification_ratio=ratio), 0.05) == approx(direct, rel=1e-9)


def test_the_ratios_of_two_levers_in_series_multiply() -> None:
    twice = lever_amplified_stack(lever_amplified_stack(STACK, amplification_ratio=2.0), amplification_ratio=3.0)
    once = lever_amplified_stack(STACK, amplification_ratio=6.0)
    assert twice.stack_stiffness == approx(once.stack_stiffness)
    assert twice.stack_mass == approx(once.stack_mass)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stroke": 0.0}, r"stroke must be positive, got 0\.0 m"),
        (
            {"resonance_frequency": 100.0},
            r"moves 9\.26 kg, more than actuator_mass, 0\.01 kg; was it measured with a load\?",
        ),
    ],
)
def test_an_impossible_data_sheet_is_refused(changes: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        replace(APA, **changes)


def test_a_data_sheet_with_a_coupling_factor_above_one_is_refused() -> None:
    with raises(InvalidInput, match="the coupling factor would exceed 1"):
        equivalent_stack(replace(APA, blocked_force=700.0))


def test_a_ratio_of_zero_is_refused() -> None:
    with raises(InvalidInput, match=r"amplification_ratio must be positive, got 0\.0"):
        lever_amplified_stack(STACK, amplification_ratio=0)
