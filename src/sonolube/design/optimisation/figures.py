"""Figures of an optimisation: Pareto front, objective over frequency, limits used, and power factor."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.design.optimisation.drive_electronics import (
    CAPACITANCE_TOLERANCE,
    DriveElectronics,
    design_rig,
    stack_admittance,
)
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.design.optimisation.gradient_search import DesignPoint
from sonolube.design.optimisation.optimum import Optimum
from sonolube.design.optimisation.space import OWN_ACTUATOR, Candidate
from sonolube.figure import COLOURS
from sonolube.models.actuator import matched_power_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

_OBJECTIVE_LABELS = {
    "power": "Power of the amplifier [W]",
    "heat": "Heat in the actuator [W]",
    "voltage": "Voltage, peak to peak [V]",
}
_MARKERS = "osD^vPX*<>"
_STYLES = ("-", "--", "-.", ":")
_MOST_CURVES = 6  # actuators drawn over frequency
_BANDS = 60  # of frequency, in each of which the least objective is drawn


def front_figure(optimum: Optimum) -> "Figure":
    """Pareto front of two objectives among all feasible designs of the screening.

    Parameters
    ----------
    optimum : Optimum
        With a second objective.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    assert optimum.second_objective is not None
    figure = Figure(figsize=(5.8, 3.8))
    axes = figure.subplots()
    screened = optimum.screening
    names = (optimum.minimise, optimum.second_objective)
    first, second = (screened.objectives[name][screened.feasible] for name in names)
    axes.plot(first, second, ".", color="0.75", markersize=3, label="designs looked at", rasterized=True, zorder=1)
    points = np.array([[point.objective(name) for name in names] for point in optimum.front])
    axes.plot(*points.T, color="0.2", linewidth=1.2, drawstyle="steps-post", zorder=2)
    for index, name in enumerate(dict.fromkeys(_family(point.candidate) for point in optimum.front)):
        own = points[[_family(point.candidate) == name for point in optimum.front]]
        axes.plot(
            *own.T,
            _MARKERS[index % len(_MARKERS)],
            color=COLOURS[index % len(COLOURS)],
            markeredgecolor="white",
            markersize=7,
            label=name,
            zorder=3,
        )
    _frame_front(axes, points)
    ends = [optimum.front[0], optimum.front[-1]] if len(optimum.front) > 1 else [optimum.front[0]]
    for point, at, (across, align) in zip(ends, (points[0], points[-1]), ((8, "left"), (-8, "right")), strict=False):
        text = f"{1e-3 * point.frequency:.2f} kHz\n{point.voltage_peak_to_peak:.3g} V"
        axes.annotate(text, at, xytext=(across, 14), textcoords="offset points", fontsize=7, ha=align)
    axes.set(xlabel=_OBJECTIVE_LABELS[optimum.minimise], ylabel=_OBJECTIVE_LABELS[optimum.second_objective])
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def frequency_figure(optimum: Optimum) -> "Figure":
    """Least objective over drive frequency, one curve for each actuator and waveform.

    Parameters
    ----------
    optimum : Optimum

    Returns
    -------
    matplotlib.figure.Figure
        With the refined designs as markers.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.8, 3.6))
    axes = figure.subplots()
    screened = optimum.screening
    families = np.array([_family(candidate) for candidate in screened.candidates])[screened.candidate_index]
    for index, point in enumerate(optimum.designs[:_MOST_CURVES]):
        own = screened.feasible & (families == _family(point.candidate))
        f, least = _envelope(screened.frequency[own], screened.objectives[optimum.minimise][own])
        colour = COLOURS[index % len(COLOURS)]
        label = _family(point.candidate).replace(f"{OWN_ACTUATOR},", "the rig's actuator,", 1)
        axes.semilogy(1e-3 * f, least, _STYLES[index % 4], color=colour, label=label)
        axes.plot(
            1e-3 * point.frequency,
            point.objective(optimum.minimise),
            _MARKERS[index],
            color=colour,
            markeredgecolor="black",
            markersize=7,
            zorder=3,
            clip_on=False,
            label=(None if index else "best of each" if len(optimum.designs) > 1 else "best"),
        )
    _plain_numbers(axes.yaxis)
    low, high = optimum.problem.space.frequencies
    ylabel = _OBJECTIVE_LABELS[optimum.minimise]
    axes.set(xlabel="Drive frequency [kHz]", ylabel=ylabel, xlim=(1e-3 * low, 1e-3 * high))
    axes.legend(ncols=2 if len(optimum.designs) > 3 else 1)
    return figure


def limits_figure(point: DesignPoint) -> "Figure":
    """Fraction of each limit that a design uses, as bars.

    Parameters
    ----------
    point : DesignPoint

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    used = {name: float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    used = {name: share for name, share in sorted(used.items(), key=lambda item: item[1]) if share > 0}
    figure = Figure(figsize=(5.8, 0.9 + 0.3 * max(len(used), 1)))
    axes = figure.subplots()
    percent = [100 * share for share in used.values()]
    bars = axes.barh([LIMITS[name] for name in used], percent, color=COLOURS[0], height=0.6)
    axes.bar_label(bars, fmt="{:.3g} %", padding=4, fontsize=8)
    axes.axvline(100, color="black", linestyle="--", linewidth=1)
    axes.set(xlabel="Share of the limit used [%]", xlim=(0, 118))
    axes.grid(visible=False, axis="y")
    return figure


def power_factor_figure(optimum: Optimum, electric: DriveElectronics) -> "Figure":
    """Power factor at the amplifier over frequency about the drive's, without and with matching networks.

    Parameters
    ----------
    optimum : Optimum
    electric : DriveElectronics
        Of its best design.

    Returns
    -------
    matplotlib.figure.Figure
        Bands are the range over the tolerance of the capacitance.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.8, 3.4))
    axes = figure.subplots()
    rig = design_rig(optimum.problem, optimum.best)
    f = optimum.best.frequency * np.linspace(0.85, 1.15, 401)
    bare = stack_admittance(rig, frequency=f)
    axes.plot(1e-3 * f, bare.real / np.abs(bare), color="0.4", linestyle=":", label="without a network")
    for index, matched in enumerate(electric.networks):
        colour = COLOURS[index]
        changed = [
            matched_power_factor(
                matched.network, admittance=stack_admittance(rig, frequency=f, capacitance_change=change), frequency=f
            )
            for change in np.linspace(-CAPACITANCE_TOLERANCE, CAPACITANCE_TOLERANCE, 9)
        ]
        axes.plot(1e-3 * f, changed[4], _STYLES[index], color=colour, label=matched.name)
        edges = [np.min(changed, axis=0), np.max(changed, axis=0)]
        label = f"capacitance off by up to {100 * CAPACITANCE_TOLERANCE:.0f} %" if index == 0 else None
        axes.fill_between(1e-3 * f, *edges, color=colour, alpha=0.13, linewidth=0, label=label)
    axes.axvline(1e-3 * optimum.best.frequency, ymax=1 / 1.32, color="0.5", linewidth=0.8, label="the drive")
    axes.set(xlabel="Frequency [kHz]", ylabel="Power factor [–]", ylim=(0, 1.32), xlim=(1e-3 * f[0], 1e-3 * f[-1]))
    axes.set_yticks(np.linspace(0, 1, 6))
    axes.legend(ncols=2, loc="upper center")
    return figure


def _family(candidate: Candidate) -> str:
    """Actuator and waveform of a design."""
    return f"{candidate.actuator}, {candidate.waveform}"


def _plain_numbers(axis: "Axis") -> None:
    """Write the numbers of a logarithmic axis in full, also between the powers of ten."""
    from matplotlib.ticker import LogFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(np.inf, np.inf)))
    axis.set_minor_formatter(NullFormatter())


def _envelope(f: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Frequency and value of the least value in each of 60 bands of frequency."""
    edges = np.linspace(f.min(), f.max() * (1 + 1e-12), _BANDS + 1)
    bins = np.clip(np.digitize(f, edges) - 1, 0, _BANDS - 1)
    places = [np.flatnonzero(bins == each) for each in np.unique(bins)]
    best = np.array([own[np.argmin(values[own])] for own in places])
    return f[best], values[best]


def _frame_front(axes: "Axes", points: Floats) -> None:
    """Set the limits of both axes to the front with a margin, logarithmic where it spans a factor of five."""
    low, high = points.min(axis=0), points.max(axis=0)
    reach = np.maximum((high / low) ** 0.5, 1.15)
    ends = low / reach**0.5, high * reach
    for axis, (first, last) in zip("xy", np.transpose(ends), strict=True):
        getattr(axes, f"set_{axis}scale")("log" if last > 5 * first else "linear")
        getattr(axes, f"set_{axis}lim")(first, last)
