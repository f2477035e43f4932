"""Chart of friction held in closed loop: friction with its reference, drive voltage and sliding speed over time."""

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Rule
from sonolube.laboratory.closed_loop.record import HeldFriction

_SIZE = (6.85, 5.2)  # inches: 174 mm


def held_friction_chart(record: HeldFriction, *, simulated: bool) -> Chart:
    """Friction force with its reference, drive voltage and sliding speed over time.

    Parameters
    ----------
    record : HeldFriction
    simulated : bool
        Whether no hardware moved.

    Returns
    -------
    Chart
        Friction as means over the intervals, with the deviation of the samples within each as a band.
    """
    time, force, band = record.time, record.friction_force, record.friction_force_deviation
    intrinsic, highest = record.intrinsic_friction_force, record.hold.controller.level_maximum
    source = "simulated" if simulated else "measured"
    friction = (
        Band(x=time, low=force - band, high=force + band, label="±1 deviation of samples", colour=5, opacity=0.5),
        Line(x=time, y=force, label=f"friction, {source}"),
        Line(x=time, y=record.setpoint, label="reference", colour=6, dash=1, weight=0.85),
        Rule(value=intrinsic, along="y", label="without vibration, before", colour=1, dash=3),
    )
    drive = (
        Line(x=time, y=record.voltage_peak_to_peak, colour=1, is_stepped=True),
        Rule(value=highest, along="y", label="highest of the controller", colour="0.45", dash=2),
    )
    speed = (Line(x=time, y=1e3 * record.sliding_speed, is_stepped=True),)
    greatest = float(np.nanmax([*(force + band), *record.setpoint, intrinsic]))
    fastest = 1.15e3 * float(record.sliding_speed.max(initial=0.0)) or 1.0
    x = Axis(label="Time under control", unit="s", lowest=float(time[0]), highest=float(time[-1]))
    panels = (
        Panel(x=x, y=Axis(label="Friction force", unit="N", lowest=0.0, highest=1.1 * greatest), parts=friction),
        Panel(x=x, y=Axis(label="Drive, peak to peak", unit="V", lowest=0.0, highest=1.35 * highest), parts=drive),
        Panel(x=x, y=Axis(label="Sliding speed", unit="mm/s", lowest=0.0, highest=fastest), parts=speed),
    )
    return Chart(panels=panels, size=_SIZE, heights=(2, 1, 1), legend="top", legend_columns=4, shares_x=True)
