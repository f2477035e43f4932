"""Charts of a rotating disc: speed and pulses."""

import numpy as np

from sonolube.charts import Axis, Chart, Line, Part, Points, Rule, envelope, one_panel
from sonolube.checks import Floats
from sonolube.measurement.friction.rotation import DiscRotation
from sonolube.report.measured.sheet import captioned

_TURNS_SHOWN = 6
_TIME = Axis("Time", "s")


@captioned("Speed turn by turn", "Each turn is timed from a magnet to the same magnet; the line is the mean.")
def speed_figure(rotation: DiscRotation) -> Chart:
    """Speed of the disc turn by turn, with the speed at the groove on the right."""
    speeds = rotation.rotation_speed
    begun = rotation.time[: speeds.size]
    parts = (
        Line(x=begun, y=speeds, weight=0.6),
        Points(x=begun, y=speeds, is_faint=True),
        Rule(value=float(rotation.mean_rotation_speed), along="y", label="mean", colour=1, dash=1),
    )
    per_turn = float(rotation.sliding_speed[0] / speeds[0])
    y = Axis("Rotation speed", "1/s", proportional=(per_turn, "Speed at the groove [m/s]"))
    return one_panel(_TIME, y, parts, size=(6.4, 3.0))


@captioned("Pulses of the probe", "The first turns, with the pulses detected and those inserted where one was missing.")
def pulses_figure(t: Floats, flux_density: Floats, rotation: DiscRotation) -> Chart:
    """Reading of the probe over the first turns, with its pulses."""
    end = float(np.interp(_TURNS_SHOWN, rotation.revolutions, rotation.time))
    shown = t <= end + 0.02 * (end - t[0])
    time, reading = envelope(t[shown], flux_density[shown])
    parts: list[Part] = [Line(x=time, y=reading, label="reading", colour="0.5", weight=0.6)]
    early = rotation.time <= end
    for which, name, place in (
        (early & ~rotation.interpolated, "pulses", 0),
        (early & rotation.interpolated, "inserted", 1),
    ):
        if which.any():
            at = rotation.time[which]
            parts.append(Points(x=at, y=np.interp(at, t, flux_density), label=name, colour=place, marker=place))
    return one_panel(_TIME, Axis("Magnetic flux density", "T"), parts, size=(6.4, 3.0), legend="top")
