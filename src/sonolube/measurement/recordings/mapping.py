"""Mapping of the columns of a file to vocabulary quantities: column, unit, calibration and text layout (TOML)."""

import json
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput, UnknownName, suggestion
from sonolube.measurement.recordings.raw_table import numbered_labels, si_conversion
from sonolube.measurement.run_columns import TEXT_NAMES
from sonolube.text.toml_text import read_toml
from sonolube.text.units import to_si
from sonolube.vocabulary import quantity

AXIS_QUANTITIES = ("time", "revolutions")
"""Quantities that can be the axis of a recording."""

_KEYS = {"title", "recognised_by", "selection", "axis", "text", "channels", "rows"}
_AXIS_KEYS = {"quantity", "column", "unit", "gain", "offset", "sample_rate"}
_CHANNEL_KEYS = {"column", "unit", "gain", "offset", "optional"}
_MAX_PATTERN = 1000  # characters of a regular expression


@dataclass(frozen=True, kw_only=True, slots=True)
class Selection:
    """Choice among the channels and sections of a file.

    Parameters
    ----------
    group : str
        Group of channels (TDMS, HDF5, structure of MATLAB); empty for all.
    channels : tuple of str
        Channels by label, or by name where only one group has it; empty for all. Columns of the time come along.
    sections : tuple of str
        Sections of a text export, by name or by number from 1, joined in the order of the file; empty for all.
    without : tuple of str
        Columns to leave out, by label, of those that no channel of the mapping is read from.
    """

    group: str = ""
    channels: tuple[str, ...] = ()
    sections: tuple[str, ...] = ()
    without: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class ChannelSource:
    """Source of one channel: the column of the file, its unit and its linear calibration.

    Parameters
    ----------
    column : str
        Label of the column in the file, with line breaks written as spaces; where several columns have it, with the
        number of the column among them, such as "force #2".
    unit : str or None
        Unit of the calibrated value; None for the unit stated in the file.
    gain, offset : float
        Calibration: value = gain * reading + offset.
    reading_unit : str or None
        Unit of the reading that the gain takes, "V" of a gain of "2 N/V"; None for the unit stated in the file.
    other_columns : tuple of str
        Labels that stand in its place in other files of the kind; the first one that a file has is read.
    optional : bool
        Whether the channel is left out of a file without such a column, instead of refusing the file.

    Raises
    ------
    InvalidInput
        If the calibration is not finite, or the gain zero.
    """

    column: str
    unit: str | None = None
    gain: float = 1.0
    offset: float = 0.0
    reading_unit: str | None = None
    other_columns: tuple[str, ...] = ()
    optional: bool = False

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the column, in order of precedence."""
        return (self.column, *self.other_columns)

    @property
    def is_calibrated(self) -> bool:
        """Whether gain and offset change a reading."""
        return (self.gain, self.offset) != (1.0, 0.0)

    def calibrated(self, values: Floats, *, stated: str | None, name: str) -> Floats:
        """Values of readings, whose unit a file states or not; refuse a gain without units where it states another."""
        if not self.is_calibrated:
            return values
        written = " ".join((stated or "").split()).strip("()[]")
        if self.reading_unit is not None and written:
            per, shift, _ = si_conversion(written, unit=self.reading_unit, name=name)
            values = values if (per, shift) == (1.0, 0.0) else values * per + shift
        elif written and self.unit and written != self.unit:
            raise InvalidInput(
                f"{name} is in {written} by the file, and its gain of {self.gain:g} has no units: write those of value"
                ' and reading, such as gain = "2 N/V"'
            )
        return values * self.gain + self.offset

    def __post_init__(self) -> None:
        for key, text in (
            ("column", self.column),
            ("unit", self.unit or ""),
            ("unit of gain", self.reading_unit or ""),
        ):
            if not isinstance(text, str):
                raise InvalidInput(f"{key} must be text, got {text!r}")
        require_finite(gain=self.gain, offset=self.offset)
        if self.gain == 0:
            raise InvalidInput(f"gain of column {self.column!r} must not be zero")


@dataclass(frozen=True, kw_only=True, slots=True)
class TextLayout:
    """Layout of a text export: separator, decimal sign, encoding, and where its tables begin and end.

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
        Character encoding, by its Python name; empty to detect UTF-8 and UTF-16, with Windows-1252 as fallback.
    header : str
        Regular expression found in the line of column labels; what stands before it is skipped. Empty where the first
        line, or the first one after `lines_to_skip`, holds the labels.
    units_row : bool
        Whether the row after the labels holds the units.
    comment : str
        Text with which lines begin that are no data.
    section : str
        Regular expression found in the line with which a section begins, such as a step of a test. Its first group, or
        all of the match, is the name of the section. Each section has a table of its own; they are joined in order.
    section_start : str
        Regular expression whose first group is the date and time at which a section began.
    section_start_format : str
        Format of that date and time, as `datetime.strptime` reads it.
    ends_at_blank_line : bool
        Whether a table ends at the first blank line after a row of data; what follows it is not read.
    has_labels : bool
        Whether a line of labels stands above the rows; without one columns are called "column 1", "column 2", ...

    Raises
    ------
    InvalidInput
        If the separator is longer than one character, the decimal sign is neither "." nor ",", both are the same, or a
        regular expression is invalid.
    """

    separator: str = ""
    decimal_sign: str = ""
    lines_to_skip: int = 0
    missing: tuple[str, ...] = ("NA", "N/A", "NaN", "nan", "-", "#N/A", "null")
    encoding: str = ""
    header: str = ""
    units_row: bool = False
    comment: str = ""
    section: str = ""
    section_start: str = ""
    section_start_format: str = ""
    ends_at_blank_line: bool = False
    has_labels: bool = True

    def __post_init__(self) -> None:
        for setting in fields(self):
            value = getattr(self, setting.name)
            if type(value) is not type(setting.default):
                raise InvalidInput(f"{setting.name} must be a {type(setting.default).__name__}, got {value!r}")
        if len(self.separator) > 1 or self.separator in ('"', "\n", "\r"):
            raise InvalidInput(f"separator must be one character, got {self.separator!r}")
        if self.decimal_sign not in ("", ".", ","):
            raise InvalidInput(f'decimal_sign must be "." or ",", got {self.decimal_sign!r}')
        if self.separator and self.separator == self.decimal_sign:
            raise InvalidInput(f"separator and decimal_sign are both {self.separator!r}")
        if self.lines_to_skip < 0:
            raise InvalidInput(f"lines_to_skip must not be negative, got {self.lines_to_skip}")
        for name in ("header", "section", "section_start"):
            _require_pattern(name, getattr(self, name))


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordingMapping:
    """Assignment of the columns of a file to vocabulary quantities, and the layout of its text.

    Parameters
    ----------
    channels : mapping of str to ChannelSource
        Source of each channel, by its vocabulary name, or that of a text of a table of runs.
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
    selection : Selection
        Group, channels and sections to read.
    name : str
        Of the mapping: of the file that holds it, or of the instrument for the ones of the package.
    recognised_by : str
        Regular expression by which the beginning of a file tells that the mapping fits; empty for none.

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
    selection: Selection = field(default_factory=Selection)
    name: str = ""
    recognised_by: str = ""

    def __post_init__(self) -> None:
        for name in self.channels:
            if name not in TEXT_NAMES:
                quantity(name)
        _require_pattern("recognised_by", self.recognised_by)
        if self.axis_quantity not in AXIS_QUANTITIES:
            raise InvalidInput(f"axis.quantity must be one of {', '.join(AXIS_QUANTITIES)}, got {self.axis_quantity!r}")
        if self.sample_rate is not None:
            require_positive(sample_rate=self.sample_rate)
            if self.axis is not None:
                raise InvalidInput("axis: give a column or a sample_rate, not both")

    def for_labels(self, labels: Sequence[str]) -> "RecordingMapping":
        """Mapping with the columns that a file of these labels has, without its absent optional channels."""
        if not (self.channels or self.axis):
            return self
        known = {*labels, *numbered_labels(labels)}
        channels = {name: _present(source, known) for name, source in self.channels.items()}
        kept = {
            name: source for name, source in channels.items() if not (source.optional and source.column not in known)
        }
        return replace(
            self,
            channels=MappingProxyType(kept or channels),
            axis=None if self.axis is None else _present(self.axis, known),
        )

    @property
    def only_selects(self) -> bool:
        """Whether nothing is set but the selection."""
        return self == RecordingMapping(channels=self.channels, selection=self.selection) and not self.channels


