"""Meaning of the columns of a table of runs: quantity and unit by heading or statement, and the mapping of them."""

import difflib
import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, Selection, TextLayout
from sonolube.measurement.recordings.raw_table import column_of_label, is_unit_of, numbered_labels
from sonolube.measurement.recordings.text_tables import NumberedCells, TextTable
from sonolube.measurement.run_columns import RUN_COLUMNS, TEXT_NAMES
from sonolube.measurement.run_numbers import cell_number
from sonolube.text.units import COMMON_FACTORS, unit_description
from sonolube.vocabulary import quantities

_OWN: Final = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")  # as the tables of sonolube have it
_WITH_UNIT: Final = tuple(
    re.compile(rf"(.+?){between}")
    for between in (r"\s*\[([^\[\]]*)\]", r"\s*\(([^()]*)\)", r"\s*/\s*(.+)", r"\s+in\s+(.+)", r"\s*,\s*(.+)")
)
_UNIT_WITHIN: Final = re.compile(r"(.*?)\s*\[([^\[\]]*)\]\s*(.*)")
_LONGEST: Final = 200  # characters of a heading that is looked at
_DIRECTION: Final = re.compile(
    r"direction|orientation|longitudinal|transvers|perpendicular|angle|richtung|orientierung|längs|\bquer|winkel"
)
_LUBRICANT: Final = re.compile(
    r"lubric|schmier|\boils?\b|\b\w*öl\b|grease|\bfett\b|coolant|emulsion|\bfluid|\bdry\b|trocken"
)
_UNIT: Final = re.compile(r"\b(?:units?|einheit(?:en)?)\b")
_SETTING: Final = re.compile(
    r"voltage|spannung|amplitude|schwing\w*weite|displacement|auslenkung|frequency|frequenz"
    r"|speed|velocity|geschwindigkeit|drehzahl|rpm"
)
_OF_UNIT: Final = {"N": "a force", "V": "a voltage"}  # what a column of unknown heading looks like, by its SI unit
_NOT_BY_LIKENESS: Final = "direction"  # a text that no estimate uses: only a table that spells it so means that
_PARTS: Final = ("%", "‰")  # units of pure numbers
_UNITS: Final = frozenset(
    {unit for factors in COMMON_FACTORS.values() for unit in factors if unit}
    | {"°", "deg", "°c", "degc", "rpm", "1/min", "µm", "μm", "µm/s", "μm/s"}
)
_WORD: Final = r"(?<![^\W_])(?:{})(?![^\W_])"
_PEAK_TO_PEAK: Final = re.compile(
    _WORD.format(r"p\s?-?\s?p|pk\s?-?\s?pk|peak[\s-]*(?:to[\s-]*)?peak|spitze[\s-]*(?:zu[\s-]*)?(?:spitze|tal)|ss")
    + r"|(?<=[Vm])_?(?:pp|ss|p-p)(?![^\W_])",
    re.IGNORECASE,
)
_ZERO_TO_PEAK: Final = re.compile(
    _WORD.format(r"(?:0|zero|null)[\s-]*(?:to[\s-]*)?(?:p|pk|peak|spitze)"), re.IGNORECASE
)
_HALF: Final = 0.5  # zero to peak over peak to peak
_MARKS: Final = {_HALF: "pp", 1 / _HALF: "0-p"}  # of statements, by the gain
_LENGTHS: Final = ("displacement", "vibration", "Schwingweite", "Schwingungsweite", "Auslenkung", "Schwingweg")
_VOLTAGES: Final = ("U", "V", "voltage", "drive voltage", "drive", "Spannung", "Anregungsspannung")
_WITH: Final = frozenset({"on", "with", "mit", "ein", "an"})
_WITHOUT: Final = frozenset({"off", "without", "ohne", "aus", "no", "kein", "keine"})
_OF_VIBRATION: Final = frozenset(
    {"us", "ultrasound", "ultrasonic", "ultrasonics", "ultraschall", "vibration", "vibrations", "schwingung", "vib"}
)
_SPREAD: Final = re.compile(
    _WORD.format(
        r"s\.?\s?d\.?|std\.?(?:[\s_-]*dev(?:iation)?\.?)?|st\.?\s?dev\.?|stdev|standard[\s_-]*(?:deviation|error|uncertainty)"
        r"|s\.?e\.?m\.?|st[da]?abw\.?|standard(?:abweichung|fehler|unsicherheit)|(?:mess)?unsicherheit|uncertainty|sigma"
    )
    + r"|\+\s?/?\s?-|±|σ",
    re.IGNORECASE,
)
_OF: Final = re.compile(r"^[\s,;:_/-]*(?:of|in|for|von|der|des|für)\b|[\[(]\s*[\])]|^[\s,;:_/-]+|[\s,;:_/-]+$")
_UNCERTAINTY_OF: Final = {"friction_ratio": "friction_reduction_uncertainty"}
_HAVE_STATES: Final = ("friction_force", "friction_coefficient", "wear_rate")


