"""Chapter 2, high stress and speed on the welder rig: section 2.4."""

from collections.abc import Iterator
from itertools import chain
from operator import sub, truediv
from typing import Final

from sonolube.contact import SphereOnFlat, hertz_mean_pressure, hertz_peak_pressure, tip_radius_for_pressure
from sonolube.metrics import linear_speed, sliding_distance
from sonolube.published.values import Computed, cell, over_rounding, stated
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.contacts import poisson_contact
from sonolube.validation.inputs import (
    exact,
    friction_drop,
    in_table,
    largest,
    named,
    published_ends,
    range_ends,
    setting,
    smallest,
    worn_per_metre,
)

_OF_ROUND: Final = 0  # first row of either tip in Table 2.8
_OF_FLAT: Final = 2


def rows() -> Iterator[Row]:
    """Yield the rows of section 2.4."""
    return chain(_stresses(), _stress_at_the_centre(), _motion(), _friction(), _motor(), _wear(), _share_of_wear())


def friction_drops(tip: int) -> list[Computed]:
    """Return the reductions that the lower and the upper forces of Table 2.9 give for a tip, a row of it. []"""
    intrinsic = range_ends(in_table("2.9", "intrinsic_friction_force", tip))
    reduced = range_ends(in_table("2.9", "reduced_friction_force", tip))
    return [over_rounding(friction_drop, before, after) for before, after in zip(intrinsic, reduced, strict=True)]


def _stresses() -> Iterator[Row]:
    round_worn, round_new = _stress_range(_OF_ROUND)
    flat_worn, flat_new = _stress_range(_OF_FLAT)
    for published, lower, upper in (
        (cell("2.8", "nominal_pressure", _OF_ROUND), round_worn, round_new),
        (cell("2.8", "nominal_pressure", _OF_FLAT), flat_worn, flat_new),
        (stated("2.4.2-round-stress"), round_worn, round_new),
    ):
        for end, stress in zip(published_ends(published), (lower, upper), strict=True):
            yield compare(end, stress, "Load over contact area; the worn area is the larger, and its stress the lower.")
    yield compare(stated("2.4.2-flat-stress-before"), flat_new, "Load over the area before the test.")
    yield compare(stated("2.4.2-flat-stress-after"), flat_worn, "Load over the area after the test.")
    yield compare(stated("2.4.6-stress"), round_new, "Load over the smallest area.")


def _stress_range(row: int) -> tuple[Computed, Computed]:
    load = setting(in_table("2.8", "normal_load", row))
    new, worn = (over_rounding(truediv, load, area) for area in range_ends(in_table("2.8", "nominal_area", row)))
    return worn, new


def _stress_at_the_centre() -> Iterator[Row]:
    load = in_table("2.8", "normal_load", _OF_ROUND).value
    modulus = poisson_contact(bodies="steel_steel").pair.effective_modulus
    radius = tip_radius_for_pressure(
        mean_pressure=in_table("2.8", "nominal_pressure", _OF_ROUND).value, normal_load=load, effective_modulus=modulus
    )
    sphere = SphereOnFlat(tip_radius=float(radius), effective_modulus=modulus)
    yield compare(
        stated("2.4.2-round-stress-centre"),
        float(hertz_peak_pressure(sphere, normal_load=load) / hertz_mean_pressure(sphere, normal_load=load)),
        "Hertz, peak over mean of any elastic sphere: the least that rounds to the print; that is from an FEA.",
    )


