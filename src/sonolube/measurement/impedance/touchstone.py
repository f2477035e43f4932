"""Touchstone files of one port, versions 1 and 2."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.measured_files import first_lines, parse_number

_FREQUENCY_UNITS = {"HZ": 1.0, "KHZ": 1e3, "MHZ": 1e6, "GHZ": 1e9}
_PARAMETERS = ("S", "Y", "Z")
_NUMBER_FORMATS = ("DB", "MA", "RI")
_MULTIPORT = re.compile(r"\.s([2-9]|[1-9][0-9]+)p")
_MAX_OPTIONS = 16  # words of an option line; it needs five
_SKIPPED_KEYWORDS = ("[number of frequencies]", "[network data]", "[two-port data order]", "[matrix format]")


@dataclass(frozen=True, kw_only=True, slots=True)
class _Options:
    """Option line of a file, with the defaults of the specification.

    `normalised` holds whether impedances and admittances are relative to the reference resistance, as in version 1.
    """

    frequency_unit: float = 1e9
    parameter: str = "S"
    number_format: str = "MA"
    reference: float = 50.0
    normalised: bool = True


@final
class Touchstone:
    """Touchstone files of one port, versions 1 and 2.

    Notes
    -----
    Version 1 has no signature and is detected by its suffix, which is part of the format: it states the number of
    ports. The suffix precedes the signatures of instruments, whose name a comment of the file may hold.
    """

    name: ClassVar[str] = "touchstone"
    suffixes: ClassVar[tuple[str, ...]] = (".s1p", ".ts")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the suffix is that of touchstone, of any number of ports, or line 1 states the version."""
        suffix, first = path.suffix.lower(), first_lines(head)[0].lower()
        return suffix in self.suffixes or _MULTIPORT.fullmatch(suffix) is not None or first.startswith("[version]")

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        r"""One sweep of a touchstone file of one port, under an empty name.

        With the reference resistance R, scattering parameters become impedances as

        .. math:: Z = R\, \frac{1 + S}{1 - S} .

        Impedances and admittances of version 1 are normalised to R, those of version 2 are not. Of several option lines
        the first one holds.

        Source: IBIS Open Forum, Touchstone File Format Specification, version 2.0 (2009).
        """
        if several := _MULTIPORT.fullmatch(path.suffix.lower()):
            raise InvalidInput(_several_ports(path, 1, several[1]))
        options: _Options | None = None
        is_version_2, reference, rows, row_lines = False, None, [], []
        for at, text in _statements(lines):
            if text.startswith("#"):
                options = options or _options(path, at, text[1:].split())
            elif text.startswith("["):
                keyword, _, value = text.lower().partition("]")
                if keyword == "[end":
                    break
                is_version_2 |= keyword == "[version"
                reference = _reference(path, at, keyword + "]", value.strip(), reference)
            else:
                if options is None:
                    raise InvalidInput(f"{path}: line {at}: values before the option line, such as '# Hz S RI R 50'")
                rows.append(_row(path, at, text))
                row_lines.append(at)
        if not rows or options is None:
            raise InvalidInput(f"{path}: line {len(lines)}: holds no values")
        options = replace(options, reference=reference or options.reference, normalised=not is_version_2)
        values = np.array(rows)
        with np.errstate(all="ignore"):
            sweep = ImpedanceSweep(
                frequency=options.frequency_unit * values[:, 0],
                impedance=_impedance(_complex(values[:, 1], values[:, 2], options.number_format), options),
                lines=np.array(row_lines),
            )
        return {"": sweep}


def _statements(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield line number and text of each statement, without comments, blank lines and information blocks of version 2.

    A reference resistance on the line after its keyword is joined to it.
    """
    information, reference_line = False, 0
    for at, line in enumerate(lines, start=1):
        text = line.partition("!")[0].strip()
        keyword = text.lower()
        if keyword in ("[begin information]", "[end information]"):
            information = keyword == "[begin information]"
        elif keyword == "[reference]":
            reference_line = at
        elif text and not information:
            yield at, f"[reference] {text}" if reference_line else text
            reference_line = 0


def _options(path: Path, at: int, words: list[str]) -> _Options:
    """Options of an option line."""
    options = _Options()
    if len(words) > _MAX_OPTIONS:
        raise InvalidInput(f"{path}: line {at}: has {len(words)} options; write such as '# Hz S RI R 50'")
    remaining = [word.upper() for word in words]
    while remaining:
        word = remaining.pop(0)
        if word in _FREQUENCY_UNITS:
            options = replace(options, frequency_unit=_FREQUENCY_UNITS[word])
        elif word in _PARAMETERS:
            options = replace(options, parameter=word)
        elif word in _NUMBER_FORMATS:
            options = replace(options, number_format=word)
        elif word == "R" and remaining:
            options = replace(options, reference=_resistance(path, at, remaining.pop(0)))
        else:
            raise InvalidInput(f"{path}: line {at}: unknown option {word[:20]!r}; write such as '# Hz S RI R 50'")
    return options


def _reference(path: Path, at: int, keyword: str, value: str, reference: float | None) -> float | None:
    """Reference resistance after a keyword of version 2; refuse unknown keywords and several ports."""
    if keyword == "[reference]":
        return _resistance(path, at, value)
    if keyword == "[version]" and not value.startswith("2"):
        raise InvalidInput(f"{path}: line {at}: version {value[:20]!r} is not known; known: 1 and 2")
    if keyword == "[number of ports]" and value != "1":
        raise InvalidInput(_several_ports(path, at, value[:20]))
    if keyword not in (*_SKIPPED_KEYWORDS, "[version]", "[number of ports]"):
        raise InvalidInput(f"{path}: line {at}: the keyword {keyword[:40]!r} is not known")
    return reference


def _several_ports(path: Path, at: int, ports: str) -> str:
    """Refusal of a file of several ports, none of whose parameters is the impedance of the transducer by itself."""
    return (
        f"{path}: line {at}: is a network of {ports} ports, and an impedance has one: S11 sees the instrument at the"
        " other ports as well; measure the transducer at one port alone and save it as .s1p, or its Z as a table"
    )


def _resistance(path: Path, at: int, text: str) -> float:
    """Positive resistance in ohm."""
    value = parse_number(text, decimal_sign=".")
    if value is None or not (np.isfinite(value) and value > 0):
        raise InvalidInput(f"{path}: line {at}: the reference resistance must be positive, got {text[:20]!r}")
    return value


def _row(path: Path, at: int, text: str) -> list[float]:
    """Three numbers of a point of one port."""
    values = [parse_number(cell, decimal_sign=".") for cell in text.split()]
    known = [value for value in values if value is not None and np.isfinite(value)]
    if len(values) != 3 or len(known) != 3:
        raise InvalidInput(f"{path}: line {at}: a point of one port is three numbers, got {text[:40]!r}")
    return known


def _complex(first: Floats, second: Floats, number_format: str) -> Complexes:
    """Complex numbers from pairs as RI (real, imaginary), MA (magnitude, degrees) or DB (decibels, degrees)."""
    if number_format == "RI":
        return np.asarray(first + 1j * second)
    magnitude = 10 ** (first / 20) if number_format == "DB" else first
    return np.asarray(magnitude * np.exp(1j * np.radians(second)))


def _impedance(values: Complexes, options: _Options) -> Complexes:
    """Impedance of scattering parameters, admittances or impedances, in ohm."""
    unit = options.reference if options.normalised else 1.0
    if options.parameter == "Z":
        return unit * values
    if options.parameter == "Y":
        return np.asarray(unit / values)
    return np.asarray(options.reference * (1 + values) / (1 - values))