def _present(source: ChannelSource, known: Collection[str]) -> ChannelSource:
    """Source with the first of its labels that is known as its only one, the first of all where none is."""
    column = next((label for label in source.labels if label in known), source.column)
    return replace(source, column=column, other_columns=())


def _require_pattern(name: str, pattern: str) -> None:
    """Refuse text that is no regular expression."""
    if not isinstance(pattern, str) or len(pattern) > _MAX_PATTERN:
        raise InvalidInput(f"{name} must be a regular expression of at most {_MAX_PATTERN} characters")
    try:
        re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as failure:
        raise InvalidInput(f"{name} is {pattern!r}, which is no regular expression: {failure}") from None


def read_mapping(path: Path) -> RecordingMapping:
    """Recording mapping read from a TOML file.

    Parameters
    ----------
    path : Path
        Sections `axis`, `text`, `selection`, `rows` and one `channels.NAME` per channel, NAME being a quantity of the
        vocabulary.

    Returns
    -------
    RecordingMapping

    Raises
    ------
    InvalidInput
        Naming the file and the key, if the file is missing, is no TOML, or a key or a value is invalid.
    """
    try:
        return replace(_mapping(read_toml(path, kind="a mapping")), name=path.stem)
    except UnknownName as failure:
        raise InvalidInput(f"{path}: channels: {failure}") from None
    except (InvalidInput, TypeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None


def _mapping(content: dict[str, Any]) -> RecordingMapping:
    """Mapping of a parsed TOML document."""
    _refuse_unknown(content, _KEYS, "")
    axis, text = _section(content, "axis", _AXIS_KEYS), _section(content, "text", _names_of(TextLayout))
    channels = _section(content, "channels", None)
    axis_quantity = axis.pop("quantity", "time")
    rate = axis.pop("sample_rate", None)
    if "missing" in text:
        text["missing"] = _texts(text["missing"], "text.missing")
    selection = _section(content, "selection", _names_of(Selection))
    for key in ("channels", "sections", "without"):
        selection[key] = _texts(selection.get(key, []), f"selection.{key}")
    return RecordingMapping(
        title=str(content.get("title", "")),
        recognised_by=content.get("recognised_by", ""),
        selection=Selection(**selection),
        channels=MappingProxyType(
            {name: _source(_section(channels, name, _CHANNEL_KEYS, "channels."), name) for name in channels}
        ),
        axis=_source(axis, "axis") if axis else None,
        axis_quantity=axis_quantity,
        sample_rate=to_si(rate, unit="Hz", name="axis.sample_rate") if isinstance(rate, str) else rate,
        text=TextLayout(**text),
        rows=MappingProxyType({name: str(value) for name, value in _section(content, "rows", None).items()}),
    )


def _source(keys: dict[str, Any], name: str) -> ChannelSource:
    """Source of a channel, whose column may be a list of labels in order of precedence."""
    first, *others = _texts(keys.pop("column", ()), f"{name}.column") or (None,)
    if first is None:
        raise InvalidInput(f"{name}.column is missing")
    if isinstance(keys.get("gain"), str):
        keys |= _gain_with_units(keys["gain"], keys.get("unit"), f"{name}.gain")
    return ChannelSource(column=first, other_columns=tuple(label for label in others if label), **keys)


def source_with_gain(column: str, text: str) -> ChannelSource | None:
    """Source of a channel by a gain with units, such as "2 N/V"; None for another text."""
    return ChannelSource(column=column, **_gain_with_units(text, None, column)) if _GAIN.fullmatch(text) else None


_GAIN = re.compile(r"\s*([-+\d.eE]+)\s*([^/\d][^/]*|1)/([^/]+)")


def _gain_with_units(text: str, unit: Any, name: str) -> dict[str, Any]:
    """Gain of a text such as "2 N/V", with the units of the value and of the reading."""
    found = _GAIN.fullmatch(text)
    if found is None:
        raise InvalidInput(f'{name} {text[:60]!r} needs a number and the units of value and reading, such as "2 N/V"')
    number, of_value, of_reading = (part.strip() for part in found.groups())
    if unit is not None and unit != of_value:
        raise InvalidInput(f"{name} {text!r} gives a value in {of_value}, but unit is {unit!r}; leave unit out")
    try:
        gain = float(number)
    except ValueError:
        raise InvalidInput(f"{name} {text[:60]!r}: {number!r} is no number") from None
    return {"gain": gain, "unit": of_value, "reading_unit": of_reading}


def _names_of(record: type[Selection | TextLayout]) -> set[str]:
    """Keys of a section, which are those of its record."""
    return {each.name for each in fields(record)}


def _texts(value: Any, name: str) -> tuple[str, ...]:
    """Text or a list of texts as a tuple."""
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, (list, tuple)) or not all(isinstance(text, str) for text in texts):
        raise InvalidInput(f"{name} must be a text or a list of texts, got {value!r}")
    return tuple(texts)


