"""Figures of the command `optimise`."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.actuator import matched_power_factor
from sonolube.checks import Floats
from sonolube.design.optimisation import (
    CAPACITANCE_TOLERANCE,
    DesignPoint,
    DriveElectronics,
    Optimum,
    design_rig,
    stack_admittance,
)
from sonolube.design.optimisation.space import OWN_ACTUATOR
from sonolube.figure import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

AXES = {
    "power": "Power of the amplifier [W]",
    "heat": "Heat in the actuator [W]",
    "voltage": "Voltage, peak to peak [V]",
}
LIMITS = {
    "stack_voltage": "voltage the stack bears",
    "voltage": "voltage of the amplifier",
    "current": "current of the amplifier",
    "slew_rate": "slew rate of the amplifier",
    "tension": "tension in the stack",
    "contact_pressure": "stress in the contact",
    "horn_stress": "stress in the horn",
    "temperature": "warming of the actuator",
    "bolt_fatigue": "fatigue of the bolt",
    "bolt_yield": "yielding of the bolt",
}
_MARKERS = "osD^vPX*<>"
_STYLES = ("-", "--", "-.", ":")
_SHOWN = 6  # actuators drawn by name


def front_figure(found: Optimum) -> "Figure":
    """Return both objectives of all designs, and the front between the best."""
    from matplotlib.figure import Figure

    assert found.second_objective is not None
    figure = Figure(figsize=(5.8, 3.8))
    axes = figure.subplots()
    land = found.screening
    first, second = (land.objectives[name][land.feasible] for name in (found.minimise, found.second_objective))
    axes.plot(first, second, ".", color="0.75", markersize=3, label="designs looked at", rasterized=True, zorder=1)
    points = np.array(
        [[point.objective(name) for name in (found.minimise, found.second_objective)] for point in found.front]
    )
    axes.plot(*points.T, color="0.2", linewidth=1.2, drawstyle="steps-post", zorder=2)
    for index, name in enumerate(dict.fromkeys(_kind(point) for point in found.front)):
        own = points[[_kind(point) == name for point in found.front]]
        axes.plot(
            *own.T,
            _MARKERS[index % len(_MARKERS)],
            color=COLOURS[index % len(COLOURS)],
            markeredgecolor="white",
            markersize=7,
            label=name,
            zorder=3,
        )
    _window(axes, points)
    ends = [found.front[0], found.front[-1]] if len(found.front) > 1 else [found.front[0]]
    for point, at, (across, align) in zip(ends, (points[0], points[-1]), ((8, "left"), (-8, "right")), strict=False):
        text = f"{1e-3 * point.frequency:.2f} kHz\n{point.voltage_peak_to_peak:.3g} V"
        axes.annotate(text, at, xytext=(across, 14), textcoords="offset points", fontsize=7, ha=align)
    axes.set(xlabel=AXES[found.minimise], ylabel=AXES[found.second_objective])
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def frequency_figure(found: Optimum) -> "Figure":
    """Return the least of the objective at each frequency, a line to an actuator."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.8, 3.6))
    axes = figure.subplots()
    land = found.screening
    kinds = np.array([f"{candidate.actuator}, {candidate.waveform}" for candidate in land.candidates])[
        land.candidate_index
    ]
    for index, point in enumerate(found.designs[:_SHOWN]):
        own = land.feasible & (kinds == _kind(point))
        f, least = _envelope(land.frequency[own], land.objectives[found.minimise][own])
        colour = COLOURS[index % len(COLOURS)]
        axes.semilogy(1e-3 * f, least, _STYLES[index % 4], color=colour, label=_named(point))
        axes.plot(
            1e-3 * point.frequency,
            point.objective(found.minimise),
            _MARKERS[index],
            color=colour,
            markeredgecolor="black",
            markersize=7,
            zorder=3,
            clip_on=False,
            label=(None if index else "best of each" if len(found.designs) > 1 else "best"),
        )
    _plain_numbers(axes.yaxis)
    low, high = found.problem.space.frequencies
    axes.set(xlabel="Drive frequency [kHz]", ylabel=AXES[found.minimise], xlim=(1e-3 * low, 1e-3 * high))
    axes.legend(ncols=2 if len(found.designs) > 3 else 1)
    return figure


