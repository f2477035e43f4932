"""Section 2.4, high stress and speed on the welder rig: rows of contact stress, motion, friction, currents and wear."""

from collections.abc import Iterator
from operator import sub, truediv
from typing import Final

from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    as_exact,
    as_setting,
    propagate_rounding,
    published_number,
    si_value,
)
from sonolube.models.contact import SphereOnFlat, hertz_mean_pressure, hertz_peak_pressure, tip_radius_for_pressure
from sonolube.reproduction import formulas
from sonolube.reproduction.row import (
    Row,
    default_model_row,
    formula_row,
    published_formula_row,
    range_rows,
    undetermined_row,
)
from sonolube.validation.contacts import poisson_contact

_ROUND_TIP: Final = 1  # first row of either tip in Table 2.8
_FLAT_TIP: Final = 3


def welder_rows() -> Iterator[Row]:
    """Yield the rows of section 2.4."""
    yield from _stresses()
    yield _peak_stress()
    yield from _motion()
    yield from _friction()
    yield from _currents()
    yield from _wear()


def welder_friction_reductions(tip: int) -> list[ComputedValue]:
    """Reductions of the lower and of the upper forces of a tip, row 1 or 2 of Table 2.9. []"""
    limits = zip(*(number.limits() for number in printed_forces(tip)), strict=True)
    return [propagate_rounding(formulas.friction_reduction, *pair) for pair in limits]


def printed_forces(tip: int) -> tuple[PrintedNumber, PrintedNumber]:
    """Friction without and with vibration with a tip, row 1 or 2 of Table 2.9."""
    off, on = (published_number(f"table-2.9-{state}_friction_force-{tip}") for state in ("intrinsic", "reduced"))
    return off, on


def _stresses() -> Iterator[Row]:
    """Yield the nominal stresses from load and contact areas before and after the test."""
    (round_worn, round_new), (flat_worn, flat_new) = _stress_range(_ROUND_TIP), _stress_range(_FLAT_TIP)
    for published, worn, new in (
        ("table-2.8-nominal_pressure-1", round_worn, round_new),
        ("table-2.8-nominal_pressure-3", flat_worn, flat_new),
        ("2.4.2-round-stress", round_worn, round_new),
    ):
        note = "Load over contact area; the worn area is the larger, and its stress the lower."
        yield from range_rows(published, worn, new, note)
    yield published_formula_row("2.4.2-flat-stress-before", flat_new, "Load over the area before the test.")
    yield published_formula_row("2.4.2-flat-stress-after", flat_worn, "Load over the area after the test.")
    yield published_formula_row("2.4.6-stress", round_new, "Load over the smallest area.")


def _stress_range(row: int) -> tuple[ComputedValue, ComputedValue]:
    """Nominal stress on the worn and on the new area of a row of Table 2.8. [Pa]"""
    load = as_setting(f"table-2.8-normal_load-{row}")
    new, worn = published_number(f"table-2.8-nominal_area-{row}").limits()
    return propagate_rounding(truediv, load, worn), propagate_rounding(truediv, load, new)


def _peak_stress() -> Row:
    """Peak over the mean stress of the round tip by the theory of Hertz."""
    load = si_value("table-2.8-normal_load-1")
    modulus = poisson_contact(bodies="steel_steel").pair.effective_modulus
    radius = tip_radius_for_pressure(
        mean_pressure=si_value("table-2.8-nominal_pressure-1"), normal_load=load, effective_modulus=modulus
    )
    sphere = SphereOnFlat(tip_radius=float(radius), effective_modulus=modulus)
    return default_model_row(
        "2.4.2-round-stress-centre",
        float(hertz_peak_pressure(sphere, normal_load=load) / hertz_mean_pressure(sphere, normal_load=load)),
        "Hertz, peak over mean of any elastic sphere: the least that rounds to the print; that is from an FEA.",
    )


