"""A chart as an object for JSON, its numbers as tables, and curves of more values than a page resolves."""

from dataclasses import fields, is_dataclass
from math import isfinite
from typing import Any

import numpy as np

from sonolube.charts.chart import Axis, Band, Bars, Chart, Field, Line, Panel, Part, Points
from sonolube.checks import Floats
from sonolube.figure import COLOURS
from sonolube.text.plain_text import with_micro_sign

_DIGITS = 6  # significant ones, more than a screen resolves


def chart_object(chart: Chart) -> dict[str, Any]:
    """Chart as an object for JSON.

    Parameters
    ----------
    chart : Chart

    Returns
    -------
    dict
        The fields of chart, panels, axes and parts by their names, each with its kind, such as "line"; axes and fields
        also with label and unit as one text. Colours are written as "#0072b2"; numbers have six digits, and None stands
        for NaN. Empty fields are left out.
    """
    return _record_object(chart)


def chart_tables(chart: Chart) -> list[dict[str, Any]]:
    """Numbers of a chart as tables, one for each part with numbers.

    Parameters
    ----------
    chart : Chart

    Returns
    -------
    list of dict
        With "title", "heads" and "rows" of text; fields have a row for each y and a column for each x.
    """
    tables = []
    for panel in chart.panels:
        for part in panel.parts:
            columns = _columns(panel, part)
            if columns:
                title = ", ".join(filter(None, (panel.title or panel.y.label, getattr(part, "label", ""))))
                rows = [list(row) for row in zip(*columns.values(), strict=True)]
                tables.append({"title": title, "heads": list(columns), "rows": rows})
    return tables


def _record_object(record: Any) -> dict[str, Any]:
    """Fields of a record that are not empty."""
    found = {"kind": type(record).__name__.lower()}
    if isinstance(record, Axis):
        found["text"] = record.text
    if isinstance(record, Field):
        found["scale_text"] = record.scale_text
    for each in fields(record):
        value = getattr(record, each.name)
        if each.name == "colour":
            found[each.name] = colour_code(value)
        elif isinstance(value, np.ndarray | np.generic) or not (value is None or value is False or value in ("", ())):
            found[each.name] = _plain(value)
    return found


def _plain(value: Any) -> Any:
    """Value of a field for JSON."""
    if is_dataclass(value):
        return _record_object(value)
    if isinstance(value, np.ndarray):
        return _numbers(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, str):
        return with_micro_sign(value)
    return [_plain(each) for each in value] if isinstance(value, tuple) else value


def _numbers(values: Any) -> Any:
    """Array as nested lists, with None for NaN."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim > 1:
        return [_numbers(row) for row in array]
    text = f"%.{_DIGITS}g " * array.size % tuple(array.tolist())  # all at once, in half the time
    return [value if isfinite(value) else None for value in map(float, text.split())]


def colour_code(colour: int | str) -> str:
    """Colour as "#rrggbb"."""
    if isinstance(colour, int):
        return COLOURS[colour % len(COLOURS)].lower()
    return "#" + f"{round(255 * float(colour)):02x}" * 3


def _columns(panel: Panel, part: Part) -> dict[str, list[str]]:
    """Columns of text of a part by their heads; empty for what has no numbers of its own."""
    x, y = panel.x, panel.y
    if isinstance(part, Line):
        return {x.text: _texts(part.x, x), y.text: _texts(part.y, y)}
    if isinstance(part, Band):
        ends = {f"{end} {y.text}": _texts(values, y) for end, values in (("lowest", part.low), ("highest", part.high))}
        return {x.text: _texts(part.x, x), **ends}
    if isinstance(part, Points):
        columns = {x.text: _texts(part.x, x), y.text: _texts(part.y, y)}
        if part.y_error is not None and np.ndim(part.y_error) == 1:
            columns["±"] = _texts(part.y_error)
        return columns | ({"source": list(part.sources)} if part.sources else {})
    if isinstance(part, Field):
        columns = {f"{y.text} \\ {x.text}": _texts(part.y)}
        for place, values in zip(_texts(part.x), np.transpose(part.values), strict=True):
            columns[place] = [part.words[int(value)] for value in values] if part.words else _texts(values)
        return columns
    if isinstance(part, Bars):
        across, along = (y, x) if part.along == "x" else (x, y)
        places = np.round(part.places) if across.words and not across.ticks else part.places  # beside their word
        return {across.text: _texts(places, across), along.text: _texts(part.lengths)}
    return {}


def _texts(values: Any, axis: Axis | None = None) -> list[str]:
    """Numbers as text, or the words that an axis has in their place."""
    words = {} if axis is None else dict(zip(axis.ticks or range(len(axis.words)), axis.words, strict=False))
    numbers = np.asarray(values, dtype=np.float64).tolist()
    return [words[value] if value in words else f"{value:.4g}" if isfinite(value) else "" for value in numbers]


_BINS = 1500  # more than a page resolves


def envelope(x: Floats, y: Floats, *, bins: int = _BINS) -> tuple[Floats, Floats]:
    """Curve through the lowest and highest value of each of some bins of equal numbers of values.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending.
    y : ndarray, shape (n,)
    bins : int

    Returns
    -------
    x, y : ndarray, shape (m,)
        As given where there are no more than two values a bin; else with both ends of a bin at its middle.
    """
    size = -(-x.size // bins)
    if size <= 2:
        return x, y
    starts = np.arange(0, x.size, size)
    middle = (x[starts] + x[np.minimum(starts + size, x.size) - 1]) / 2
    ends = np.column_stack([np.fmin.reduceat(y, starts), np.fmax.reduceat(y, starts)])
    return np.repeat(middle, 2), ends.ravel()
