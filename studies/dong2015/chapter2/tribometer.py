"""Section 2.3, the modified tribometer, and its protocol in appendix A: rows and figures."""

from collections.abc import Iterator
from math import hypot
from operator import add, sub, truediv
from typing import TYPE_CHECKING, Final

from dong2015 import formulas
from dong2015.plots import curve_style, draw_printed, line_style, report_figure, single_axes
from dong2015.row import Row, formula_row, published_formula_row, published_model_row, range_rows, undetermined_row
from sonolube.checks import Floats
from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    as_exact,
    as_setting,
    propagate_rounding,
    published_number,
    si_value,
    table,
)
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.models.wear import cube_wear_rate, vibrating_cube_wear_rate
from sonolube.validation.contacts import wear_contact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SPEEDS: Final = ("20.3", "40.6", "87")  # one to a row of Tables 2.2 and 2.5, one to two rows of Tables 2.3 and 2.4
_ROTATIONS: Final = ("A.3.1.6-rotation-20.3", "A.3.1.10-rotation-40.6", "A.3.1.10-rotation-87")
_DISTANCE: Final = "table-2.2-sliding_distance-1"
_HIGHEST_SPEED: Final = "table-2.2-sliding_speed-3"


def tribometer_rows() -> Iterator[Row]:
    """Yield the rows of section 2.3."""
    yield from _settings_of_first_study()
    yield from _protocol()
    yield from _friction()
    yield from _distances_to_steadiness()
    yield from _surfaces()
    yield from _wear_of_first_study()
    yield from _marks()
    yield from _settings_of_second_study()
    yield from _wear_of_second_study()


def _distances_to_steadiness() -> Iterator[Row]:
    """Yield the distances to steadiness of Table 2.3, and their quotients, by which D says what vibration does."""
    missing = "a model of how oxide and surfaces run in; the distance was measured."
    for column in ("friction_distance", "rms_distance"):
        for row in range(1, 7):
            yield undetermined_row(f"table-2.3-{column}-{row}", missing)
    for column, name, note, order in (
        ("friction_distance", "distance", "Distance with vibration over that without.", 1),
        ("rms_distance", "fluctuation-distance", "Distance without vibration over that with.", -1),
    ):
        for speed, off in zip(_SPEEDS, (1, 3, 5), strict=True):
            pair = [f"table-2.3-{column}-{off + 1}", f"table-2.3-{column}-{off}"][::order]
            yield formula_row(f"2.3.3-{name}-ratio-{speed}", note, truediv, *pair)


def reductions_of_table_2_3(column: str) -> list[ComputedValue]:
    """Reductions of a column of Table 2.3 under vibration at the three speeds. []"""
    return [
        propagate_rounding(formulas.friction_reduction, f"table-2.3-{column}-{off}", f"table-2.3-{column}-{off + 1}")
        for off in (1, 3, 5)
    ]


def wear_reductions(table_id: str) -> list[ComputedValue]:
    """Wear reductions of the three pairs of wear rates of Table 2.5 or 2.7. []"""
    return [
        propagate_rounding(
            formulas.wear_reduction,
            f"table-{table_id}-intrinsic_wear_rate-{row}",
            f"table-{table_id}-reduced_wear_rate-{row}",
        )
        for row in (1, 2, 3)
    ]


def _settings_of_first_study() -> Iterator[Row]:
    """Yield the rows of Table 2.2 from distance, revolutions and rotation speed."""
    turns = as_setting("table-2.2-revolutions-1")
    printed = formulas.sliding_distance(turns.value, si_value("table-2.2-groove_diameter-1"))
    note = f"Distance over pi times turns; with the printed diameter the distance is {printed:.1f} m."
    yield formula_row("table-2.2-groove_diameter-1", note, formulas.groove_diameter, _DISTANCE, turns)

    def speed(rotation: float, distance: float, turns: float) -> float:
        return formulas.sliding_speed(rotation, formulas.groove_diameter(distance, turns))

    for row, rotation in enumerate(_ROTATIONS, start=1):
        speed_id, note = f"table-2.2-sliding_speed-{row}", "Rotation of appendix A times distance per turn."
        yield formula_row(speed_id, note, speed, rotation, _DISTANCE, turns)
        yield formula_row(f"table-2.2-running_time-{row}", "Distance over speed.", truediv, _DISTANCE, speed_id)