@dataclass(frozen=True, slots=True)
class RunHeading:
    """Meaning of a heading.

    Parameters
    ----------
    name : str
        Quantity of the vocabulary, or name of a text.
    unit : str
        As written; empty where none is.
    gain : float
        Quantity over what the column has: a half of an amplitude that is written peak to peak.
    """

    name: str
    unit: str = ""
    gain: float = 1.0

    @property
    def statement(self) -> str:
        """Quantity and unit as `meaning` reads them."""
        return " ".join(filter(None, (self.name, self.unit, _MARKS.get(self.gain, ""))))

    def source(self, label: str) -> ChannelSource:
        """Source of the quantity, the column of a label."""
        unit = None if self.name in TEXT_NAMES else self.unit
        if self.gain == 1:
            return ChannelSource(column=label, unit=unit)
        return ChannelSource(column=label, unit=unit, gain=self.gain, reading_unit=unit)


def run_heading(label: str) -> RunHeading | None:
    """Quantity and unit of the heading of a column; None where it is not known."""
    text = " ".join(label.split())
    own = _OWN.fullmatch(text)
    if own and (own[1] in quantities() or own[1] in TEXT_NAMES):
        return RunHeading(own[1], own[2] or "")
    if len(text) > _LONGEST:
        return None
    if found_spread := _of_spread(text):
        return found_spread
    if of_peaks := _of_peaks(text):
        return of_peaks
    with_unit = list(_with_unit(text))
    if found := next(filter(fits, with_unit), None) or _of_state(text):
        return found
    whole = None if _has_unit_in_brackets(text) else _names().get(_plain(text))
    return RunHeading(whole) if whole else next(iter(with_unit), None)


def _has_unit_in_brackets(text: str) -> bool:
    """Whether a heading ends in brackets around a unit."""
    found = re.search(r"[\[(]([^\[\]()]*)[\])]\Z", text)
    return found is not None and found[1].strip() in _UNITS


def uncertainty_of(name: str) -> str:
    """Quantity of the standard uncertainty of another; empty where the vocabulary has none."""
    own = _UNCERTAINTY_OF.get(name, f"{name}_uncertainty")
    return own if own in quantities() else ""


def is_spread(label: str) -> bool:
    """Whether a heading is that of a standard deviation or uncertainty.

    Names of the vocabulary are none, nor is what may be a lubricant or a direction, such as "Std. oil".
    """
    if len(label) > _LONGEST or not _SPREAD.search(label):
        return False
    own, plain = _OWN.fullmatch(" ".join(label.split())), _plain(label)
    is_known = own is not None and own[1] in quantities()
    return not (is_known or _LUBRICANT.search(plain) or _DIRECTION.search(plain))


def _without_spread(text: str) -> str:
    """Rest of the heading of a spread: of what it is, and its unit."""
    rest = _SPREAD.sub(" ", text, count=1).strip()
    return _OF.sub("", _OF.sub("", rest)).strip()


def _of_spread(text: str) -> RunHeading | None:
    """Uncertainty of the quantity that the heading of a spread names; None where it names none that has one."""
    rest = _without_spread(text) if is_spread(text) else ""
    owner = run_heading(rest) if rest else None
    own = uncertainty_of(owner.name) if owner is not None and owner.gain == 1 else ""
    return RunHeading(own, owner.unit) if own and owner is not None else None


