"""Forward model of a pin-on-disc rig in a test stated in Python, beside those that files of facts state."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from sonolube.facts.published import si_value
from sonolube.identification import Conditions, ForwardModel, Observation, parametric_structure, structure_model
from sonolube.models.actuator import PiezoStack
from sonolube.models.contact import decay_length
from sonolube.models.dynamics.chain import chain_structure, pin_on_disc_chain
from sonolube.models.dynamics.structure import Structure
from sonolube.validation.contacts import wear_contact
from sonolube.validation.tribometer import tribometer_stack

GRAVITY = 9.80665  # m/s2
REFERENCE = {
    "tip_mass": 1.0,
    "reaction_mass": 1.0,
    "arm_mass": 1.0,
    "arm_stiffness": 1e6,
    "arm_damping": 1e3,
    "tip_damping": 1e3,
}
OBSERVED = (
    "electrical_resonance",
    "resonance_quality_factor",
    "resonance_settling_time",
    "amplitude_per_volt",
    "dissipated_power",
    "resonance_amplitude_ratio",
    "residual_frequency",
    "residual_settling_time",
    "residual_fraction",
    "arm_mass",
)


@dataclass(frozen=True, kw_only=True, slots=True)
class PinOnDiscTest:
    """Stack of a pin-on-disc tribometer, how it was driven and loaded, and the mass hung on its arm."""

    stack: PiezoStack
    frequency: float
    voltage_peak_to_peak: float
    normal_load: float
    decay_length: float
    settling_time: float
    added_mass: float


def pin_on_disc_model(test: PinOnDiscTest) -> ForwardModel:
    """Forward model of the pin-on-disc chain in a test."""
    conditions = Conditions(
        frequency=test.frequency,
        voltage_peak_to_peak=test.voltage_peak_to_peak,
        normal_load=test.normal_load,
        decay_length=test.decay_length,
        observation_time=test.settling_time,
    )
    observations = {name: Observation(observable=name, conditions=conditions) for name in OBSERVED}
    observations["mass_ratio"] = Observation(observable="reaction_mass/tip_mass")
    observations["residual_frequency_with_added_mass"] = Observation(
        observable="residual_frequency", conditions=replace(conditions, added_mass=test.added_mass, added_to="arm_mass")
    )

    def build(parameters: Mapping[str, float]) -> Structure:
        return chain_structure(pin_on_disc_chain(test.stack, **parameters))

    return structure_model(parametric_structure(build, reference=REFERENCE), observations)


def tribometer_test() -> PinOnDiscTest:
    """Stack of the tribometer as printed, with its drive and load."""
    load = si_value("table-3.2-normal_load-1")
    load_of_most_arm_vibration = (si_value("4.1.2-peak-load-1") + si_value("4.1.2-peak-load-2")) / 2
    return PinOnDiscTest(
        stack=tribometer_stack(),
        frequency=si_value("4.1.1-frequency"),
        voltage_peak_to_peak=si_value("table-4.1-voltage_peak_to_peak-15"),
        normal_load=load,
        decay_length=float(decay_length(wear_contact())),
        settling_time=si_value("3.3.4-settling-time"),
        added_mass=(load_of_most_arm_vibration - load) / GRAVITY,
    )
