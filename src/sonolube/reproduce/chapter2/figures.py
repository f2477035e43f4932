"""Figures of chapter 2: the experiments in numbers, and what the cube says of them."""

from math import hypot, pi
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.actuator import BarWaveguide, surface_trajectory
from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.friction import dong_2015_half_period_ratio
from sonolube.published import PrintedNumber, table
from sonolube.reproduce.chapter2.tribometer import drops_of, wear_reductions
from sonolube.validation.contacts import wear_contact
from sonolube.validation.inputs import in_table, said, wear_drop
from sonolube.wear import cube_wear_rate, vibrating_cube_wear_rate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE: Final = (4.5, 3.4)  # inches
_SPEED: Final = "Sliding speed [mm/s]"
_LAGS: Final = {0.0: "driven on one end", -pi / 2: "quarter turn of D 3.25"}
_ASIDE: Final = 1.2  # mm/s between points of one speed, so that none hides another


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of chapter 2."""
    return (
        ReportFigure(
            name="figure-2-4-loci",
            chapter=2,
            title="Paths of three points on the waveguide's surface",
            caption="Computed, D 3.22 and 3.25 at the amplitude of section 2.1.2: one inch left of the centre, at the "
            "centre, one inch right of it. Full: a horn driven on one end, whose normal motion follows the axial one "
            "at once, so that the lag is zero on one side and half a turn on the other, and paths are lines. Broken: "
            "normal motion a quarter turn ahead, the lag of D 3.25, which such a horn does not give, with the sign "
            "with which the surface moves towards the centre while it is lowest, as the block did; the arrow shows the "
            "sense of motion.",
            draw=_loci,
        ),
        ReportFigure(
            name="figure-2-20-friction-against-speed",
            chapter=2,
            title="Friction against sliding speed",
            caption="Points and scatter: Table 2.3. Triangles: the cube (Table 3.2, 2.5 um) times the friction without "
            "vibration. Its ratio is the same at every speed, so that it misses the benefit that fades with speed.",
            draw=_friction_against_speed,
        ),
        ReportFigure(
            name="figure-2-22-fluctuation-against-speed",
            chapter=2,
            title="Stick-slip fluctuation of friction against sliding speed",
            caption="Root mean square of the fluctuation and its scatter, Table 2.3.",
            draw=_fluctuation_against_speed,
        ),
        ReportFigure(
            name="figure-2-27-reductions-against-speed",
            chapter=2,
            title="Reductions of friction, fluctuation and wear against sliding speed",
            caption="Full points: the reductions that the forces and fluctuations of Table 2.3 and the wear rates of "
            "Table 2.5 give; bars: the scatter of Table 2.3, carried on. Open circles: the friction reductions that "
            "Table 2.5 prints. Points of one speed are drawn side by side.",
            draw=_reductions_against_speed,
        ),
        ReportFigure(
            name="table-2-7-wear-reduction",
            chapter=2,
            title="Wear reduction against revolutions",
            caption="Points: wear rates of Table 2.7. Line: the cube (Table 3.2, 2.5 um), D 3.26 averaged over the "
            "separating half period; it knows no distance.",
            draw=_wear_reduction_against_revolutions,
        ),
        ReportFigure(
            name="table-2-14-pairs",
            chapter=2,
            title="Reductions of friction and wear for six pairs of materials",
            caption="Pin on disc, as printed in Table 2.14. Where titanium takes part, wear did not fall.",
            draw=_pairs,
        ),
    )


def _loci() -> "Figure":
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 3, figsize=(7.2, 2.7), sharex=True, sharey=True)
    inch = said("2.1.3-outer-points").value
    for axes, place, title in zip(panels, (-inch, 0.0, inch), ("point -1", "point 0", "point +1"), strict=True):
        for index, horn in enumerate(("aluminium", "steel")):
            for line, (phase, lag) in zip(LINES, _LAGS.items(), strict=False):
                path = surface_trajectory(_waveguide(horn), position=place, phase=phase)
                u, v = 1e6 * path.axial_displacement, 1e6 * path.normal_displacement
                axes.plot(u, v, linestyle=line, color=COLOURS[index], label=f"{horn} horn, {lag}")
                if index == 0 and phase and place:
                    _arrow(axes, u, v)
        axes.set(title=f"{title}, x = {1e3 * place:g} mm".replace("-", "−"), xlabel="Axial displacement [µm]")
        axes.title.set_fontsize(9)
    panels[0].set(ylabel="Normal displacement\ninto the bar [µm]", ylim=(-1.1, 1.1), xlim=(-6, 6))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _waveguide(horn: str) -> BarWaveguide:
    return BarWaveguide(
        length=said("2.1.2-waveguide-length").value,
        thickness=said("2.1.2-waveguide-thickness").value,
        poisson_ratio=in_table("3.1", f"poisson_ratio_{horn}").value,
        axial_amplitude=said("2.1.2-welder-amplitude").value,
        frequency=said("2.1.2-welder-frequency").value,
    )


def _arrow(axes: "Axes", u: Floats, v: Floats) -> None:
    lowest = int(np.argmin(v))
    before, after = max(lowest - 12, 0), min(lowest + 12, v.size - 1)
    axes.annotate(
        "",
        xy=(u[after], v[after]),
        xytext=(u[before], v[before]),
        arrowprops={"arrowstyle": "-|>", "color": COLOURS[0], "mutation_scale": 14, "shrinkA": 0, "shrinkB": 0},
    )


def _friction_against_speed() -> "Figure":
    figure, axes = _against_speed("friction_force", ylabel="Steady friction force [N]")
    load, amplitude = in_table("3.2", "normal_load").value, said("2.3.1-amplitude").value
    ratio = float(dong_2015_half_period_ratio(wear_contact(), normal_load=load, vibration_amplitude=amplitude))
    axes.errorbar(
        1e3 * _speeds(),
        ratio * table("2.3").columns["friction_force"].values[::2],
        linestyle=LINES[2],
        marker=MARKERS[2],
        mfc="white",
        color=COLOURS[2],
        label="with vibration, cube",
    )
    axes.legend(loc="upper left")
    return figure


def _fluctuation_against_speed() -> "Figure":
    figure, axes = _against_speed("friction_rms", ylabel="RMS of the friction's fluctuation [N]")
    axes.legend(loc="upper left")
    return figure


def _against_speed(column: str, *, ylabel: str) -> "tuple[Figure, Axes]":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=_SIZE)
    numbers = [in_table("2.3", column, row) for row in range(6)]
    for first, state in enumerate(("without vibration", "with vibration")):
        axes.errorbar(
            1e3 * _speeds(),
            [number.value for number in numbers[first::2]],
            yerr=[_scatter(number) for number in numbers[first::2]],
            linestyle=LINES[first],
            marker=MARKERS[first],
            color=COLOURS[first],
            capsize=3,
            label=f"{state}, Table 2.3",
        )
    axes.set(xlabel=_SPEED, ylabel=ylabel, xlim=(0, 95), ylim=(0, 1.4 * max(number.high for number in numbers)))
    return figure, axes


def _reductions_against_speed() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=_SIZE)
    for index, (label, drops, scatters) in enumerate(
        (
            ("friction, forces of Table 2.3", drops_of("friction_force"), _scatters_of_drops("friction_force")),
            ("fluctuation, Table 2.3", drops_of("friction_rms"), _scatters_of_drops("friction_rms")),
            ("wear, rates of Table 2.5", wear_reductions("2.5"), None),
        )
    ):
        axes.errorbar(
            1e3 * _speeds() + (index - 1) * _ASIDE,
            [100 * drop.value for drop in drops],
            yerr=scatters,
            linestyle=LINES[index],
            marker=MARKERS[index],
            color=COLOURS[index],
            capsize=3,
            label=label,
        )
    printed = 100 * table("2.5").columns["friction_reduction"].values
    axes.errorbar(
        1e3 * _speeds() - 2 * _ASIDE, printed, fmt="o", mfc="white", color=COLOURS[0], label="friction, Table 2.5"
    )
    axes.set(xlabel=_SPEED, ylabel="Reduction [%]", xlim=(0, 95), ylim=(0, 118), yticks=range(0, 101, 20))
    axes.legend(loc="upper right")
    return figure


def _wear_reduction_against_revolutions() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=_SIZE)
    turns = table("2.7").columns["revolutions"].values
    measured = [100 * reduction.value for reduction in wear_reductions("2.7")]
    axes.plot(turns, measured, linestyle=LINES[0], marker=MARKERS[0], color=COLOURS[0], label="measured, Table 2.7")
    contact, load = wear_contact(), in_table("3.2", "normal_load").value
    vibrating = vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=said("2.3.1-amplitude").value)
    computed = 100 * wear_drop(float(cube_wear_rate(contact, normal_load=load)), float(vibrating))
    axes.axhline(computed, linestyle=LINES[1], color=COLOURS[1], label="cube")
    axes.set(xlabel="Revolutions of the disc", ylabel="Wear reduction [%]", xlim=(800, 2050), ylim=(0, 70))
    axes.legend(loc="upper left")
    return figure


def _pairs() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(5.4, 3.8))
    columns = table("2.14").columns
    places = np.arange(len(columns["pin"].printed))[::-1]
    for name, label, offset, hatch, colour in (
        ("friction_reduction", "friction, Table 2.14", 0.2, "", COLOURS[0]),
        ("wear_reduction", "wear, Table 2.14", -0.2, "////", COLOURS[1]),
    ):
        values = 100 * columns[name].values
        bars = axes.barh(
            places + offset,
            np.nan_to_num(values),
            height=0.38,
            label=label,
            facecolor=colour if not hatch else "white",
            edgecolor=colour,
            hatch=hatch,
        )
        axes.bar_label(bars, [f"{value:.0f}" if value > 0 else "no reduction" for value in values], padding=3, size=8)
    pairs = zip(columns["pin"].printed, columns["disc"].printed, strict=True)
    axes.set(
        xlabel="Reduction [%]", xlim=(0, 100), yticks=places, yticklabels=[f"{pin}\non {disc}" for pin, disc in pairs]
    )
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def _speeds() -> Floats:
    return table("2.2").columns["sliding_speed"].values


def _scatter(number: PrintedNumber) -> float:
    return number.high - number.value


def _scatters_of_drops(column: str) -> list[float]:
    """Return how far the scatter of both numbers, taken as independent, carries each reduction. [%]"""
    pairs = [(in_table("2.3", column, row), in_table("2.3", column, row + 1)) for row in (0, 2, 4)]
    return [100 * on.value / off.value * hypot(_scatter(off) / off.value, _scatter(on) / on.value) for off, on in pairs]