def _section(content: Mapping[str, Any], name: str, known: set[str] | None, prefix: str = "") -> dict[str, Any]:
    """Section as a new dictionary; refuse what is no section and unknown keys."""
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


def mapping_toml(mapping: RecordingMapping) -> str:
    """Mapping as the text of its file, entries of their default value left out."""
    axis: dict[str, Any] = {} if mapping.axis_quantity == "time" else {"quantity": mapping.axis_quantity}
    axis |= {} if mapping.sample_rate is None else {"sample_rate": mapping.sample_rate}
    axis |= {} if mapping.axis is None else _source_entries(mapping.axis)
    tables = {
        "": {name: getattr(mapping, name) for name in ("title", "recognised_by") if getattr(mapping, name)},
        "text": _changed(mapping.text),
        "axis": axis,
        **{f"channels.{name}": _source_entries(source) for name, source in mapping.channels.items()},
        "rows": dict(mapping.rows),
        "selection": _changed(mapping.selection),
    }
    return "\n".join("".join(_lines(name, table)) for name, table in tables.items() if table)


def _lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Lines of a table."""
    if name:
        yield f"[{name}]\n"
    for key, value in table.items():
        yield f"{key if key.isidentifier() and key.isascii() else _text(key)} = {_text(value)}\n"


def _text(value: Any) -> str:
    """Value in TOML, whose texts and lists are those of JSON but for characters that it wants escaped."""
    text = json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return text.replace("\x7f", "\\u007f")


def _source_entries(source: ChannelSource) -> dict[str, Any]:
    """Entries of a channel or an axis."""
    changed = {key: value for key, value in _changed(source).items() if key not in ("column", "other_columns")}
    if reading_unit := changed.pop("reading_unit", None):
        changed["gain"] = f"{source.gain!r} {changed.pop('unit')}/{reading_unit}"
    return {"column": source.labels if source.other_columns else source.column} | changed


def _changed(record: Any) -> dict[str, Any]:
    """Entries of a record that are not at their default."""
    values = ((each, getattr(record, each.name)) for each in fields(record))
    return {each.name: value for each, value in values if value != each.default}
