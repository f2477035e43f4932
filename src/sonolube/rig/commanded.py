"""Commanded quantity of a rig: its drive voltage, or its vibration amplitude where it has no voltage."""

from collections.abc import Collection, Hashable
from dataclasses import dataclass
from typing import Any, Final, Literal

from numpy.typing import ArrayLike

from sonolube.charts import Axis
from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.rig.amplitude_source import resolved_vibration
from sonolube.rig.driven_rig import require_drive
from sonolube.rig.record import Rig
from sonolube.units import format_si


@dataclass(frozen=True, kw_only=True, slots=True)
class CommandedQuantity:
    """Quantity that sets the vibration of a rig.

    Parameters
    ----------
    name : {"voltage_peak_to_peak", "vibration_amplitude"}
        Its name in the vocabulary.
    key : str
        Its key in the file of a rig.
    word : str
        Its name in a sentence.
    unit : str
        SI unit.
    qualifier : str
        Extent that is meant: "peak to peak" or "zero to peak".
    axis : Axis
        Of figures.
    axis_scale : float
        Factor from SI to the unit of that axis. []
    """

    name: Literal["voltage_peak_to_peak", "vibration_amplitude"]
    key: str
    word: Literal["voltage", "amplitude"]
    unit: str
    qualifier: str
    axis: Axis
    axis_scale: float

    def text(self, value: float, *, digits: int = 3) -> str:
        """Value with its unit, such as "28 V peak to peak"."""
        return f"{format_si(value, self.unit, digits=digits)} {self.qualifier}"


VOLTAGE: Final = CommandedQuantity(
    name="voltage_peak_to_peak",
    key="drive.voltage_peak_to_peak",
    word="voltage",
    unit="V",
    qualifier="peak to peak",
    axis=Axis(label="Voltage, peak to peak", unit="V"),
    axis_scale=1.0,
)
"""Drive voltage, peak to peak; its offset goes with it in proportion."""

AMPLITUDE: Final = CommandedQuantity(
    name="vibration_amplitude",
    key="vibration.vibration_amplitude",
    word="amplitude",
    unit="m",
    qualifier="zero to peak",
    axis=Axis(label="Vibration amplitude", unit="µm"),
    axis_scale=1e6,
)
"""Amplitude of a sine normal to the contact, zero to peak."""


POWERS: Final = ("actuator_power", "dissipated_power")
"""Numbers of a point that a rig without a voltage does not have."""


def commanded_quantity(rig: Rig) -> CommandedQuantity:
    """Quantity that sets the vibration of a rig: its drive voltage, or its amplitude where it has no voltage.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    CommandedQuantity

    Raises
    ------
    InvalidInput
        If the rig has no amplitude.
    """
    if rig.drive is not None and rig.drive.voltage_peak_to_peak is not None:
        return VOLTAGE
    resolved_vibration(rig)  # refuses a rig without an amplitude
    return AMPLITUDE


def quantity_of_axis(names: Collection[Hashable]) -> CommandedQuantity:
    """Commanded quantity among the axes of a result.

    Parameters
    ----------
    names : collection of str

    Returns
    -------
    CommandedQuantity
    """
    return AMPLITUDE if AMPLITUDE.name in names else VOLTAGE


def own_level(rig: Rig) -> float:
    """Voltage of a rig, or its amplitude where it has no voltage. [V or m]

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the rig has no amplitude.
    """
    if commanded_quantity(rig) is VOLTAGE:
        return require_drive(rig).voltage_peak_to_peak or 0.0
    return resolved_vibration(rig).sine_amplitude or 0.0


def level_settings(rig: Rig, level: ArrayLike) -> dict[str, Any]:
    """Settings of operating points for values of the commanded quantity, by name.

    Parameters
    ----------
    rig : Rig
    level : array_like, any shape
        Voltages, whose offset is in the rig's own ratio to them, or amplitudes. [V or m]

    Returns
    -------
    dict of str to ndarray
        Arguments of `operating_points` and `point_batch`.

    Raises
    ------
    InvalidInput
        If a value is negative or not finite, or the rig has no amplitude.
    """
    quantity = commanded_quantity(rig)
    values = require_non_negative(**{quantity.name: level})
    if quantity is AMPLITUDE:
        return {quantity.name: values}
    return {quantity.name: values, "voltage_offset": _offset(rig, values)}


def require_commanded(rig: Rig, quantity: CommandedQuantity) -> None:
    """Raise if a quantity does not set the vibration of a rig.

    Parameters
    ----------
    rig : Rig
    quantity : CommandedQuantity

    Raises
    ------
    InvalidInput
        If the other one does, or the rig has no amplitude.
    """
    own = commanded_quantity(rig)
    if quantity is VOLTAGE:
        require_drive(rig)
    elif own is not quantity:
        raise InvalidInput(f"{rig.title}: its voltage sets its amplitude; vary {own.key} instead")


def _offset(rig: Rig, volts: Floats) -> Floats:
    """Offset in the rig's ratio to each voltage; its own where it has none, being at 0 V."""
    drive = require_drive(rig)
    return volts * drive.offset_ratio if drive.voltage_peak_to_peak else 0 * volts + drive.voltage_offset
