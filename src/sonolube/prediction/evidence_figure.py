"""Chart of published tests: measured friction ratios over amplitude and over velocity ratio, by source."""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from sonolube.charts import Axis, Chart, Panel, Points
from sonolube.prediction.published_source import PublishedRig, PublishedSource
from sonolube.prediction.source_file import PublishedPoint
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.text.units import format_si

_COLOURS: Final = 6  # of the palette that differ well
_MARKERS: Final = 10
_Place = Callable[[PublishedPoint], float | None]


def evidence_chart(sources: Sequence[PublishedSource]) -> Chart:
    """Measured friction ratios over vibration amplitude and over velocity ratio, each source in a colour.

    Parameters
    ----------
    sources : sequence of PublishedSource

    Returns
    -------
    Chart
        Filled along the normal, hollow within the plane. Bars are the stated scatter of the ratio, and of the
        amplitude the spread with which it is known; a median factor on an amplitude that was not measured is applied.
    """
    panels = []
    for label, unit, place, power in (
        ("Vibration amplitude", "µm", _amplitude, 1),
        ("Sliding speed over vibration velocity", "", _velocity_ratio, -1),
    ):
        parts = [
            part
            for number, source in enumerate(sources)
            for is_normal in (True, False)
            for part in _parts(source, number, is_normal, place, power)
        ]
        x = Axis(label=label, unit=unit, logarithmic=True)
        y = Axis(label="Friction with over without vibration", lowest=-0.05, highest=_highest(sources))
        panels.append(Panel(x=x, y=y, parts=tuple(parts)))
    return Chart(panels=tuple(panels), size=(6.85, 3.4), columns=2, legend="top", legend_columns=3, shares_y=True)


def _highest(sources: Sequence[PublishedSource]) -> float:
    """Upper end of the axis of ratios."""
    return max(
        1.15,
        *(
            point.friction_ratio + (point.uncertainty or 0.0) + 0.05
            for source in sources
            for rig in source.rigs
            for point in rig.points
        ),
    )


def _parts(source: PublishedSource, number: int, is_normal: bool, place: _Place, power: int) -> list[Points]:
    """Points of a source in one kind of direction; none where it has none there."""
    rows = [
        (rig, point, where)
        for rig in source.rigs
        if rig.is_normal == is_normal
        for point in rig.points
        if (where := place(point)) is not None
    ]
    if not rows:
        return []
    x = np.array([where * rig.section.amplitude_factor**power for rig, _, where in rows])
    spread = np.exp([rig.section.amplitude_spread or AMPLITUDE_ERROR for rig, _, _ in rows])
    return [
        Points(
            x=x,
            y=np.array([point.friction_ratio for _, point, _ in rows]),
            x_error=np.stack([x - x / spread, x * spread - x]),
            y_error=np.array([point.uncertainty or 0.0 for _, point, _ in rows]),
            label=f"{source.title}, {'along the normal' if is_normal else 'within the plane'}",
            colour=number % _COLOURS,
            marker=number % _MARKERS,
            is_hollow=not is_normal,
            sources=tuple(_source(source, rig, point) for rig, point, _ in rows),
        )
    ]


def _amplitude(point: PublishedPoint) -> float | None:
    """Amplitude in um; None where it is not printed."""
    return None if point.vibration_amplitude is None else 1e6 * point.vibration_amplitude


def _velocity_ratio(point: PublishedPoint) -> float | None:
    """Sliding speed over peak velocity of the vibration. []"""
    return point.sliding_speed / point.vibration_velocity


def _source(source: PublishedSource, rig: PublishedRig, point: PublishedPoint) -> str:
    """Provenance of a point."""
    speed = format_si(point.sliding_speed, "m/s")
    return f"{source.title}, {rig.section.title}, {point.label}: {speed}"