def limits_figure(point: DesignPoint) -> "Figure":
    """Return the share of each limit that a design uses."""
    from matplotlib.figure import Figure

    used = {name: float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    used = {name: share for name, share in sorted(used.items(), key=lambda item: item[1]) if share > 0}
    figure = Figure(figsize=(5.8, 0.9 + 0.3 * max(len(used), 1)))
    axes = figure.subplots()
    axes.barh([LIMITS[name] for name in used], [100 * share for share in used.values()], color=COLOURS[0], height=0.6)
    for place, share in enumerate(used.values()):
        axes.annotate(
            f"{100 * share:.3g} %",
            (100 * share, place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    axes.axvline(100, color="black", linestyle="--", linewidth=1)
    axes.set(xlabel="Share of the limit used [%]", xlim=(0, 118))
    axes.grid(visible=False, axis="y")
    return figure


def power_factor_figure(found: Optimum, electric: DriveElectronics) -> "Figure":
    """Return the power factor that the amplifier sees around the drive's frequency, with each network."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.8, 3.4))
    axes = figure.subplots()
    rig = design_rig(found.problem, found.best)
    f = found.best.frequency * np.linspace(0.85, 1.15, 401)
    bare = stack_admittance(rig, frequency=f)
    axes.plot(1e-3 * f, bare.real / np.abs(bare), color="0.4", linestyle=":", label="without a network")
    for index, matched in enumerate(electric.networks):
        colour = COLOURS[index]
        changed = [
            matched_power_factor(
                matched.network, admittance=stack_admittance(rig, frequency=f, capacitance_change=share), frequency=f
            )
            for share in np.linspace(-CAPACITANCE_TOLERANCE, CAPACITANCE_TOLERANCE, 9)
        ]
        axes.plot(1e-3 * f, changed[4], _STYLES[index], color=colour, label=matched.name)
        edges = [np.min(changed, axis=0), np.max(changed, axis=0)]
        label = f"capacitance off by up to {100 * CAPACITANCE_TOLERANCE:.0f} %" if index == 0 else None
        axes.fill_between(1e-3 * f, *edges, color=colour, alpha=0.13, linewidth=0, label=label)
    axes.axvline(1e-3 * found.best.frequency, ymax=1 / 1.32, color="0.5", linewidth=0.8, label="the drive")
    axes.set(xlabel="Frequency [kHz]", ylabel="Power factor [–]", ylim=(0, 1.32), xlim=(1e-3 * f[0], 1e-3 * f[-1]))
    axes.set_yticks(np.linspace(0, 1, 6))
    axes.legend(ncols=2, loc="upper center")
    return figure


def _kind(point: DesignPoint) -> str:
    return f"{point.candidate.actuator}, {point.candidate.waveform}"


def _named(point: DesignPoint) -> str:
    """Return how a reader knows the actuator and waveform of a point."""
    return _kind(point).replace(f"{OWN_ACTUATOR},", "the rig's actuator,", 1)


def _plain_numbers(axis: "Axis") -> None:
    """Write numbers on a logarithmic axis out, also between the powers of ten."""
    from matplotlib.ticker import LogFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(np.inf, np.inf)))
    axis.set_minor_formatter(NullFormatter())


def _envelope(f: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return the least value in each of many narrow bands of frequency."""
    edges = np.linspace(f.min(), f.max() * (1 + 1e-12), 61)
    bins = np.clip(np.digitize(f, edges) - 1, 0, 59)
    there = np.unique(bins)
    places = [np.flatnonzero(bins == each) for each in there]
    best = np.array([own[np.argmin(values[own])] for own in places])
    return f[best], values[best]


def _window(axes: "Axes", points: Floats) -> None:
    """Show the front with what lies near it, on a logarithmic axis where it spans much."""
    low, high = points.min(axis=0), points.max(axis=0)
    reach = np.maximum((high / low) ** 0.5, 1.15)
    ends = low / reach**0.5, high * reach
    for axis, (first, last) in zip("xy", np.transpose(ends), strict=True):
        getattr(axes, f"set_{axis}scale")("log" if last > 5 * first else "linear")
        getattr(axes, f"set_{axis}lim")(first, last)