def spread_headings(labels: Sequence[str], meanings: Sequence[RunHeading | None]) -> dict[int, RunHeading]:
    """Uncertainties that columns of spreads hold, by their places, where it is clear to which column each belongs.

    One that names a quantity belongs to that; one that names none to the column before it, unless that stands behind
    another result without a spread, whose it may be as well. The unit is its own, else that of the column. Shares of a
    pure number may be of the number or of its value, and are not clear.
    """
    spread = [is_spread(label) for label in labels]
    found: dict[int, RunHeading] = {}
    for place in (at for at, each in enumerate(spread) if each):
        own = _of_spread(" ".join(labels[place].split()))
        rest = _without_spread(" ".join(labels[place].split())).strip("[]() ")
        if own is not None:
            owner = next((each for each in meanings if each and uncertainty_of(each.name) == own.name), None)
        elif (rest and rest not in _UNITS) or place == 0 or spread[place - 1]:
            continue
        else:
            owner = meanings[place - 1]
            before = meanings[place - 2] if place > 1 and not spread[place - 2] else None
            if owner is None or (owner.name in _RESULTS and before is not None and before.name in _RESULTS):
                continue
        unit = (own.unit if own else rest) or (owner.unit if owner else "")
        name = own.name if own else uncertainty_of(owner.name) if owner else ""
        heading = RunHeading(name, unit)
        is_share = unit in _PARTS and (owner is None or owner.unit not in _PARTS)
        if name and fits(heading) and not is_share and heading.name not in {each.name for each in found.values()}:
            found[place] = heading
    return found


_RESULTS: Final = tuple(column.name for column in RUN_COLUMNS if column.is_result)


def fits(found: RunHeading) -> bool:
    """Whether the unit of a heading is one of its quantity, and is there where the quantity has one."""
    if found.name in TEXT_NAMES:
        return not found.unit
    unit = quantities()[found.name].unit
    return is_unit_of(found.unit, unit) if found.unit else not unit


def meaning_at_stake(label: str) -> str:
    """Why a column of unknown heading must not be left out unasked: what it looks like; empty where it may be."""
    text = _plain(label)
    bare = label.strip().strip("[]()").strip()
    if _UNIT.search(text) or bare in _UNITS or bare.lower() in _UNITS:
        return "a unit"
    if _DIRECTION.search(text):
        return "a direction"
    if _LUBRICANT.search(text):
        return "a lubricant"
    if _SETTING.search(text) or any(f" {words} " in f" {text} " for words in _settings()):
        return "a setting of the run"
    written = [unit for _, unit in _splits(label[:_LONGEST]) if unit]
    kinds = (kind for unit, kind in _OF_UNIT.items() if any(is_unit_of(each, unit) for each in written))
    return next(kinds, "")


_MAX_LIKELY: Final = 3
_LEAST_LIKENESS: Final = 0.6


def likely_statements(label: str) -> list[str]:
    """Statements of quantity and unit that a column of unknown meaning may have, the likeliest first."""
    text = _plain(label)
    written = [unit for _, unit in _splits(label[:_LONGEST]) if unit]
    if "weite" in text:
        unit = next((each for each in written if is_unit_of(each, "m")), "um")
        return [f"vibration_amplitude {unit} pp", f"vibration_amplitude {unit}"]
    scores: list[tuple[float, str]] = []
    for column in RUN_COLUMNS:
        if column.is_text or column.name.endswith("_uncertainty"):
            continue
        known = quantities()[column.name]
        unit = next(
            (each for each in written if known.unit and each not in _PARTS and is_unit_of(each, known.unit)), ""
        )
        names = [_plain(each) for each in (column.name, *known.also)]
        likeness = max(difflib.SequenceMatcher(None, text, each).ratio() for each in names)
        likeness = max([likeness, *(0.9 for each in names if len(each) > 2 and f" {each} " in f" {text} ")])
        if unit or (likeness >= _LEAST_LIKENESS and not _has_unit_in_brackets(label)):
            scores.append((likeness + bool(unit), f"{column.name} {unit or column.unit}".strip()))
    return [statement for _, statement in sorted(scores, key=lambda each: -each[0])[:_MAX_LIKELY]]


