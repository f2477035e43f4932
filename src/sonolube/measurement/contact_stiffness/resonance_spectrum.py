"""Spectra that show resonances: impedance, or vibration over frequency, both as a displacement over the drive."""

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.headings import ColumnHeading, is_unit, parse_heading
from sonolube.measurement.impedance.spectrum import passive_spectrum, read_impedance, sweep_bytes, text_lines
from sonolube.measurement.measured_files import require_points
from sonolube.measurement.recordings.headed_tables import finite_numbers, headed_table
from sonolube.measurement.recordings.raw_table import is_unit_of
from sonolube.measurement.recordings.text_tables import decoded_content
from sonolube.measurement.time_series import require_equal_length

_ORDERS = {"displacement": 0, "amplitude": 0, "receptance": 0, "velocity": 1, "mobility": 1, "acceleration": 2}
_VIBRATION = re.compile(rf"\W*({'|'.join(_ORDERS)})\b", re.IGNORECASE)
_MIN_POINTS = 12


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
    content = sweep_bytes(path)
    table = _vibration_table(path, content)
    if table is None:
        return _of_impedance(path, sweep)
    if sweep is not None:
        raise InvalidInput(f"{path}: is a table of one spectrum of vibration; leave sweep {sweep!r} out")
    frequency, response, quantity, caveats = table
    order = np.argsort(frequency, kind="stable")
    try:
        found = vibration_spectrum(frequency=frequency[order], response=response[order], quantity=quantity)
    except InvalidInput as refusal:
        raise InvalidInput(f"{path}: {refusal}") from None
    return replace(found, file_name=path.name, sha256=hashlib.sha256(content).hexdigest(), caveats=caveats)


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
    return replace(found, file_name=path.name, sha256=spectrum.sha256, caveats=turned)


def _vibration_table(path: Path, content: bytes) -> tuple[Floats, Complexes | Floats, str, tuple[str, ...]] | None:
    """Frequency, response, quantity and caveats of a table of vibration; None without headings of one."""
    text, caveats = decoded_content(content, path)
    found = headed_table(text_lines(text), path, is_complete=_is_vibration, is_unit=_is_unit)
    if found is None:
        return None
    table = found.table
    require_points(len(table.rows), path, line=table.line)
    headings = [parse_heading(label) for label in table.labels]
    places = _places(path, table.line, table.labels, headings)
    quantity = next(kind for kind in places if kind in _ORDERS)
    columns = {
        kind: (heading.scale if (heading := headings[places[kind]]) else 1.0)
        * finite_numbers(table.rows, places[kind], decimal_sign=found.decimal_sign, path=path)
        for kind in (quantity, "phase", "frequency")
        if kind in places
    }
    turn = np.exp(1j * columns["phase"]) if "phase" in columns else 1.0
    return columns["frequency"], columns[quantity] * turn, quantity, caveats


def _is_vibration(labels: Sequence[str]) -> bool:
    """Whether headings name a frequency and a quantity of vibration."""
    has_frequency = any(heading.symbol == "f" for label in labels if (heading := parse_heading(label)))
    return has_frequency and any(map(_VIBRATION.match, labels))


def _is_unit(text: str) -> bool:
    """Whether a cell is a unit of such a table."""
    return is_unit(text) or any(is_unit_of(text.strip(" ()[]"), unit) for unit in ("m", "m/s", "m/s2"))


def _places(path: Path, line: int, labels: list[str], headings: Sequence[ColumnHeading | None]) -> dict[str, int]:
    """Places of the frequency, of quantities of vibration and of the phase; refuse two of one, and a bare phase."""
    places: dict[str, int] = {}
    for place, (label, heading) in enumerate(zip(labels, headings, strict=True)):
        vibration = _VIBRATION.match(label)
        symbol = heading.symbol.partition("_")[0] if heading else ""
        kind = vibration[1].lower() if vibration else {"f": "frequency", "theta": "phase"}.get(symbol)
        if kind in places:
            several = f"columns {places[kind] + 1} and {place + 1} are of {kind}"
            raise InvalidInput(f"{path}: line {line}: {several}; keep one")
        if kind is not None:
            places[kind] = place
    if "phase" not in places and any(label.lower().startswith("phase") for label in labels):
        raise InvalidInput(f"{path}: line {line}: the phase needs a unit, 'phase (deg)' or '(rad)'")
    return places
