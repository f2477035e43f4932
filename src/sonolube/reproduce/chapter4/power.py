"""Section 4.1: settings of the power maps, their example test, and what cube and efficiency line make of it."""

from collections.abc import Callable, Iterator

from sonolube.metrics import linear_speed, power_for_friction
from sonolube.published import PrintedNumber
from sonolube.published.values import Computed, Published, cell, over_rounding, stated
from sonolube.reproduce.row import Row, compare
from sonolube.validation.contacts import STEEL_ON_STEEL_NOTE
from sonolube.validation.inputs import friction_drop, named, published_ends, range_ends, said
from sonolube.validation.power_map import (
    ExamplePoint,
    actuator_power,
    cube_friction,
    efficiency_line,
    example_points,
    example_test,
    line_efficiency,
    line_end,
    line_friction,
    point_efficiency,
    printed,
    sufficient_power,
)

_UNIT_OF_LINE = 1e-9  # mW mm2/(N W) in m2/N


def power_map_rows() -> Iterator[Row]:
    """Yield the rows of section 4.1."""
    yield from stresses("4.1")
    yield from _powers()
    yield from amplitudes("4.1")
    yield _highest_amplitude()
    yield from _settings_of_the_text()
    yield from _example_test()
    for point in example_points():
        yield _reduction_of_mean_forces(point)
        yield _friction_by_the_cube(point)
        yield _efficiency(point)
        yield _friction_by_the_line(point)
        yield _power_by_the_line(point)
    yield from _reductions_at_the_lowest_speed()
    yield _intrinsic_friction()


def stresses(table_id: str) -> Iterator[Row]:
    """Yield the nominal stresses of a table from its loads and its nominal area."""
    area = printed(table_id, "nominal_area")[0]
    for row, load in printed(table_id, "normal_load").items():
        yield _stress(cell(table_id, "nominal_pressure", row), load.value, area)


def amplitudes(table_id: str) -> Iterator[Row]:
    """Yield the amplitudes between none and the highest of a table, in proportion to its voltages."""
    voltages, printed_amplitudes = printed(table_id, "voltage_peak_to_peak"), printed(table_id, "vibration_amplitude")
    last = max(voltages)
    highest, amplitude = voltages[last], printed_amplitudes[last]
    note = f"{amplitude.value / highest.value * 1e6:.4f} um per volt peak to peak, from {highest.text} V"
    for row, voltage in voltages.items():
        if 0 < voltage.value < highest.value:
            share = over_rounding(lambda a, u_highest, u: a / u_highest * u, amplitude, highest, voltage)
            yield compare(cell(table_id, "vibration_amplitude", row), share, note)


def power_row(published: Published, voltage: float) -> Row:
    """Return the row of an actuator power at a voltage peak to peak. [V]"""
    power = float(actuator_power(voltage_peak_to_peak=voltage))
    note = f"C U_max U_pp f (D 1.9) with U_max = U_pp; U_max = U_pp/2 would give {power / 2:.3g} W"
    return compare(published, power, note)


def reduction_by_the_line(published: Published, test: dict[str, float], power: float) -> Row:
    """Return the row of a friction reduction on D's efficiency line; settings as `example_test` gives them."""
    off = test["intrinsic_friction_force"]
    on = float(line_friction(test, actuator_power=power))
    note = (
        f"efficiency line at {power:.3g} W, {test['normal_load']:g} N and {test['sliding_speed'] * 1e3:g} mm/s, from"
        f" {off:.3g} N; the line ends at {line_end() * 1e3:.0f} mm/s, where it crosses zero"
    )
    return compare(published, friction_drop(off, on), note)


def _stress(published: Published, load: float, area: PrintedNumber) -> Row:
    stress = over_rounding(lambda area: load / area, area)
    return compare(published, stress, f"{load:g} N over {area.text} mm2, the load taken as exact")


def _powers() -> Iterator[Row]:
    for row, voltage in printed("4.1", "voltage_peak_to_peak").items():
        yield power_row(cell("4.1", "actuator_power", row), voltage.value)


def _highest_amplitude() -> Row:
    voltages = printed("4.1", "voltage_peak_to_peak")
    last = max(voltages)
    in_wear_tests = 2 * said("A.3.1.3-voltage-amplitude").value * said("A.3.1.5-gain").value
    amplitude = said("2.3.1-amplitude")
    return compare(
        cell("4.1", "vibration_amplitude", last),
        over_rounding(lambda a: a / in_wear_tests * voltages[last].value, amplitude),
        f"in proportion to {amplitude.text} um at {in_wear_tests:.3g} V peak to peak, section 2.3.1 and appendix A 3.1",
    )


def _settings_of_the_text() -> Iterator[Row]:
    for nth in ("1", "2"):
        inches = said(f"4.1.3-groove-diameter-{nth}")
        yield compare(stated(f"4.1.1-diameter-{nth}"), inches.value, f"{inches.text} in of section 4.1.3")
    area, loads = said("4.1.1-nominal-area"), range_ends(said("4.1.1-normal-load"))
    for stress, load in zip(published_ends(stated("4.1.1-stress")), loads, strict=True):
        yield _stress(stress, load.value, area)
    yield _stress(stated("4.1.2-efficiency-stress"), loads[1].value, area)
    first, *_, last = example_points()
    for power, point in zip(published_ends(stated("4.1.1-power")), (first, last), strict=True):
        yield power_row(power, point.voltage_peak_to_peak)


