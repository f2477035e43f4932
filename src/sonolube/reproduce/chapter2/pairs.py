"""Chapter 2, other pairs of materials: section 2.5, and the summary over all pairs."""

from collections.abc import Iterator
from itertools import chain
from math import pi
from operator import mul
from typing import Final

from sonolube.metrics import linear_speed
from sonolube.published.values import cell, over_rounding, stated
from sonolube.reproduce.chapter2.tribometer import drops_of, wear_reductions
from sonolube.reproduce.chapter2.welder import friction_drops
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.inputs import friction_drop, in_table, largest, said, setting

_TESTS: Final = (("2.11", 0), ("2.12", 0), ("2.12", 1), ("2.12", 2), ("2.13", 0))  # table and row


def rows() -> Iterator[Row]:
    """Yield the rows of section 2.5."""
    return chain(_settings(), _friction(), _summary_of_friction(), _summary_of_wear(), _largest())


def _settings() -> Iterator[Row]:
    for table_id, row in _TESTS:
        speed, turns, diameter = (
            in_table(table_id, name, row) for name in ("sliding_speed", "revolutions", "groove_diameter")
        )
        time = setting(in_table(table_id, "running_time", row))
        for column, computed, note in (
            ("sliding_distance", over_rounding(mul, speed, time), "Speed times running time."),
            ("revolutions", over_rounding(_turns, speed, time, diameter), "Distance over the length of the groove."),
            (
                "sliding_speed",
                over_rounding(_speed, turns, time, diameter),
                "Turns over time, times the groove's length.",
            ),
        ):
            yield compare(cell(table_id, column, row), computed, note)
    yield undetermined(cell("2.13", "nominal_pressure", 0), "the radius of the pins' tips, or the first contact area.")


def _friction() -> Iterator[Row]:
    for section, pair in (("2.5.2", "titanium"), ("2.5.4", "ceramic")):
        drop = over_rounding(
            friction_drop, said(f"{section}-friction-{pair}-off"), said(f"{section}-friction-{pair}-on")
        )
        yield compare(stated(f"{section}-friction-reduction"), drop, "D 2.1 from the mean forces.")
    yield compare(
        stated("2.5.5-friction-m50-on"),
        over_rounding(
            lambda force, drop: force * (1 - drop), said("2.5.5-friction-m50-off"), said("2.5.5-friction-reduction")
        ),
        "Force without vibration, less the stated reduction.",
    )
    yield undetermined(stated("2.5.5-friction-reduction"), "the force with vibration: that without is printed twice.")
    for amplitude in ("2.5um", "1um"):
        yield undetermined(
            stated(f"2.5.3-friction-reduction-{amplitude}"),
            "the forces, and of the titanium surfaces the summit radius and density.",
        )


def _summary_of_friction() -> Iterator[Row]:
    titanium, ceramic = (
        over_rounding(friction_drop, said(f"{pair}-off"), said(f"{pair}-on"))
        for pair in ("2.5.2-friction-titanium", "2.5.4-friction-ceramic")
    )
    on_itself = (over_rounding(float, said(f"2.5.3-friction-reduction-{size}")) for size in ("2.5um", "1um"))
    for row, (detail, note) in enumerate(
        (
            (largest(drops_of("friction_force")), "The largest that the forces of Table 2.3 give."),
            (largest(friction_drops(0) + friction_drops(1)), "The largest that the forces of Table 2.9 give."),
            (titanium, "Forces of section 2.5.2."),
            (largest(on_itself), "The larger of section 2.5.3."),
            (ceramic, "Forces of section 2.5.4."),
            (over_rounding(float, said("2.5.5-friction-reduction")), "Section 2.5.5."),
        )
    ):
        yield compare(cell("2.14", "friction_reduction", row), detail, note)


def _summary_of_wear() -> Iterator[Row]:
    yield compare(
        cell("2.14", "wear_reduction", 0),
        largest(wear_reductions("2.5")),
        "The largest that the rates of Table 2.5 give.",
    )
    yield compare(
        cell("2.14", "wear_reduction", 1), over_rounding(float, said("2.4.5-wear-reduction")), "Section 2.4.5."
    )
    for row in (4, 5):
        yield undetermined(cell("2.14", "wear_reduction", row), "the worn volumes, shown only as profiles.")


def _largest() -> Iterator[Row]:
    for measure in ("friction_reduction", "wear_reduction"):
        cells = [in_table("2.14", measure, row) for row in (0, 1, 4, 5)]
        yield compare(
            stated(f"2.5.7-{measure.replace('_', '-')}"),
            largest(over_rounding(float, number) for number in cells),
            "The largest of Table 2.14.",
        )


def _turns(speed: float, time: float, diameter: float) -> float:
    return speed * time / (pi * diameter)


def _speed(turns: float, time: float, diameter: float) -> float:
    return float(linear_speed(rotation_speed=turns / time, groove_diameter=diameter))
