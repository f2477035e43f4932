"""Figures of results of a rig: steady vibration, linear response, start-up, temperature and lubrication regime."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.figure import COLOURS, LINES
from sonolube.models.friction import LubricationMethod

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from sonolube.rig.contact_temperature import TemperaturePoint
    from sonolube.rig.labelled_arrays import LabelledArrays
    from sonolube.rig.linear_response import FrequencyResponse
    from sonolube.rig.lubrication import LubricationMap, LubricationPoint
    from sonolube.rig.record import Rig
    from sonolube.rig.start_up_transient import StartUp

_CONTACT_LOSS_FORCE = 0.01  # force over load below which contact counts as lost
_LAST_PERIODS = 4  # periods of the drive shown enlarged at the end of a start-up
_LAST_POINTS = 801  # points drawn of those periods
_METHOD_COLOURS = {"dry": "0.75", "ultrasonic": "#9ecae1", "lubricant": "#fdd0a2", "combined": "#c7e9c0"}


def simulation_figure(result: "xr.Dataset | LabelledArrays") -> "Figure":
    """Displacement of the tip and contact force over one repetition of the steady vibration.

    Parameters
    ----------
    result : xarray.Dataset or LabelledArrays
        As `simulation_arrays` returns it.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels over time; intervals without contact are shaded.
    """
    from matplotlib.figure import Figure

    microseconds = 1e6 * result["time"].to_numpy()
    displacement, normal_force = result["displacement"].to_numpy(), result["normal_force"].to_numpy()
    rest, load = result.attrs["separation_at_rest_m"], result.attrs["normal_load_N"]
    figure = Figure(figsize=(5.2, 4.6))
    gap, force = figure.subplots(2, 1, sharex=True)
    gap.plot(microseconds, 1e6 * displacement, color=COLOURS[0])
    rise = 1e6 * result.attrs["mean_displacement_m"]
    gap.axhline(rise, color=COLOURS[1], linestyle="--", linewidth=1.0, label=f"mean gap, {1e6 * rest + rise:.2f} µm")
    gap.axhline(0.0, color="0.3", linestyle=":", linewidth=1.0, label=f"gap at rest, {1e6 * rest:.2f} µm")
    gap.set(ylabel="Displacement of the tip\nfrom rest [µm]")
    force.plot(microseconds, normal_force, color=COLOURS[0])
    force.axhline(load, color="0.3", linestyle=":", linewidth=1.0, label=f"load, {load:.4g} N")
    force.set(ylabel="Contact force [N]", xlabel="Time [µs]", xlim=(0, microseconds[-1]), ylim=(0, None))
    lost = normal_force < _CONTACT_LOSS_FORCE * load
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
    figure.suptitle(f"{result.attrs['rig']}\n{result.attrs['interval']}", fontsize=9)
    return figure


def response_figure(rig: "Rig", result: "FrequencyResponse") -> "Figure":
    """Amplitude per volt, electrical impedance and phase of the linear response over frequency.

    Parameters
    ----------
    rig : Rig
    result : FrequencyResponse
        Result of `linear_response` for the same rig.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 5.4))
    panels = figure.subplots(3, 1, sharex=True)
    kilohertz = 1e-3 * result.frequency
    rows = (
        (1e6 * result.amplitude_per_volt, "Amplitude per volt\n[µm/V]", "log"),
        (result.impedance, "Impedance\n[ohm]", "log"),
        (np.degrees(result.phase), "Phase\n[deg]", "linear"),
    )
    for index, (axes, (values, label, scale)) in enumerate(zip(panels, rows, strict=True)):
        axes.plot(kilohertz, values, color=COLOURS[index])
        axes.set(ylabel=label, yscale=scale)
        if rig.drive is not None:
            axes.axvline(1e-3 * rig.drive.frequency, color="0.4", linestyle=":", label="drive")
    panels[0].legend(loc="upper left")
    panels[-1].set_xlabel("Frequency [kHz]")
    panels[-1].set_yticks([-90, -45, 0, 45, 90])
    figure.suptitle(rig.title, fontsize=9)
    return figure


