"""The map of earlier studies, D figure 1.4, as far as the text gives it: reduction over sliding speed and pressure.

No point of the figure itself came along. A study that states no pressure lies in the grey band, a range of speeds is a
line, and a study that states neither stands beside the map. Reductions are the highest stated. The tests of D are at
the nominal areas of its Tables 3.2, 4.1 and 2.8.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.figure import COLOURS, MARKERS
from sonolube.published import PreviousStudy, PrintedNumber, previous_studies
from sonolube.validation.friction_tests import friction_tests

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

_DIRECTIONS: Final = ("perpendicular", "longitudinal", "in plane", "")
_OWN_TESTS: Final = {  # by their labels among the friction tests
    "A-1": "D 2.3.4, slow",
    "A-3": "D 2.3.4, fast",
    "B-5": "D 4.1.2, 25.9 V",
    "G-1": "D 2.4.4, round tip",
    "G-2": "D 2.4.4, flat tip",
}
_LABELLED_LEFT: Final = ("D 2.3.4, slow", "D 4.1.2, 25.9 V")
_SPEEDS, _PRESSURES = (1e-4, 10.0), (1e3, 1e9)  # m/s and Pa that the axes hold
_NO_PRESSURE, _EDGE_PRESSURE = 2.6e3, 8e3  # where a study of unknown pressure is drawn, and the band it lies in


@dataclass(frozen=True, kw_only=True, slots=True)
class MapPoint:
    """One point of the map.

    Parameters
    ----------
    label : str
        Whose it is.
    direction : str
        How the vibration stood to the sliding, as in `PreviousStudy`.
    friction_reduction : float
        The reduction, the highest where a range or a limit is printed. []
    sliding_speed : tuple of float, or None
        Lowest and highest; None where it is not known. [m/s]
    nominal_pressure : float or None
        Load over the nominal area; None where it is not known. [Pa]
    """

    label: str
    direction: str
    friction_reduction: float
    sliding_speed: tuple[float, float] | None
    nominal_pressure: float | None


def study_points() -> tuple[MapPoint, ...]:
    """Return every earlier study with a printed friction reduction, then some of D's own tests."""
    earlier = [_earlier(study) for study in previous_studies() if study.number("friction_reduction")]
    own = [
        MapPoint(
            label=_OWN_TESTS[test.label],
            direction="perpendicular",
            friction_reduction=1 - test.friction_ratio,
            sliding_speed=(test.sliding_speed, test.sliding_speed),
            nominal_pressure=test.normal_load / test.contact.nominal_area,
        )
        for test in friction_tests()
        if test.label in _OWN_TESTS
    ]
    return (*earlier, *own)


def study_map(mine: MapPoint | None = None) -> "Figure":
    """Draw the map, with one point of the reader's own where given.

    Parameters
    ----------
    mine : MapPoint or None
        Of known speed and pressure.

    Returns
    -------
    Figure
    """
    import matplotlib.pyplot as plt
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shades = ScalarMappable(Normalize(0, 100), "viridis")
    figure, (aside, axes) = plt.subplots(1, 2, figsize=(7.6, 4.4), width_ratios=(1, 3.2))
    axes.set(xscale="log", yscale="log", xlim=_SPEEDS, ylim=_PRESSURES)
    axes.set(xlabel="Sliding speed [m/s]", ylabel="Nominal pressure [Pa]")
    axes.axhspan(_PRESSURES[0], _EDGE_PRESSURE, color="0.92", zorder=0)
    axes.text(_SPEEDS[1] * 0.9, 1.25e3, "pressure not stated", ha="right", color="0.4", fontsize=8)
    points = study_points()
    known = [point for point in points if point.sliding_speed]
    for point in known:
        low, high = point.sliding_speed or _SPEEDS
        pressure = point.nominal_pressure or _NO_PRESSURE
        if high > low:
            axes.plot([max(low, _SPEEDS[0]), high], [pressure, pressure], color=_shade(shades, point), lw=3, zorder=2)
        _mark(axes, point, (high, pressure), shades)
    _draw_unplaced(aside, [point for point in points if point not in known], shades)
    for direction in (each for each in _DIRECTIONS if any(point.direction == each for point in points)):
        axes.plot([], [], _marker(direction), color="0.5", label=direction or "direction not stated")
    if mine and mine.sliding_speed and mine.nominal_pressure:
        place, colour = (mine.sliding_speed[1], mine.nominal_pressure), _shade(shades, mine)
        axes.plot(*place, "*", ms=17, mfc=colour, mec=COLOURS[1], mew=1.5, zorder=5, ls="", label=mine.label)
    figure.colorbar(shades, ax=axes, label="Friction reduction [%]", pad=0.02)
    figure.legend(loc="outside upper center", ncols=5, columnspacing=1.2, handletextpad=0.3)
    return figure


def _draw_unplaced(axes: "Axes", points: list[MapPoint], shades: "ScalarMappable") -> None:
    for height, point in enumerate(points):
        _mark(axes, point, (0.0, -float(height)), shades)
    axes.set(xlim=(-0.1, 1), ylim=(0.5 - max(len(points), 5), 0.5), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    axes.set_xlabel("neither speed nor\npressure stated", color="0.4", fontsize=8)


def _mark(axes: "Axes", point: MapPoint, place: tuple[float, float], shades: "ScalarMappable") -> None:
    axes.plot(*place, _marker(point.direction), ms=8, color=_shade(shades, point), mec="black", mew=0.6, zorder=3)
    offset, side = (-7, "right") if point.label in _LABELLED_LEFT else (7, "left")
    text = f"{point.label.replace(' and ', chr(10) + 'and ', 1)}, {100 * point.friction_reduction:.0f} %"
    axes.annotate(text, place, (offset, 0), textcoords="offset points", ha=side, va="center", fontsize=7.5)


def _shade(shades: "ScalarMappable", point: MapPoint) -> tuple[float, ...]:
    return tuple(shades.to_rgba(np.array([100 * point.friction_reduction]))[0])


def _marker(direction: str) -> str:
    return MARKERS[_DIRECTIONS.index(direction)]


def _earlier(study: PreviousStudy) -> MapPoint:
    reduction, speed, pressure = (
        study.number(quantity) for quantity in ("friction_reduction", "sliding_speed", "nominal_pressure")
    )
    assert reduction is not None
    return MapPoint(
        label=study.study,
        direction=study.direction,
        friction_reduction=reduction.value,
        sliding_speed=_span(speed) if speed else None,
        nominal_pressure=pressure.value if pressure else None,
    )


def _span(speed: PrintedNumber) -> tuple[float, float]:
    """Return the ends of a printed range, or twice the one number printed."""
    return (speed.low, speed.high) if "-" in speed.text else (speed.value, speed.value)
