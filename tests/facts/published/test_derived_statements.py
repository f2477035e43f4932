"""Numbers of D's running text that follow from other printed numbers, derived again."""

import re
from collections.abc import Callable
from functools import partial
from itertools import product
from operator import mul, sub, truediv

import numpy as np
import pytest
from pytest import approx
from scipy.special import i0

from sonolube.errors import InvalidInput
from sonolube.facts.published import PrintedNumber, erratum, parse_printed, si_value, statement, statements, table

Place = tuple[str, str, int]
Span = tuple[float, float]


def rightly(source: str | Place) -> PrintedNumber:
    """Return a statement by name or a cell by place, put right where it is in correction."""
    if isinstance(source, str):
        entry = statement(source)
        return put_right(entry.number, entry.corrected, entry.unit, entry.quantity)
    number, name, row = source
    column = table(number).columns[name]
    cell = column.cells[row]
    assert cell is not None
    right = [
        correction.corrected
        for correction in table(number).corrections
        if (correction.column, correction.row) == (name, row)
    ]
    return put_right(cell, "".join(right), column.unit, column.quantity)


def put_right(number: PrintedNumber, right: str, unit: str, quantity: str) -> PrintedNumber:
    try:
        return parse_printed(right, unit, quantity=quantity)
    except InvalidInput:
        return number


def of(function: Callable[..., float], *sources: str | Place, exact: bool = False) -> Callable[[], Span]:
    """Derive a number from others, over all corners of their rounding; whole numbers were set where `exact`."""

    def span() -> Span:
        numbers = [rightly(source) for source in sources]
        halves = [0.0 if exact and "." not in number.text else number.rounding_half_width for number in numbers]
        ends = [(number.value - half, number.value + half) for number, half in zip(numbers, halves, strict=True)]
        values = [function(*corner) for corner in product(*ends)]
        return min(values), max(values)

    return span


def share_lost(before: float, after: float) -> float:
    return 1 - after / before


def itself(number: float) -> float:
    return number


def round_tip() -> Span:
    """Table 2.9, the greatest reduction at either tip: 10.73 N falls to 5.323 N."""
    return 1 - 5.3235 / 10.725, 1 - 5.3225 / 10.735


STATED: dict[str, Callable[[], Span]] = {
    "2.2.5-vibration-velocity": of(lambda stroke: np.pi * 16e3 * stroke * 4 / 150, "2.2.2-stroke"),
    **{
        f"2.2.5-power-{level}": of(
            lambda c, u: c * u * 4 * 16e3, "2.2.2-capacitance", f"2.2.3-voltage-maximum-{level}", exact=True
        )
        for level in (1, 2, 3)
    },
    **{
        f"2.3.4-indentation-{speed}": of(lambda v: v * 0.01, f"2.3.2-sliding-speed-{speed}")
        for speed in ("20.3", "40.6", "87")
    },
    "2.3.4-hardness-steel": of(itself, ("2.15", "hardness", 1)),
    "2.3.4-hardness-aluminium": of(itself, ("2.15", "hardness", 0)),
    "2.3.4-dots-calculated": of(lambda v: v / 22e3, "2.3.2-sliding-speed-87"),
    "2.3.5-friction-reduction-20.3": of(itself, ("2.5", "friction_reduction", 0)),
    "2.3.5-friction-reduction-87": of(itself, ("2.5", "friction_reduction", 2)),
    "2.3.6-revolutions-1": of(itself, ("2.7", "revolutions", 0)),
    "2.3.7-friction-reduction": of(itself, ("2.5", "friction_reduction", 0)),
    "5.1.1-tribometer-friction-reduction": of(itself, ("2.5", "friction_reduction", 0)),
    "2.3.7-friction-reduction-87": of(itself, ("2.5", "friction_reduction", 2)),
    "2.3.7-wear-reduction": of(itself, ("2.5", "wear_reduction", 2)),
    "2.3.7-stick-slip-reduction": of(share_lost, ("2.3", "friction_rms", 2), ("2.3", "friction_rms", 3)),
    "2.4.2-flat-stress-before": of(lambda area: 70 / area, "2.4.2-flat-area-before", exact=True),
    "2.4.2-flat-stress-after": of(lambda area: 70 / area, "2.4.2-flat-area-after"),
    "2.4.5-flat-wear-share": of(truediv, ("2.10", "wear_rate", 2), ("2.10", "wear_rate", 1)),
    **{name: of(itself, ("2.8", "sliding_speed", 3)) for name in ("2.4.6-sliding-speed", "5.1.1-high-speed")},
    "2.4.6-friction-reduction": round_tip,
    "5.1.1-high-stress-friction-reduction": round_tip,
    "2.5.2-friction-reduction": of(share_lost, "2.5.2-friction-titanium-off", "2.5.2-friction-titanium-on"),
    "2.5.4-friction-reduction": of(share_lost, "2.5.4-friction-ceramic-off", "2.5.4-friction-ceramic-on"),
    "2.5.5-friction-m50-on": of(
        lambda force, share: force * (1 - share), "2.5.5-friction-m50-off", "2.5.5-friction-reduction"
    ),
    "2.5.7-friction-reduction": of(itself, ("2.14", "friction_reduction", 5)),
    "5.1.1-m50-friction-reduction": of(itself, ("2.14", "friction_reduction", 5)),
    "2.5.7-wear-reduction": of(itself, ("2.14", "wear_reduction", 5)),
    "5.1.1-m50-wear-reduction": of(itself, ("2.14", "wear_reduction", 5)),
    "3.1.4-area-factor": lambda: (240 / 40, 240 / 40),  # area is proportional to load
    "4.1.2-sliding-speed": of(lambda d, time: np.pi * d / time, "4.1.1-diameter-1", "4.1.2-turn-duration"),
    "4.1.2-efficiency-stress": of(lambda area: 9 / area, "4.1.1-nominal-area"),
    "4.1.2-friction-drop": of(sub, ("4.2", "friction_force", 0), ("4.2", "friction_force", 1)),
    **{
        f"4.3.4-example-speed-rise-{end}": of(
            sub, ("4.5", "superimposed_speed", row), ("4.5", "sliding_speed", row), exact=True
        )
        for end, row in (("low", 32), ("high", 35))
    },
    **{
        f"4.4.3-coefficient-{state}-{load}N": of(partial(mul, 1 / load), f"4.4.3-friction-{state}-{load}N")
        for state, load in product(("off", "on"), (2, 3, 4))
    },
    **{
        f"4.4.3-reduction-{load}N": of(share_lost, f"4.4.3-friction-off-{load}N", f"4.4.3-friction-on-{load}N")
        for load in (2, 3, 4)
    },
    "A.1.3.6-groove-radius": of(lambda diameter: diameter / 2, ("2.2", "groove_diameter", 0)),
    **{
        f"A.3.1.{step}-sliding-speed-{speed}": of(
            lambda rotation, diameter: np.pi * diameter * rotation,
            f"A.3.1.{step}-rotation-{speed}",
            ("2.2", "groove_diameter", 0),
        )
        for step, speed in ((6, "20.3"), (10, "40.6"), (10, "87"))
    },
}