def _splits(text: str) -> Iterator[tuple[str, str]]:
    """Words before and after a unit with that unit, as a heading may be read; without a unit last."""
    for pattern in _WITH_UNIT:
        if found := pattern.fullmatch(text):
            yield found[1], found[2].strip()
    if found := _UNIT_WITHIN.fullmatch(text):
        yield f"{found[1]} {found[3]}", found[2].strip()
    for gap in reversed(list(re.finditer(r"[\s_]+", text))):
        yield text[: gap.start()], text[gap.end() :]
    yield text, ""


def _with_unit(text: str) -> Iterator[RunHeading]:
    """Headings of a known name before a unit; behind a blank or an underscore only what is a unit of the quantity."""
    for pattern in (*_WITH_UNIT, _UNIT_WITHIN):
        if found := pattern.fullmatch(text):
            words = _plain(" ".join((found[1], *found.groups()[2:])))
            each = RunHeading(known, found[2].strip()) if (known := _named(words)) else None
            if each is not None and (len(words) > 1 or fits(each)):  # one letter stands for many things
                yield each
    for gap in reversed(list(re.finditer(r"[\s_]+", text))):
        if name := _names().get(_plain(text[: gap.start()])):
            found_behind = RunHeading(name, text[gap.end() :])
            is_number = name not in TEXT_NAMES and not quantities()[name].unit
            if fits(found_behind) and (not is_number or found_behind.unit in _PARTS):
                yield found_behind


def _named(words: str) -> str:
    """Quantity of words that name it, alone or with its symbol behind them; empty where they name none."""
    if name := _names().get(words):
        return name
    parts = words.split()
    both = ((" ".join(parts[:at]), " ".join(parts[at:])) for at in range(1, len(parts)))
    pairs = ((_names().get(before, ""), _names().get(behind)) for before, behind in both)
    return next((before for before, behind in pairs if before and before == behind), "")


def _of_peaks(text: str) -> RunHeading | None:
    """Amplitude or voltage by a heading that says between which peaks it is; None where it does not."""
    is_swing = _PEAK_TO_PEAK.search(text) is not None
    pattern = _PEAK_TO_PEAK if is_swing else _ZERO_TO_PEAK
    if not pattern.search(text):
        return None
    rest = re.sub(r"\[\s*\]|\(\s*\)", "", pattern.sub(" ", text)).strip(" ,;-_")
    found: list[RunHeading] = []
    for words, unit in [*_splits(rest), ("", rest.strip("[]() "))]:
        base, written = _plain(words), unit.strip()
        if base in _amplitudes():
            found.append(RunHeading("vibration_amplitude", written, _HALF if is_swing else 1.0))
        if base in _voltages():
            found.append(RunHeading("voltage_peak_to_peak", written, 1.0 if is_swing else 1 / _HALF))
    return next(filter(fits, found), None) or next((each for each in found if not each.unit), None)


def _of_state(text: str) -> RunHeading | None:
    """Friction or wear with or without vibration by a heading that says so; None where it does not."""
    spelled = re.sub(r"\bw/o\b", "without", text, flags=re.IGNORECASE)
    found: list[RunHeading] = []
    for words, unit in _splits(spelled):
        tokens = _plain(words).split()
        stated = [each for each in tokens if each in _WITH | _WITHOUT | _OF_VIBRATION]
        base = " ".join(each for each in tokens if each not in stated)
        name = "friction_force" if base == "f" else _names().get(base, "")
        if stated and name in _HAVE_STATES:
            is_without = not _WITHOUT.isdisjoint(stated)
            found.append(RunHeading(f"intrinsic_{name}" if is_without else name, unit))
    return next(filter(fits, found), None) or next((each for each in found if not each.unit), None)


def _plain(text: str) -> str:
    """Words of a heading in small letters, without signs between them."""
    return re.sub(r"[\W_]+", " ", unicodedata.normalize("NFKC", text).casefold()).strip()


