"""Chart of a dry run: speed, drive voltage and temperatures over the time line."""

from typing import Final

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Rule, Zone
from sonolube.checks import Floats
from sonolube.laboratory.dry_run.record import DryRun

_UNITS: Final = ((2 * 3600.0, "h", 3600.0), (180.0, "min", 60.0), (0.0, "s", 1.0))
_WIDTH: Final = 6.85  # inches: 174 mm
_MAX_PROMPTS: Final = 40  # that are marked


def dry_run_chart(found: DryRun) -> Chart:
    """Speed of the sliding, drive and temperature rises of a protocol over time.

    Parameters
    ----------
    found : DryRun

    Returns
    -------
    Chart
        A panel each for speed, voltage, the frequency where it is swept, and the temperatures with a rig; recordings
        are shaded, prompts dotted lines.
    """
    unit, scale = next((unit, scale) for least, unit, scale in _UNITS if found.duration >= least)
    time = np.array([point.setting.time for point in found.points]) / scale
    x = Axis(label="Time without prompts", unit=unit, lowest=float(-0.01 * time[-1]), highest=float(1.01 * time[-1]))
    curves = [_speed(time, found), _voltage(time, found), *_frequency(time, found), *_temperatures(found, scale)]
    prompts = sorted({point.setting.time / scale for point in found.points if point.setting.kind == "prompt"})
    panels: list[Panel] = []
    for axis, lines in curves:
        is_first = not panels
        marks: list[Part] = []
        if is_first and found.recordings:
            start, lasts = (np.array([getattr(each, of) for each in found.recordings]) for of in ("start", "duration"))
            marks.append(
                Zone(first=start / scale, last=(start + lasts) / scale, label="recorded", colour=2, opacity=0.25)
            )
        marks += [
            Rule(value=place, label="prompt" if is_first and not number else "", colour="0.35")
            for number, place in enumerate(prompts[:_MAX_PROMPTS])
        ]
        panels.append(Panel(x=x, y=axis, parts=(*marks, *lines)))
    size = (_WIDTH, 1.2 + 1.45 * len(panels))
    return Chart(panels=tuple(panels), size=size, legend="top", legend_columns=5, shares_x=True)


def _speed(time: Floats, found: DryRun) -> tuple[Axis, tuple[Line, ...]]:
    """Sliding speed, or speed of the disc where the groove is unknown."""
    is_known = all(point.sliding_speed is not None for point in found.points)
    speeds = [
        1e3 * (point.sliding_speed or 0.0) if is_known else 60 * (point.setting.rotation_speed or 0.0)
        for point in found.points
    ]
    label, unit = ("Sliding speed", "mm/s") if is_known else ("Speed of the disc", "rpm")
    return _from_zero(label, unit, speeds), (Line(x=time, y=np.array(speeds), is_stepped=True),)


def _voltage(time: Floats, found: DryRun) -> tuple[Axis, tuple[Line, ...]]:
    """Peak-to-peak voltage."""
    volts = [point.setting.voltage_peak_to_peak for point in found.points]
    line = Line(x=time, y=np.array(volts), colour=1, is_stepped=True)
    return _from_zero("Drive, peak to peak", "V", volts), (line,)


def _frequency(time: Floats, found: DryRun) -> list[tuple[Axis, tuple[Line, ...]]]:
    """Frequency of the drive, where it is swept."""
    frequency = np.array([np.nan if f is None else f for f in (point.setting.frequency for point in found.points)])
    driven = frequency[np.isfinite(frequency)]
    if not driven.size or np.ptp(driven) == 0:
        return []
    return [(Axis(label="Frequency", unit="kHz"), (Line(x=time, y=1e-3 * frequency, colour=6, is_stepped=True),))]


def _temperatures(found: DryRun, scale: float) -> list[tuple[Axis, tuple[Line, ...]]]:
    """Temperature rises of contact, pin and actuator."""
    heating = found.heating
    if heating is None:
        return []
    curves = (
        ("contact, mean", heating.contact_rise, 1, 0),
        ("pin", heating.pin_rise, 0, 1),
        ("actuator", heating.actuator_rise, 6, 2),
    )
    lines = tuple(
        Line(x=heating.time / scale, y=rise, label=label, colour=colour, dash=dash)
        for label, rise, colour, dash in curves
        if rise is not None
    )
    return [(Axis(label="Computed rise", unit="K", lowest=0.0), lines)]


def _from_zero(label: str, unit: str, values: list[float]) -> Axis:
    """Axis from zero to a little over the greatest of some values."""
    return Axis(label=label, unit=unit, lowest=0.0, highest=1.15 * max(values) or 1.0)
