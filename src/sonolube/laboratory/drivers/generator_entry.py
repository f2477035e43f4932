"""Section of a device map for function generators of the Agilent and Keysight 33500 family."""

from typing import ClassVar, Literal

from sonolube.laboratory.devices import DriveSource
from sonolube.laboratory.drivers.entry import DriveEntry, Resource, VisaLibrary
from sonolube.laboratory.drivers.function_generator import FunctionGenerator
from sonolube.laboratory.drivers.resources import visa_resource
from sonolube.laboratory.drivers.visa_connection import VisaConnection


class GeneratorEntry(DriveEntry):
    """Function generator of the Agilent and Keysight 33500 family.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it.
    visa_library : str
    output : int
    description, amplifier : str
        Model and serial number.
    amplifier_gain : float
        []
    voltage_maximum : float
        Magnitude at the actuator, offset included. [V]
    frequency_maximum : float
        In Hz.
    output_maximum : float
        Magnitude that the amplifier takes, in V.
    """

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    driver: Literal["scpi"]
    resource: Resource
    visa_library: VisaLibrary = "@py"
    output: Literal[1, 2] = 1

    @property
    def where(self) -> str:
        """Address."""
        return self.resource

    @property
    def reserved_as(self) -> str:
        """Canonical name of the instrument."""
        return visa_resource(self.resource)

    def new_device(self) -> DriveSource:
        """Generator, not connected."""
        line = VisaConnection(
            name=f"function generator {self.resource}", resource=self.resource, library=self.visa_library
        )
        return FunctionGenerator(line, output=self.output, limits=self.limits)
