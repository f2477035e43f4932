"""Mapping of an instrument's columns to vocabulary quantities: column, unit, calibration and text layout (TOML)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sonolube.checks import require_finite, require_positive
from sonolube.errors import InvalidInput, UnknownName, suggestion
from sonolube.toml_text import read_toml
from sonolube.units import to_si
from sonolube.vocabulary import quantity

AXIS_QUANTITIES = ("time", "revolutions")
"""Quantities that can be the axis of a recording."""

_KEYS = {"title", "axis", "text", "channels", "rows"}
_AXIS_KEYS = {"quantity", "column", "unit", "gain", "offset", "sample_rate"}
_TEXT_KEYS = {"separator", "decimal_sign", "lines_to_skip", "missing", "encoding"}
_CHANNEL_KEYS = {"column", "unit", "gain", "offset"}


@dataclass(frozen=True, kw_only=True, slots=True)
class ChannelSource:
    """Source of one channel: the column of the file, its unit and its linear calibration.

    Parameters
    ----------
    column : str
        Label of the column in the file, with line breaks written as spaces.
    unit : str or None
        Unit of the calibrated value; None for the unit stated in the file.
    gain, offset : float
        Calibration: value = gain * reading + offset.

    Raises
    ------
    InvalidInput
        If the calibration is not finite, or the gain zero.
    """

    column: str
    unit: str | None = None
    gain: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        for key, text in (("column", self.column), ("unit", self.unit or "")):
            if not isinstance(text, str):
                raise InvalidInput(f"{key} must be text, got {text!r}")
        require_finite(gain=self.gain, offset=self.offset)
        if self.gain == 0:
            raise InvalidInput(f"gain of column {self.column!r} must not be zero")


@dataclass(frozen=True, kw_only=True, slots=True)
class TextLayout:
    """Layout of a text export: separator, decimal sign, skipped lines, missing-value texts and encoding.

    Parameters
    ----------
    separator : str
        Character between cells; empty to detect it.
    decimal_sign : str
        "." or ","; empty to detect it.
    lines_to_skip : int
        Lines before the line of column labels.
    missing : tuple of str
        Texts that stand for a missing value, beside empty cells.
    encoding : str
        Character encoding, by its Python name.

    Raises
    ------
    InvalidInput
        If the separator is longer than one character, the decimal sign is neither "." nor ",", or both are the same.
    """

    separator: str = ""
    decimal_sign: str = ""
    lines_to_skip: int = 0
    missing: tuple[str, ...] = ("NA", "N/A", "NaN", "nan", "-", "#N/A", "null")
    encoding: str = "utf-8-sig"

    def __post_init__(self) -> None:
        if len(self.separator) > 1 or self.separator in ('"', "\n", "\r"):
            raise InvalidInput(f"separator must be one character, got {self.separator!r}")
        if self.decimal_sign not in ("", ".", ","):
            raise InvalidInput(f'decimal_sign must be "." or ",", got {self.decimal_sign!r}')
        if self.separator and self.separator == self.decimal_sign:
            raise InvalidInput(f"separator and decimal_sign are both {self.separator!r}")
        if self.lines_to_skip < 0:
            raise InvalidInput(f"lines_to_skip must not be negative, got {self.lines_to_skip}")


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordingMapping:
    """Assignment of the columns of a file to vocabulary quantities, and the layout of its text.

    Parameters
    ----------
    channels : mapping of str to ChannelSource
        Source of each channel, by its vocabulary name.
    axis : ChannelSource or None
        Column of the axis (independent variable); None where `sample_rate` or the file states it.
    axis_quantity : str
        Quantity of the axis: "time", or "revolutions" for exports with one row per cycle.
    sample_rate : float or None
        Rows per second, where no column holds the time. [Hz]
    text : TextLayout
        Layout of a text export.
    rows : mapping of str to str
        Required cell by column label; only matching rows are read, such as one test out of a file of many.
    title : str
        Title of the recording.

    Raises
    ------
    UnknownName
        If a channel's name is not in the vocabulary.
    InvalidInput
        If the axis quantity is unknown, or both a column and a sample rate define the axis.
    """

    channels: Mapping[str, ChannelSource]
    axis: ChannelSource | None = None
    axis_quantity: str = "time"
    sample_rate: float | None = None
    text: TextLayout = field(default_factory=TextLayout)
    rows: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    title: str = ""

    def __post_init__(self) -> None:
        for name in self.channels:
            quantity(name)
        if self.axis_quantity not in AXIS_QUANTITIES:
            raise InvalidInput(f"axis.quantity must be one of {', '.join(AXIS_QUANTITIES)}, got {self.axis_quantity!r}")
        if self.sample_rate is not None:
            require_positive(sample_rate=self.sample_rate)
            if self.axis is not None:
                raise InvalidInput("axis: give a column or a sample_rate, not both")


def read_mapping(path: Path) -> RecordingMapping:
    """Return a recording mapping read from a TOML file.

    Parameters
    ----------
    path : Path
        Sections `axis`, `text`, `rows` and one `channels.NAME` per channel, NAME being a quantity of the vocabulary.

    Returns
    -------
    RecordingMapping

    Raises
    ------
    InvalidInput
        Naming the file and the key, if the file is missing, is no TOML, or a key or a value is invalid.
    """
    try:
        return _mapping(read_toml(path, kind="a mapping"))
    except UnknownName as failure:
        raise InvalidInput(f"{path}: channels: {failure}") from None
    except (InvalidInput, TypeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None


def _mapping(content: dict[str, Any]) -> RecordingMapping:
    """Return the mapping of a parsed TOML document."""
    _refuse_unknown(content, _KEYS, "")
    axis, text = _section(content, "axis", _AXIS_KEYS), _section(content, "text", _TEXT_KEYS)
    channels = _section(content, "channels", None)
    axis_quantity = axis.pop("quantity", "time")
    rate = axis.pop("sample_rate", None)
    if "missing" in text:
        text["missing"] = tuple(text["missing"])
    return RecordingMapping(
        title=str(content.get("title", "")),
        channels=MappingProxyType(
            {name: ChannelSource(**_section(channels, name, _CHANNEL_KEYS, "channels.")) for name in channels}
        ),
        axis=ChannelSource(**axis) if axis else None,
        axis_quantity=axis_quantity,
        sample_rate=to_si(rate, unit="Hz", name="axis.sample_rate") if isinstance(rate, str) else rate,
        text=TextLayout(**text),
        rows=MappingProxyType({name: str(value) for name, value in _section(content, "rows", None).items()}),
    )


def _section(content: Mapping[str, Any], name: str, known: set[str] | None, prefix: str = "") -> dict[str, Any]:
    """Return a section as a new dictionary; refuse what is no section and unknown keys."""
    section = content.get(name, {})
    if not isinstance(section, dict):
        raise InvalidInput(f"{prefix}{name} must be a section, got {section!r}")
    if known is not None:
        _refuse_unknown(section, known, f"{prefix}{name}.")
    return dict(section)


def _refuse_unknown(section: Mapping[str, Any], known: set[str], prefix: str) -> None:
    """Refuse a key that is not among the known ones, with the closest."""
    for key in section:
        if key not in known:
            raise InvalidInput(f"{prefix}{key}: unknown key; {suggestion(key, known) or 'known: ' + ', '.join(known)}")
