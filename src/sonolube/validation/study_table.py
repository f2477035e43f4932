"""Earlier studies as an open table: the points of the package as CSV, and a table of a user's own beside them."""

import csv
import io
from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import PreviousStudy, previous_studies
from sonolube.measurement.measured_runs import run_caveats
from sonolube.measurement.run_columns import RUN_COLUMNS
from sonolube.measurement.run_selection import checked_ratios, setting
from sonolube.text.units import convert
from sonolube.validation.previous_study_map import DIRECTIONS, StudyPoint, speed_range
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

Row = dict[str, str | float | None]
_QUANTITIES: Final = (
    "lowest_speed",
    "sliding_speed",
    "normal_load",
    "nominal_area",
    "nominal_pressure",
    "frequency",
    "vibration_amplitude",
    "vibration_velocity",
    "friction_reduction",
    "friction_reduction_uncertainty",
)
_NAMES: Final = ("study", "direction", *_QUANTITIES, "source", "note")
STUDY_COLUMNS: Final = tuple(column for name in _NAMES for column in RUN_COLUMNS if column.name == name)
"""Columns of a table of studies, of those of a table of runs."""


def study_table() -> str:
    """Points of the package as CSV in `STUDY_COLUMNS`: earlier studies, then every test of D.

    A row for each study with a quoted friction reduction; a quantity that is not printed has an empty cell.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([column.heading for column in STUDY_COLUMNS])
    for row in _rows():
        writer.writerow([_cell(row.get(column.name), column.name, column.unit) for column in STUDY_COLUMNS])
    return text.getvalue()


def studies_of_runs(runs: "xr.Dataset", *, title: str) -> tuple[tuple[StudyPoint, ...], tuple[str, ...]]:
    """Points of measured runs that are not among those of the package, and caveats."""
    texts = {name: _texts(runs[name].to_numpy() if name in runs else None, runs.sizes["run"]) for name in _NAMES[:2]}
    sources = _texts(runs["source"].to_numpy() if "source" in runs else None, runs.sizes["run"])
    for name, cells in (("study", texts["study"]), ("source", sources)):
        if not all(cells):
            raise InvalidInput(f"{title}: every point needs a {name}: run {cells.index('') + 1} names none")
    for direction in texts["direction"]:
        if direction not in DIRECTIONS:
            raise UnknownName.among(filter(None, DIRECTIONS), kind="direction", name=direction)
    reduction = 1 - checked_ratios(runs, title=title)
    speed = setting(runs, "sliding_speed", np.nan)
    slowest = setting(runs, "lowest_speed", speed)
    pressure = setting(
        runs, "nominal_pressure", setting(runs, "normal_load", np.nan) / setting(runs, "nominal_area", np.nan)
    )
    known = {(row["study"], row["direction"], f"{_percent(row):.4g}") for row in _rows()}
    points = tuple(
        StudyPoint(
            label=study,
            direction=direction,
            friction_reduction=float(reduction[index]),
            sliding_speed=(float(slowest[index]), float(speed[index])) if isfinite(speed[index]) else None,
            nominal_pressure=float(pressure[index]) if isfinite(pressure[index]) else None,
            source=sources[index],
        )
        for index, (study, direction) in enumerate(zip(texts["study"], texts["direction"], strict=True))
        if (study, direction, f"{100 * reduction[index]:.4g}") not in known
    )
    return points, run_caveats(runs)


def _texts(cells: "np.ndarray | None", count: int) -> list[str]:
    """Texts of a column; empty ones where there is none."""
    return [""] * count if cells is None else [str(cell) for cell in cells]


def _rows() -> list[Row]:
    """Rows of earlier studies with a friction reduction, then those of the tests of D."""
    studies = (study for study in previous_studies() if study.number("friction_reduction"))
    return [*map(_of_study, studies), *map(_of_test, friction_tests())]


def _percent(row: Row) -> float:
    """Friction reduction of a row in percent."""
    reduction = row["friction_reduction"]
    assert isinstance(reduction, float)
    return 100 * reduction


def _of_study(study: PreviousStudy) -> Row:
    """Row of an earlier study: its highest friction reduction with the numbers that D quotes."""
    row: Row = {
        "study": study.study,
        "direction": study.direction,
        "source": f"D {study.section}, its references {', '.join(map(str, study.references))}",
        "note": "; ".join(
            f"{entry.quantity} {entry.relation} {entry.number.text} {entry.unit}"
            for entry in study.numbers
            if entry.quantity in _QUANTITIES and entry.relation != "="
        ),
    }
    for name in _QUANTITIES:
        number = study.number(name)
        if number is not None:
            row[name] = number.value
    speed = study.number("sliding_speed")
    if speed is not None:
        row["lowest_speed"], row["sliding_speed"] = speed_range(speed)
    return row


def _of_test(test: FrictionTest) -> Row:
    """Row of a test of D."""
    return {
        "study": f"Dong 2015, {test.label}",
        "direction": "perpendicular",
        "sliding_speed": test.sliding_speed,
        "normal_load": test.normal_load,
        "nominal_area": test.contact.nominal_area,
        "frequency": test.frequency,
        "vibration_amplitude": test.vibration_amplitude,
        "friction_reduction": 1 - test.friction_ratio,
        "friction_reduction_uncertainty": test.uncertainty,
        "source": f"D, {NORMAL_VIBRATION_SETS[test.set_name]}",
    }


def _cell(value: "str | float | None", name: str, unit: str) -> str:
    """Value as the cell of its column, a number in the unit of the heading."""
    if value is None or isinstance(value, str):
        return value or ""
    return f"{convert(value, from_unit=quantity(name).unit, to_unit=unit) if unit else value:.6g}"
