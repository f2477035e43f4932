"""Spectra that show resonances: impedance, or vibration over frequency, both as a displacement over the drive."""

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.measurement.impedance.column_headings import ColumnHeading, parse_heading
from sonolube.measurement.impedance.passivity import passive_spectrum
from sonolube.measurement.impedance.reader import read_impedance
from sonolube.measurement.limits import require_points
from sonolube.measurement.numeric_text import detected_decimal_sign, parse_number
from sonolube.measurement.time_series import require_equal_length
from sonolube.storage.input_files import input_bytes

_ORDERS = {"displacement": 0, "amplitude": 0, "receptance": 0, "velocity": 1, "mobility": 1, "acceleration": 2}
_VIBRATION = re.compile(rf"\W*({'|'.join(_ORDERS)})\b", re.IGNORECASE)
_COMMENTS = ("#", "!", "%")
_LARGEST_FILE = 1 << 28  # bytes; far above any sweep
_MIN_POINTS = 12
_HEAD_LINES = 64  # among which the headings of a table of vibration stand


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ResonanceSpectrum:
    """Response of a structure over frequency, in whose poles its resonances show.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Increasing. [Hz]
    response : ndarray, shape (n,)
        Complex, proportional to a displacement per drive: vibration in any unit, or admittance over frequency.
    weight : ndarray, shape (n,)
        Reciprocal standard deviation of the noise, up to a factor.
    has_phase : bool
        Whether the phase was measured; else the response is its magnitude.
    quantity : str
        What was measured, such as "impedance" or "velocity".
    file_name : str
        File it was read from; empty where it was not read from a file.
    sha256 : str
        Digest of that file.
    caveats : tuple of str
        What had to be assumed in reading.

    Raises
    ------
    InvalidInput
        If the shapes differ, there are fewer than 12 points, or a frequency is not positive or does not increase.
    """

    frequency: Floats
    response: Complexes
    weight: Floats
    has_phase: bool = True
    quantity: str = "displacement"
    file_name: str = ""
    sha256: str = ""
    caveats: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        f = require_positive(frequency=self.frequency)
        response = require_finite_complex(response=self.response)
        require_equal_length(frequency=f, response=response, weight=require_positive(weight=self.weight))
        if f.size < _MIN_POINTS:
            raise InvalidInput(f"spectrum must have at least {_MIN_POINTS} points, got {f.size}")
        if np.any(np.diff(f) <= 0):
            raise InvalidInput("frequency must increase, and does not")
        if not np.any(response):
            raise InvalidInput("response must not be zero at every frequency")

    def between(self, lowest: float, highest: float) -> "ResonanceSpectrum":
        """Part of the spectrum between two frequencies; the whole where fewer than 12 points lie between them."""
        inside = (self.frequency >= lowest) & (self.frequency <= highest)
        if inside.sum() < _MIN_POINTS:
            return self
        return replace(
            self, frequency=self.frequency[inside], response=self.response[inside], weight=self.weight[inside]
        )


def vibration_spectrum(
    *, frequency: Floats, response: Complexes | Floats, quantity: str = "displacement"
) -> ResonanceSpectrum:
    """Spectrum of a measured vibration, whose noise is taken as the same at all frequencies.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Increasing. [Hz]
    response : ndarray, shape (n,)
        Complex, or real where only the amplitude was measured; per drive, in any unit.
    quantity : {"displacement", "amplitude", "receptance", "velocity", "mobility", "acceleration"}
        What was measured.

    Returns
    -------
    ResonanceSpectrum

    Raises
    ------
    InvalidInput
        If the quantity is none of these, or as `ResonanceSpectrum`.
    """
    if quantity not in _ORDERS:
        raise InvalidInput(f"quantity must be one of {', '.join(_ORDERS)}, got {quantity!r}")
    f = require_positive(frequency=frequency)
    rise = (f / f[-1]) ** _ORDERS[quantity]
    turn = 1j ** _ORDERS[quantity] if np.iscomplexobj(response) else 1
    return ResonanceSpectrum(
        frequency=f,
        response=np.asarray(response) / (turn * rise),
        weight=rise,
        has_phase=np.iscomplexobj(response),
        quantity=quantity,
    )


def read_resonance_spectrum(path: Path, *, sweep: str | None = None) -> ResonanceSpectrum:
    """Spectrum of a file: impedance in any format of `read_impedance`, or a table of vibration over frequency.

    Parameters
    ----------
    path : Path
        A table of vibration has a row of headings such as `frequency (Hz), velocity (mm/s), phase (deg)`, with
        displacement, amplitude, receptance, velocity, mobility or acceleration in any unit; without a phase it is of
        magnitudes.
    sweep : str or None
        Name of one of several sweeps of a file of impedance.

    Returns
    -------
    ResonanceSpectrum

    Raises
    ------
    InvalidInput
        Naming the file, the line and the reason, if it can be read as neither.
    UnknownName
        Naming the file, if it has no such sweep.
    """
    content = _content(path)
    table = _vibration_table(path, content.decode("utf-8-sig", errors="replace").splitlines())
    if table is None:
        return _of_impedance(path, sweep)
    if sweep is not None:
        raise InvalidInput(f"{path}: is a table of one spectrum of vibration; leave sweep {sweep!r} out")
    order = np.argsort(table.frequency, kind="stable")
    try:
        found = vibration_spectrum(
            frequency=table.frequency[order], response=table.response[order], quantity=table.quantity
        )
    except InvalidInput as refusal:
        raise InvalidInput(f"{path}: {refusal}") from None
    return _named(found, path, hashlib.sha256(content).hexdigest(), ())


