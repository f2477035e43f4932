"""The modified tribometer as a rig, from published tables and what their facts leave of the unprinted structure."""

from dataclasses import replace

from sonolube.actuator.drive import Drive
from sonolube.dynamics import chain_structure, pin_on_disc_chain
from sonolube.friction import FRICTION_MODELS
from sonolube.rig.driven_rig import DrivenRig
from sonolube.validation.contacts import steel_on_steel_contact, wear_contact
from sonolube.validation.inputs import exact, in_table, said
from sonolube.validation.tribometer import tribometer_stack

IDENTIFIED = {
    "tip_mass": 0.1093,
    "reaction_mass": 2.41,
    "arm_mass": 0.602,
    "arm_stiffness": 4.56e5,
    "arm_damping": 90.0,
    "tip_damping": 702.0,
}
"""What `tribometer_identification` finds, in SI, rounded; the search takes half a minute."""

IDENTIFIED_NOTE = "Masses, springs and dampers of D 3.3.1 are not printed; they are identified from published facts"
"""What rests on them says so."""


def tribometer_rig(*, friction_model: str = "asperity_stick_slip") -> DrivenRig:
    """Return the tribometer of section 2.3 as the multi-scale model of section 3.3 takes it, driven as in the tests.

    Parameters
    ----------
    friction_model : str
        Name of the friction model.

    Returns
    -------
    DrivenRig
    """
    stack, load = tribometer_stack(), exact(in_table("2.2", "normal_load")).value
    voltage = 2 * said("A.3.1.3-voltage-amplitude").value * said("A.3.1.5-gain").value
    return DrivenRig(
        title="Modified pin-on-disc tribometer",
        source="D Tables 2.2, 2.3, 3.2 and 3.5, appendix A",
        contact=wear_contact(),
        normal_load=load,
        friction_coefficient=in_table("2.3", "friction_force").value / load,
        sliding_speed=in_table("2.3", "sliding_speed").value,
        vibration_amplitude=said("2.3.1-amplitude").value,
        drive=Drive(frequency=said("4.1.1-frequency").value, voltage_peak_to_peak=voltage, voltage_offset=voltage / 2),
        capacitance=stack.free_capacitance,
        stack=stack,
        structure=chain_structure(pin_on_disc_chain(stack, **IDENTIFIED)),
        friction_model=FRICTION_MODELS[friction_model](),
        assumptions={"structure": IDENTIFIED_NOTE},
    )


def plate_rig() -> DrivenRig:
    """Return the tribometer with the uncoated steel plates of section 4.1, as its example test runs it.

    Returns
    -------
    DrivenRig
    """
    rig, highest = tribometer_rig(), in_table("4.1", "voltage_peak_to_peak", 14).value
    return replace(
        rig,
        title="Tribometer with uncoated steel plates",
        source="D Tables 4.1 and 4.2",
        contact=steel_on_steel_contact(nominal_area=in_table("4.1", "nominal_area").value),
        friction_coefficient=said("4.1.2-friction-off").value / said("4.1.2-normal-load").value,
        normal_load=said("4.1.2-normal-load").value,
        sliding_speed=said("4.1.2-sliding-speed").value,
        drive=replace(rig.drive, voltage_peak_to_peak=highest, voltage_offset=highest / 2),
    )