@cache
def _names() -> dict[str, str]:
    """Names of quantities and texts by their headings in plain words; another heading counts before a name."""
    names = {_plain(each): known.name for known in quantities().values() for each in known.also}
    names |= {_plain(each): column.name for column in RUN_COLUMNS for each in column.also}
    for name in (*quantities(), *TEXT_NAMES):
        if name != _NOT_BY_LIKENESS:
            names.setdefault(_plain(name), name)
    return names


@cache
def _amplitudes() -> frozenset[str]:
    """Words for the amplitude of a vibration beside those for its peaks."""
    return frozenset({"", *map(_plain, (*_LENGTHS, "vibration_amplitude", *quantities()["vibration_amplitude"].also))})


@cache
def _voltages() -> frozenset[str]:
    """Words for the voltage of the drive beside those for its peaks."""
    return frozenset({"", *map(_plain, (*_VOLTAGES, *quantities()["voltage_peak_to_peak"].also))})


@cache
def _settings() -> tuple[str, ...]:
    """Headings of what is set in a run, in plain words of four letters or more."""
    names = [column.name for column in RUN_COLUMNS if not (column.is_text or column.is_result)]
    every = {_plain(each) for name in names for each in (name, *quantities()[name].also)}
    return tuple(sorted(words for words in every if len(words) >= 4))


_STATES: Final = {
    **dict.fromkeys(("on", "ein", "an", "with", "mit", "1", "yes", "ja", "true", "x"), True),
    **dict.fromkeys(("off", "aus", "without", "ohne", "0", "no", "nein", "false", ""), False),
}  # whether a row is with vibration, by the word in a column of states
_IS_STATE: Final = re.compile(
    r"ultraso|ultrascha|\bus\b|vibration|schwingung|\bstate|zustand|sonotrod|excitation|anregung"
    r"|\bmode\b|\bmodus\b|on ?/ ?off|(?:ein|an) ?/ ?aus"
)


def state_column(labels: Sequence[str], rows: Sequence[NumberedCells], taken: Collection[str]) -> int | None:
    """Place of the column that says of each row whether it is with vibration; None where none does."""
    for place, (label, numbered) in enumerate(zip(labels, numbered_labels(labels), strict=True)):
        words = {_state_word(cells, place) for _, cells in rows}
        if label in taken or numbered in taken or len(words) != len({True, False}) or not words <= _STATES.keys():
            continue
        is_named = _IS_STATE.search(label.casefold()) is not None and run_heading(label) is None
        if is_named and len({_STATES[word] for word in words}) > 1:
            return place
    return None


def is_without_vibration(cells: Sequence[str], place: int) -> bool:
    """Whether a row is without vibration, by the column of states."""
    return not _STATES[_state_word(cells, place)]


def _state_word(cells: Sequence[str], place: int) -> str:
    """Word for the state in a row."""
    words = (cells[place] if place < len(cells) else "").casefold().split()
    return " ".join(each for each in words if each.strip("()") not in _OF_VIBRATION)


LEFT_OUT: Final = "-"
"""Statement that leaves a column out."""

STATES: Final = "with or without vibration"
"""Meaning of a column that says so of each row."""

_MAX_CELLS: Final = 3  # that tell what a column holds

Meaning = RunHeading | str
"""Quantity and unit of a column, `STATES` or `LEFT_OUT`."""


def stated_columns(table: TextTable, statements: Mapping[str, str], path: Path) -> dict[str, Meaning | None]:
    """Meaning of each column by its label: as stated, else by its heading; None without meaning or unit."""
    labels = numbered_labels(table.labels)
    if "" in labels:
        place = labels.index("") + 1
        raise InvalidInput(f"{path}: line {table.line}: column {place} has no heading; name it, or delete the column")
    known = {label: label for label in labels}
    found: dict[str, Meaning | None] = {
        label: _by_heading(own) for label, own in zip(labels, table.labels, strict=True)
    }
    for place, label in enumerate(labels):
        if found[label] is None and _has_its_units(table, place):
            found[label] = run_heading(table.labels[place])
    stated = {column_of_label(known, label, path): meaning(text, label) for label, text in statements.items()}
    found |= stated
    meanings = [each if isinstance(each, RunHeading) else None for each in found.values()]
    spreads = spread_headings(table.labels, meanings)
    for place, label in enumerate(labels):
        if is_spread(table.labels[place]) and label not in stated:
            found[label] = spreads.get(place, LEFT_OUT)
    if (place_of_states := state_column(table.labels, table.rows, statements)) is not None:
        found[labels[place_of_states]] = STATES
    return found