class _Table(NamedTuple):
    """Columns of a table of vibration."""

    frequency: Floats
    response: Complexes | Floats
    quantity: str


def _of_impedance(path: Path, sweep: str | None) -> ResonanceSpectrum:
    """Spectrum of an impedance: its admittance over the frequency, with relative noise."""
    spectrum, turned = passive_spectrum(read_impedance(path, sweep=sweep))
    capacitance = spectrum.admittance / (2j * np.pi * spectrum.frequency)
    if not spectrum.has_phase:
        capacitance = np.abs(capacitance).astype(np.complex128)
    try:
        found = ResonanceSpectrum(
            frequency=spectrum.frequency,
            response=capacitance,
            weight=1 / np.abs(capacitance),
            has_phase=spectrum.has_phase,
            quantity="impedance",
        )
    except InvalidInput as refusal:
        raise InvalidInput(f"{path}: {refusal}") from None
    return _named(found, path, spectrum.sha256, turned)


def _named(found: ResonanceSpectrum, path: Path, digest: str, caveats: tuple[str, ...]) -> ResonanceSpectrum:
    """Spectrum with its origin."""
    return replace(found, file_name=path.name, sha256=digest, caveats=caveats)


def _content(path: Path) -> bytes:
    """Bytes of a file of limited size."""
    with refuse_unreadable(path):
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput(f"{path}: line 1: is larger than {_LARGEST_FILE >> 20} MiB, more than any sweep")
        return input_bytes(path, most=_LARGEST_FILE)


def _vibration_table(path: Path, lines: list[str]) -> _Table | None:
    """Columns of a table of vibration, or None where the file has no heading of one among its first lines."""
    for at, line in enumerate(lines[:_HEAD_LINES]):
        if line.startswith(_COMMENTS):
            continue
        separator = next((sign for sign in "\t;," if sign in line), ",")
        labels = [label.strip().strip('"') for label in line.split(separator)]
        headings = [parse_heading(label) for label in labels]
        amplitude = next((place for place, label in enumerate(labels) if _VIBRATION.match(label)), None)
        frequency = next((place for place, heading in enumerate(headings) if heading and heading.symbol == "f"), None)
        if amplitude is None or frequency is None:
            continue
        _require_one_of_each(path, at + 1, labels, headings)
        phase = next((place for place, h in enumerate(headings) if h and h.symbol.startswith("theta")), None)
        if phase is None and any(label.lower().startswith("phase") for label in labels):
            raise InvalidInput(f"{path}: line {at + 1}: the phase needs a unit, 'phase (deg)' or '(rad)'")
        rows = [(n, row.split(separator)) for n, row in enumerate(lines[at + 1 :], at + 2) if row.strip()]
        rows = [(n, row) for n, row in rows if not row[0].startswith(_COMMENTS)]
        require_points(len(rows), path, line=at + 1)
        sign = detected_decimal_sign(cell for _, row in rows for cell in row) if separator != "," else "."

        def column(place: int, *, rows: list[tuple[int, list[str]]] = rows, sign: str = sign) -> Floats:
            return np.array([_number(path, n, row, place, sign) for n, row in rows])

        f_heading = headings[frequency]
        assert f_heading is not None
        response: Complexes | Floats = column(amplitude)
        if phase is not None:
            turn = headings[phase]
            assert turn is not None
            response = response * np.exp(1j * turn.scale * column(phase))
        matched = _VIBRATION.match(labels[amplitude])
        assert matched is not None
        return _Table(f_heading.scale * column(frequency), response, matched[1].lower())
    return None


def _require_one_of_each(path: Path, line: int, labels: list[str], headings: Sequence[ColumnHeading | None]) -> None:
    """Refuse a table with two columns of the frequency, of one quantity of vibration or of the phase."""
    found: dict[str, int] = {}
    for place, (label, heading) in enumerate(zip(labels, headings, strict=True), start=1):
        vibration = _VIBRATION.match(label)
        symbol = heading.symbol if heading else ""
        kind = vibration[1].lower() if vibration else {"f": "frequency"}.get(symbol, symbol[:5])
        if kind in ("frequency", "theta") or vibration:
            if kind in found:
                word = "phase" if kind == "theta" else kind
                raise InvalidInput(f"{path}: line {line}: columns {found[kind]} and {place} are of {word}; keep one")
            found[kind] = place


def _number(path: Path, line: int, row: list[str], place: int, sign: str) -> float:
    """Number in one cell; a missing or unreadable one is refused with its line."""
    value = parse_number(row[place].strip('" '), decimal_sign=sign) if place < len(row) else None
    if value is None or not np.isfinite(value):
        raise InvalidInput(f"{path}: line {line}: column {place + 1} is not a finite number")
    return value
