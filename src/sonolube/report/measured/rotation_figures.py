"""Figures of a rotating disc: speed and pulses."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.measurement.friction.rotation import DiscRotation
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TURNS_SHOWN = 6


@captioned("Speed turn by turn", "Each turn is timed from a magnet to the same magnet; the line is the mean.")
def speed(rotation: DiscRotation) -> "Figure":
    """DiscRotation speed turn by turn, with the speed at the groove on the right."""
    figure, axes = subplots(figsize=(6.4, 3.0))
    speeds = rotation.rotation_speed
    begun = rotation.time[: speeds.size]
    axes.plot(begun, speeds, marker=".", linewidth=0.8, markersize=4)
    axes.axhline(rotation.mean_rotation_speed, color=COLOURS[1], linestyle="--", linewidth=1.2, label="mean")
    axes.set(xlabel="time (s)", ylabel="rotation speed (1/s)")
    per_turn = float(rotation.sliding_speed[0] / speeds[0])

    def at_groove(rotation_speed: Any) -> Any:
        return rotation_speed * per_turn

    def at_disc(sliding_speed: Any) -> Any:
        return sliding_speed / per_turn

    right = axes.secondary_yaxis("right", functions=(at_groove, at_disc))
    right.set_ylabel("speed at the groove (m/s)")
    axes.legend()
    return figure


@captioned("Pulses of the probe", "The first turns, with the pulses detected and those inserted where one was missing.")
def pulses(t: Floats, flux_density: Floats, rotation: DiscRotation) -> "Figure":
    """Reading of the probe over the first turns, with its pulses."""
    figure, axes = subplots(figsize=(6.4, 3.0))
    end = float(np.interp(_TURNS_SHOWN, rotation.revolutions, rotation.time))
    shown = t <= end + 0.02 * (end - t[0])
    axes.plot(t[shown], flux_density[shown], color="0.5", linewidth=0.8, label="reading")
    early = rotation.time <= end
    for which, name, place in (
        (early & ~rotation.interpolated, "pulses", 0),
        (early & rotation.interpolated, "inserted", 1),
    ):
        if which.any():
            at = rotation.time[which]
            height = np.interp(at, t, flux_density)
            axes.plot(at, height, MARKERS[place], color=COLOURS[place], linestyle="none", label=name)
    axes.set(xlabel="time (s)", ylabel="magnetic flux density (T)")
    figure.legend(loc="outside upper center", ncols=3)
    return figure
