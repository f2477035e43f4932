"""Map of friction reductions in previous studies over sliding speed and nominal pressure, after D figure 1.4.

The map has the numbers that the text quotes; no point of the figure is available. A study without a stated pressure is
drawn in the grey band, a range of speeds as a line, and a study without speed and pressure beside the map. Reductions
are the highest stated. The tests of D are drawn at the nominal areas of its Tables 3.2, 4.1 and 2.8.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.facts.published import PreviousStudy, PrintedNumber, previous_studies
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.validation.published_tests import friction_tests

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

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
_EDGE, _OWN_EDGE = ("black", 0.6), (COLOURS[1], 1.8)  # of the markers of the package and of a user's own table
_OWN_UNKNOWN_PRESSURE: Final = 5.5e3  # above those of the package
_UNKNOWN_PRESSURE, _BAND_EDGE = 2.6e3, 8e3  # ordinate of studies of unknown pressure, and edge of their band


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
    """

    label: str
    direction: str
    friction_reduction: float
    sliding_speed: tuple[float, float] | None
    nominal_pressure: float | None


def study_points() -> tuple[StudyPoint, ...]:
    """Return the previous studies with a quoted friction reduction, then some tests of D."""
    previous = [_previous_study(study) for study in previous_studies() if study.number("friction_reduction")]
    tests = [
        StudyPoint(
            label=_DISSERTATION_TESTS[test.label],
            direction="perpendicular",
            friction_reduction=1 - test.friction_ratio,
            sliding_speed=(test.sliding_speed, test.sliding_speed),
            nominal_pressure=test.normal_load / test.contact.nominal_area,
        )
        for test in friction_tests()
        if test.label in _DISSERTATION_TESTS
    ]
    return (*previous, *tests)


def study_map(added: StudyPoint | None = None, *, others: tuple[StudyPoint, ...] = ()) -> "Figure":
    """Draw the map of friction reductions, with an additional point and further studies if given.

    Parameters
    ----------
    added : StudyPoint or None
        Point of known speed and pressure.
    others : tuple of StudyPoint
        Of a table of the user's own, drawn with an edge in colour.

    Returns
    -------
    Figure
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shades = ScalarMappable(Normalize(0, 100), "viridis")
    figure, (aside, axes) = subplots(1, 2, figsize=(7.6, 4.4), width_ratios=(1, 3.2))
    axes.set(xscale="log", yscale="log", xlim=_SPEEDS, ylim=_PRESSURES)
    axes.set(xlabel="Sliding speed [m/s]", ylabel="Nominal pressure [Pa]")
    axes.axhspan(_PRESSURES[0], _BAND_EDGE, color="0.92", zorder=0)
    axes.text(_SPEEDS[1] * 0.9, 1.25e3, "pressure not stated", ha="right", color="0.4", fontsize=8)
    own = study_points()
    points = (*own, *others)
    edges = {id(point): _OWN_EDGE for point in others}
    known = [point for point in points if point.sliding_speed]
    for point in known:
        low, high = point.sliding_speed or _SPEEDS
        pressure = point.nominal_pressure or (_OWN_UNKNOWN_PRESSURE if id(point) in edges else _UNKNOWN_PRESSURE)
        if high > low:
            axes.plot([max(low, _SPEEDS[0]), high], [pressure, pressure], color=_colour(shades, point), lw=3, zorder=2)
        _mark(axes, point, (high, pressure), shades, edge=edges.get(id(point), _EDGE))
    _draw_unplaced(aside, [point for point in points if not point.sliding_speed], shades, edges)
    for direction in (each for each in DIRECTIONS if any(point.direction == each for point in points)):
        axes.plot([], [], _marker(direction), color="0.5", label=direction or "direction not stated")
    if others:
        axes.plot([], [], "o", color="0.85", mec=_OWN_EDGE[0], mew=_OWN_EDGE[1], label="own table")
    if added and added.sliding_speed and added.nominal_pressure:
        place, colour = (added.sliding_speed[1], added.nominal_pressure), _colour(shades, added)
        axes.plot(*place, "*", ms=17, mfc=colour, mec=COLOURS[1], mew=1.5, zorder=5, ls="", label=added.label)
    figure.colorbar(shades, ax=axes, label="Friction reduction [%]", pad=0.02)
    figure.legend(loc="outside upper center", ncols=5, columnspacing=1.2, handletextpad=0.3)
    return figure


def _draw_unplaced(
    axes: "Axes", points: list[StudyPoint], shades: "ScalarMappable", edges: dict[int, tuple[str, float]]
) -> None:
    """Draw the studies without speed and pressure in a column of their own."""
    for height, point in enumerate(points):
        _mark(axes, point, (0.0, -float(height)), shades, edge=edges.get(id(point), _EDGE))
    axes.set(xlim=(-0.1, 1), ylim=(0.5 - max(len(points), 5), 0.5), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    axes.set_xlabel("neither speed nor\npressure stated", color="0.4", fontsize=8)


def _mark(
    axes: "Axes", point: StudyPoint, place: tuple[float, float], shades: "ScalarMappable", *, edge: tuple[str, float]
) -> None:
    """Draw a point with its label, its marker by direction and its colour by reduction."""
    colour, width = edge
    axes.plot(*place, _marker(point.direction), ms=8, color=_colour(shades, point), mec=colour, mew=width, zorder=3)
    offset, side = (-7, "right") if point.label in _LABELLED_LEFT else (7, "left")
    text = f"{point.label.replace(' and ', chr(10) + 'and ', 1)}, {100 * point.friction_reduction:.0f} %"
    axes.annotate(text, place, (offset, 0), textcoords="offset points", ha=side, va="center", fontsize=7.5)


def _colour(shades: "ScalarMappable", point: StudyPoint) -> tuple[float, ...]:
    """Return the colour of a point by its reduction."""
    return tuple(shades.to_rgba(np.array([100 * point.friction_reduction]))[0])


def _marker(direction: str) -> str:
    """Return the marker of a direction of vibration."""
    return MARKERS[DIRECTIONS.index(direction)]


def _previous_study(study: PreviousStudy) -> StudyPoint:
    """Return the point of a study with a quoted friction reduction."""
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
    )


def speed_range(speed: PrintedNumber) -> tuple[float, float]:
    """Return the limits of a printed range, which coincide for a single number. [m/s]"""
    return (speed.low, speed.high) if "-" in speed.text else (speed.value, speed.value)
