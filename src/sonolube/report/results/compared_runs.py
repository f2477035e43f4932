"""Levels of several runs in one table: friction and its reduction at each voltage, as text, CSV and chart."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from sonolube.charts import Axis, Chart, Points, one_panel
from sonolube.measurement.run_columns import DIRECTION_COLUMN, DIRECTION_WORDS, SOURCE, TEXT_NAMES
from sonolube.report.blocks import Table
from sonolube.text.units import format_si

_COLUMNS: Final = {  # of the table, by the columns of `level_rows`
    "load": ("normal_load", "N"),
    "speed": ("sliding_speed", "m/s"),
    "voltage": ("voltage_peak_to_peak", "V"),
    "frequency": ("frequency", "Hz"),
    "friction": ("friction_force", "N"),
}
_HEADS: Final = ("run", *_COLUMNS, "reduction")


def level_objects(rows: Sequence[Sequence[str]]) -> list[dict[str, Any]]:
    """Rows of `sonolube.laboratory.catalogue.level_rows` as objects for JSON, in SI; None where nothing is known."""
    names = [heading.partition(" [")[0] for heading in rows[0]]
    return [{name: _value(name, cell) for name, cell in zip(names, row, strict=True)} for row in rows[1:]]


def _value(name: str, cell: str) -> float | str | None:
    """Number or text of a cell; None where it is empty and of a number."""
    if name in TEXT_NAMES or (name == DIRECTION_COLUMN and cell in DIRECTION_WORDS):
        return cell
    return float(cell) if cell else None


def level_table(levels: Sequence[dict[str, Any]]) -> Table:
    """Table of levels: load, speed, voltage and frequency, friction and its reduction with standard uncertainties."""
    return Table(_HEADS, [_row(level) for level in levels])


def _row(level: dict[str, Any]) -> list[str]:
    """Cells of a level."""
    cells = []
    for name, unit in _COLUMNS.values():
        value, deviation = level.get(name), level.get(f"{name}_uncertainty")
        text = "-" if value is None else format_si(value, unit)
        cells.append(
            text if deviation is None or value is None else f"{text} +- {format_si(deviation, unit, digits=2)}"
        )
    reduction, deviation = level["friction_reduction"], level["friction_reduction_uncertainty"]
    told = "-" if reduction is None else f"{100 * reduction:.1f} %"
    more = "" if reduction is None or deviation is None else f" +- {100 * deviation:.1f} %"
    return [str(level["run"]), *cells, told + more]


def levels_csv(rows: Sequence[Sequence[str]]) -> str:
    """Table of runs as CSV, as `fit` and `predict` read it, with the names of the records alone.

    The standard error of a level within one test is left out: friction of another test differs by more, and a
    prediction would take it for all of the uncertainty.
    """
    kept = [place for place, heading in enumerate(rows[0]) if "_uncertainty" not in heading]
    records = [place for place, heading in enumerate(rows[0]) if heading == SOURCE]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for row in rows:
        writer.writerow([Path(row[place]).name if place in records else row[place] for place in kept])
    return out.getvalue()


def levels_chart(levels: Sequence[dict[str, Any]]) -> Chart:
    """Chart of friction over the voltage, a marker for each run, bars of two standard uncertainties."""
    parts = []
    for place, run in enumerate(dict.fromkeys(level["run"] for level in levels)):
        own = [level for level in levels if level["run"] == run and level["voltage_peak_to_peak"] is not None]
        x, y, deviation = (
            np.array([level[name] or 0.0 for level in own], float)
            for name in ("voltage_peak_to_peak", "friction_force", "friction_force_uncertainty")
        )
        parts.append(Points(x=x, y=y, y_error=2 * deviation, label=str(run), colour=place, marker=place))
    return one_panel(Axis("Voltage, peak to peak", "V"), Axis("Friction force", "N"), parts)