def _motion() -> Iterator[Row]:
    speeds = [
        over_rounding(
            _speed,
            in_table("2.8", "rotation_speed", row),
            in_table("2.8", "groove_diameter", row),
        )
        for row in range(4)
    ]
    for row, speed in enumerate(speeds):
        yield compare(cell("2.8", "sliding_speed", row), speed, "Pi times rotation times groove diameter.")
    yield compare(stated("2.4.6-sliding-speed"), largest(speeds), "The largest speed of Table 2.8.")
    for published, tip in (
        (cell("2.8", "sliding_distance", _OF_ROUND), _OF_ROUND),
        (cell("2.8", "sliding_distance", _OF_FLAT), _OF_FLAT),
        (cell("2.10", "sliding_distance", 1), _OF_ROUND),
        (cell("2.10", "sliding_distance", 2), _OF_FLAT),
    ):
        distance = over_rounding(
            _distance,
            setting(in_table("2.8", "revolutions", tip)),
            in_table("2.8", "groove_diameter", tip),
        )
        yield compare(published, distance, "Pi times turns times groove diameter.")


def _friction() -> Iterator[Row]:
    for tip in (0, 1):
        drops = friction_drops(tip)
        ends = published_ends(cell("2.9", "friction_reduction", tip))
        for end, drop in zip(ends, (smallest(drops), largest(drops)), strict=True):
            yield compare(end, drop, "D 2.1, lower force with lower and upper with upper.")
    yield compare(
        stated("2.4.6-friction-reduction"),
        largest(friction_drops(0) + friction_drops(1)),
        "D 2.1 from the forces of Table 2.9, the largest.",
    )
    for name, tip in (("round", 0), ("flat", 1)):
        middle = in_table("2.9", "intrinsic_friction_force", tip).value
        yield compare(stated(f"2.4.4-friction-{name}"), middle, "Middle of the range in Table 2.9.")


def _motor() -> Iterator[Row]:
    for name, tip in (("round", 0), ("flat", 1)):
        drop = over_rounding(
            sub,
            exact(in_table("2.9", "intrinsic_motor_current", tip)),
            exact(in_table("2.9", "reduced_motor_current", tip)),
        )
        yield compare(named(stated("2.4.4-current-drop"), name), drop, "Difference of the currents of Table 2.9.")


def _wear() -> Iterator[Row]:
    for row, tip in ((1, _OF_ROUND), (2, _OF_FLAT)):
        yield compare(
            cell("2.10", "wear_volume_per_turn", row),
            over_rounding(truediv, in_table("2.10", "wear_volume", row), setting(in_table("2.8", "revolutions", tip))),
            "Volume over turns.",
        )
        yield compare(cell("2.10", "wear_rate", row), _wear_rate(row), "Volume over distance.")
    yield undetermined(stated("2.4.5-wear-reduction"), "the worn volumes of the two tests with the round tip.")


def _share_of_wear() -> Iterator[Row]:
    round_tip, flat_tip = _wear_rate(1), _wear_rate(2)
    as_printed = in_table("2.10", "wear_rate", 2).value / in_table("2.10", "wear_rate", 1).value
    yield compare(
        stated("2.4.5-flat-wear-share"),
        Computed(
            value=flat_tip.value / round_tip.value,
            low=flat_tip.low / round_tip.high,
            high=flat_tip.high / round_tip.low,
        ),
        f"Volumes over distances of Table 2.10; the printed rates give {100 * as_printed:.1f} %.",
    )


def _wear_rate(row: int) -> Computed:
    """Return a rate of Table 2.10, within what its volume and its volume per turn, each rounded, leave together."""
    distance = in_table("2.10", "sliding_distance", row)
    turns = in_table("2.8", "revolutions").value
    whole = over_rounding(worn_per_metre, in_table("2.10", "wear_volume", row), distance)
    by_turn = over_rounding(
        lambda volume, way: worn_per_metre(turns * volume, way), in_table("2.10", "wear_volume_per_turn", row), distance
    )
    return Computed(value=whole.value, low=max(whole.low, by_turn.low), high=min(whole.high, by_turn.high))


def _speed(rotation: float, diameter: float) -> float:
    return float(linear_speed(rotation_speed=rotation, groove_diameter=diameter))


def _distance(turns: float, diameter: float) -> float:
    return float(sliding_distance(revolutions=turns, groove_diameter=diameter))
