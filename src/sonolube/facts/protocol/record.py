"""Test protocol: its steps, the limits of the rig, and the specimens."""

from typing import Annotated

from pydantic import Field

from sonolube.facts.protocol.quantity_text import Amperes, Kelvins, Metres, Newtons, Seconds, Table, Volts
from sonolube.facts.protocol.steps import Step

_TEXT = 500


class Limits(Table):
    """Limits beyond which the test is ended.

    Parameters
    ----------
    voltage_maximum : float
        Magnitude of the drive voltage, its offset included. [V]
    duration_maximum : float
        Time of the whole test without prompts, in s.
    current_maximum : float or None
        Magnitude of the drive current. [A]
    temperature_maximum : float or None
        Of the actuator, in K.
    friction_force_maximum : float or None
        In N.
    """

    voltage_maximum: Volts
    duration_maximum: Seconds
    current_maximum: Amperes | None = None
    temperature_maximum: Kelvins | None = None
    friction_force_maximum: Newtons | None = None


class Metadata(Table):
    """Specimens and pair of materials of a test.

    Parameters
    ----------
    pin_material, disc_material : str
    normal_load : float or None
        [N]
    groove_diameter : float or None
        Of the middle of the wear track. [m]
    specimen : str
        Name of the pair of bodies.
    operator : str
        Who makes the test.
    humidity : str
        Relative humidity of the air, such as 45 %.
    calibrated : str
        Date of the latest calibration of the sensors, such as 2026-03-01.
    run : int or None
        Row of the table of runs.
    block : int or None
        Runs made together, such as on one day.
    """

    pin_material: str = Field(default="", max_length=_TEXT)
    disc_material: str = Field(default="", max_length=_TEXT)
    normal_load: Newtons | None = None
    groove_diameter: Metres | None = None
    specimen: str = Field(default="", max_length=_TEXT)
    operator: str = Field(default="", max_length=_TEXT)
    humidity: str = Field(default="", max_length=_TEXT)
    calibrated: str = Field(default="", max_length=_TEXT)
    run: int | None = Field(default=None, ge=1)
    block: int | None = Field(default=None, ge=1)


class Protocol(Table):
    """A test as a sequence of steps.

    Parameters
    ----------
    title : str
    source : str
        Where the procedure comes from.
    limits : Limits
    metadata : Metadata
    steps : tuple of step
        One after the other; `sonolube.facts.protocol.steps` has their kinds.
    """

    title: str = Field(min_length=1, max_length=_TEXT)
    source: str = Field(min_length=1, max_length=_TEXT)
    limits: Limits
    metadata: Metadata = Metadata()
    steps: Annotated[tuple[Step, ...], Field(strict=False, min_length=1, max_length=1000)]
