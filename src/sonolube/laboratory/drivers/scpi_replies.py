"""What all instruments by SCPI have in a device map: identity, setup, error queue, and numbers in their answers."""

import re
from fnmatch import fnmatchcase
from typing import Annotated, Final

from pydantic import AfterValidator, Field

from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.entry import Line
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.laboratory.drivers.visa_entry import VisaLineEntry

_NUMBER: Final = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]?\d+)?)\s*(?:V|VPP|HZ)?", re.IGNORECASE)
_MAX_ERRORS: Final = 50
_OVERLOAD: Final = 9.9e37  # by SCPI, for no reading or one beyond the range


def _plain(text: str) -> str:
    """Command without a place for a number."""
    if re.search(r"[{}]", text.replace("{highest}", "").replace("{lowest}", "")):
        raise ValueError("must hold no braces but {highest} and {lowest}")
    return text


Setup = Annotated[tuple[Annotated[Line, AfterValidator(_plain)], ...], Field(strict=False, max_length=50)]


class ScpiEntry(VisaLineEntry):
    """Keys of every instrument whose SCPI commands stand in the map."""

    identity: Annotated[Line, Field(min_length=3)]
    setup: Setup = ()


class ErrorEntry(Table):
    """Query of the error queue.

    Parameters
    ----------
    query : str
    none : str
        Beginning of its answer up to a comma where there is no error.
    """

    query: Line = "SYST:ERR?"
    none: Line = "0"

    def errors(self, line: VisaConnection) -> list[str]:
        """All errors of an instrument, which has none afterwards.

        Parameters
        ----------
        line : VisaConnection

        Returns
        -------
        list of str

        Raises
        ------
        DeviceError
            If there is no end of them.
        """
        found: list[str] = []
        while len(found) <= _MAX_ERRORS:
            answer = line.ask(self.query)
            if answer.partition(",")[0].strip().lstrip("+") == self.none:
                return found
            found.append(answer[:80])
        raise DeviceError(f"{line.name}: answers {found[-1]!r} to {self.query!r} without end")


class ReplyEntry(Table):
    """Query whose answer has a number.

    Parameters
    ----------
    query : str
    item : int
        Place in the list between commas, from 1.
    after : str
        Word behind which the number stands, in place of item.
    """

    query: Line
    item: Annotated[int, Field(ge=1, le=1000)] = 1
    after: Annotated[str, Field(max_length=40)] = ""

    def number(self, answer: str, *, device: str) -> float:
        """Number of an answer; NaN where the instrument has none or one beyond its range.

        Parameters
        ----------
        answer : str
        device : str
            Name in errors.

        Returns
        -------
        float

        Raises
        ------
        DeviceError
            If no number stands there.
        """
        items = [each.strip() for each in answer.split(",")]
        place = self.item - 1
        if self.after:
            words = [each.rpartition(" ")[2].upper() for each in items]
            place = words.index(self.after.upper()) + 1 if self.after.upper() in words else len(items)
        found = _NUMBER.fullmatch(items[place]) if place < len(items) else None
        if found is None:
            where = f"behind {self.after}" if self.after else f"at place {self.item}"
            raise DeviceError(f"{device}: answers {answer[:80]!r} to {self.query!r}; expected a number {where}")
        value = float(found[1])
        return value if abs(value) < _OVERLOAD else float("nan")


def require_identity(line: VisaConnection, pattern: str) -> None:
    """Ask an instrument who it is until that answer comes, passing over answers to commands that were broken off."""
    line.ask_until("*IDN?", lambda heard: fnmatchcase(heard.upper(), pattern.upper()), expected=pattern)


def send(line: VisaConnection, command: str, errors: ErrorEntry | None) -> None:
    """Send a command, and raise where the instrument has put an error into its queue."""
    line.write(command)
    complaints = [] if errors is None else errors.errors(line)
    if complaints:
        raise DeviceError(f"{line.name}: refuses {command!r}: {'; '.join(complaints[:3])}")
