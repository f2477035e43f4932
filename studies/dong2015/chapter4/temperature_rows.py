"""Section 4.3: rows of settings, superimposed speeds and the temperatures of contact and waveguide."""

import math
from collections.abc import Iterator
from functools import partial
from operator import sub
from typing import Final

import numpy as np

from dong2015 import formulas
from dong2015.chapter4 import temperature_tests as tests
from dong2015.chapter4.power_map import example_points
from dong2015.chapter4.power_rows import amplitude_rows, line_reduction_row, nominal_pressure_rows, power_row
from dong2015.row import (
    Row,
    RowKind,
    comparison_row,
    default_model_row,
    formula_row,
    published_formula_row,
    undetermined_row,
)
from sonolube.checks import Floats
from sonolube.facts.materials import material
from sonolube.facts.published import as_exact, column_numbers, propagate_rounding, published_value, si_value
from sonolube.models import thermal

_FRICTION_NOTE: Final = (
    f"Friction kept at {tests.EXAMPLE_FRICTION_RATIO:g} of its dry value at every voltage: in the text it falls "
    "further beyond 10.3 V, by an amount that is only drawn (Fig. 4.33), and that could only cool"
)
_CERAMIC: Final = "pic255"  # soft, as in stacks; D does not print the material


def contact_temperature_rows() -> Iterator[Row]:
    """Yield the rows of section 4.3 on temperatures."""
    yield _slopes()
    yield from _example_by_superimposed_speed()
    yield from _example_by_vibration_heat()
    yield _low_speed()
    yield _tribometer_peak()
    yield _waveguide_peak()
    yield _foil_peak()


def _slopes() -> Row:
    """Slope of the temperature over speed at 26 MPa over that at 52 MPa."""
    rises = tests.dry_rises()
    low, high = (float(np.polyfit(tests.speeds(), rise, 1)[0]) for rise in rises)
    per_speed = rises[0] / tests.speeds()
    note = (
        f"Least-squares slopes of the rise at 12 s without vibration. Heat of friction is proportional to the load; "
        f"the rise per speed falls by {100 * (1 - per_speed[-1] / per_speed[0]):.0f} % from the lowest to the highest "
        f"speed, nearly a straight line. {tests.ASSUMED}."
    )
    return default_model_row("4.3.4-slope-ratio", low / high, note)


def _example_by_superimposed_speed() -> Iterator[Row]:
    """Yield the temperatures of the example by friction times superimposed speed."""
    speed = si_value("4.3.4-example-speed")
    peaks = np.array([peak.value for peak in column_numbers("4.4", "vibration_velocity").values()])
    heat = thermal.superimposed_heat_rate(
        friction_force=tests.EXAMPLE_FRICTION_RATIO, sliding_speed=speed, vibration_velocity=peaks
    )
    note = f"Explanation of D: heat is proportional to friction times superimposed speed of Table 4.5. {_FRICTION_NOTE}"
    yield from _example(heat / speed, "by-superimposed-speed", note, kind=RowKind.PUBLISHED_FORMULA, fitted="")


def _example_by_vibration_heat() -> Iterator[Row]:
    """Yield the temperatures of the example by frictional heat and a fraction of the actuator's power."""
    (low, high), loss_tangent = tests.vibration_heat_window(), material(_CERAMIC).value("loss_tangent")
    note = (
        "Heat of friction and a fraction of the actuator's power (D 1.9) in the contact. The fraction is not printed: "
        f"these four statements limit it to {1e2 * low:.2f} to {1e2 * high:.2f} %, and "
        f"{1e2 * tests.vibration_heat_fraction():.2f} %, their geometric mean, is taken: the rows show its existence, "
        f"not its value. {_FRICTION_NOTE}; a fall by more than "
        f"{100 * (1 - tests.EXAMPLE_FRICTION_RATIO) * high / low:.0f} % at 20.7 V would leave none. A stack of "
        f"{_CERAMIC} would lose {100 * np.pi / 4 * loss_tangent:.1f} % of that power in its ceramic"
    )
    yield from _example(
        tests.EXAMPLE_FRICTION_RATIO + tests.vibration_heat() / tests.example_heat(),
        "by-vibration-heat",
        note,
        kind=RowKind.DEFAULT_MODEL,
        fitted="the fraction of the power, with the other three statements",
    )


def _example(ratios: Floats, suffix: str, note: str, *, kind: RowKind, fitted: str) -> Iterator[Row]:
    """Yield the rows of the example at four voltages from heat with vibration over heat without."""
    row = partial(comparison_row, note=note, suffix=suffix, kind=kind, fitted=fitted)
    for voltage, ratio in zip(tests.voltages(), ratios, strict=True):
        if voltage < 15:
            yield row(f"4.3.4-example-cooler-{voltage:g}V", float(ratio))
        elif voltage > 20:
            yield row(f"4.3.4-example-warmer-{voltage:g}V", float(1 / ratio))


def _low_speed() -> Row:
    """Temperature without vibration over that with it at the lowest speed."""
    slowest = float(tests.speeds()[0])
    dry = tests.dry_heat(normal_load=float(tests.loads()[0]), sliding_speed=slowest)
    least, most = (
        float(np.max(dry / (tests.slow_friction_ratio() * dry + tests.vibration_heat(fraction))))
        for fraction in tests.vibration_heat_window()
    )
    ratios = tests.slow_friction_ratio() + tests.vibration_heat() / dry
    listed = ", ".join(f"{ratio:.2f}" for ratio in ratios)
    note = (
        f"At {1e3 * slowest:g} mm/s and 26 MPa, the voltage of the least warming. Friction by asperity stick-slip, "
        "heat of vibration by the fraction from the example at 220 mm/s; rises with vibration over those without, from "
        f"5.1 to 25.9 V: {listed}. Possible: over the fractions that the example leaves open"
    )
    return default_model_row("4.3.4-low-speed-warmer", float(np.max(1 / ratios)), note, possible=(least, most))


