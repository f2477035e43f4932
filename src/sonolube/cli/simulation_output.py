"""What the command `simulate` writes: the motion of the tip as a figure and as netCDF."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import separation
from sonolube.figure import COLOURS, publication_style, write_figure
from sonolube.rig import Rig, Simulation, dataset, write_netcdf

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOST = 0.01  # force over load below which contact counts as lost


def write_simulation(rig: Rig, result: Simulation, *, folder: Path, name: str) -> list[Path]:
    """Write one repetition of the motion as a figure and as netCDF, and return the files."""
    motion = result.vibration.motions[0]
    time = np.arange(motion.displacement.size) / (motion.displacement.size * motion.frequency)
    values = {"time": time, "displacement": motion.displacement, "normal_force": motion.normal_force}
    labelled = dataset(values, along="time", title=f"Steady motion of {rig.title}")
    labelled.attrs |= {
        "status": result.vibration.status,
        "reason": result.vibration.reason,
        "attractor": result.vibration.attractor,
        "repetition_periods": result.vibration.repetition_periods,
        "normal_load_N": motion.normal_load,
        "separation_at_rest_m": _rest(rig),
        "mean_displacement_m": result.vibration.mean_displacement,
        "contact_loss_fraction": result.vibration.contact_loss_fraction,
    }
    with publication_style():
        figures = write_figure(_figure(rig, result, 1e6 * time), folder=folder, name=name)
    return [*figures, write_netcdf(labelled, path=folder / f"{name}.nc")]


def _rest(rig: Rig) -> float:
    return float(separation(rig.contact, normal_load=rig.normal_load))


def _figure(rig: Rig, result: Simulation, microseconds: Floats) -> "Figure":
    from matplotlib.figure import Figure

    motion, rest = result.vibration.motions[0], _rest(rig)
    figure = Figure(figsize=(5.2, 4.6))
    gap, force = figure.subplots(2, 1, sharex=True)
    gap.plot(microseconds, 1e6 * motion.displacement, color=COLOURS[0])
    rise = 1e6 * result.vibration.mean_displacement
    gap.axhline(rise, color=COLOURS[1], linestyle="--", linewidth=1.0, label=f"mean gap, {1e6 * rest + rise:.2f} µm")
    gap.axhline(0.0, color="0.3", linestyle=":", linewidth=1.0, label=f"gap at rest, {1e6 * rest:.2f} µm")
    gap.set(ylabel="Displacement of the tip\nfrom rest [µm]")
    force.plot(microseconds, motion.normal_force, color=COLOURS[0])
    force.axhline(
        motion.normal_load, color="0.3", linestyle=":", linewidth=1.0, label=f"load, {motion.normal_load:.4g} N"
    )
    force.set(ylabel="Contact force [N]", xlabel="Time [µs]", xlim=(0, microseconds[-1]), ylim=(0, None))
    lost = motion.normal_force < _LOST * motion.normal_load
    for axes in (gap, force):
        axes.fill_between(
            microseconds,
            0,
            1,
            where=lost.tolist(),
            transform=axes.get_xaxis_transform(),
            color="0.85",
            linewidth=0,
            zorder=0,
            label="contact lost" if lost.any() else None,
        )
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2)
    figure.suptitle(f"{rig.title}\n{_what(result)}", fontsize=9)
    return figure


def _what(result: Simulation) -> str:
    if result.vibration.repetition_periods == 1:
        return "one period of the drive"
    if result.vibration.repetition_periods:
        return f"{result.vibration.repetition_periods} periods of the drive, after which the motion repeats"
    return f"a stretch of a motion that does not repeat: {result.vibration.attractor}"
