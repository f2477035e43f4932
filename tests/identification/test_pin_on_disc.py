"""Observables of the pin-on-disc chain against closed forms, the dynamics room and a transient integrated in time."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises
from scipy.linalg import expm
from tests.pin_on_disc import PinOnDiscTest, pin_on_disc_model

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification import Conditions, Fact, identify
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.chain import chain_structure, pin_on_disc_chain
from sonolube.models.dynamics.linear import poles
from sonolube.models.dynamics.structure import Structure, drive_receptance, electrical_admittance, with_contact_spring

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=8.68e-9, stack_stiffness=2e9, stack_mass=0.07, stack_damping=30.0
)
TEST = PinOnDiscTest(
    stack=STACK,
    frequency=22e3,
    voltage_peak_to_peak=25.9,
    normal_load=3.0,
    decay_length=2e-6,
    settling_time=0.05,
    added_mass=0.357,
)
RIG = {
    "tip_mass": 0.15,
    "reaction_mass": 0.28,
    "arm_mass": 0.5,
    "arm_stiffness": 2e5,
    "arm_damping": 20.0,
    "tip_damping": 1e-9,
}


def observed(test: PinOnDiscTest = TEST, **changes: float) -> dict[str, float]:
    values = pin_on_disc_model(test)({name: np.array([value]) for name, value in {**RIG, **changes}.items()})
    return {name: float(each[0]) for name, each in values.items()}


def structure(**changes: float) -> Structure:
    return chain_structure(pin_on_disc_chain(STACK, **{**RIG, **changes}))


def state_matrix(rig: Structure) -> Floats:
    n = rig.coordinates
    inverse = np.linalg.inv(rig.mass_matrix)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ rig.stiffness_matrix, -inverse @ rig.damping_matrix]])


def test_an_effective_mass_of_105_grams_on_the_printed_stack_resonates_at_22_kilohertz() -> None:
    effective = 0.15 * 0.35 / (0.15 + 0.35)
    assert effective == approx(0.105)
    assert observed()["electrical_resonance"] == approx(math.sqrt(2e9 / effective) / (2 * math.pi), rel=1e-4)
    assert observed()["electrical_resonance"] == approx(22e3, rel=2e-3)


def test_the_resonance_is_where_conductance_peaks() -> None:
    frequency = np.linspace(21.5e3, 22.5e3, 20001)
    conductance = electrical_admittance(structure(tip_damping=500.0), frequency=frequency).real
    peak = frequency[np.argmax(conductance)]
    assert observed(tip_damping=500.0)["electrical_resonance"] == approx(peak, rel=2e-4)


def test_the_printed_damping_alone_gives_a_quality_of_482() -> None:
    # Q = sqrt(k_p m_e)/c_p = k_p/(omega c_p)
    found = observed(arm_damping=1e-6)
    assert found["resonance_quality_factor"] == approx(
        2e9 / (2 * math.pi * found["electrical_resonance"] * 30), rel=1e-4
    )
    assert found["resonance_quality_factor"] == approx(482, rel=3e-3)


def test_the_amplitude_of_the_tip_is_the_receptance_of_the_structure() -> None:
    expected = abs(drive_receptance(structure(), frequency=22e3)) / 2
    assert observed()["amplitude_per_volt"] == approx(float(expected), rel=1e-6)


def test_the_electrical_power_is_the_power_dissipated_by_the_dampers() -> None:
    rig, omega = structure(tip_damping=300.0), 2 * math.pi * 22e3
    dynamic = rig.stiffness_matrix + 1j * omega * rig.damping_matrix - omega**2 * rig.mass_matrix
    velocity = 1j * omega * np.linalg.solve(dynamic, rig.drive_vector * 25.9 / 2)
    heat = float((velocity.conj() @ rig.damping_matrix @ velocity).real) / 2
    assert observed(tip_damping=300.0)["dissipated_power"] == approx(heat, rel=1e-6)


def test_far_below_resonance_the_free_stroke_divides_inversely_to_the_masses() -> None:
    # two free masses: the tip moves by M/(m_1 + M) of the elongation
    found = observed(replace(TEST, frequency=2e3), arm_stiffness=1.0, arm_damping=1e-6)
    share = 0.35 / 0.5
    gain = 1 / (1 - (2e3 / found["electrical_resonance"]) ** 2)
    assert found["amplitude_per_volt"] == approx(8.68e-9 / 2 * share * gain, rel=1e-4)


@pytest.mark.parametrize("detuning", [0.0, 10.0, 300.0])
def test_the_amplitude_off_resonance_is_that_of_an_oscillator(detuning: float) -> None:
    peak = observed()["electrical_resonance"]
    found = observed(replace(TEST, frequency=peak - detuning))
    half_width = peak / (2 * found["resonance_quality_factor"])
    assert found["resonance_amplitude_ratio"] == approx(1 / math.hypot(1, detuning / half_width), rel=1e-2)


def test_the_residual_oscillation_is_that_of_the_structure_on_a_contact_spring() -> None:
    free = poles(with_contact_spring(structure(), normal_stiffness=3.0 / 2e-6))
    arm, slowest = free[0], min(-free[:4].real)
    assert observed()["residual_frequency"] == approx(abs(arm) / (2 * math.pi), rel=1e-6)
    assert observed()["residual_settling_time"] == approx(math.log(50) / slowest, rel=1e-5)
    assert observed()["residual_fraction"] == approx(math.exp(arm.real * 0.05), rel=1e-5)


def test_on_a_stiff_contact_the_arm_oscillates_on_its_own_spring() -> None:
    found = observed(replace(TEST, decay_length=1e-10), arm_damping=1e-6)
    assert found["residual_frequency"] == approx(math.sqrt(2e5 / 0.5) / (2 * math.pi), rel=1e-3)
    assert found["residual_frequency_with_added_mass"] == approx(math.sqrt(2e5 / 0.857) / (2 * math.pi), rel=1e-3)


def test_the_stack_has_settled_to_two_percent_after_its_settling_time() -> None:
    rig = structure(tip_damping=100.0)
    time, period = observed(tip_damping=100.0)["resonance_settling_time"], 1 / 22e3
    start = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])

    def swing(from_time: float) -> float:
        state, step = expm(state_matrix(rig) * from_time) @ start, expm(state_matrix(rig) * period / 200)
        elongation = []
        for _ in range(200):
            elongation.append(float(state[1] - state[0]))
            state = step @ state
        return max(elongation) - min(elongation)

    assert swing(time) / swing(0.0) == approx(0.02, rel=0.02)


def test_parameters_are_recovered_from_the_observables_of_a_known_rig() -> None:
    truth = {**RIG, "tip_damping": 200.0}
    wanted = (
        "electrical_resonance",
        "amplitude_per_volt",
        "resonance_quality_factor",
        "residual_frequency",
        "residual_frequency_with_added_mass",
        "residual_settling_time",
        "arm_mass",
    )
    values = observed(tip_damping=200.0)
    facts = [Fact(name=name, value=values[name], tolerance=1e-3 * values[name], rank=1) for name in wanted]
    bounds = {name: (value / 5, value * 5) for name, value in truth.items()}
    found = identify(pin_on_disc_model(TEST), facts=facts, bounds=bounds)
    assert found.satisfied == set(wanted)
    for name, estimate in found.estimates.items():
        assert estimate.lower <= truth[name] <= estimate.upper, name
        assert estimate.value == approx(truth[name], rel=0.01), name
    assert found.unidentifiable_directions == ()


def test_facts_of_the_stack_alone_do_not_determine_the_arm() -> None:
    values = observed()
    facts = [
        Fact(name=name, value=values[name], tolerance=0.01 * values[name], rank=1)
        for name in ("electrical_resonance", "amplitude_per_volt", "resonance_quality_factor")
    ]
    found = identify(pin_on_disc_model(TEST), facts=facts, bounds={name: (v / 3, v * 3) for name, v in RIG.items()})
    for name in ("arm_mass", "arm_stiffness"):
        estimate = found.estimates[name]
        assert estimate.lower_is_bound, name
        assert estimate.upper_is_bound, name
    assert len(found.unidentifiable_directions) >= 2


@pytest.mark.parametrize(
    "name", ["frequency", "voltage_peak_to_peak", "normal_load", "decay_length", "observation_time"]
)
def test_a_condition_that_is_not_positive_is_refused_by_name(name: str) -> None:
    with raises(InvalidInput, match=f"{name} must be positive"):
        Conditions(**{name: 0.0})  # type: ignore[arg-type]


def test_a_missing_parameter_is_named() -> None:
    with raises(InvalidInput, match=r"parameters must be tip_mass, reaction_mass, .*, got tip_mass"):
        pin_on_disc_model(TEST)({"tip_mass": np.array([0.1])})
