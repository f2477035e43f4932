"""What the command `transient` says and writes."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.cli.output import closing_lines
from sonolube.dynamics.trajectories import Trajectory
from sonolube.figure import COLOURS, publication_style, write_figure
from sonolube.rig import Rig, StartUp, dataset, write_netcdf
from sonolube.units import format_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DRAWN = 801  # points of the last periods


def start_up_object(rig: Rig, result: StartUp, written: list[Path]) -> dict[str, Any]:
    """Return how the rig settled as it goes into JSON."""
    return {
        "rig": rig.title,
        "status": result.status,
        "reason": result.reason,
        "settling_time": {"value": result.settling_time, "unit": "s"},
        "vibration_amplitude": {"value": result.vibration_amplitude, "unit": "m"},
        "mean_displacement": {"value": result.mean_displacement, "unit": "m"},
        "beat_frequency": {"value": result.beat_frequency, "unit": "Hz"},
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def start_up_lines(rig: Rig, result: StartUp, written: list[Path]) -> list[str]:
    """Return how the rig settled as lines."""
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, from rest",
        f"  amplitude settles    within 2 % after {format_si(result.settling_time, 's')}",
        f"  amplitude            {format_si(result.vibration_amplitude, 'm')}",
        f"  mean displacement    {format_si(result.mean_displacement, 'm')}",
        f"  slow oscillation     {format_si(result.beat_frequency, 'Hz')}",
        f"  status               {result.status}" + (f": {result.reason}" if result.reason else ""),
        *closing_lines(written, assumptions=rig.assumptions),
    ]


def write_start_up(rig: Rig, result: StartUp, *, folder: Path, name: str) -> list[Path]:
    """Write the trajectory as a figure and as netCDF, and return the files."""
    marched = result.trajectory
    values = {
        "time": marched.time,
        "displacement": marched.contact.displacement,
        "normal_force": marched.contact.normal_force,
    }
    labelled = dataset(values, along="time", title=f"Start-up of {rig.title}")
    with publication_style():
        figures = write_figure(_figure(rig, marched), folder=folder, name=name)
    return [*figures, write_netcdf(labelled, path=folder / f"{name}.nc")]


def _figure(rig: Rig, marched: Trajectory) -> "Figure":
    from matplotlib.figure import Figure
    from scipy.interpolate import CubicHermiteSpline

    assert rig.drive is not None
    figure = Figure(figsize=(5.2, 4.6))
    whole, last = figure.subplots(2, 1)
    milliseconds, micrometres = 1e3 * marched.time, 1e6 * marched.contact.displacement
    end = int(np.searchsorted(marched.time, marched.time[-1] - 4 / rig.drive.frequency))
    whole.plot(milliseconds, micrometres, color=COLOURS[0], linewidth=0.6)
    along = CubicHermiteSpline(marched.time[end:], micrometres[end:], 1e6 * marched.contact.velocity[end:])
    closer = np.linspace(marched.time[end], marched.time[-1], _DRAWN)
    last.plot(1e3 * closer, along(closer), color=COLOURS[0])
    for axes in (whole, last):
        axes.set(xlabel="Time [ms]", ylabel="Displacement\nof the tip [µm]")
    last.set_title("the last four periods", fontsize=8)
    figure.suptitle(rig.title, fontsize=9)
    return figure
