"""Forward model of a pin-on-disc tribometer: the chain of tip, stack, reaction mass and arm, and its observables."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from sonolube.checks import require_non_negative, require_positive
from sonolube.identification.fact import ForwardModel
from sonolube.identification.observation import Observation, structure_model
from sonolube.identification.small_vibration import Conditions
from sonolube.identification.structure_parametrisation import parametric_structure
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics import Structure, chain_structure, pin_on_disc_chain

_REFERENCE = {
    "tip_mass": 1.0,
    "reaction_mass": 1.0,
    "arm_mass": 1.0,
    "arm_stiffness": 1e6,
    "arm_damping": 1e3,
    "tip_damping": 1e3,
}
_OBSERVED = (
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
    """Stack of a pin-on-disc tribometer, and how it was driven and loaded.

    Parameters
    ----------
    stack : PiezoStack
        The actuator between tip and reaction mass.
    frequency : float
        Drive frequency. [Hz]
    voltage_peak_to_peak : float
        Drive voltage at which the power is evaluated. [V]
    normal_load : float
        Load on the contact. [N]
    decay_length : float
        Decay length of the contact force; the contact stiffness is load over decay length. [m]
    settling_time : float
        Time after the start of the drive at which the residual oscillation is evaluated. [s]
    added_mass : float
        Mass hung on the arm for a second observation of it, whose weight adds to the load. [kg]

    Raises
    ------
    InvalidInput
        If a value is not positive, or the added mass negative.
    """

    stack: PiezoStack
    frequency: float
    voltage_peak_to_peak: float
    normal_load: float
    decay_length: float
    settling_time: float
    added_mass: float

    def __post_init__(self) -> None:
        require_positive(
            frequency=self.frequency,
            voltage_peak_to_peak=self.voltage_peak_to_peak,
            normal_load=self.normal_load,
            decay_length=self.decay_length,
            settling_time=self.settling_time,
        )
        require_non_negative(added_mass=self.added_mass)


def pin_on_disc_model(test: PinOnDiscTest) -> ForwardModel:
    """Forward model of the pin-on-disc chain in a test.

    Parameters
    ----------
    test : PinOnDiscTest

    Returns
    -------
    callable
        Takes a mapping of `tip_mass`, `reaction_mass`, `arm_mass`, `arm_stiffness`, `arm_damping` and `tip_damping`
        to an array of shape (n,) each, and returns one of arrays of that shape, by the names of the observables
        `electrical_resonance`, `resonance_quality_factor`, `resonance_settling_time`, `amplitude_per_volt`,
        `dissipated_power`, `resonance_amplitude_ratio`, `residual_frequency`, `residual_settling_time` and
        `residual_fraction`, and `residual_frequency_with_added_mass`, `mass_ratio` (reaction mass over tip mass) and
        `arm_mass`.

    Raises
    ------
    InvalidInput
        By the callable, if a parameter is missing or not one of these.
    """
    conditions = Conditions(
        frequency=test.frequency,
        voltage_peak_to_peak=test.voltage_peak_to_peak,
        normal_load=test.normal_load,
        decay_length=test.decay_length,
        observation_time=test.settling_time,
    )
    observations = {name: Observation(observable=name, conditions=conditions) for name in _OBSERVED}
    observations["mass_ratio"] = Observation(observable="reaction_mass/tip_mass")
    observations["residual_frequency_with_added_mass"] = Observation(
        observable="residual_frequency", conditions=replace(conditions, added_mass=test.added_mass, added_to="arm_mass")
    )

    def build(parameters: Mapping[str, float]) -> Structure:
        return chain_structure(pin_on_disc_chain(test.stack, **parameters))

    return structure_model(parametric_structure(build, reference=_REFERENCE), observations)
