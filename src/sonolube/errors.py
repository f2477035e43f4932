"""Errors and warnings of sonolube, each with one line that names the cause and the remedy."""

import warnings
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Final, TypeVar

_Entry = TypeVar("_Entry")
_PACKAGE: Final = Path(__file__).parent
_LONGEST: Final = 200  # characters of the text of an exception


class SonolubeError(Exception):
    """Base of all errors that sonolube raises; the text is one line that names the cause and the remedy."""


class InvalidInput(SonolubeError, ValueError):
    """A value without meaning for its argument.

    Parameters
    ----------
    text : str
        One line that names the argument, the value and the remedy.
    key : str
        Name of the argument, or dotted key of a file; empty where the text is of several.
    """

    def __init__(self, text: str = "", *, key: str = "") -> None:
        self.key = key
        super().__init__(text)


class SeveralFaults(InvalidInput):
    """Several faults of one input, which the program prints one to a line.

    Parameters
    ----------
    faults : iterable of str
        Each in one line that names its place.
    rest : int
        Number of further faults, which are not listed.
    where : str
        What has the faults, such as a file.
    keys : iterable of str
        Dotted key of each fault, where it has one.
    """

    def __init__(self, faults: Iterable[str], *, rest: int = 0, where: str = "", keys: Iterable[str] = ()) -> None:
        self.faults, self.rest, self.where, self.keys = tuple(faults), rest, where, tuple(keys)
        super().__init__("; ".join([self.heading, *self.lines]))

    @property
    def heading(self) -> str:
        """Heading of the list: the subject and the number of its faults."""
        return f"{self.where}: {len(self.faults) + self.rest} faults".removeprefix(": ")

    @property
    def lines(self) -> list[str]:
        """Faults, a line each, and the number of further ones."""
        return [*self.faults, *([f"... and {self.rest} more"] if self.rest else [])]

    def at(self, place: str) -> "SeveralFaults":
        """Same faults with a place before each key."""
        where = f"{place}: {self.where}".removesuffix(": ")
        return SeveralFaults(self.faults, rest=self.rest, where=where, keys=self.keys)


class OutsideRange(InvalidInput):
    """A meaningful value outside the range of the requested model."""


class MissingProperty(SonolubeError, LookupError):
    """A property without a known source, for which no value is given."""


class NoGroove(SonolubeError):
    """A scan without a detectable wear groove or scar; the text gives what was detected instead."""


class SeveralGrooves(SonolubeError):
    """Several wear tracks lie in a scan, and none was chosen."""


class UnknownName(SonolubeError, LookupError):
    """A name that is in no table."""

    @classmethod
    def among(cls, known: Iterable[str], *, kind: str, name: str) -> "UnknownName":
        """Error for an unknown name, with the closest known name as a suggestion."""
        names = sorted(known)
        quoted = repr(name if len(name) <= _LONGEST else f"{name[:_LONGEST]}...")
        return cls(f"unknown {kind} {quoted}; {suggestion(name, names) or 'known: ' + ', '.join(names)}")


class MissingPackage(InvalidInput, ImportError):
    """A package of an optional part of the installation is not installed."""


class SystemRefusal(SonolubeError, OSError):
    """What the operating system refuses, such as a folder without permission to write."""


class UnexpectedFault(SonolubeError, RuntimeError):
    """A fault of sonolube itself, in one line with its kind and place; the original is its cause."""


class ModelRangeWarning(UserWarning):
    """A result outside the range in which its model was verified."""


class InconsistentCoupling(ModelRangeWarning):
    """A stated coupling factor that disagrees with the one from stroke, stiffness and capacitance."""


def words_of(failure: BaseException) -> str:
    """What an exception says, in one line; empty where it says nothing, or its text fails."""
    try:
        return " ".join(str(failure).split())
    except BaseException:  # of a class of another package
        return ""


def fault_line(failure: BaseException) -> str:
    """Line on an exception that no refusal foresees: a fault of the program with its kind and place, to be reported.

    What was noted of the exception, such as whether motor and drive are off, stands first.
    """
    text = words_of(failure)[:_LONGEST]
    told = f"{type(failure).__name__} ({text})" if text else type(failure).__name__
    noted = "".join(f"{note}; " for note in getattr(failure, "__notes__", ()))
    return (
        f"{noted}a fault of sonolube itself, not of your input: {told}{_place_of(failure)}; please report it with this"
        " line and what you asked for, by the form Fault on the page of the repository"
    )


def _place_of(failure: BaseException) -> str:
    """Innermost line of sonolube that an exception has passed."""
    place, passed = "", failure.__traceback__
    while passed is not None:
        path = Path(passed.tb_frame.f_code.co_filename)
        if path.is_relative_to(_PACKAGE):
            place = f" in {path.relative_to(_PACKAGE.parent).as_posix()}, line {passed.tb_lineno}"
        passed = passed.tb_next
    return place


def warn_of_range(message: str, *, stacklevel: int = 2) -> None:
    """Issue a ModelRangeWarning; by default at the caller of the function that calls this one."""
    warnings.warn(message, ModelRangeWarning, stacklevel=stacklevel + 1)


def entry_named(known: Mapping[str, _Entry], name: str, *, kind: str) -> _Entry:
    """Entry of a table by its name; UnknownName, with the closest name of the table, where it has none."""
    if name not in known:
        raise UnknownName.among(known, kind=kind, name=name)
    return known[name]


def suggestion(name: str, known: Iterable[str]) -> str:
    """Question "did you mean ...?" with the closest known name, or an empty text if none is close."""
    if len(name) > _LONGEST:
        return ""
    close = get_close_matches(name.lower(), list(known), n=1, cutoff=0.6)
    return f"did you mean {close[0]}?" if close else ""
