"""Figure of a dry run: speed, drive voltage and temperatures over the time line."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.figure import COLOURS
from sonolube.laboratory.dry_run.record import DryRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_UNITS = ((2 * 3600.0, "h", 3600.0), (180.0, "min", 60.0), (0.0, "s", 1.0))
_WIDTH = 6.85  # inches: 174 mm
_MOST_PROMPTS = 40  # that are marked


def dry_run_figure(found: DryRun) -> "Figure":
    """Speed of the sliding, drive voltage and temperature rises of a protocol over time.

    Parameters
    ----------
    found : DryRun

    Returns
    -------
    matplotlib.figure.Figure
        Two panels without a rig, three with one; recordings are bars, prompts dotted lines.
    """
    from matplotlib.figure import Figure

    unit, scale = next((unit, scale) for least, unit, scale in _UNITS if found.duration >= least)
    count = 2 if found.heating is None else 3
    figure = Figure(figsize=(_WIDTH, 1.2 + 1.45 * count))
    panels = figure.subplots(count, 1, sharex=True)
    time = np.array([point.setting.time for point in found.points]) / scale
    _draw_speed(panels[0], time, found)
    _draw_drive(panels[1], time, found)
    if found.heating is not None:
        _draw_temperature(panels[2], found, scale)
    _mark_recordings(panels[0], found, scale)
    prompts = sorted({point.setting.time / scale for point in found.points if point.setting.kind == "prompt"})
    for axes in panels:
        for number, place in enumerate(prompts[:_MOST_PROMPTS]):
            label = "prompt" if axes is panels[0] and number == 0 else None
            axes.axvline(place, color="0.35", linestyle=":", linewidth=0.9, label=label, zorder=0.5)
        axes.margins(x=0)
    panels[0].legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, borderaxespad=0.2)
    panels[-1].set(xlabel=f"Time without prompts [{unit}]")
    panels[-1].set_xlim(-0.01 * time[-1], 1.01 * time[-1])
    return figure


def _draw_speed(axes: "Axes", time: "np.ndarray", found: DryRun) -> None:
    """Sliding speed, or speed of the disc where the groove is unknown."""
    known = all(point.sliding_speed is not None for point in found.points)
    speeds = [
        1e3 * (point.sliding_speed or 0.0) if known else 60 * (point.setting.rotation_speed or 0.0)
        for point in found.points
    ]
    axes.step(time, speeds, where="post", color=COLOURS[0], label="speed")
    axes.set(ylabel="Sliding speed\n[mm/s]" if known else "Speed of\nthe disc [rpm]")
    axes.set_ylim(0, 1.15 * max(speeds) or 1.0)


def _draw_drive(axes: "Axes", time: "np.ndarray", found: DryRun) -> None:
    """Peak-to-peak voltage, and the frequency where it is swept."""
    volts = [point.setting.voltage_peak_to_peak for point in found.points]
    axes.step(time, volts, where="post", color=COLOURS[1], label="voltage")
    axes.set(ylabel="Drive, peak\nto peak [V]")
    axes.set_ylim(0, 1.15 * max(volts) or 1.0)
    frequency = np.array([np.nan if f is None else f for f in (point.setting.frequency for point in found.points)])
    driven = frequency[np.isfinite(frequency)]
    if driven.size and np.ptp(driven) > 0:
        beside = axes.twinx()
        beside.step(time, 1e-3 * frequency, where="post", color=COLOURS[6], linestyle="--")
        beside.set(ylabel="Frequency [kHz]\n(dashed)")
        beside.grid(visible=False)


def _draw_temperature(axes: "Axes", found: DryRun, scale: float) -> None:
    """Temperature rises of contact, pin and actuator."""
    heating = found.heating
    assert heating is not None
    curves = (
        ("contact, mean", heating.contact_rise, COLOURS[1], "-"),
        ("pin", heating.pin_rise, COLOURS[0], "--"),
        ("actuator", heating.actuator_rise, COLOURS[6], "-."),
    )
    for label, rise, colour, line in curves:
        if rise is not None:
            axes.plot(heating.time / scale, rise, color=colour, linestyle=line, label=label)
    axes.set(ylabel="Computed rise\n[K]")
    axes.set_ylim(0, None)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, borderaxespad=0.2)


def _mark_recordings(axes: "Axes", found: DryRun, scale: float) -> None:
    """Bars along the top over the recordings."""
    spans = [(each.start / scale, each.duration / scale) for each in found.recordings]
    if spans:
        transform = axes.get_xaxis_transform()
        axes.broken_barh(spans, (0.94, 0.06), transform=transform, color=COLOURS[2], label="recorded", zorder=3)
