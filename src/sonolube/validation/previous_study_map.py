"""Friction reductions in previous studies: map over sliding speed and nominal pressure after D figure 1.4, and table.

The map has the numbers that the text quotes; no point of the figure is available. A study without a stated pressure is
drawn in the grey band, a range of speeds as a line, and a study without speed and pressure beside the map. Reductions
are the highest stated. The tests of D are drawn at the nominal areas of its Tables 3.2, 4.1 and 2.8. The table has the
points of the package as CSV, and takes a table of a user's own beside them.
"""

import csv
import io
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from sonolube.charts import Axis, Chart, Line, Note, Panel, Part, Points, Zone
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import PreviousStudy, PrintedNumber, previous_studies
from sonolube.measurement.measured_runs import checked_ratios, run_caveats, setting
from sonolube.measurement.run_columns import RUN_COLUMNS
from sonolube.text.units import convert
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

DIRECTIONS: Final = ("perpendicular", "longitudinal", "in plane", "", "transverse")
"""Directions of vibration with a marker on the map; empty where it is not stated."""

_DISSERTATION_TESTS: Final = {  # by label of the friction test
    "A-1": "D 2.3.4, slow",
    "A-3": "D 2.3.4, fast",
    "B-5": "D 4.1.2, 25.9 V",
    "G-1": "D 2.4.4, round tip",
    "G-2": "D 2.4.4, flat tip",
}
_LABELLED_LEFT: Final = ("D 2.3.4, slow", "D 4.1.2, 25.9 V")
_SPEEDS, _PRESSURES = (1e-4, 10.0), (1e3, 1e9)  # limits of the axes in m/s and Pa
_BAND: Final = np.array([_PRESSURES[0], 8e3])  # of studies of unknown pressure
_UNKNOWN, _OWN_UNKNOWN = 2.6e3, 5.5e3  # ordinate of those of the package, and of those of a user's own table


@dataclass(frozen=True, kw_only=True, slots=True)
class StudyPoint:
    """Point of the map: friction reduction with its conditions.

    Parameters
    ----------
    label : str
        Authors or test.
    direction : str
        Direction of the vibration relative to the sliding, as in `PreviousStudy`.
    friction_reduction : float
        Friction reduction; the highest where a range or a limit is printed. []
    sliding_speed : tuple of float, or None
        Lowest and highest sliding speed; None if unknown. [m/s]
    nominal_pressure : float or None
        Load over nominal area; None if unknown. [Pa]
    source : str
        Where the numbers are stated.
    """

    label: str
    direction: str
    friction_reduction: float
    sliding_speed: tuple[float, float] | None
    nominal_pressure: float | None
    source: str = ""


_Placed: TypeAlias = tuple[StudyPoint, tuple[float, float]]  # with its place on the map


def study_points() -> tuple[StudyPoint, ...]:
    """Previous studies with a quoted friction reduction, then some tests of D."""
    previous = [_previous_study(study) for study in previous_studies() if study.number("friction_reduction")]
    tests = [
        StudyPoint(
            label=_DISSERTATION_TESTS[test.label],
            direction="perpendicular",
            friction_reduction=1 - test.friction_ratio,
            sliding_speed=(test.sliding_speed, test.sliding_speed),
            nominal_pressure=test.normal_load / test.contact.nominal_area,
            source=f"friction test {test.label}",
        )
        for test in friction_tests()
        if test.label in _DISSERTATION_TESTS
    ]
    return (*previous, *tests)


