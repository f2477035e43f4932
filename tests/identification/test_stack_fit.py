"""Stack parameters fitted to spectra of a known stack in its structure."""

from dataclasses import replace

import numpy as np
from pytest import approx, mark

from sonolube.identification.stack_fit import fit_stack
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.chain import chain_structure, pin_on_disc_chain
from sonolube.models.dynamics.structure import Structure, electrical_admittance

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=6e-9, stack_stiffness=2e9, stack_damping=300.0, stack_mass=0.05
)


def in_tribometer(stack: PiezoStack) -> Structure:
    return chain_structure(
        pin_on_disc_chain(stack, tip_mass=0.15, reaction_mass=0.3, arm_mass=1.0, arm_stiffness=2e5, arm_damping=5.0)
    )


def measured(noise: float) -> ImpedanceSpectrum:
    f = np.linspace(10e3, 40e3, 301)
    scatter = noise * (np.random.default_rng(1).standard_normal((2, 301)).T @ np.array([1, 1j]))
    return ImpedanceSpectrum(
        frequency=f, impedance=np.exp(scatter) / electrical_admittance(in_tribometer(STACK), frequency=f)
    )


@mark.parametrize(
    "wrong",
    [
        {"stack_stiffness": 0.3e9},
        {"stack_stiffness": 2e10, "free_capacitance": 700e-9, "free_stroke_per_volt": 3e-9},
        {"stack_damping": 0.0},
    ],
)
@mark.parametrize("noise", [0.0, 0.01])
def test_the_stack_is_recovered_from_wrong_initial_values(wrong: dict[str, float], noise: float) -> None:
    found = fit_stack(measured(noise), replace(STACK, **wrong), in_structure=in_tribometer)
    for name in ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_damping"):
        assert getattr(found.stack, name) == approx(getattr(STACK, name), rel=1e-4 + noise)
        if noise:
            assert found.intervals[name].lower < getattr(found.stack, name) < found.intervals[name].upper
    assert found.charge_per_elongation.value == approx(12.0, rel=1e-4 + noise)
    assert found.residual_rms == approx(noise * np.sqrt(2), rel=0.1, abs=1e-6)  # of a real and an imaginary part
    assert found.stack.stack_mass == STACK.stack_mass


def test_masses_a_tenth_too_heavy_make_the_stack_a_tenth_too_stiff() -> None:
    def heavier(stack: PiezoStack) -> Structure:
        structure = in_tribometer(stack)
        return replace(structure, mass_matrix=1.1 * structure.mass_matrix)

    found = fit_stack(measured(0.0), STACK, in_structure=heavier)
    assert found.stack.stack_stiffness == approx(2.2e9, rel=2e-3)


def test_a_sweep_far_below_the_resonance_hardly_determines_the_stiffness() -> None:
    f = np.linspace(1e3, 2e3, 41)
    scatter = 0.01 * (np.random.default_rng(2).standard_normal((2, 41)).T @ np.array([1, 1j]))
    low = ImpedanceSpectrum(
        frequency=f, impedance=np.exp(scatter) / electrical_admittance(in_tribometer(STACK), frequency=f)
    )
    found = fit_stack(low, STACK, in_structure=in_tribometer)
    assert any("hardly determined" in caveat for caveat in found.caveats)
