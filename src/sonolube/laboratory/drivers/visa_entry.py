"""Keys of a device map for instruments that VISA reaches."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.drivers.entry import Resource, VisaLibrary
from sonolube.laboratory.drivers.resources import visa_resource
from sonolube.laboratory.drivers.visa_connection import TERMINATIONS, VisaConnection


class VisaEntry(Table):
    """Keys of every instrument of VISA."""

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    resource: Resource
    visa_library: VisaLibrary = "@py"

    @property
    def where(self) -> str:
        """Address."""
        return self.resource

    @property
    def reserved_as(self) -> str:
        """Canonical name of the instrument or port."""
        return visa_resource(self.resource)

    def line(self, kind: str) -> VisaConnection:
        """Connection, not open, to an instrument of a kind."""
        return VisaConnection(name=f"{kind} {self.resource}", resource=self.resource, library=self.visa_library)


class VisaLineEntry(VisaEntry):
    """Keys of every instrument of VISA that may have a serial port."""

    baud_rate: Annotated[int, Field(ge=50, le=4_000_000)] | None = None
    termination: Literal["CR", "LF", "CRLF"] = "LF"

    def line(self, kind: str) -> VisaConnection:
        """Connection, not open, to an instrument of a kind."""
        return VisaConnection(
            name=f"{kind} {self.resource}",
            resource=self.resource,
            library=self.visa_library,
            termination=TERMINATIONS[self.termination],
            baud_rate=self.baud_rate,
        )
