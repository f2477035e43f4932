"""Impedance of the stack in its rig as printed: capacitance and resonances that follow from the misprints."""

import numpy as np
from pytest import approx

from sonolube.models.actuator import PiezoStack, dong_2015_impedance

# D Table 3.5: 62 layers of 140 pm/V
STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=62 * 140e-12, stack_stiffness=2e9, stack_damping=30.0, stack_mass=0.07
)
RIG = {
    "tip_mass": 0.15,
    "reaction_mass": 0.28,
    "arm_mass": 0.5,
    "arm_stiffness": 2e5,
    "arm_damping": 20.0,
    "tip_damping": 0.0,
}


def test_the_printed_capacitance_below_resonance_is_twice_that_of_the_stack() -> None:
    # above the arm, below the stack: C_T (1 - k^2)^2/(1 - 2 k^2) with k^2 = 0.4186 is 2.08 C_T
    z = dong_2015_impedance(STACK, **RIG, normal_stiffness=0.0, normal_load=3.0, frequency=1e3)
    assert -1 / (2 * np.pi * 1e3 * z.imag) == approx(2.08 * 360e-9, rel=0.01)


def test_at_the_resonance_of_the_arm_on_its_spring_the_reaction_mass_is_without_effect() -> None:
    # mass and spring of the arm share one force, whose impedance is unbounded where m3 s = -k2/s
    rig = RIG | {"arm_damping": 1e-9, "normal_stiffness": 0.0, "normal_load": 0.0}
    resonance = np.sqrt(RIG["arm_stiffness"] / RIG["arm_mass"]) / (2 * np.pi)
    for frequency, same in ((resonance, True), (2 * resonance, False)):
        light, heavy = (
            dong_2015_impedance(STACK, **{**rig, "reaction_mass": mass}, frequency=frequency) for mass in (0.28, 28.0)
        )
        assert (light == approx(heavy, rel=1e-9)) is same


def test_the_printed_impedance_has_resonances_at_ten_and_thirty_one_kilohertz_instead_of_twenty_two() -> None:
    f = np.linspace(5e3, 50e3, 45001)
    z = np.abs(dong_2015_impedance(STACK, **RIG, normal_stiffness=0.0, normal_load=3.0, frequency=f)) * f
    dips = f[1:-1][(z[1:-1] < z[:-2]) & (z[1:-1] < z[2:])]
    assert dips == approx(np.array([10.45e3, 31.02e3]), rel=1e-3)
