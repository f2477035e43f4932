"""Parameters of the tribometer that are not printed, identified from published facts."""

import math

import pytest
from pytest import approx
from tests.identified import identified_tribometer
from tests.pin_on_disc import tribometer_test
from tests.same import same

from sonolube.facts.published import ComputedValue, PrintedNumber, propagate_rounding, published_number, si_value
from sonolube.identification import Identification
from sonolube.models.contact import decay_length
from sonolube.validation.contacts import wear_contact
from sonolube.validation.tribometer import IDENTIFIED, tribometer_problem, tribometer_stack

PROBLEM = tribometer_problem()
FACTS = {fact.name: fact for fact in PROBLEM.facts}
GRAVITY = 9.80665  # m/s2


@pytest.fixture(scope="module")
def found() -> Identification:
    return identified_tribometer()


def test_facts_are_the_printed_numbers() -> None:
    assert FACTS["electrical_resonance"].value == 22e3
    assert FACTS["amplitude_per_volt"].value == approx(0.0892e-6, rel=1e-3)
    assert FACTS["residual_frequency"].value == 100
    assert FACTS["residual_settling_time"].value == 0.05
    assert FACTS["resonance_quality_factor"].value == approx(482, rel=1e-3)
    assert tribometer_stack().derived_coupling_factor == approx(0.647, abs=5e-4)
    assert tribometer_test().decay_length == approx(2e-6)


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("electrical_resonance", published_number("4.1.1-frequency")),
        (
            "amplitude_per_volt",
            propagate_rounding(
                lambda amplitude, voltage: amplitude / voltage,
                "table-4.1-vibration_amplitude-15",
                "table-4.1-voltage_peak_to_peak-15",
            ),
        ),
        (
            "resonance_quality_factor",
            propagate_rounding(
                lambda stiffness, frequency, damping: stiffness / (2 * math.pi * frequency * damping),
                "table-3.5-stack_stiffness-1",
                "4.1.1-frequency",
                "table-3.5-stack_damping-1",
            ),
        ),
    ],
)
def test_a_fact_of_printed_numbers_has_their_value_and_their_rounding_for_its_tolerance(
    name: str, printed: PrintedNumber | ComputedValue
) -> None:
    assert FACTS[name].value == printed.value
    same(FACTS[name].tolerance, (printed.high - printed.low) / 2)


def test_the_other_facts_are_the_printed_numbers_within_tolerances_that_their_reading_leaves() -> None:
    power, settling = published_number("table-4.1-actuator_power-15"), si_value("3.3.4-settling-time")
    hung, heaviest = si_value("A.3.1.1-weight") / GRAVITY, 1.0
    expected = {
        "resonance_amplitude_ratio": (">=", 1.0, 1 - 0.5**0.5),
        "mass_ratio": (">=", 10.0, 5.0),
        "dissipated_power": ("<=", power.value, power.rounding_half_width),
        "resonance_settling_time": ("=", settling, settling / 2),
        "residual_settling_time": ("=", settling, settling / 2),
        "residual_frequency": ("=", si_value("3.3.4-residual-frequency"), 20.0),
        "residual_fraction": (">=", 0.5, 0.25),
        "residual_frequency_with_added_mass": ("=", si_value("4.1.2-arm-frequency"), 20.0),
        "arm_mass": ("=", (hung + heaviest) / 2, (heaviest - hung) / 2),
    }
    same({name: (FACTS[name].relation, FACTS[name].value, FACTS[name].tolerance) for name in expected}, expected)


def test_the_facts_are_observed_under_the_printed_conditions() -> None:
    conditions = PROBLEM.observations["amplitude_per_volt"].conditions
    assert conditions.frequency == si_value("4.1.1-frequency")
    assert conditions.voltage_peak_to_peak == si_value("table-4.1-voltage_peak_to_peak-15")
    assert conditions.normal_load == si_value("table-3.2-normal_load-1")
    same(conditions.decay_length, float(decay_length(wear_contact())))
    assert conditions.observation_time == si_value("3.3.4-settling-time")
    added = PROBLEM.observations["residual_frequency_with_added_mass"].conditions.added_mass
    same(added, tribometer_test().added_mass)


