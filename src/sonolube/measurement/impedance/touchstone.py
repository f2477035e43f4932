"""Impedance from touchstone files of one port (.s1p), versions 1 and 2."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.numeric_text import parse_number

TOUCHSTONE = "touchstone"

_FREQUENCY = {"HZ": 1.0, "KHZ": 1e3, "MHZ": 1e6, "GHZ": 1e9}
_PARAMETERS = ("S", "Y", "Z")
_NUMBERS = ("DB", "MA", "RI")
_PASSED_OVER = ("[number of frequencies]", "[network data]", "[two-port data order]")


@dataclass(frozen=True, kw_only=True, slots=True)
class _Options:
    frequency: float = 1e9
    parameter: str = "S"
    numbers: str = "MA"
    reference: float = 50.0
    normalized: bool = True  # impedances and admittances count in the reference resistance: version 1 only


def read_touchstone(path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
    """Return the one sweep of a touchstone file of one port.

    Parameters
    ----------
    path : Path
        Of the file, for messages.
    lines : list of str
        Of the file.

    Returns
    -------
    dict of str to Points

    Raises
    ------
    InvalidInput
        Naming the file and the line, if there is no option line, an option or keyword is unknown, the file has more
        ports than one, or a value is no number.

    Notes
    -----
    Scattering parameters become impedances as Z = R (1 + S)/(1 - S). Impedances and admittances of version 1 are
    normalized to R, those of version 2 are not. The first option line counts.
    """
    options: _Options | None = None
    version_2, reference, rows, at_row = False, None, [], []
    for at, line in enumerate(lines, start=1):
        text = line.partition("!")[0].strip()
        if text.startswith("#"):
            options = options or _options(path, at, text[1:].split())
        elif text.startswith("["):
            keyword, _, value = text.lower().partition("]")
            if keyword == "[end":
                break
            version_2 |= keyword == "[version"
            reference = _keyword(path, at, keyword + "]", value.strip(), reference)
        elif text:
            if options is None:
                raise InvalidInput(f"{path}: line {at}: values before the option line, such as '# Hz S RI R 50'")
            rows.append(_row(path, at, text))
            at_row.append(at)
    if not rows or options is None:
        raise InvalidInput(f"{path}: line {len(lines)}: holds no values")
    known = _Options(
        frequency=options.frequency,
        parameter=options.parameter,
        numbers=options.numbers,
        reference=reference or options.reference,
        normalized=not version_2,
    )
    values = np.array(rows)
    with np.errstate(all="ignore"):
        points = ImpedanceSweep(
            frequency=known.frequency * values[:, 0],
            impedance=_impedance(_complex(values[:, 1], values[:, 2], known.numbers), known),
            lines=np.array(at_row),
        )
    return {"": points}


def _options(path: Path, at: int, words: list[str]) -> _Options:
    frequency, parameter, numbers, reference = 1e9, "S", "MA", 50.0
    remaining = [word.upper() for word in words]
    while remaining:
        word = remaining.pop(0)
        if word in _FREQUENCY:
            frequency = _FREQUENCY[word]
        elif word in _PARAMETERS:
            parameter = word
        elif word in _NUMBERS:
            numbers = word
        elif word == "R" and remaining:
            reference = _resistance(path, at, remaining.pop(0))
        else:
            raise InvalidInput(f"{path}: line {at}: unknown option {word[:20]!r}; write such as '# Hz S RI R 50'")
    return _Options(frequency=frequency, parameter=parameter, numbers=numbers, reference=reference)


def _keyword(path: Path, at: int, keyword: str, value: str, reference: float | None) -> float | None:
    if keyword == "[reference]":
        return _resistance(path, at, value)
    if keyword == "[version]" and not value.startswith("2"):
        raise InvalidInput(f"{path}: line {at}: version {value[:20]!r} is not known; known: 1 and 2")
    if keyword == "[number of ports]" and value != "1":
        raise InvalidInput(f"{path}: line {at}: has {value[:20]!r} ports; an impedance has one")
    if keyword not in (*_PASSED_OVER, "[version]", "[number of ports]"):
        raise InvalidInput(f"{path}: line {at}: the keyword {keyword[:40]!r} is not known")
    return reference


def _resistance(path: Path, at: int, text: str) -> float:
    value = parse_number(text, decimal_sign=".")
    if value is None or not (np.isfinite(value) and value > 0):
        raise InvalidInput(f"{path}: line {at}: the reference resistance must be positive, got {text[:20]!r}")
    return value


def _row(path: Path, at: int, text: str) -> list[float]:
    values = [parse_number(cell, decimal_sign=".") for cell in text.split()]
    known = [value for value in values if value is not None and np.isfinite(value)]
    if len(values) != 3 or len(known) != 3:
        raise InvalidInput(f"{path}: line {at}: a point of one port is three numbers, got {text[:40]!r}")
    return known


def _complex(first: Floats, second: Floats, numbers: str) -> Complexes:
    if numbers == "RI":
        return np.asarray(first + 1j * second)
    magnitude = 10 ** (first / 20) if numbers == "DB" else first
    return np.asarray(magnitude * np.exp(1j * np.radians(second)))


def _impedance(values: Complexes, options: _Options) -> Complexes:
    unit = options.reference if options.normalized else 1.0
    if options.parameter == "Z":
        return unit * values
    if options.parameter == "Y":
        return np.asarray(unit / values)
    return np.asarray(options.reference * (1 + values) / (1 - values))
