"""What the command `thermal` draws."""

from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.figure import COLOURS, LINES, publication_style, write_figure
from sonolube.rig import Rig, TemperaturePoint

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_heat(rig: Rig, result: TemperaturePoint, *, folder: Path, name: str) -> list[Path]:
    """Write the temperature in time as a figure and return the files."""
    with publication_style():
        return write_figure(_figure(rig, result), folder=folder, name=name)


def _figure(rig: Rig, result: TemperaturePoint) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 3.6))
    axes = figure.subplots()
    for index, (label, record) in enumerate(
        (("without vibration", result.without_vibration), ("with vibration", result.with_vibration))
    ):
        for what, rise, line in (
            ("contact", record.temperature_rise, LINES[0]),
            ("bulk of the pin", record.bulk_rise, LINES[1]),
        ):
            axes.plot(record.time, rise, linestyle=line, color=COLOURS[index], label=f"{what}, {label}")
    axes.set(xlabel="Time [s]", ylabel="Rise of the temperature [K]", xlim=(0, record.time[-1]))
    axes.set_ylim(0, 1.35 * axes.get_ylim()[1])
    axes.legend(loc="upper left", ncols=2, fontsize=7)
    figure.suptitle(rig.title, fontsize=9)
    return figure
