"""Section 4.3: rows of the settings of the temperature tests, of superimposed speeds and of the example's friction."""

from collections.abc import Iterator
from operator import sub

import numpy as np

from sonolube.facts.published import as_exact, column_numbers, propagate_rounding, published_value, si_value
from sonolube.reproduction import formulas
from sonolube.reproduction.chapter4.contact_temperature_rows import contact_temperature_rows
from sonolube.reproduction.chapter4.power_map import example_points
from sonolube.reproduction.chapter4.power_rows import (
    amplitude_rows,
    line_reduction_row,
    nominal_pressure_rows,
    power_row,
)
from sonolube.reproduction.row import Row, formula_row, published_formula_row


def temperature_rows() -> Iterator[Row]:
    """Yield the rows of section 4.3."""
    yield from _settings()
    yield from _superimposed_speeds()
    yield _raised_speed()
    yield from _speed_rises()
    yield _example_reduction()
    yield from contact_temperature_rows()


def _settings() -> Iterator[Row]:
    """Yield the rows of Table 4.4 and of the durations in the text."""
    yield from nominal_pressure_rows("4.4")
    yield from amplitude_rows("4.4")
    frequency = as_exact("table-4.4-frequency-1")
    for row, amplitude in column_numbers("4.4", "vibration_amplitude").items():
        velocity, note = f"table-4.4-vibration_velocity-{row}", f"2 pi f a with {amplitude.text} um"
        yield formula_row(velocity, note, formulas.peak_vibration_velocity, frequency, amplitude)
    voltages = column_numbers("4.4", "voltage_peak_to_peak")
    highest = published_value("table-4.4-actuator_power-1").limits()[1]
    yield power_row(highest, voltages[max(voltages)].value)

    dry = si_value("4.3.3-motor-start") + si_value("4.3.3-dry-duration")
    yield published_formula_row("4.3.3-vibration-start", dry, "start of the motor and rotation without vibration")
    levels, level, cooling = len(voltages), si_value("4.3.3-level-duration"), si_value("4.3.3-cooling-duration")
    note = f"start of the vibration, {levels} levels of {level:g} s and {cooling:g} s of cooling"
    yield published_formula_row("4.3.3-duration", dry + levels * level + cooling, note)


def _superimposed_speeds() -> Iterator[Row]:
    """Yield the cells of Table 4.5 under vibration; each mean vibration velocity once."""
    speeds = column_numbers("4.5", "sliding_speed")
    for row, peak in column_numbers("4.5", "vibration_velocity").items():
        if peak.value == 0:
            continue
        if speeds[row] == speeds[1]:
            mean = propagate_rounding(lambda v_1: v_1 / np.pi, peak)
            note = f"peak over pi, the half-wave mean; the mean of the modulus would be {2 * mean.value * 1e3:.0f} mm/s"
            yield published_formula_row(f"table-4.5-mean_vibration_velocity-{row}", mean, note)
        speed = f"table-4.5-superimposed_speed-{row}"
        note = f"sqrt(v_r^2 + (v_1/pi)^2) with {speeds[row].text} and {peak.text} mm/s"
        yield formula_row(speed, note, formulas.superimposed_speed, speeds[row], peak)


def _raised_speed() -> Row:
    """Superimposed speed of section 4.3.4."""
    slowest, second, *_ = column_numbers("4.4", "sliding_speed").values()
    *_, peak = column_numbers("4.4", "vibration_velocity").values()
    note = (
        f"as Table 4.5 at {second.text} mm/s and the highest voltage; at {slowest.text} mm/s"
        f" {formulas.superimposed_speed(slowest.value, peak.value) * 1e3:.0f} mm/s; the peak velocity itself is"
        f" {peak.text} mm/s"
    )
    return formula_row("4.3.4-raised-speed", note, formulas.superimposed_speed, second, peak)


def _speed_rises() -> Iterator[Row]:
    """Yield the rises of the speed in the example of section 4.3.4 from Table 4.5."""
    example = si_value("4.3.4-example-speed")
    rows = [row for row, speed in column_numbers("4.5", "sliding_speed").items() if speed.value == example]
    raised, peaks = (column_numbers("4.5", name) for name in ("superimposed_speed", "vibration_velocity"))
    for name, row in (("low", rows[2]), ("high", rows[-1])):
        unrounded = formulas.superimposed_speed(example, peaks[row].value) - example
        note = f"{raised[row].text} less {raised[rows[0]].text} mm/s of Table 4.5; unrounded {unrounded * 1e3:.1f} mm/s"
        yield formula_row(f"4.3.4-example-speed-rise-{name}", note, sub, raised[row], raised[rows[0]])


def _example_reduction() -> Row:
    """Reduction of the example at 10.3 V, near the end of the efficiency line."""
    load = si_value("table-4.4-normal_load-1")
    example = {
        "intrinsic_friction_force": si_value("4.1.3-friction-coated-last") * load,  # a coefficient: erratum E18
        "sliding_speed": si_value("4.3.4-example-speed"),
        "nominal_area": si_value("table-4.4-nominal_area-1"),
        "normal_load": load,
    }
    return line_reduction_row("4.3.4-example-reduction", example, actuator_power=example_points()[1].actuator_power)