def _example_test() -> Iterator[Row]:
    def speed(turn: float, diameter: float = said("4.1.2-diameter").value) -> float:
        return float(linear_speed(rotation_speed=1 / turn, groove_diameter=diameter))

    turn = said("4.1.2-turn-duration")
    rounded = speed(turn.value, said("4.1.1-diameter-1").value)
    note = f"pi times 1.1 in over the time of a turn; with the rounded 28 mm {rounded * 1e3:.1f} mm/s"
    yield compare(stated("4.1.2-sliding-speed"), over_rounding(speed, turn), note)

    levels, level = said("4.1.1-voltage-count").value, said("4.1.2-level-duration").value
    duration = said("4.1.2-vibration-start").value + levels * level
    yield compare(stated("4.1.2-duration"), duration, f"start of the vibration, then {levels:g} levels of {level:g} s")

    off, on, *_ = printed("4.2", "friction_force").values()
    drop = over_rounding(lambda off, on: off - on, off, on)
    yield compare(stated("4.1.2-friction-drop"), drop, f"{off.value:g} N less {on.value:g} N")


def _reduction_of_mean_forces(point: ExamplePoint) -> Row:
    off, on = example_test()["intrinsic_friction_force"], point.friction.value
    note = f"D 2.1 from the mean forces, {off:g} N and {on:g} N"
    # held to D's scatter as it stands: with the rounding of the forces it would hide that D's mean is another one, E17
    return compare(cell("4.2", "friction_reduction", point.row), friction_drop(off, on), note)


def _friction_by_the_cube(point: ExamplePoint) -> Row:
    off = example_test()["intrinsic_friction_force"]
    friction = float(cube_friction(voltage_peak_to_peak=point.voltage_peak_to_peak))
    note = (
        f"cube, D 3.15: ratio {friction / off:.3f} of {off:g} N; roughness of Table 3.2; {STEEL_ON_STEEL_NOTE};"
        " neither sliding speed nor in-plane motion of the tip enters"
    )
    return compare(named(cell("4.2", "friction_force", point.row), "by-the-cube"), friction, note)


def _efficiency(point: ExamplePoint) -> Row:
    line, test = efficiency_line(), example_test()
    to_zero_speed = -line.slope * test["sliding_speed"]
    here = point_efficiency(point, friction=point.friction.value)
    there = float(line_efficiency(sliding_speed=test["sliding_speed"]))
    note = (
        f"D 4.1 at {point.voltage_peak_to_peak:g} V gives {here / _UNIT_OF_LINE:.3f}, the line"
        f" {there / _UNIT_OF_LINE:.3f} mW mm2/(N W); carried to zero speed by the printed slope"
    )
    intercept = _over_scatter(
        lambda friction: point_efficiency(point, friction=friction) + to_zero_speed, point.friction
    )
    published = named(stated("4.1.2-efficiency-intercept"), f"at-{point.voltage_peak_to_peak:g}V")
    return compare(published, intercept, note + _needless_power(point))


def _friction_by_the_line(point: ExamplePoint) -> Row:
    test = example_test()
    as_printed = test["intrinsic_friction_force"] * (1 + point.actuator_power / sufficient_power(test))
    note = (
        f"D 4.4 solved for the reduced friction, at {point.actuator_power:.3g} W; "
        f"as printed it would rise to {as_printed:.3g} N"
    )
    published = named(cell("4.2", "friction_force", point.row), "by-the-line")
    return compare(
        published, float(line_friction(test, actuator_power=point.actuator_power)), note + _needless_power(point)
    )


def _power_by_the_line(point: ExamplePoint) -> Row:
    def power(friction: float) -> float:
        return float(power_for_friction(efficiency_line(), reduced_friction_force=friction, **example_test()))

    voltages = printed("4.1", "voltage_peak_to_peak")
    row = next(row for row, voltage in voltages.items() if voltage.value == point.voltage_peak_to_peak)
    published = named(cell("4.1", "actuator_power", row), "by-the-line")
    note = f"D 4.3 for the {point.friction.text} N of Table 4.2"
    return compare(published, _over_scatter(power, point.friction), note + _needless_power(point))


def _needless_power(point: ExamplePoint) -> str:
    sufficient = sufficient_power(example_test())
    if point.actuator_power <= sufficient:
        return ""
    return (
        f"; of {point.actuator_power:.3g} W the line needs {sufficient:.3g} W to take all friction away, "
        "the rest saves nothing"
    )


def _reductions_at_the_lowest_speed() -> Iterator[Row]:
    first, *_, last = example_points()
    slowest = example_test() | {"sliding_speed": printed("4.1", "sliding_speed")[0].low}
    yield reduction_by_the_line(stated("4.1.2-reduction-lowest-voltage"), slowest, first.actuator_power)
    yield reduction_by_the_line(stated("4.1.2-reduction-highest-voltage"), slowest, last.actuator_power)


def _intrinsic_friction() -> Row:
    test = example_test()
    off, load = test["intrinsic_friction_force"], test["normal_load"]
    note = f"friction of Table 4.2 at {load:g} N; over that load a coefficient of {off / load:.3f}"
    return compare(stated("4.1.3-friction-uncoated"), off, note)


def _over_scatter(function: Callable[[float], float], measured: PrintedNumber) -> Computed:
    """Evaluate a monotone function at a measured mean and at the ends of its scatter."""
    ends = function(measured.low), function(measured.high)
    return Computed(value=function(measured.value), low=min(ends), high=max(ends))