def _tribometer_peak() -> Row:
    """Highest temperature of the tests on the tribometer."""
    load, speed = float(tests.loads()[-1]), float(tests.speeds()[-1])
    record = tests.history(tests.TemperatureTest(normal_load=load, sliding_speed=speed))
    peak = tests.ROOM_TEMPERATURE + float(record.temperature_rise.max())
    contact = tests.heated_contact()
    flux = record.heat_rate.max() / contact.source.area
    flash = thermal.flash_rise(tests.POWDER_COATING, contact.source, heat_flux=flux, sliding_speed=speed)
    insulated = tests.ROOM_TEMPERATURE + float(flash.mean_temperature_rise)
    note = (
        f"Highest of the computed tests, 52 MPa, 220 mm/s and 25.9 V, {1e3 * record.heat_rate.max():.0f} mW of heat of "
        f"which {100 * record.heat_partition[record.heat_rate.argmax()]:.0f} % enter the pin. {tests.ASSUMED}. With an "
        f"insulating adhesive of the thermocouple, the coating alone would give {insulated - 273.15:.0f} degC: the "
        "measured peak lies between, depending on the bond of the thermocouple, which is not printed"
    )
    return default_model_row("4.3.5-tribometer-temperature-peak", peak, note, possible=(peak, insulated))


def _waveguide_peak() -> Row:
    """Row of the peak beside the waveguide, with the most that the welder's power could warm it to."""
    aluminium = material("aluminium_2024")
    length, width, thickness = (si_value(f"2.1.2-waveguide-{side}") for side in ("length", "width", "thickness"))
    volume, density = length * width * thickness, aluminium.value("density")
    capacity = volume * density * aluminium.value("specific_heat_capacity")
    first, peak = (si_value(f"4.3.5-temperature-{state}") for state in ("first", "peak"))
    duration = si_value("4.3.5-vibration-duration")
    needed = float(
        thermal.adiabatic_heat_rate(heat_capacity=capacity, temperature_rise=peak - first, duration=duration)
    )
    power = si_value("2.1.2-welder-power")
    energy = thermal.half_wave_bar_energy(
        density=density,
        cross_section=width * thickness,
        length=length,
        frequency=si_value("2.1.2-welder-frequency"),
        axial_amplitude=si_value("4.3.5-waveguide-amplitude"),
    )
    at_one = thermal.vibration_loss_heat_rate(
        stored_energy=energy, frequency=si_value("2.1.2-welder-frequency"), quality_factor=1.0
    )
    missing = (
        "load, friction and heat loss of the thermocouple that rubs on the waveguide, to which the text ascribes the "
        "peak. The waveguide itself, of aluminium and warmed evenly without loss by all "
        f"{1e-3 * power:g} kW of the welder, would reach {first + power * duration / capacity - 273.15:.0f} degC at "
        f"most: the printed peak would take {1e-3 * needed:.1f} kW, a quality factor of {float(at_one) / needed:.0f} "
        "where metals have a thousand and more, which warms it by less than "
        f"{float(at_one) / 1000 * duration / capacity:.1f} K"
    )
    return undetermined_row("4.3.5-temperature-peak", missing, kind=RowKind.DEFAULT_MODEL)


def _foil_peak() -> Row:
    """Row of the peak behind a foil, with what the conductance of the foil alone would leave of it."""
    first, peak = (si_value(f"4.3.5-temperature-{state}") for state in ("first", "peak"))
    sheltered = si_value("4.3.5-foil-temperature-peak")
    foil = float(
        thermal.layer_conductance(
            thermal_conductivity=material("aluminium_2024").value("thermal_conductivity"),
            thickness=si_value("4.3.5-foil-thickness"),
        )
    )
    onward = 100.0  # W/(m2 K), tape and air
    joint = float(
        thermal.interface_conductance(
            temperature_rise=peak - first, rise_behind_interface=sheltered - first, convection_coefficient=onward
        )
    )
    behind = first + (peak - first) * foil / (foil + onward)
    missing = (
        f"the joints of foil, waveguide and thermocouple. Through the foil alone, {1e-3 * foil:.0f} kW/(m2 K) with the "
        f"conductivity of 2024, {behind - 273.15:.0f} degC would remain of the printed peak, as the thermocouple loses "
        "100 W/(m2 K) onwards, assumed and generous: the thickness of the foil has next to no effect. The printed "
        f"{sheltered - 273.15:.0f} degC correspond to a joint of {joint / onward:.2f} times the loss of the "
        "thermocouple, spreading of the heat in the foil included"
    )
    return undetermined_row("4.3.5-foil-temperature-peak", missing, kind=RowKind.DEFAULT_MODEL)


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
    """Superimposed speed of section 4.3.4, which counts the vibration with its peak velocity."""
    slowest, second, *_ = column_numbers("4.4", "sliding_speed").values()
    *_, peak = column_numbers("4.4", "vibration_velocity").values()
    mean, at_slowest = formulas.superimposed_speed(second.value, peak.value), math.hypot(slowest.value, peak.value)
    note = (
        f"sqrt(v_r^2 + v_1^2) with {second.text} and {peak.text} mm/s; at {slowest.text} mm/s {at_slowest * 1e3:.0f}"
        f" mm/s. Table 4.5 counts the vibration with its mean, by which it would be {mean * 1e3:.0f} mm/s (N5)"
    )
    return formula_row("4.3.4-raised-speed", note, math.hypot, second, peak)


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