def _has_its_units(table: TextTable, place: int) -> bool:
    """Whether the heading of a column is known but for a unit, which every filled cell has."""
    if (found := run_heading(table.labels[place])) is None or found.unit or found.name in TEXT_NAMES:
        return False
    cells = [cells[place].strip() for _, cells in table.rows if "".join(cells[place : place + 1]).strip()]
    units = [stated.unit for cell in cells if (stated := cell_number(cell, sign="." if "." in cell else ","))]
    return bool(cells) and len(units) == len(cells) and all(units)


def meaning(text: str, label: str) -> Meaning:
    """Quantity and unit that a text such as "friction_force N" states, `STATES` or `LEFT_OUT`."""
    if text.strip() in (LEFT_OUT, STATES):
        return text.strip()
    name, _, unit = text.strip().partition(" ")
    found = run_heading(text)
    if name in quantities() or name in TEXT_NAMES:
        found = _stated(name, unit.strip(" []()"))
    if found is None:
        likely = likely_statements(text) or likely_statements(label) or ["friction_force N"]
        raise InvalidInput(f"column {label!r}: {text!r} is no quantity; did you mean {' or '.join(likely)}?")
    if not fits(found):
        unit = "" if found.name in TEXT_NAMES else quantities()[found.name].unit
        expected = unit_description(unit) if unit else "none"
        raise InvalidInput(f"column {label!r}: {text!r} has no unit of {found.name}; expected {expected}")
    return found


def _stated(name: str, unit: str) -> RunHeading:
    """Quantity with a unit behind which "pp" or "0-p" may stand."""
    for gain, mark in _MARKS.items():
        if unit.endswith(f" {mark}") and name == ("vibration_amplitude" if gain < 1 else "voltage_peak_to_peak"):
            return RunHeading(name, unit.removesuffix(mark).strip(), gain)
    return RunHeading(name, unit)


def samples(table: TextTable, label: str) -> list[str]:
    """First cells of a column that are not empty."""
    place = numbered_labels(table.labels).index(label)
    filled = [cells[place].strip() for _, cells in table.rows if "".join(cells[place : place + 1]).strip()]
    return filled[:_MAX_CELLS]


def _by_heading(label: str) -> RunHeading | None:
    """Meaning of a column by its heading, where that has its unit too."""
    found = run_heading(label)
    return found if found is not None and fits(found) else None


def mapping_of_columns(table: TextTable, columns: Mapping[str, Meaning], *, decimal_sign: str = "") -> RecordingMapping:
    """Mapping of the columns of a table; a time is the axis, which tables of runs have no use for."""
    sources = {found.name: found.source(label) for label, found in columns.items() if isinstance(found, RunHeading)}
    axis = sources.pop("time", None)
    return RecordingMapping(
        channels=MappingProxyType(sources),
        axis=axis,
        selection=Selection(without=tuple(label for label, found in columns.items() if found == LEFT_OUT)),
        text=TextLayout(lines_to_skip=table.line - 1, decimal_sign=decimal_sign),
    )


def columns_of_mapping(table: TextTable, mapping: RecordingMapping) -> dict[str, Meaning]:
    """Meaning of each column by a mapping of its label, the reverse of `mapping_of_columns`; others are left out."""
    labels = numbered_labels(table.labels)
    known = mapping.for_labels(table.labels)
    sources = {**known.channels, **({known.axis_quantity: known.axis} if known.axis else {})}
    found = {source.column: RunHeading(name, source.unit or "", source.gain) for name, source in sources.items()}
    return {label: found.get(label, LEFT_OUT) for label in labels if label}