def start_up_figure(rig: "Rig", result: "StartUp") -> "Figure":
    """Displacement of the tip from rest over the whole start-up and over its last four periods.

    Parameters
    ----------
    rig : Rig
        With a drive.
    result : StartUp
        Result of `start_up` for the same rig.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Between steps of the time integration the last periods are drawn by cubic Hermite interpolation of displacement
    and velocity.
    """
    from matplotlib.figure import Figure
    from scipy.interpolate import CubicHermiteSpline

    assert rig.drive is not None
    figure = Figure(figsize=(5.2, 4.6))
    whole, last = figure.subplots(2, 1)
    time, contact = result.trajectory.time, result.trajectory.contact
    milliseconds, micrometres = 1e3 * time, 1e6 * contact.displacement
    end = int(np.searchsorted(time, time[-1] - _LAST_PERIODS / rig.drive.frequency))
    whole.plot(milliseconds, micrometres, color=COLOURS[0], linewidth=0.6)
    interpolated = CubicHermiteSpline(time[end:], micrometres[end:], 1e6 * contact.velocity[end:])
    dense_time = np.linspace(time[end], time[-1], _LAST_POINTS)
    last.plot(1e3 * dense_time, interpolated(dense_time), color=COLOURS[0])
    for axes in (whole, last):
        axes.set(xlabel="Time [ms]", ylabel="Displacement\nof the tip [µm]")
    last.set_title("the last four periods", fontsize=8)
    figure.suptitle(rig.title, fontsize=9)
    return figure


def temperature_figure(rig: "Rig", result: "TemperaturePoint") -> "Figure":
    """Temperature rise of the contact and of the bulk of the pin over a test, with and without vibration.

    Parameters
    ----------
    rig : Rig
    result : TemperaturePoint
        Result of `heat_point` for the same rig.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 3.6))
    axes = figure.subplots()
    for index, (label, history) in enumerate(
        (("without vibration", result.without_vibration), ("with vibration", result.with_vibration))
    ):
        for body, rise, line in (
            ("contact", history.temperature_rise, LINES[0]),
            ("bulk of the pin", history.bulk_rise, LINES[1]),
        ):
            axes.plot(history.time, rise, linestyle=line, color=COLOURS[index], label=f"{body}, {label}")
    axes.set(xlabel="Time [s]", ylabel="Rise of the temperature [K]", xlim=(0, history.time[-1]))
    axes.set_ylim(0, 1.35 * axes.get_ylim()[1])
    axes.legend(loc="upper left", ncols=2, fontsize=7)
    figure.suptitle(rig.title, fontsize=9)
    return figure


def lubrication_figure(rig: "Rig", result: "LubricationPoint", surroundings: "LubricationMap") -> "Figure":
    """Map of the method of least friction over sliding speed and nominal pressure, with the rig on it.

    Parameters
    ----------
    rig : Rig
    result : LubricationPoint
        Result of `regime_point` for the same rig.
    surroundings : LubricationMap
        Result of `regime_map` for the same rig and lubricant.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = [str(method) for method in LubricationMethod]
    figure = Figure(figsize=(5.2, 4.0))
    axes = figure.subplots()
    axes.pcolormesh(
        1e3 * surroundings.sliding_speed,
        1e-6 * surroundings.nominal_pressure,
        np.searchsorted(np.sort(names), surroundings.best),
        cmap=ListedColormap([_METHOD_COLOURS[name] for name in sorted(names)]),
        vmin=-0.5,
        vmax=len(names) - 0.5,
        rasterized=True,
    )
    (point,) = axes.plot(
        1e3 * result.sliding_speed, 1e-6 * result.nominal_pressure, "ko", label="the rig", linestyle="none"
    )
    shown = [Patch(color=_METHOD_COLOURS[name], label=name) for name in names if np.any(surroundings.best == name)]
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Nominal pressure [MPa]", xscale="log", yscale="log")
    axes.grid(visible=False)
    figure.legend(handles=[*shown, point], loc="outside lower center", ncols=5)
    figure.suptitle(rig.title, fontsize=9)
    return figure
