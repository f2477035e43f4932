"""Map of friction reductions in previous studies over sliding speed and nominal pressure, after D figure 1.4.

The map has the numbers that the text quotes; no point of the figure is available. A study without a stated pressure is
drawn in the grey band, a range of speeds as a line, and a study without speed and pressure beside the map. Reductions
are the highest stated. The tests of D are drawn at the nominal areas of its Tables 3.2, 4.1 and 2.8.
"""

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np

from sonolube.charts import Axis, Chart, Line, Note, Panel, Part, Points, Zone
from sonolube.facts.published import PreviousStudy, PrintedNumber, previous_studies
from sonolube.validation.published_tests import friction_tests

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