def _motion() -> Iterator[Row]:
    """Yield sliding speeds and distances from rotation, revolutions and groove diameter."""
    settings = [(f"table-2.8-rotation_speed-{row}", f"table-2.8-groove_diameter-{row}") for row in (1, 2, 3, 4)]
    speeds = [propagate_rounding(formulas.sliding_speed, *pair) for pair in settings]
    for row, speed in enumerate(speeds, start=1):
        yield published_formula_row(f"table-2.8-sliding_speed-{row}", speed, "Pi times rotation times groove diameter.")
    yield published_formula_row("2.4.6-sliding-speed", max(speeds), "The largest speed of Table 2.8.")
    for published, row in (
        ("table-2.8-sliding_distance-1", _ROUND_TIP),
        ("table-2.8-sliding_distance-3", _FLAT_TIP),
        ("table-2.10-sliding_distance-2", _ROUND_TIP),
        ("table-2.10-sliding_distance-3", _FLAT_TIP),
    ):
        factors = as_setting(f"table-2.8-revolutions-{row}"), f"table-2.8-groove_diameter-{row}"
        yield formula_row(published, "Pi times turns times groove diameter.", formulas.sliding_distance, *factors)


def _friction() -> Iterator[Row]:
    """Yield friction reductions from the forces of Table 2.9, and the mean forces of the text."""
    for tip in (1, 2):
        reductions = welder_friction_reductions(tip)
        note = "D 2.1, lower force with lower and upper with upper."
        yield from range_rows(f"table-2.9-friction_reduction-{tip}", min(reductions), max(reductions), note)
    yield published_formula_row(
        "2.4.6-friction-reduction",
        max(welder_friction_reductions(1) + welder_friction_reductions(2)),
        "D 2.1 from the forces of Table 2.9, the largest.",
    )
    for name, tip in (("round", 1), ("flat", 2)):
        middle = si_value(f"table-2.9-intrinsic_friction_force-{tip}")
        yield published_formula_row(f"2.4.4-friction-{name}", middle, "Middle of the range in Table 2.9.")


def _currents() -> Iterator[Row]:
    """Yield the drop of the motor current with either tip."""
    for name, tip in (("round", 1), ("flat", 2)):
        currents = (as_exact(f"table-2.9-{state}_motor_current-{tip}") for state in ("intrinsic", "reduced"))
        drop = propagate_rounding(sub, *currents)
        yield published_formula_row("2.4.4-current-drop", drop, "Difference of the currents of Table 2.9.", suffix=name)


def _wear() -> Iterator[Row]:
    """Yield wear volumes per turn and wear rates of Table 2.10, and the wear of the flat over that of the round tip."""
    for row, tip in ((2, _ROUND_TIP), (3, _FLAT_TIP)):
        volume, turns = f"table-2.10-wear_volume-{row}", as_setting(f"table-2.8-revolutions-{tip}")
        yield formula_row(f"table-2.10-wear_volume_per_turn-{row}", "Volume over turns.", truediv, volume, turns)
        yield published_formula_row(f"table-2.10-wear_rate-{row}", _wear_rate(row), "Volume over distance.")
    yield undetermined_row("2.4.5-wear-reduction", "the worn volumes of the two tests with the round tip.")
    round_tip, flat_tip = _wear_rate(2), _wear_rate(3)
    of_printed_rates = si_value("table-2.10-wear_rate-3") / si_value("table-2.10-wear_rate-2")
    yield published_formula_row(
        "2.4.5-flat-wear-share",
        ComputedValue(
            value=flat_tip.value / round_tip.value,
            low=flat_tip.low / round_tip.high,
            high=flat_tip.high / round_tip.low,
        ),
        f"Volumes over distances of Table 2.10; the printed rates give {100 * of_printed_rates:.1f} %.",
    )


def _wear_rate(row: int) -> ComputedValue:
    """Wear rate of Table 2.10 within the rounding of both its volume and its volume per turn. [m2]"""
    distance, turns = f"table-2.10-sliding_distance-{row}", si_value("table-2.8-revolutions-1")
    total = propagate_rounding(formulas.wear_rate, f"table-2.10-wear_volume-{row}", distance)
    by_turn = propagate_rounding(
        lambda volume, length: formulas.wear_rate(turns * volume, length),
        f"table-2.10-wear_volume_per_turn-{row}",
        distance,
    )
    return ComputedValue(value=total.value, low=max(total.low, by_turn.low), high=min(total.high, by_turn.high))
