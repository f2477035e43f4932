"""Impedance in text tables whose first row names the columns: quantity and unit of each, and the sweep of them."""

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.measured_files import parse_number, require_channels

_LABELS = {
    "f": ("frequency", "freq", "freq.", "f"),
    "|Z|": ("|z|", "z", "abs(z)", "absz", "mag(z)", "zmod", "impedance"),
    "theta_Z": ("theta-z", "theta", "phase", "phasez", "phase(z)", "arg(z)", "zphz", "θ"),
    "R": ("r", "re(z)", "real(z)", "realz", "z'", "resistance"),
    "X": ("x", "im(z)", "imag(z)", "imagz", "z''", "reactance"),
    "-X": ("-im(z)", "-imag(z)", "-z''"),
    "|Y|": ("|y|", "y", "abs(y)", "mag(y)", "admittance"),
    "theta_Y": ("theta-y", "phase(y)", "arg(y)"),
    "G": ("g", "re(y)", "real(y)", "conductance"),
    "B": ("b", "im(y)", "imag(y)", "susceptance"),
} | {symbol: (symbol.lower(),) for symbol in ("Ls", "Rs", "Cs", "Lp", "Rp", "Cp")}
_SYMBOL = {label: symbol for symbol, labels in _LABELS.items() for label in labels}
_DIMENSION = MappingProxyType(
    {"f": "Hz", "|Y|": "S", "G": "S", "B": "S", "Ls": "H", "Lp": "H", "Cs": "F", "Cp": "F"}
    | dict.fromkeys(("theta_Z", "theta_Y"), "rad")
)
_UNIT = re.compile(r"([pnuµμmkMG]?)(Hz|[Oo]hm|OHM|Ω|S|H|F|rad)")
_PREFIX = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
_LARGEST = 1e30  # in any unit
_BRACKETED = re.compile(r"(.*\S)\s*[(\[]([^()\[\]]*)[)\]]")
_DIVIDED = re.compile(r"(.*\S)\s*/\s*(\S+)")

_IMPEDANCE: Mapping[tuple[str, str], Callable[[Floats, Floats, Floats], Floats | Complexes]] = MappingProxyType(
    {
        ("R", "X"): lambda w, r, x: r + 1j * x,
        ("R", "-X"): lambda w, r, x: r - 1j * x,
        ("|Z|", "theta_Z"): lambda w, z, theta: z * np.exp(1j * theta),
        ("G", "B"): lambda w, g, b: 1 / (g + 1j * b),
        ("|Y|", "theta_Y"): lambda w, y, theta: np.exp(-1j * theta) / y,
        ("Ls", "Rs"): lambda w, inductance, r: r + 1j * w * inductance,
        ("Cs", "Rs"): lambda w, c, r: r + 1 / (1j * w * c),
        ("Lp", "Rp"): lambda w, inductance, r: 1 / (1 / r + 1 / (1j * w * inductance)),
        ("Cp", "Rp"): lambda w, c, r: 1 / (1 / r + 1j * w * c),
        ("|Z|", "|Z|"): lambda w, z, _: z,
        ("|Y|", "|Y|"): lambda w, y, _: 1 / y,
    }
)
MAGNITUDES = (("|Z|", "|Z|"), ("|Y|", "|Y|"))
"""Of `IMPEDANCE_PARTS` those that define the magnitude only."""
IMPEDANCE_PARTS = tuple(_IMPEDANCE)
"""Pairs of column symbols that define an impedance, in order of preference."""


class ColumnHeading(NamedTuple):
    """Quantity and unit of a column.

    Parameters
    ----------
    symbol : str
        Symbol of the quantity, such as ``f``, ``|Z|`` or ``theta_Z``.
    scale : float
        Value of the column's unit in SI.
    """

    symbol: str
    scale: float


def parse_heading(text: str) -> ColumnHeading | None:
    """Quantity and unit in the heading of a column, or None where it is none of an impedance table.

    See Also
    --------
    is_phase_without_unit : Why a heading may be None.
    """
    label = text.strip().strip('"').strip()
    for split in (_BRACKETED, _DIVIDED):
        if (found := split.fullmatch(label)) and (symbol := _SYMBOL.get(found[1].lower())):
            scale = _unit_scale(found[2].strip(), _DIMENSION.get(symbol, "ohm"))
            return ColumnHeading(symbol, scale) if scale is not None else None
    symbol = _SYMBOL.get(label.lower(), "")
    return ColumnHeading(symbol, 1.0) if symbol and not symbol.startswith("theta") else None


def is_phase_without_unit(text: str) -> bool:
    """Whether the heading of a column names a phase and states no unit, or one that is no angle."""
    label = text.strip().strip('"').strip()
    found = _BRACKETED.fullmatch(label) or _DIVIDED.fullmatch(label)
    names_phase = _SYMBOL.get((found[1] if found else label).lower(), "").startswith("theta")
    return names_phase and parse_heading(text) is None


def sweep_of_parts(columns: Mapping[str, Floats], pair: tuple[str, str], *, lines: NDArray[np.int64]) -> ImpedanceSweep:
    r"""Sweep over the column f from two real parts of impedance, admittance or an equivalent circuit.

    Its impedance is not finite where the parts define no finite one.

    With :math:`\omega = 2\pi f`: :math:`R + jX`, :math:`|Z| e^{j\theta}`, :math:`1/(G + jB)`, the series circuits
    :math:`R_s + j\omega L_s` and :math:`R_s + 1/(j\omega C_s)`, and the parallel circuits
    :math:`(1/R_p + 1/(j\omega L_p))^{-1}` and :math:`(1/R_p + j\omega C_p)^{-1}`.
    """
    first, second = pair
    with np.errstate(all="ignore"):
        omega = 2 * np.pi * columns["f"]
        impedance = np.asarray(_IMPEDANCE[pair](omega, columns[first], columns[second]), dtype=np.complex128)
    return ImpedanceSweep(frequency=columns["f"], impedance=impedance, lines=lines, has_phase=pair not in MAGNITUDES)


