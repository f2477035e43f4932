"""Every column that D derives from other printed numbers, derived again; what disagrees must be on record."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from sonolube.errors import InvalidInput
from sonolube.facts.published import Column, Correction, parse_printed, statement, table, table_ids

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Cells:
    """Printed numbers with their ends and the half of their last digit, one to a row."""

    value: Floats
    low: Floats
    high: Floats
    half: Floats
    text: tuple[str, ...]

    def __getitem__(self, rows: slice | list[int]) -> "Cells":
        texts = np.array(self.text, dtype=object)[rows]
        return Cells(self.value[rows], self.low[rows], self.high[rows], self.half[rows], tuple(texts))


@dataclass(frozen=True)
class Span:
    """Where a derived number lies, given the rounding of what it is derived from."""

    low: Floats
    high: Floats


@dataclass(frozen=True)
class Reader:
    """Reads columns with the corrected cells put right, save the one correction that is left as printed."""

    as_printed: tuple[str, Correction] | None = None

    def __call__(self, number: str, name: str) -> Cells:
        source = table(number)
        return cells_of(source.columns[name], tuple(self.text(number, name)))

    def text(self, number: str, name: str) -> list[str]:
        texts = list(table(number).columns[name].printed)
        for correction in table(number).corrections:
            if correction.column == name and is_settled(correction) and (number, correction) != self.as_printed:
                assert correction.row is not None
                texts[correction.row] = correction.corrected
        return texts


RIGHT = Reader()
Relation = Callable[[Reader], Span | tuple[Span, Span]]


def cells_of(column: Column, texts: tuple[str, ...]) -> Cells:
    numbers = [
        parse_printed(text, column.unit, column.scale, quantity=column.quantity) if text else None for text in texts
    ]

    def each(name: str) -> Floats:
        return np.array([np.nan if number is None else getattr(number, name) for number in numbers])

    return Cells(each("value"), each("low"), each("high"), each("rounding_half_width"), texts)


def is_settled(correction: Correction) -> bool:
    try:
        parse_printed(correction.corrected)
    except InvalidInput:
        return False
    return correction.row is not None


def over(function: Callable[..., Floats], *inputs: Cells) -> Span:
    corners = product(*[(cells.value - cells.half, cells.value + cells.half) for cells in inputs])
    values = np.array([function(*corner) for corner in corners])
    return Span(values.min(axis=0), values.max(axis=0))


def first(cells: Cells) -> Cells:
    return replace(cells, value=cells.low)


def last(cells: Cells) -> Cells:
    return replace(cells, value=cells.high)


def setting(cells: Cells) -> Cells:
    """Whole numbers of newtons, hours, turns and volts were set, not rounded."""
    exact = np.array(["." not in text for text in cells.text])
    return replace(cells, half=np.where(exact, 0.0, cells.half))


def stated(name: str) -> Cells:
    number = statement(name).number
    value, low, high, half = np.array([[number.value], [number.low], [number.high], [number.rounding_half_width]])
    return Cells(value, low, high, half, (number.text,))


def share_lost(before: Floats, after: Floats) -> Floats:
    return 1 - after / before


def turns(speed: Floats, time: Floats, diameter: Floats) -> Floats:
    return speed * time / (np.pi * diameter)


def stress(number: str) -> Relation:
    return lambda read: over(np.divide, setting(read(number, "normal_load")), read(number, "nominal_area"))


def distance_and_turns(number: str) -> dict[tuple[str, str], Relation]:
    def distance(read: Reader) -> Span:
        return over(np.multiply, read(number, "sliding_speed"), setting(read(number, "running_time")))

    def revolutions(read: Reader) -> Span:
        time = setting(read(number, "running_time"))
        return over(turns, read(number, "sliding_speed"), time, read(number, "groove_diameter"))

    return {(number, "sliding_distance"): distance, (number, "revolutions"): revolutions}


def groove_diameter(read: Reader) -> Span:
    time, count = setting(read("2.2", "running_time")), setting(read("2.2", "revolutions"))
    return over(turns, read("2.2", "sliding_speed"), time, count)


def contact_count(read: Reader) -> Span:
    frequency = setting(read("2.2", "frequency"))
    time = over(np.divide, read("2.2", "sliding_distance"), read("2.2", "sliding_speed"))
    return Span(frequency.value * time.low, frequency.value * time.high)


def tribometer_friction_reduction(read: Reader) -> Span:
    friction = read("2.3", "friction_force")
    return over(share_lost, friction[::2], friction[1::2])


def revolutions_at_constant_rotation(read: Reader) -> Span:
    count, time = setting(read("2.6", "revolutions")), setting(read("2.6", "running_time"))
    return over(lambda hours: count.value[2] / time.value[2] * hours, time)


def high_stress(read: Reader) -> tuple[Span, Span]:
    load, area = setting(read("2.8", "normal_load")), read("2.8", "nominal_area")
    return over(np.divide, load, last(area)), over(np.divide, load, first(area))


def high_stress_friction_reduction(read: Reader) -> tuple[Span, Span]:
    before, after = read("2.9", "intrinsic_friction_force"), read("2.9", "reduced_friction_force")
    slow, fast = over(share_lost, first(before), first(after)), over(share_lost, last(before), last(after))
    least = Span(np.minimum(slow.low, fast.low), np.minimum(slow.high, fast.high))
    most = Span(np.maximum(slow.low, fast.low), np.maximum(slow.high, fast.high))
    return least, most


def high_stress_wear_rate(read: Reader) -> Span:
    volume, per_turn = read("2.10", "wear_volume"), read("2.10", "wear_volume_per_turn")
    low = np.maximum(volume.value - volume.half, 11 * (per_turn.value - per_turn.half))
    high = np.minimum(volume.value + volume.half, 11 * (per_turn.value + per_turn.half))
    return over(
        np.divide, replace(volume, value=(low + high) / 2, half=(high - low) / 2), read("2.10", "sliding_distance")
    )


def summed_up(*entries: Span | None) -> Span:
    ends = [(np.nan, np.nan) if entry is None else (entry.low.max(), entry.high.max()) for entry in entries]
    return Span(*np.array(ends).T)


def wear_summary(read: Reader) -> Span:
    tribometer = over(np.copy, read("2.5", "wear_reduction"))
    return summed_up(tribometer, over(np.copy, stated("2.4.5-wear-reduction")), None, None, None, None)


def friction_summary(read: Reader) -> Span:
    forces = read("2.9", "intrinsic_friction_force")[:1], read("2.9", "reduced_friction_force")[:1]
    return summed_up(
        over(np.copy, read("2.5", "friction_reduction")),
        over(share_lost, first(forces[0]), first(forces[1])),
        over(share_lost, stated("2.5.2-friction-titanium-off"), stated("2.5.2-friction-titanium-on")),
        over(np.copy, stated("2.5.3-friction-reduction")),
        over(share_lost, stated("2.5.4-friction-ceramic-off"), stated("2.5.4-friction-ceramic-on")),
        over(np.copy, stated("2.5.5-friction-reduction")),
    )


def effective_modulus(read: Reader) -> Span:
    names = ("youngs_modulus_aluminium", "poisson_ratio_aluminium", "youngs_modulus_steel", "poisson_ratio_steel")
    return over(
        lambda e1, nu1, e2, nu2: 1 / ((1 - nu1**2) / e1 + (1 - nu2**2) / e2), *[read("3.1", name) for name in names]
    )


def model_error(number: str) -> Relation:
    return lambda read: over(lambda test, model: abs(test - model) / test, read(number, "test"), read(number, "model"))


def coupling_factor(read: Reader) -> Span:
    names = ("charge_constant_33", "stack_stiffness", "capacitance")
    layers = read("3.5", "stack_layers").value
    return over(lambda d33, k, c: layers * d33 * np.sqrt(k / c), *[read("3.5", name) for name in names])


def power(read: Reader) -> Span:
    voltage, frequency = read("4.1", "voltage_peak_to_peak"), setting(read("4.1", "frequency"))
    return over(lambda u, c: c * u**2 * frequency.value, voltage, read("4.1", "capacitance"))


def example_friction_reduction(read: Reader) -> Span:
    friction = read("4.2", "friction_force")
    return over(share_lost, friction[[0] * 6], friction)


def peak_velocity(read: Reader) -> Span:
    frequency = setting(read("4.4", "frequency")).value
    return over(lambda amplitude: 2 * np.pi * frequency * amplitude, read("4.4", "vibration_amplitude"))


DERIVED: dict[tuple[str, str], Relation] = {
    **distance_and_turns("2.2"),
    ("2.2", "groove_diameter"): groove_diameter,
    ("2.4", "total_height"): lambda read: over(
        np.add, read("2.4", "maximum_peak_height"), read("2.4", "maximum_pit_depth")
    ),
    ("2.5", "wear_rate_drop"): lambda read: over(
        np.subtract, read("2.5", "intrinsic_wear_rate"), read("2.5", "reduced_wear_rate")
    ),
    ("2.5", "wear_reduction"): lambda read: over(
        share_lost, read("2.5", "intrinsic_wear_rate"), read("2.5", "reduced_wear_rate")
    ),
    ("2.5", "vibration_contact_count"): contact_count,
    ("2.5", "friction_reduction"): tribometer_friction_reduction,
    ("2.6", "sliding_speed"): lambda read: over(
        np.divide, read("2.6", "sliding_distance"), setting(read("2.6", "running_time"))
    ),
    ("2.6", "revolutions"): revolutions_at_constant_rotation,
    ("2.7", "intrinsic_wear_rate"): lambda read: over(
        np.divide, read("2.7", "intrinsic_wear_volume"), read("2.6", "sliding_distance")
    ),
    ("2.7", "reduced_wear_rate"): lambda read: over(
        np.divide, read("2.7", "reduced_wear_volume"), read("2.6", "sliding_distance")
    ),
    ("2.7", "wear_reduction"): lambda read: over(
        share_lost, read("2.7", "intrinsic_wear_volume"), read("2.7", "reduced_wear_volume")
    ),
    ("2.8", "nominal_pressure"): high_stress,
    ("2.8", "sliding_distance"): lambda read: over(
        lambda diameter: 11 * np.pi * diameter, read("2.8", "groove_diameter")
    ),
    ("2.8", "sliding_speed"): lambda read: over(
        lambda diameter, rotation: np.pi * diameter * rotation,
        read("2.8", "groove_diameter"),
        read("2.8", "rotation_speed"),
    ),
    ("2.9", "friction_reduction"): high_stress_friction_reduction,
    ("2.10", "wear_volume_per_turn"): lambda read: over(lambda volume: volume / 11, read("2.10", "wear_volume")),
    ("2.10", "wear_rate"): high_stress_wear_rate,
    **distance_and_turns("2.11"),
    **distance_and_turns("2.12"),
    **distance_and_turns("2.13"),
    ("2.14", "wear_reduction"): wear_summary,
    ("2.14", "friction_reduction"): friction_summary,
    ("3.2", "effective_modulus"): effective_modulus,
    ("3.3", "error"): model_error("3.3"),
    ("3.4", "error"): model_error("3.4"),
    ("3.5", "coupling_factor"): coupling_factor,
    ("4.1", "nominal_pressure"): stress("4.1"),
    ("4.1", "actuator_power"): power,
    ("4.2", "friction_reduction"): example_friction_reduction,
    ("4.3", "nominal_pressure"): stress("4.3"),
    ("4.4", "nominal_pressure"): stress("4.4"),
    ("4.4", "vibration_velocity"): peak_velocity,
    ("4.5", "mean_vibration_velocity"): lambda read: over(lambda peak: peak / np.pi, read("4.5", "vibration_velocity")),
    ("4.5", "superimposed_speed"): lambda read: over(
        np.hypot, read("4.5", "sliding_speed"), read("4.5", "mean_vibration_velocity")
    ),
}
del DERIVED["2.2", "revolutions"]  # the diameter is in correction, not the turns

SAME = [
    ("2.6 revolutions", (0, 1, 2), "2.7 revolutions", (0, 1, 2)),
    ("2.7 revolutions", (0, 1, 2, 0, 1, 2), "3.4 revolutions", range(6)),
    ("2.2 sliding_speed", (0, 1, 2), "2.5 sliding_speed", (0, 1, 2)),
    ("2.2 sliding_speed", (0, 0, 1, 1, 2, 2), "2.3 sliding_speed", range(6)),
    ("2.2 sliding_speed", (0, 0, 1, 1, 2, 2), "2.4 sliding_speed", range(1, 7)),
    ("2.5 sliding_speed", (0, 1, 2, 0, 1, 2), "3.3 sliding_speed", range(6)),
    ("2.5 intrinsic_wear_rate", (0, 1, 2), "3.3 test", (0, 1, 2)),
    ("2.5 reduced_wear_rate", (0, 1, 2), "3.3 test", (3, 4, 5)),
    ("2.7 intrinsic_wear_rate", (0, 1, 2), "3.4 test", (0, 1, 2)),
    ("2.7 reduced_wear_rate", (0, 1, 2), "3.4 test", (3, 4, 5)),
    ("3.3 model", range(6), "3.4 model", range(6)),
    ("2.8 sliding_distance", (0, 2), "2.10 sliding_distance", (1, 2)),
    ("4.1 nominal_pressure", (0, 3, 6), "4.3 nominal_pressure", (0, 1, 2)),
    ("4.1 voltage_peak_to_peak", range(9, 15), "4.2 voltage_peak_to_peak", range(6)),
    ("4.1 voltage_peak_to_peak", range(10, 15), "4.4 voltage_peak_to_peak", range(8, 13)),
    ("4.1 voltage_peak_to_peak", [*range(9, 15)] * 6, "4.5 voltage_peak_to_peak", range(36)),
    ("4.1 voltage_peak_to_peak", (14, 14, 14), "4.3 voltage_peak_to_peak", (0, 1, 2)),
    ("4.1 vibration_amplitude", range(10, 15), "4.4 vibration_amplitude", range(8, 13)),
    ("4.1 vibration_amplitude", (14, 14, 14), "4.3 vibration_amplitude", (0, 1, 2)),
    ("4.1 actuator_power", (14, 14, 14), "4.3 actuator_power", (0, 1, 2)),
    ("4.4 sliding_speed", [row for row in range(2, 8) for _ in range(6)], "4.5 sliding_speed", range(36)),
    ("4.4 vibration_velocity", [*range(8, 13)] * 6, "4.5 vibration_velocity", [r for r in range(36) if r % 6]),
]


def agrees(end: Floats, half: Floats, span: Span) -> NDArray[np.bool_]:
    slack = 1e-9 * np.abs(end)  # decimal halves are not exact in binary
    return np.isnan(span.low) | ((end - half - slack <= span.high) & (end + half + slack >= span.low))


def agreement(place: tuple[str, str], read: Reader) -> NDArray[np.bool_]:
    printed, derived = read(*place), DERIVED[place](read)
    if isinstance(derived, Span):
        found = agrees(printed.value, printed.half, derived)
    else:
        found = agrees(printed.low, printed.half, derived[0]) & agrees(printed.high, printed.half, derived[1])
    return found | np.isnan(printed.value)


def differing(read: Reader) -> list[tuple[str, str]]:
    return [
        (here, there)
        for here, rows, there, others in SAME
        for row, other in zip(rows, others, strict=True)
        if read.text(*here.split())[row] != read.text(*there.split())[other]
    ]


CORRECTIONS = [(number, correction) for number in table_ids() for correction in table(number).corrections]
SETTLED = [(number, correction) for number, correction in CORRECTIONS if is_settled(correction)]


def test_every_derived_column_is_derived_again() -> None:
    derived = {(n, c.name) for n in table_ids() for c in table(n).columns.values() if c.role == "derived"}
    assert derived <= set(DERIVED)


@pytest.mark.parametrize("place", DERIVED, ids=str)
def test_derived_cells_follow_from_the_others_once_corrections_are_made(place: tuple[str, str]) -> None:
    assert agreement(place, RIGHT).all()


def test_what_is_printed_twice_is_the_same_once_corrections_are_made() -> None:
    assert differing(RIGHT) == []


@pytest.mark.parametrize(("number", "correction"), SETTLED, ids=lambda value: getattr(value, "column", value))
def test_a_corrected_cell_contradicts_the_other_cells_as_printed(number: str, correction: Correction) -> None:
    read = Reader(as_printed=(number, correction))
    broken = [place for place in DERIVED if not agreement(place, read).all()]
    assert broken or differing(read)


@pytest.mark.parametrize(("number", "correction"), CORRECTIONS, ids=lambda value: getattr(value, "column", value))
def test_a_correction_quotes_the_cell_it_corrects(number: str, correction: Correction) -> None:
    column = table(number).columns[correction.column]
    if correction.row is not None:
        assert column.printed[correction.row] == correction.printed
    else:
        assert not is_settled(correction)
