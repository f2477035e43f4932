"""Observables of structures of any kind, against closed forms and the dynamics room."""

import math
from collections.abc import Mapping

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification import (
    OBSERVABLES,
    Conditions,
    Fact,
    Observation,
    StructureBuilder,
    identify,
    observable_named,
    observable_unit,
    parametric_structure,
    reference_parameters,
    structure_model,
)
from sonolube.models.actuator import PiezoStack, circuit_resonances
from sonolube.models.dynamics import (
    GROUND,
    Damper,
    LumpedChain,
    Structure,
    chain_structure,
    drive_receptance,
    electrical_admittance,
    equivalent_circuit,
    modal_structure,
    modes,
    pin_on_disc_chain,
    static_contact,
    with_contact_spring,
)

STACK = PiezoStack(free_capacitance=360e-9, free_stroke_per_volt=6e-9, stack_stiffness=2e9, stack_damping=30.0)
CONDITIONS = Conditions(
    frequency=15e3, voltage_peak_to_peak=20.0, normal_load=3.0, decay_length=2e-6, observation_time=1e-3
)


def transducer(parameters: Mapping[str, float]) -> Structure:
    """Build three modes of a transducer that is held, of which the second draws the most current."""
    return modal_structure(
        frequencies=[8e3, parameters["frequency"], 31e3],
        damping_ratios=[0.02, parameters["damping_ratio"], 0.01],
        drive_participation=[1.0, 30.0, 5.0],
        contact_participation=[0.5, 2.0, -1.0],
        clamped_capacitance=200e-9,
    )


def mounted_stack(parameters: Mapping[str, float]) -> Structure:
    """Build a stack on the ground that carries one damped mass."""
    return chain_structure(
        LumpedChain(
            masses={"head": parameters["tip_mass"]},
            springs=(),
            dampers=(Damper(between=("head", GROUND), viscous_damping=parameters["tip_damping"]),),
            stack=STACK,
            stack_between=("head", GROUND),
            contact="head",
        )
    )


def floating_chain(parameters: Mapping[str, float]) -> Structure:
    return chain_structure(
        pin_on_disc_chain(
            STACK, tip_mass=parameters["tip_mass"], reaction_mass=0.5, arm_mass=0.6, arm_stiffness=2e5, arm_damping=20.0
        )
    )


CASES: list[tuple[StructureBuilder, dict[str, float]]] = [
    (transducer, {"frequency": 20e3, "damping_ratio": 0.004}),
    (mounted_stack, {"tip_mass": 0.2, "tip_damping": 120.0}),
    (floating_chain, {"tip_mass": 0.2}),
]
KINDS = pytest.mark.parametrize(("build", "values"), CASES, ids=["modes", "mounted stack", "floating chain"])


def observed(
    observable: str, build: StructureBuilder, values: Mapping[str, float], conditions: Conditions = CONDITIONS
) -> float:
    model = structure_model(
        parametric_structure(build, reference=values), {"it": Observation(observable=observable, conditions=conditions)}
    )
    return float(model({name: np.array([value]) for name, value in values.items()})["it"][0])


@KINDS
def test_resonance_and_antiresonance_are_those_of_the_strongest_branch(
    build: StructureBuilder, values: dict[str, float]
) -> None:
    # the equivalent circuit has the exact resonances of one mode, those of several to the coupling between them
    circuit = circuit_resonances(equivalent_circuit(build(values)))
    strongest = int(np.argmax(circuit.coupling_factor))
    resonance = observed("electrical_resonance", build, values)
    antiresonance = observed("electrical_antiresonance", build, values)
    assert resonance == approx(float(circuit.series_frequency[strongest]), rel=1e-9)
    assert antiresonance == approx(float(circuit.parallel_frequency[strongest]), rel=2e-3)
    coupling = observed("effective_coupling_factor", build, values)
    assert coupling == approx(math.sqrt(1 - (resonance / antiresonance) ** 2), rel=1e-9)


@KINDS
def test_without_losses_admittance_is_largest_at_resonance_and_least_at_antiresonance(
    build: StructureBuilder, values: dict[str, float]
) -> None:
    structure = build(values)
    for name, sign in (("electrical_resonance", 1), ("electrical_antiresonance", -1)):
        at = observed(name, build, values)
        frequency = at * np.linspace(0.98, 1.02, 2001)
        magnitude = np.abs(electrical_admittance(structure, frequency=frequency))
        assert frequency[np.argmax(sign * magnitude)] == approx(at, rel=1e-3), name


def test_the_coupling_factor_of_a_mounted_stack_is_that_of_the_stack() -> None:
    # one mass and the whole stack in series: f_p^2/f_s^2 = C_T/C_S
    coupling = observed("effective_coupling_factor", *CASES[1])
    assert coupling == approx(STACK.derived_coupling_factor, rel=1e-9)


@KINDS
def test_natural_frequencies_are_those_of_the_modes_without_rigid_ones(
    build: StructureBuilder, values: dict[str, float]
) -> None:
    natural = modes(build(values))
    vibrating = natural.natural_frequency[~natural.rigid]
    for number, expected in enumerate(vibrating, start=1):
        assert observed(f"natural_frequency_{number}", build, values) == approx(float(expected), rel=1e-9)
    loaded = modes(with_contact_spring(build(values), normal_stiffness=1.5e6)).natural_frequency
    assert observed("loaded_natural_frequency_1", build, values) == approx(float(loaded[0]), rel=1e-9)
    with raises(InvalidInput, match=f"the structure has fewer than {vibrating.size + 1} vibration modes"):
        observed(f"natural_frequency_{vibrating.size + 1}", build, values)