def study_chart(added: StudyPoint | None = None, *, others: tuple[StudyPoint, ...] = ()) -> Chart:
    """Map of friction reductions, with an additional point and further studies if given."""
    points = (*study_points(), *others)
    placed = [
        (point, (point.sliding_speed[1], point.nominal_pressure or (_OWN_UNKNOWN if point in others else _UNKNOWN)))
        for point in points
        if point.sliding_speed
    ]
    unplaced = [point for point in points if not point.sliding_speed]
    parts: list[Part] = [
        Zone(first=_BAND[:1], last=_BAND[1:], along="y", colour="0.92"),
        Note(x=0.9 * _SPEEDS[1], y=1.25e3, text="pressure not stated", side="left", colour="0.4"),
        *(
            Line(x=np.array([max(point.sliding_speed[0], _SPEEDS[0]), speed]), y=np.full(2, pressure), colour="0.6")
            for point, (speed, pressure) in placed
            if point.sliding_speed and speed > point.sliding_speed[0]
        ),
        *_points(placed, others, scale_text="Friction reduction [%]"),
    ]
    if added and added.sliding_speed and added.nominal_pressure:
        parts.append(_shaded([(added, (added.sliding_speed[1], added.nominal_pressure))], added.label, 9, size=8.0))
    known = Panel(
        x=Axis(label="Sliding speed", unit="m/s", logarithmic=True, lowest=_SPEEDS[0], highest=_SPEEDS[1]),
        y=Axis(label="Nominal pressure", unit="Pa", logarithmic=True, lowest=_PRESSURES[0], highest=_PRESSURES[1]),
        parts=tuple(parts),
    )
    aside = Panel(
        x=Axis(label="neither stated", lowest=-0.1, highest=1.0, ticks=(0.0,), words=("",)),
        y=Axis(lowest=0.5 - max(len(unplaced), 5), highest=0.5, ticks=(0.5,), words=("",)),
        parts=_points([(point, (0.0, -float(row))) for row, point in enumerate(unplaced)], others),
    )
    return Chart(panels=(aside, known), size=(7.6, 4.4), columns=2, widths=(1, 3.2), legend="top", legend_columns=5)


def _points(placed: list[_Placed], others: tuple[StudyPoint, ...], *, scale_text: str = "") -> tuple[Part, ...]:
    """Studies by direction, shaded by their reduction, with their labels; those of the user's own within a ring."""
    parts: list[Part] = []
    for number, direction in enumerate(DIRECTIONS):
        chosen = [each for each in placed if each[0].direction == direction]
        if chosen:
            parts.append(_shaded(chosen, direction or "direction not stated", number, scale_text=scale_text))
    own = [place for point, place in placed if point in others]
    if own:
        x, y = np.array(own).T
        parts.append(Points(x=x, y=y, label="own table", colour=1, size=2.6, is_hollow=True))
    for point, (x_place, y_place) in placed:
        text = f"{point.label.replace(' and ', chr(10) + 'and ', 1)}, {100 * point.friction_reduction:.0f} %"
        side: Literal["left", "right"] = "left" if point.label in _LABELLED_LEFT else "right"
        parts.append(Note(x=x_place, y=y_place, text=text, side=side))
    return tuple(parts)


def _shaded(placed: list[_Placed], label: str, marker: int, *, size: float = 2.2, scale_text: str = "") -> Points:
    """Points with a marker, shaded by their friction reduction."""
    x, y = np.array([place for _, place in placed]).T
    return Points(
        x=x,
        y=y,
        label=label,
        marker=marker,
        size=size,
        shades=np.array([100 * point.friction_reduction for point, _ in placed]),
        scale_text=scale_text,
        scale_ends=(0.0, 100.0),
        sources=tuple(f"{point.label}: {point.source}" for point, _ in placed),
    )


def _previous_study(study: PreviousStudy) -> StudyPoint:
    """Point of a study with a quoted friction reduction."""
    reduction, speed, pressure = (
        study.number(quantity) for quantity in ("friction_reduction", "sliding_speed", "nominal_pressure")
    )
    assert reduction is not None
    return StudyPoint(
        label=study.study,
        direction=study.direction,
        friction_reduction=reduction.value,
        sliding_speed=speed_range(speed) if speed else None,
        nominal_pressure=pressure.value if pressure else None,
        source=f"D {study.section}",
    )


def speed_range(speed: PrintedNumber) -> tuple[float, float]:
    """Limits of a printed range, which coincide for a single number. [m/s]"""
    return (speed.low, speed.high) if "-" in speed.text else (speed.value, speed.value)


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