def test_the_amplitude_at_28_volts_is_the_same_amplitude_per_volt() -> None:
    # 3 V amplitude times a gain of 4.67 gives 28.02 V peak to peak; 2.5 um is printed to 0.05 um
    assert abs(FACTS["amplitude_per_volt"].value * 28.02 - 2.5e-6) < 0.05e-6


@pytest.mark.slow
def test_the_printed_damping_cannot_give_the_measured_amplitude_at_resonance_behind_a_large_reaction_mass(
    found: Identification,
) -> None:
    # at resonance Q = 482 would move the tip by 0.00868 um/V * 482 / 2 = 2.1 um per volt peak to peak, not 0.0892
    measured = {"mass_ratio", "resonance_amplitude_ratio", "amplitude_per_volt"}
    assert frozenset(measured | {"resonance_quality_factor"}) in found.conflicts
    assert frozenset(measured | {"resonance_settling_time"}) in found.conflicts


@pytest.mark.slow
def test_the_measured_amplitude_at_resonance_costs_more_than_the_stated_power(found: Identification) -> None:
    # the stack's force in phase with its velocity: half of 12.95 V * 17.36 N/V * 0.334 m/s is 37.5 W, not 5.31 W
    assert frozenset({"dissipated_power", "resonance_amplitude_ratio", "amplitude_per_volt"}) in found.conflicts
    velocity = 2.31e-6 * 2 * math.pi * 22e3 * (1 + found.estimates["tip_mass"].value / (0.07 + 2.4057))
    assert found.observed["dissipated_power"] == approx(12.95 * 8.68e-9 * 2e9 * velocity / 2, rel=0.01)


@pytest.mark.slow
def test_what_settles_in_time_cannot_stay(found: Identification) -> None:
    assert frozenset({"residual_settling_time", "residual_fraction"}) in found.conflicts
    assert math.exp(-math.log(50) * 0.05 / 0.075) < 0.25  # left after 0.05 s at the slowest settling that agrees


@pytest.mark.slow
def test_no_single_fact_explains_every_conflict_and_the_tuning_explains_all_but_the_arms(found: Identification) -> None:
    assert not any(all(name in conflict for conflict in found.conflicts) for name in FACTS)
    others = set(found.conflicts) - {frozenset({"residual_settling_time", "residual_fraction"})}
    assert all("resonance_amplitude_ratio" in conflict for conflict in others)
    given_up = [set(FACTS) - reading.satisfied for reading in found.consistent_fits]
    assert {"resonance_amplitude_ratio", "residual_fraction"} in given_up


@pytest.mark.slow
def test_the_rig_keeps_what_was_measured(found: Identification) -> None:
    assert {fact.name for fact in found.facts if fact.rank == 1} <= found.satisfied
    assert all(abs(found.consistent_fits[0].residuals[name]) <= 1 for name in found.satisfied)
    mass = {name: estimate.value for name, estimate in found.estimates.items()}
    behind = mass["reaction_mass"] + 0.07
    effective = mass["tip_mass"] * behind / (mass["tip_mass"] + behind)
    assert effective == approx(0.1047, rel=1e-3)  # of two masses on 2e9 N/m at 22 kHz
    # gain over the free stroke of half the voltage, shared between tip and reaction mass
    gain = FACTS["amplitude_per_volt"].value * 2 / 8.68e-9 * (mass["tip_mass"] + behind) / behind
    assert found.observed["resonance_quality_factor"] == approx(gain, rel=0.02)


@pytest.mark.slow
def test_the_arms_damping_is_not_to_be_had_from_the_facts(found: Identification) -> None:
    damping = found.estimates["arm_damping"]
    assert damping.lower_is_bound
    assert damping.upper_is_bound
    assert found.unidentifiable_directions[0].exponents["arm_damping"] == approx(1, abs=0.05)


@pytest.mark.slow
def test_the_rounded_parameters_are_those_identified(found: Identification) -> None:
    for name, value in IDENTIFIED.items():
        assert found.estimates[name].value == approx(value, rel=0.01), name
