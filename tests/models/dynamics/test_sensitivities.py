"""Sensitivities of steady vibrations against central differences."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, SteadyStates, steady_state
from sonolube.models.dynamics.kinematic_friction import friction_averages
from sonolube.models.dynamics.sensitivities import StructureChange, steady_state_sensitivities
from sonolube.models.dynamics.structure import Structure

STACK, ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
FLOATING = Structure(
    mass_matrix=np.diag([0.15, 0.35, 0.5]),
    damping_matrix=300.0 * np.outer(STACK, STACK) + 20.0 * np.outer(ARM, ARM),
    stiffness_matrix=2e9 * np.outer(STACK, STACK) + 2e5 * np.outer(ARM, ARM),
    drive_vector=17.36 * STACK,
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=2.093e-7,
)
HELD = replace(FLOATING, stiffness_matrix=FLOATING.stiffness_matrix + np.diag([0.0, 0.0, 3e7]))
SPEEDS = np.array([0.05, 0.3])
DRIVE = {
    "normal_load": np.array([5.0, 60.0]),
    "frequency": np.array([23e3, 9e3]),
    "voltage_harmonics": np.array([[8.0], [60.0]], dtype=complex),
    "voltage_offset": np.array([3.0, -5.0]),
}
LAWS: dict[str, GapLaw] = {
    "rough": ExponentialGap(decay_length=2e-6, force_damping=0.1),
    "ball": HertzGap(tip_radius=2e-3, effective_modulus=60e9),
    "spring": LinearGap(normal_stiffness=4e6),
}
CHANGES = {
    "stack_stiffness": StructureChange(stiffness_matrix=2e9 * np.outer(STACK, STACK)),
    "stack_damping": StructureChange(damping_matrix=300.0 * np.outer(STACK, STACK)),
    "tip_mass": StructureChange(mass_matrix=np.diag([0.15, 0.0, 0.0])),
    "stroke": StructureChange(drive_vector=17.36 * STACK),
    "lever": StructureChange(contact_vector=np.array([0.1, 0.05, 0.0])),
}


def moved(structure: Structure, change: StructureChange, share: float) -> Structure:
    def add(whole: NDArray[np.float64], part: NDArray[np.float64] | None) -> NDArray[np.float64]:
        return whole if part is None else whole + share * part

    return replace(
        structure,
        mass_matrix=add(structure.mass_matrix, change.mass_matrix),
        damping_matrix=add(structure.damping_matrix, change.damping_matrix),
        stiffness_matrix=add(structure.stiffness_matrix, change.stiffness_matrix),
        drive_vector=add(structure.drive_vector, change.drive_vector),
        contact_vector=add(structure.contact_vector, change.contact_vector),
    )


def solve(structure: Structure, gap_law: GapLaw, **drive: NDArray[np.float64]) -> SteadyStates:
    return steady_state(structure, gap_law, minimum_harmonics=24, stability=False, **(DRIVE | drive))  # type: ignore[arg-type]


def compare(
    name: str,
    structure: Structure,
    gap_law: GapLaw,
    varied: Callable[[float], SteadyStates],
    unit: NDArray[np.float64] | float,
) -> None:
    """Compare with central differences in fractions of a unit, extrapolated to a step of zero."""

    def differences(step: float) -> list[NDArray[np.float64]]:
        up, down = varied(step), varied(-step)
        friction = [friction_averages(states, sliding_speed=SPEEDS).kinematic for states in (up, down)]
        pairs = (
            (up.vibration_amplitude, down.vibration_amplitude),
            (up.mean_displacement, down.mean_displacement),
            (friction[0], friction[1]),
        )
        return [(one - other) / (2 * step) for one, other in pairs]

    found = steady_state_sensitivities(solve(structure, gap_law), sliding_speed=SPEEDS, structure_changes=CHANGES)
    amplitude, mean, kinematic = (
        (4 * fine - coarse) / 3 for coarse, fine in zip(differences(2e-4), differences(1e-4), strict=True)
    )
    assert found.vibration_amplitude[name] * unit == approx(amplitude, rel=1e-6, abs=1e-13)
    assert found.mean_displacement[name] * unit == approx(mean, rel=1e-6, abs=1e-13)
    assert approx(kinematic, rel=1e-6, abs=1e-7) == (found.kinematic[name].T * unit).T


@pytest.mark.parametrize("structure", [FLOATING, HELD], ids=["floating", "held"])
@pytest.mark.parametrize("name", CHANGES)
def test_sensitivities_to_the_structure_are_central_differences(structure: Structure, name: str) -> None:
    law = LAWS["rough"]
    compare(name, structure, law, lambda step: solve(moved(structure, CHANGES[name], step), law), 1.0)


@pytest.mark.parametrize("structure", [FLOATING, HELD], ids=["floating", "held"])
@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("normal_load", DRIVE["normal_load"]),
        ("frequency", DRIVE["frequency"]),
        ("voltage_scale", 1.0),
        ("voltage_offset", 1.0),
    ],
)
def test_sensitivities_to_load_and_drive_are_central_differences(
    structure: Structure, name: str, unit: NDArray[np.float64] | float
) -> None:
    law = LAWS["rough"]

    def varied(step: float) -> SteadyStates:
        if name == "voltage_scale":
            return solve(structure, law, voltage_harmonics=DRIVE["voltage_harmonics"] * (1 + step))
        return solve(structure, law, **{name: DRIVE[name] + step * unit})

    compare(name, structure, law, varied, unit)


@pytest.mark.parametrize(
    ("law", "name"),
    [
        ("rough", "decay_length"),
        ("rough", "force_damping"),
        ("ball", "tip_radius"),
        ("ball", "effective_modulus"),
        ("spring", "normal_stiffness"),
    ],
)
def test_sensitivities_to_the_contact_law_are_central_differences(law: str, name: str) -> None:
    gap_law, drive = LAWS[law], DRIVE
    if law != "rough":
        # a contact that never opens, whose force is smooth
        drive = DRIVE | {"voltage_harmonics": DRIVE["voltage_harmonics"] * 0.01}
    value = getattr(gap_law, name)

    def varied(step: float) -> SteadyStates:
        changed = replace(gap_law, **{name: value * (1 + step)})  # type: ignore[type-var]
        return steady_state(HELD, changed, minimum_harmonics=24, stability=False, **drive)  # type: ignore[arg-type]

    found = steady_state_sensitivities(varied(0.0), sliding_speed=SPEEDS)
    up, down = varied(1e-4), varied(-1e-4)
    difference = (up.vibration_amplitude - down.vibration_amplitude) / 2e-4
    assert found.vibration_amplitude[name] * value == approx(difference, rel=3e-6, abs=1e-14)
    difference = (up.mean_displacement - down.mean_displacement) / 2e-4
    assert found.mean_displacement[name] * value == approx(difference, rel=3e-6, abs=1e-14)


def test_a_parameter_name_that_is_taken_is_refused() -> None:
    with raises(InvalidInput, match="must not be named 'frequency', which is taken"):
        steady_state_sensitivities(solve(FLOATING, LAWS["rough"]), structure_changes={"frequency": StructureChange()})