def test_the_quality_factor_of_a_mode_is_one_over_twice_its_damping_ratio() -> None:
    build, values = CASES[0]
    assert observed("quality_factor_1", build, values) == approx(25.0, rel=1e-9)
    assert observed("quality_factor_2", build, values) == approx(125.0, rel=1e-9)
    assert observed("resonance_quality_factor", build, values) == approx(125.0, rel=1e-9)
    # exp(-zeta omega t) is 2 %
    assert observed("resonance_settling_time", build, values) == approx(
        math.log(50) / (0.004 * 2 * math.pi * 20e3), rel=1e-9
    )


def test_an_undamped_mode_has_a_finite_quality_factor_and_settling_time() -> None:
    build, values = CASES[0]
    undamped = {**values, "damping_ratio": 1e-30}
    assert 1e12 < observed("quality_factor_2", build, undamped) < math.inf
    assert 1e6 < observed("resonance_settling_time", build, undamped) < math.inf


@KINDS
def test_the_amplitude_per_volt_is_half_the_receptance(build: StructureBuilder, values: dict[str, float]) -> None:
    receptance = float(np.abs(drive_receptance(build(values), frequency=15e3)))
    assert observed("amplitude_per_volt", build, values) == approx(receptance / 2, rel=1e-9)


@KINDS
def test_the_dissipated_power_is_that_of_the_conductance(build: StructureBuilder, values: dict[str, float]) -> None:
    conductance = float(electrical_admittance(build(values), frequency=15e3).real)
    assert observed("dissipated_power", build, values) == approx(conductance * 10.0**2 / 2, rel=1e-6)


def test_the_static_displacement_of_a_mounted_stack_is_its_free_stroke() -> None:
    # the body in front of the stack moves away from it, towards the other surface
    found = observed("static_displacement_per_volt", *CASES[1])
    assert found == approx(-6e-9, rel=1e-9)
    build, values = CASES[0]
    expected = static_contact(build(values)).displacement_per_volt
    assert observed("static_displacement_per_volt", build, values) == approx(expected, rel=1e-9)


def test_a_floating_structure_has_no_static_displacement() -> None:
    with raises(InvalidInput, match="floats with its contact free: no static displacement is defined"):
        observed("static_displacement_per_volt", *CASES[2])


def test_frequency_and_damping_of_a_mode_are_identified_from_its_amplitude_and_settling() -> None:
    build, truth = CASES[0]
    observables = {
        "electrical_resonance": Conditions(),
        "amplitude_per_volt": Conditions(frequency=20e3),
        "resonance_settling_time": Conditions(),
    }
    observations = {name: Observation(observable=name, conditions=each) for name, each in observables.items()}
    bounds = {"frequency": (19e3, 21e3), "damping_ratio": (1e-3, 1e-1)}
    model = structure_model(
        parametric_structure(build, reference=reference_parameters(build, bounds=bounds)), observations
    )
    exact = {name: float(each[0]) for name, each in model({n: np.array([v]) for n, v in truth.items()}).items()}
    facts = [Fact(name=name, value=value, tolerance=1e-3 * value, rank=1) for name, value in exact.items()]
    found = identify(model, facts=facts, bounds=bounds)
    assert found.satisfied == set(observables)
    for name, estimate in found.estimates.items():
        assert estimate.value == approx(truth[name], rel=1e-4)
        assert estimate.lower <= truth[name] <= estimate.upper


def test_a_parameter_and_a_ratio_of_two_can_be_observed_themselves() -> None:
    build, values = CASES[1]
    assert observed("tip_mass", build, values) == 0.2
    assert observed("tip_damping/tip_mass", build, values) == approx(600.0)
    assert observable_unit("tip_mass", values) == "kg"
    assert observable_unit("arm_mass/tip_mass", {"arm_mass": 1, "tip_mass": 1}) == ""
    with raises(
        InvalidInput, match=r"tip_damping/tip_mass is a ratio of N s/m and kg; take two parameters of one unit"
    ):
        observable_unit("tip_damping/tip_mass", values)


@pytest.mark.parametrize("name", [name for name, observable in OBSERVABLES.items() if observable.requires])
def test_a_missing_condition_is_refused_by_name(name: str) -> None:
    missing = OBSERVABLES[name].requires[0]
    with raises(InvalidInput, match=f"fact it: {name} requires the condition {missing}; give it"):
        observed(name, *CASES[2], conditions=Conditions())


def test_conditions_are_checked_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must be positive, got -1\.0 N"):
        Conditions(normal_load=-1.0)
    with raises(InvalidInput, match="added_to must name the free parameter to which added_mass adds"):
        Conditions(added_mass=1.0)
    with raises(UnknownName, match=r"unknown free parameter 'arm_mas'; known: tip_mass"):
        observed("tip_mass", *CASES[2], conditions=Conditions(added_mass=1.0, added_to="arm_mas"))


@pytest.mark.parametrize("name", ["natural_frequency", "natural_frequency_0", "quality_factor_x"])
def test_an_observable_of_no_mode_is_refused(name: str) -> None:
    with raises(UnknownName, match=f"unknown observable '{name}'"):
        observable_named(name)


def test_an_unknown_observable_is_refused_with_the_closest_name() -> None:
    with raises(UnknownName, match=r"unknown observable 'electrical_resonanse'; did you mean electrical_resonance\?"):
        observed("electrical_resonanse", *CASES[2])