def _unit_scale(unit: str, dimension: str) -> float | None:
    """Value of a unit in SI, None where it is unknown or of another dimension."""
    if unit.lower() in ("deg", "°", "degrees"):
        return math.pi / 180 if dimension == "rad" else None
    found = _UNIT.fullmatch(unit)
    if not found or (found[2] if found[2].lower() not in ("ohm", "ω") else "ohm") != dimension:
        return None
    return _PREFIX[found[1]]


_COMMENTS = ("#", "!", "%")

NumberedCells = tuple[int, list[str]]  # line of a row, and its cells


@final
class NamedColumns:
    """Any text table whose first row names the columns, such as `frequency (kHz)`, `|Z| (ohm)`, `phase (deg)`.

    Notes
    -----
    Has no signature: the fallback for every text file.
    """

    name: ClassVar[str] = "table with named columns"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".tsv", ".txt")

    def recognises(self, head: bytes, path: Path) -> bool:
        """True: any text may be a table."""
        return True

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """One sweep of a table, under an empty name."""
        numbered = [(at, line) for at, line in enumerate(lines, 1) if line.strip() and not line.startswith(_COMMENTS)]
        if not numbered:
            raise InvalidInput(f"{path}: line {len(lines)}: holds no row")
        separator = next((sign for sign in "\t;," if sign in numbered[0][1]), ",")
        require_channels(numbered[0][1].count(separator) + 1, path, kind="columns")
        rows = [(at, line.split(separator)) for at, line in numbered]
        at, labels = rows[0]
        decimal_sign = "," if separator != "," and any("," in cell for _, row in rows[1:9] for cell in row) else "."
        headings = [parse_heading(label) for label in labels]
        _require_units_of_phases(path, at, labels, headings)
        return {"": sweep_from_columns(path, at, headings, rows[1:], decimal_sign=decimal_sign)}


def _require_units_of_phases(path: Path, line: int, labels: list[str], headings: list[ColumnHeading | None]) -> None:
    """Refuse a phase without unit where without it the table would define magnitudes only."""
    symbols = {heading.symbol for heading in headings if heading}
    complete = any({*pair} <= symbols for pair in IMPEDANCE_PARTS if pair not in MAGNITUDES)
    label = next((label for label in labels if is_phase_without_unit(label)), None)
    if label is not None and not complete:
        raise InvalidInput(f"{path}: line {line}: {label.strip()[:40]!r} needs a unit, 'phase (deg)' or '(rad)'")


def sweep_from_columns(
    path: Path, heading_line: int, headings: list[ColumnHeading | None], rows: list[NumberedCells], *, decimal_sign: str
) -> ImpedanceSweep:
    """Sweep of a table by the headings of its columns.

    Of the first pair of `IMPEDANCE_PARTS` that the table has: the magnitude alone only where there is nothing else.
    """
    known = {heading.symbol for heading in headings if heading}
    pair = next((pair for pair in IMPEDANCE_PARTS if all(part in known for part in pair)), None)
    if "f" not in known or pair is None:
        raise InvalidInput(
            f"{path}: line {heading_line}: names no columns of frequency and impedance, such as"
            " 'frequency (Hz)', '|Z| (ohm)', 'phase (deg)' or 'R (ohm)', 'X (ohm)'"
        )
    if not rows:
        raise InvalidInput(f"{path}: line {heading_line}: no values follow")
    columns = {}
    for symbol in ("f", *pair):
        several = {at: heading for at, heading in enumerate(headings) if heading and heading.symbol == symbol}
        found = {at: _column(path, rows, at, heading, decimal_sign) for at, heading in several.items()}
        columns[symbol], *others = found.values()
        if not all(np.array_equal(columns[symbol], other) for other in others):
            numbers = " and ".join(str(at + 1) for at in found)
            raise InvalidInput(
                f"{path}: line {heading_line}: columns {numbers} are all of {symbol} and differ; keep one of them"
            )
    return sweep_of_parts(columns, pair, lines=np.array([line for line, _ in rows]))


def _column(path: Path, rows: list[NumberedCells], at: int, heading: ColumnHeading, decimal_sign: str) -> Floats:
    """Numbers of one column in SI."""
    values = np.array([_finite_number(path, row, at, decimal_sign) for row in rows])
    with np.errstate(all="ignore"):
        return np.asarray(heading.scale * values)


def _finite_number(path: Path, row: NumberedCells, at: int, decimal_sign: str) -> float:
    """Number in one cell of a row; refuse a missing cell and what is no finite number."""
    line, cells = row
    if at >= len(cells):
        raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where column {at + 1} is required")
    value = parse_number(cells[at], decimal_sign=decimal_sign)
    if value is None or not np.isfinite(value):
        raise InvalidInput(f"{path}: line {line}: {cells[at].strip()[:40]!r} is not a finite number")
    if abs(value) > _LARGEST:
        raise InvalidInput(f"{path}: line {line}: {cells[at].strip()[:40]!r} lies beyond any instrument")
    return value