def _protocol() -> Iterator[Row]:
    """Yield the rows of appendix A from the settings of Table 2.2."""
    turns = as_setting("table-2.2-revolutions-1")
    note = "Half the diameter that follows from distance and turns of Table 2.2."
    yield formula_row(
        "A.1.3.6-groove-radius", note, lambda *each: formulas.groove_diameter(*each) / 2, _DISTANCE, turns
    )
    for row, rotation in enumerate(_ROTATIONS, start=1):
        time = as_setting(f"table-2.2-running_time-{row}")
        yield formula_row(rotation, "Turns over running time of Table 2.2.", truediv, turns, time)
    note = "Distance over speed of Table 2.2."
    yield formula_row("A.3.1.10-duration-87", note, truediv, _DISTANCE, _HIGHEST_SPEED)


def _friction() -> Iterator[Row]:
    """Yield the rows of friction with vibration by the cube, and of the reductions of friction and fluctuation."""
    load, amplitude = si_value("table-2.2-normal_load-1"), si_value("table-2.2-vibration_amplitude-1")
    ratio = float(dong_2015_half_period_ratio(wear_contact(), normal_load=load, vibration_amplitude=amplitude))
    for row in (2, 4, 6):
        yield published_model_row(
            f"table-2.3-friction_force-{row}",
            ratio * si_value(f"table-2.3-friction_force-{row - 1}"),
            f"Cube, D 3.15 with Table 3.2: {ratio:.3f} of the force without vibration, at every speed; it has no slip.",
        )
    reductions = reductions_of_table_2_3("friction_force")
    for published, reduction in (
        *((f"table-2.5-friction_reduction-{row}", each) for row, each in enumerate(reductions, start=1)),
        ("2.3.5-friction-reduction-20.3", reductions[0]),
        ("2.3.5-friction-reduction-87", reductions[2]),
        ("2.3.7-friction-reduction", max(reductions)),
        ("2.3.7-friction-reduction-87", reductions[2]),
    ):
        yield published_formula_row(published, reduction, "D 2.1 from the forces of Table 2.3.")
    reductions = reductions_of_table_2_3("friction_rms")
    each = ", ".join(f"{100 * reduction.value:.1f}" for reduction in reductions)
    note = f"Largest reduction of the fluctuation in Table 2.3: {each} %."
    yield published_formula_row("2.3.7-stick-slip-reduction", max(reductions), note)


def _surfaces() -> Iterator[Row]:
    """Yield the rows of Table 2.4 and of the hardness."""
    for row in range(1, 8):
        parts = f"table-2.4-maximum_peak_height-{row}", f"table-2.4-maximum_pit_depth-{row}"
        yield formula_row(f"table-2.4-total_height-{row}", "R_p + R_v.", add, *parts)
    for metal, hardness in (("steel", "table-2.15-hardness-2"), ("aluminium", "table-2.15-hardness-1")):
        yield formula_row(f"2.3.4-hardness-{metal}", "The same alloy in Table 2.15.", float, hardness)


def _wear_of_first_study() -> Iterator[Row]:
    """Yield the rows of Table 2.5 on wear, and of the wear reductions in the text."""
    reductions = wear_reductions("2.5")
    for row, reduction in enumerate(reductions, start=1):
        rates = f"table-2.5-intrinsic_wear_rate-{row}", f"table-2.5-reduced_wear_rate-{row}"
        yield formula_row(f"table-2.5-wear_rate_drop-{row}", "Difference of the rates.", sub, *rates)
        yield published_formula_row(f"table-2.5-wear_reduction-{row}", reduction, "D 2.3 from the rates.")
        count, frequency = f"table-2.5-vibration_contact_count-{row}", f"table-2.2-frequency-{row}"
        time = as_setting(f"table-2.2-running_time-{row}")
        yield formula_row(count, "f times running time.", formulas.contact_count, frequency, time)
    smallest, largest = (f"D 2.3 from the rates of Table 2.5, the {which}." for which in ("smallest", "largest"))
    yield from range_rows("2.3.5-wear-reduction", min(reductions), max(reductions), smallest, high_note=largest)
    yield published_formula_row("2.3.7-wear-reduction", max(reductions), largest)
    yield _wear_reduction_of_the_cube()