def agrees(number: PrintedNumber, span: Span) -> bool:
    slack = 1e-9 * abs(number.value)  # decimal halves are not exact in binary
    return (
        number.value - number.rounding_half_width - slack <= span[1]
        and number.value + number.rounding_half_width + slack >= span[0]
    )


@pytest.mark.parametrize("name", STATED)
def test_a_stated_number_follows_from_others_or_is_corrected(name: str) -> None:
    entry, span = statement(name), STATED[name]()
    assert agrees(entry.number, span) == (not entry.evidence)
    assert agrees(rightly(name), span)


def test_every_corrected_statement_is_derived_again() -> None:
    settled = {
        entry.id
        for entry in statements()
        if put_right(entry.number, entry.corrected, entry.unit, entry.quantity) is not entry.number
    }
    assert settled <= set(STATED)


def test_the_rings_of_the_collar_would_have_to_be_wider_than_printed_to_breathe_as_low() -> None:
    # N16: rings breathe at c/(2 pi R), and turn oval at (6/sqrt 5) c h/(2 pi sqrt(12) R^2), Hoppe, for a wall h.
    names = ("inner-ring-outer-diameter", "inner-ring-inner-diameter", "breathing-mode-first", "breathing-mode-revised")
    outer, inner, first, revised = (statement(f"4.5.2-{name}").number.value for name in names)
    speed, radius = np.sqrt(200e9 / 8000.0), (outer + inner) / 4
    breathing = speed / (2 * np.pi * radius)
    oval = 6 / np.sqrt(5) * speed * (outer - inner) / 2 / (2 * np.pi * np.sqrt(12) * radius**2)
    assert breathing == approx(84e3, rel=0.01)
    assert oval == approx(43e3, rel=0.01)
    assert first < oval < first * 1.1
    assert speed / (np.pi * revised) == approx(59e-3, rel=0.01)
    assert speed / (np.pi * revised) > 3 * statement("4.5.4-rod-diameter").number.value
    assert {"84 kHz", "59 mm", "19 mm", "43 kHz"} <= set(re.findall(r"\d+ (?:kHz|mm)", erratum("N16").evidence))


def test_without_the_6_um_of_table_3_2_normal_vibration_can_reach_the_last_row_of_table_4_2() -> None:
    # N17: friction carried by the widest gap of a load-balanced sine, exp(-beta)/I0(beta), beta = 3 a/R_q
    lowest, without = (si_value(f"table-4.2-friction_force-{row}") for row in (6, 1))
    beta = 3 * si_value("table-4.1-vibration_amplitude-15") / np.array([6e-6, 2.12e-6, 1.69e-6])
    reached = np.exp(-beta) / i0(beta) < lowest / without
    assert reached.tolist() == [False, True, True]
    assert si_value("2.5.2-roughness-unworn") == si_value("table-2.4-arithmetic_mean_height-1")
    assert 1.69 * np.sqrt(np.pi / 2) == approx(2.12, abs=5e-3)
    assert 1.73 * np.sqrt(np.pi / 2) == approx(2.17, abs=5e-3)
