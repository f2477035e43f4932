"""Answers of instruments by SCPI: identity, error queue, and numbers in lists between commas."""

import re
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final

from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.visa_connection import VisaConnection

_NUMBER: Final = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]?\d+)?)\s*(?:V|VPP|HZ)?", re.IGNORECASE)
_MAX_ERRORS: Final = 50
_OVERLOAD: Final = 9.9e37  # by SCPI, for no reading or one beyond the range


@dataclass(frozen=True, kw_only=True, slots=True)
class Reply:
    """Number in the answer to a query.

    Parameters
    ----------
    query : str
    item : int
        Place in the list between commas, from 1.
    after : str
        Word behind which the number stands in that list, in place of `item`; empty without.
    """

    query: str
    item: int = 1
    after: str = ""

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


@dataclass(frozen=True, kw_only=True, slots=True)
class ErrorQueue:
    """Query of errors, one an answer.

    Parameters
    ----------
    query : str
    none : str
        Beginning of the answer, up to a comma, where there is none; signs before 0 are passed over.
    """

    query: str = "SYST:ERR?"
    none: str = "0"

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


def require_identity(line: VisaConnection, pattern: str) -> None:
    """Ask an instrument who it is until that answer comes, passing over answers to commands that were broken off."""
    line.ask_until("*IDN?", lambda heard: fnmatchcase(heard.upper(), pattern.upper()), expected=pattern)


def send(line: VisaConnection, command: str, errors: ErrorQueue | None) -> None:
    """Send a command, and raise where the instrument has put an error into its queue."""
    line.write(command)
    complaints = [] if errors is None else errors.errors(line)
    if complaints:
        raise DeviceError(f"{line.name}: refuses {command!r}: {'; '.join(complaints[:3])}")