def _wear_reduction_of_the_cube() -> Row:
    """Wear reduction by the cube, with Table 3.2 and the rounding of the amplitude."""
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    off = float(cube_wear_rate(contact, normal_load=load))

    def reduction(amplitude: float) -> float:
        return 1 - float(vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=amplitude)) / off

    return published_model_row(
        "2.3.5-wear-reduction",
        propagate_rounding(reduction, "2.3.1-amplitude"),
        "Cube, D 3.26 averaged over the separating half period against that at rest; the same at every speed.",
        suffix="by-the-cube",
    )


def _marks() -> Iterator[Row]:
    """Yield the rows of the marks on the discs: dots of the vibration and indentations of stick-slip."""
    period = as_exact("2.3.4-stick-slip-period")
    dots = propagate_rounding(formulas.dot_spacing, _HIGHEST_SPEED, "table-2.2-frequency-3")
    yield published_formula_row("2.3.4-dots-calculated", dots, "v over f.")
    note = "v over f, the length of one cycle; D states no scatter of the measurement in one image."
    yield published_formula_row("2.3.4-dots-measured", dots, note)
    for row, printed in enumerate(_SPEEDS, start=1):
        needed = si_value(f"2.3.4-indentation-{printed}") / si_value(f"table-2.2-sliding_speed-{row}")
        note = f"D 2.4 with {1e3 * period.value:g} ms; the print corresponds to {1e3 * needed:.1f} ms."
        inputs = f"table-2.2-sliding_speed-{row}", period
        yield formula_row(f"2.3.4-indentation-{printed}", note, formulas.indentation_spacing, *inputs)
    for published in ("2.3.4-indentation-measured", "2.3.7-indentations"):
        yield formula_row(published, "D 2.4.", formulas.indentation_spacing, _HIGHEST_SPEED, period)
    note = "v over the measured distance of indentations."
    yield formula_row("2.3.7-stick-slip-frequency", note, truediv, _HIGHEST_SPEED, "2.3.4-indentation-measured")


def _settings_of_second_study() -> Iterator[Row]:
    """Yield the rows of Table 2.6, and of the revolutions of the second study, from running times."""
    times = [as_setting(f"table-2.6-running_time-{row}") for row in (1, 2, 3)]
    for row, time in enumerate(times, start=1):
        speed, distance = f"table-2.6-sliding_speed-{row}", f"table-2.6-sliding_distance-{row}"
        yield formula_row(speed, "Distance over running time.", truediv, distance, time)

    def in_proportion(whole: float, part_time: float, whole_time: float) -> float:
        return whole * part_time / whole_time

    way, turns = published_number("table-2.6-sliding_distance-3"), as_setting("table-2.6-revolutions-3")
    for published, quantity, whole, time in (
        ("table-2.6-sliding_distance-1", "Distance", way, times[0]),
        ("table-2.6-sliding_distance-2", "Distance", way, times[1]),
        ("table-2.6-revolutions-1", "Turns", turns, times[0]),
        ("table-2.6-revolutions-2", "Turns", turns, times[1]),
        ("table-2.7-revolutions-1", "Turns", turns, times[0]),
        ("2.3.6-revolutions-1", "Turns", turns, times[0]),
    ):
        note = f"{quantity} of the longest test, in proportion to time."
        yield formula_row(published, note, in_proportion, whole, time, times[2])


def _wear_of_second_study() -> Iterator[Row]:
    """Yield the rows of Table 2.7."""
    for row, reduction in enumerate(wear_reductions("2.7"), start=1):
        distance = f"table-2.6-sliding_distance-{row}"
        for state in ("intrinsic", "reduced"):
            rate, volume = f"table-2.7-{state}_wear_rate-{row}", f"table-2.7-{state}_wear_volume-{row}"
            yield formula_row(rate, "D 2.2 with the distance of Table 2.6.", formulas.wear_rate, volume, distance)
        yield published_formula_row(f"table-2.7-wear_reduction-{row}", reduction, "D 2.3 from the rates.")


_SIZE: Final = (4.5, 3.4)  # inches
_SPEED: Final = "Sliding speed [mm/s]"
_OFFSET: Final = 1.2  # mm/s between points of one speed, so that none covers another


def tribometer_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.3."""
    yield report_figure("figure-2-20-friction-against-speed", _friction_against_speed)
    yield report_figure("figure-2-22-fluctuation-against-speed", _fluctuation_against_speed)
    yield report_figure("figure-2-27-reductions-against-speed", _reductions_against_speed)
    yield report_figure("table-2-7-wear-reduction", _wear_reduction_against_revolutions)


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
