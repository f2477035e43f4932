"""Section 2.3: figures of friction, fluctuation and wear on the modified tribometer, with the cube model."""

from collections.abc import Iterator
from math import hypot
from typing import TYPE_CHECKING, Final

from sonolube.checks import Floats
from sonolube.facts.published import PrintedNumber, published_number, si_value, table
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.models.wear import cube_wear_rate, vibrating_cube_wear_rate
from sonolube.reproduction import formulas
from sonolube.reproduction.chapter2.tribometer import reductions_of_table_2_3, wear_reductions
from sonolube.reproduction.plots import curve_style, draw_printed, line_style, single_axes
from sonolube.validation.contacts import wear_contact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE: Final = (4.5, 3.4)  # inches
_SPEED: Final = "Sliding speed [mm/s]"
_OFFSET: Final = 1.2  # mm/s between points of one speed, so that none covers another


def tribometer_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.3."""
    yield ReportFigure(
        name="figure-2-20-friction-against-speed",
        title="Friction against sliding speed",
        caption="Points and scatter: Table 2.3. Triangles: the cube (Table 3.2, 2.5 um) times the friction without "
        "vibration. Its ratio is the same at every speed, so that it misses the benefit that fades with speed.",
        draw=_friction_against_speed,
    )
    yield ReportFigure(
        name="figure-2-22-fluctuation-against-speed",
        title="Stick-slip fluctuation of friction against sliding speed",
        caption="Root mean square of the fluctuation and its scatter, Table 2.3.",
        draw=_fluctuation_against_speed,
    )
    yield ReportFigure(
        name="figure-2-27-reductions-against-speed",
        title="Reductions of friction, fluctuation and wear against sliding speed",
        caption="Full points: reductions of the forces and fluctuations of Table 2.3 and of the wear rates of "
        "Table 2.5; bars: the propagated scatter of Table 2.3. Open circles: the friction reductions printed in "
        "Table 2.5. Points of one speed are drawn side by side.",
        draw=_reductions_against_speed,
    )
    yield ReportFigure(
        name="table-2-7-wear-reduction",
        title="Wear reduction against revolutions",
        caption="Points: wear rates of Table 2.7. Line: the cube (Table 3.2, 2.5 um), D 3.26 averaged over the "
        "separating half period; it does not depend on the distance.",
        draw=_wear_reduction_against_revolutions,
    )


def _friction_against_speed() -> "Figure":
    """Draw the friction of Table 2.3 with that of the cube under vibration."""
    figure, axes = _against_speed("friction_force", ylabel="Steady friction force [N]")
    load, amplitude = si_value("table-3.2-normal_load-1"), si_value("2.3.1-amplitude")
    ratio = float(dong_2015_half_period_ratio(wear_contact(), normal_load=load, vibration_amplitude=amplitude))
    computed = ratio * table("2.3").columns["friction_force"].values[::2]
    axes.errorbar(1e3 * _speeds(), computed, **curve_style(2), mfc="white", label="with vibration, cube")
    axes.legend(loc="upper left")
    return figure


def _fluctuation_against_speed() -> "Figure":
    """Draw the fluctuation of friction of Table 2.3."""
    figure, axes = _against_speed("friction_rms", ylabel="RMS of the friction's fluctuation [N]")
    axes.legend(loc="upper left")
    return figure


def _against_speed(column: str, *, ylabel: str) -> "tuple[Figure, Axes]":
    """Draw a column of Table 2.3 without and with vibration against the sliding speed."""
    figure, axes = single_axes(_SIZE)
    numbers = _numbers(column)
    for first, state in enumerate(("without vibration", "with vibration")):
        label = f"{state}, Table 2.3"
        draw_printed(axes, 1e3 * _speeds(), numbers[first::2], **curve_style(first), label=label)
    axes.set(xlabel=_SPEED, ylabel=ylabel, xlim=(0, 95), ylim=(0, 1.4 * max(number.high for number in numbers)))
    return figure, axes


def _reductions_against_speed() -> "Figure":
    """Draw the reductions of friction, fluctuation and wear against the sliding speed."""
    figure, axes = single_axes(_SIZE)
    curves = (
        ("friction, forces of Table 2.3", reductions_of_table_2_3("friction_force"), _scatter("friction_force")),
        ("fluctuation, Table 2.3", reductions_of_table_2_3("friction_rms"), _scatter("friction_rms")),
        ("wear, rates of Table 2.5", wear_reductions("2.5"), None),
    )
    for index, (label, reductions, scatter) in enumerate(curves):
        speeds, percent = 1e3 * _speeds() + (index - 1) * _OFFSET, [100 * reduction.value for reduction in reductions]
        axes.errorbar(speeds, percent, yerr=scatter, **curve_style(index), capsize=3, label=label)
    speeds, printed = 1e3 * _speeds() - 2 * _OFFSET, 100 * table("2.5").columns["friction_reduction"].values
    axes.errorbar(speeds, printed, fmt="o", mfc="white", color=COLOURS[0], label="friction, Table 2.5")
    axes.set(xlabel=_SPEED, ylabel="Reduction [%]", xlim=(0, 95), ylim=(0, 118), yticks=range(0, 101, 20))
    axes.legend(loc="upper right")
    return figure


def _wear_reduction_against_revolutions() -> "Figure":
    """Draw the wear reduction of Table 2.7 with that of the cube."""
    figure, axes = single_axes(_SIZE)
    turns = table("2.7").columns["revolutions"].values
    measured = [100 * reduction.value for reduction in wear_reductions("2.7")]
    axes.plot(turns, measured, **curve_style(0), label="measured, Table 2.7")
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    vibrating = vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=si_value("2.3.1-amplitude"))
    computed = 100 * formulas.wear_reduction(float(cube_wear_rate(contact, normal_load=load)), float(vibrating))
    axes.axhline(computed, **line_style(1), label="cube")
    axes.set(xlabel="Revolutions of the disc", ylabel="Wear reduction [%]", xlim=(800, 2050), ylim=(0, 70))
    axes.legend(loc="upper left")
    return figure


def _speeds() -> Floats:
    """Three sliding speeds of Table 2.2. [m/s]"""
    return table("2.2").columns["sliding_speed"].values


def _numbers(column: str) -> list[PrintedNumber]:
    """Six numbers of a column of Table 2.3."""
    return [published_number(f"table-2.3-{column}-{row}") for row in range(1, 7)]


def _scatter(column: str) -> list[float]:
    """Scatter of the reductions of a column of Table 2.3, that of both numbers taken as independent. [%]"""
    numbers = _numbers(column)
    return [
        100 * on.value / off.value * hypot(*((number.high - number.value) / number.value for number in (off, on)))
        for off, on in zip(numbers[::2], numbers[1::2], strict=True)
    ]
