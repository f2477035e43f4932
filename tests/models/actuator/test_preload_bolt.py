"""Preload bolt: parallel stiffness, stresses and fatigue against hand calculation."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack, PreloadBolt, bolt_stresses, bolted_stack

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=8.68e-9, stack_stiffness=2e9, stack_damping=30.0, stack_mass=0.07
)
BOLT = PreloadBolt(thread_diameter=8e-3, length=40e-3, youngs_modulus=205e9, yield_strength=640e6, preload=10e3)


def test_an_m8_bolt_has_the_stress_area_and_endurance_limit_of_the_standards() -> None:
    assert BOLT.stress_area == approx(36.6e-6, abs=0.05e-6)  # ISO 898-1
    assert BOLT.endurance_limit == approx(54.2e6, rel=1e-3)  # 0.85 (150/8 + 45) MPa
    assert BOLT.stiffness == approx(205e9 * 36.6e-6 / 40e-3, rel=1e-3)


@mark.parametrize(
    ("size", "area"),
    [(2, 2.07), (2.5, 3.39), (3, 5.03), (4, 8.78), (5, 14.2), (6, 20.1), (8, 36.6), (10, 58.0), (12, 84.3)],
)
def test_coarse_threads_have_the_stress_areas_of_iso_898(size: float, area: float) -> None:
    bolt = PreloadBolt(thread_diameter=size * 1e-3, length=0.04, youngs_modulus=2e11, yield_strength=6e8, preload=1.0)
    assert bolt.stress_area == approx(area * 1e-6, rel=3e-3)


def test_force_and_charge_of_a_bolted_stack_are_those_of_stack_and_bolt_in_parallel() -> None:
    joined = bolted_stack(STACK, BOLT)
    volts, elongation = 30.0, 50e-9
    alone = STACK.charge_per_elongation * volts - STACK.stack_stiffness * elongation
    force = joined.charge_per_elongation * volts - joined.stack_stiffness * elongation
    assert force == approx(alone - BOLT.stiffness * elongation)
    charge = STACK.clamped_capacitance * volts + STACK.charge_per_elongation * elongation
    assert joined.clamped_capacitance * volts + joined.charge_per_elongation * elongation == approx(charge)
    assert joined.free_capacitance < STACK.free_capacitance
    assert joined.preload == 10e3


def test_the_stress_of_the_bolt_follows_hookes_law() -> None:
    load = bolt_stresses(BOLT, elongation_amplitude=[0.0, 1e-6], elongation=2e-6)
    strain = np.array([0.0, 1e-6]) / 40e-3
    assert load.bolt_stress_amplitude == approx(205e9 * strain)
    assert load.highest_bolt_stress == approx(10e3 / BOLT.stress_area + 205e9 * (strain + 2e-6 / 40e-3))
    assert load.fatigue_safety[0] == np.inf
    assert load.fatigue_safety[1] == approx(54.2 / 5.125, rel=1e-3)
    assert load.yield_safety == approx(640e6 / load.highest_bolt_stress)


def test_a_thread_without_a_tabulated_pitch_is_refused() -> None:
    with raises(InvalidInput, match="thread_diameter must be one of"):
        PreloadBolt(thread_diameter=7e-3, length=0.04, youngs_modulus=2e11, yield_strength=6e8, preload=1.0)
