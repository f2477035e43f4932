"""Chapter 2, the modified tribometer: section 2.3 and its protocol, appendix A."""

from collections.abc import Iterator
from itertools import chain
from math import pi
from operator import add, sub, truediv
from typing import Final

from sonolube.friction import dong_2015_half_period_ratio
from sonolube.metrics import dot_spacing, indentation_spacing, linear_speed, sliding_distance
from sonolube.published import PrintedNumber
from sonolube.published.values import Computed, cell, over_rounding, stated
from sonolube.reproduce.row import Row, compare
from sonolube.validation.contacts import wear_contact
from sonolube.validation.inputs import (
    exact,
    friction_drop,
    in_table,
    largest,
    published_ends,
    said,
    setting,
    smallest,
    wear_drop,
    worn_per_metre,
)
from sonolube.wear import vibration_contact_count

_SPEEDS: Final = ("20.3", "40.6", "87")  # row by row in Tables 2.2 and 2.5, in pairs of rows in Tables 2.3 and 2.4
_ROTATIONS: Final = ("A.3.1.6-rotation-20.3", "A.3.1.10-rotation-40.6", "A.3.1.10-rotation-87")


def rows() -> Iterator[Row]:
    """Yield the rows of section 2.3."""
    return chain(
        _settings_of_study_one(),
        _protocol(),
        _cube_friction(),
        _friction_reductions(),
        _fluctuation(),
        _surfaces(),
        _wear_of_study_one(),
        _marks(),
        _settings_of_study_two(),
        _revolutions_of_study_two(),
        _wear_of_study_two(),
    )


def drops_of(column: str) -> list[Computed]:
    """Return by what share a column of Table 2.3 falls under vibration, for the three speeds. []"""
    return [
        over_rounding(friction_drop, in_table("2.3", column, off), in_table("2.3", column, off + 1))
        for off in (0, 2, 4)
    ]


def wear_reductions(table_id: str) -> list[Computed]:
    """Return the reductions that the three pairs of wear rates of Table 2.5 or 2.7 give. []"""
    return [
        over_rounding(
            wear_drop, in_table(table_id, "intrinsic_wear_rate", row), in_table(table_id, "reduced_wear_rate", row)
        )
        for row in range(3)
    ]


def _settings_of_study_one() -> Iterator[Row]:
    distance, turns = in_table("2.2", "sliding_distance"), setting(in_table("2.2", "revolutions"))
    printed = float(sliding_distance(revolutions=turns.value, groove_diameter=in_table("2.2", "groove_diameter").value))
    yield compare(
        cell("2.2", "groove_diameter", 0),
        over_rounding(_groove_diameter, distance, turns),
        f"Distance over pi times turns; with the printed diameter the distance is {printed:.1f} m.",
    )
    for row, rotation in enumerate(_ROTATIONS):
        yield compare(
            cell("2.2", "sliding_speed", row),
            over_rounding(_speed, said(rotation), distance, turns),
            "Rotation of appendix A times distance per turn.",
        )
        yield compare(
            cell("2.2", "running_time", row),
            over_rounding(truediv, distance, in_table("2.2", "sliding_speed", row)),
            "Distance over speed.",
        )


def _protocol() -> Iterator[Row]:
    distance, turns = in_table("2.2", "sliding_distance"), setting(in_table("2.2", "revolutions"))
    yield compare(
        stated("A.1.3.6-groove-radius"),
        over_rounding(_groove_radius, distance, turns),
        "Half the diameter that distance and turns of Table 2.2 ask for.",
    )
    for row, rotation in enumerate(_ROTATIONS):
        yield compare(
            stated(rotation),
            over_rounding(truediv, turns, setting(in_table("2.2", "running_time", row))),
            "Turns over running time of Table 2.2.",
        )
    yield compare(
        stated("A.3.1.10-duration-87"),
        over_rounding(truediv, distance, in_table("2.2", "sliding_speed", 2)),
        "Distance over speed of Table 2.2.",
    )


def _cube_friction() -> Iterator[Row]:
    load, amplitude = in_table("2.2", "normal_load").value, in_table("2.2", "vibration_amplitude").value
    ratio = float(dong_2015_half_period_ratio(wear_contact(), normal_load=load, vibration_amplitude=amplitude))
    for row in (1, 3, 5):
        yield compare(
            cell("2.3", "friction_force", row),
            ratio * in_table("2.3", "friction_force", row - 1).value,
            f"Cube, D 3.15 with Table 3.2: {ratio:.3f} of the force without vibration, at every speed; it has no slip.",
        )


def _friction_reductions() -> Iterator[Row]:
    drops = drops_of("friction_force")
    for published, drop in (
        *((cell("2.5", "friction_reduction", row), drop) for row, drop in enumerate(drops)),
        (stated("2.3.5-friction-reduction-20.3"), drops[0]),
        (stated("2.3.5-friction-reduction-87"), drops[2]),
        (stated("2.3.7-friction-reduction"), largest(drops)),
        (stated("2.3.7-friction-reduction-87"), drops[2]),
    ):
        yield compare(published, drop, "D 2.1 from the forces of Table 2.3.")


def _fluctuation() -> Iterator[Row]:
    drops = drops_of("friction_rms")
    each = ", ".join(f"{100 * drop.value:.1f}" for drop in drops)
    yield compare(
        stated("2.3.7-stick-slip-reduction"),
        largest(drops),
        f"Largest drop of the fluctuation in Table 2.3: {each} %.",
    )


def _surfaces() -> Iterator[Row]:
    for row in range(7):
        yield compare(
            cell("2.4", "total_height", row),
            over_rounding(
                add,
                in_table("2.4", "maximum_peak_height", row),
                in_table("2.4", "maximum_pit_depth", row),
            ),
            "R_p + R_v.",
        )
    for metal, row in (("steel", 1), ("aluminium", 0)):
        yield compare(
            stated(f"2.3.4-hardness-{metal}"),
            over_rounding(float, in_table("2.15", "hardness", row)),
            "The same alloy in Table 2.15.",
        )


def _wear_of_study_one() -> Iterator[Row]:
    reductions = wear_reductions("2.5")
    for row, reduction in enumerate(reductions):
        rates = in_table("2.5", "intrinsic_wear_rate", row), in_table("2.5", "reduced_wear_rate", row)
        yield compare(cell("2.5", "wear_rate_drop", row), over_rounding(sub, *rates), "Difference of the rates.")
        yield compare(cell("2.5", "wear_reduction", row), reduction, "D 2.3 from the rates.")
        time = setting(in_table("2.2", "running_time", row))
        yield compare(
            cell("2.5", "vibration_contact_count", row),
            over_rounding(_contacts, in_table("2.2", "frequency", row), time),
            "f times running time.",
        )
    lowest, highest = published_ends(stated("2.3.5-wear-reduction"))
    yield compare(lowest, smallest(reductions), "D 2.3 from the rates of Table 2.5, the smallest.")
    for published in (highest, stated("2.3.7-wear-reduction")):
        yield compare(published, largest(reductions), "D 2.3 from the rates of Table 2.5, the largest.")


def _marks() -> Iterator[Row]:
    speed, period = in_table("2.2", "sliding_speed", 2), exact(said("2.3.4-stick-slip-period"))
    dots = over_rounding(_dots, speed, in_table("2.2", "frequency", 2))
    yield compare(stated("2.3.4-dots-calculated"), dots, "v over f.")
    yield compare(
        stated("2.3.4-dots-measured"),
        dots,
        "v over f, the length of one cycle; D states no scatter of what it measured in one image.",
    )
    for row, printed in enumerate(_SPEEDS):
        asked = said(f"2.3.4-indentation-{printed}").value / in_table("2.2", "sliding_speed", row).value
        yield compare(
            stated(f"2.3.4-indentation-{printed}"),
            over_rounding(_indentations, in_table("2.2", "sliding_speed", row), period),
            f"D 2.4 with {1e3 * period.value:g} ms; the print asks for {1e3 * asked:.1f} ms.",
        )
    measured = said("2.3.4-indentation-measured")
    at_highest_speed = over_rounding(_indentations, speed, period)
    yield compare(stated("2.3.4-indentation-measured"), at_highest_speed, "D 2.4.")
    yield compare(stated("2.3.7-indentations"), at_highest_speed, "D 2.4.")
    yield compare(
        stated("2.3.7-stick-slip-frequency"),
        over_rounding(truediv, speed, measured),
        "v over the measured distance of indentations.",
    )


def _settings_of_study_two() -> Iterator[Row]:
    times = _times_of_study_two()
    for row, time in enumerate(times):
        yield compare(
            cell("2.6", "sliding_speed", row),
            over_rounding(truediv, in_table("2.6", "sliding_distance", row), time),
            "Distance over running time.",
        )
    for row in (0, 1):
        yield compare(
            cell("2.6", "sliding_distance", row),
            over_rounding(_in_proportion, in_table("2.6", "sliding_distance", 2), times[row], times[2]),
            "Distance of the longest test, in proportion to time.",
        )


def _revolutions_of_study_two() -> Iterator[Row]:
    times, turns = _times_of_study_two(), setting(in_table("2.6", "revolutions", 2))
    for published, row in (
        (cell("2.6", "revolutions", 0), 0),
        (cell("2.6", "revolutions", 1), 1),
        (cell("2.7", "revolutions", 0), 0),
        (stated("2.3.6-revolutions-1"), 0),
    ):
        yield compare(
            published,
            over_rounding(_in_proportion, turns, times[row], times[2]),
            "Turns of the longest test, in proportion to time.",
        )


def _wear_of_study_two() -> Iterator[Row]:
    for row, reduction in enumerate(wear_reductions("2.7")):
        distance = in_table("2.6", "sliding_distance", row)
        for state in ("intrinsic", "reduced"):
            yield compare(
                cell("2.7", f"{state}_wear_rate", row),
                over_rounding(worn_per_metre, in_table("2.7", f"{state}_wear_volume", row), distance),
                "D 2.2 with the distance of Table 2.6.",
            )
        yield compare(cell("2.7", "wear_reduction", row), reduction, "D 2.3 from the rates.")


def _times_of_study_two() -> tuple[PrintedNumber, ...]:
    return tuple(setting(in_table("2.6", "running_time", row)) for row in range(3))


def _groove_diameter(distance: float, turns: float) -> float:
    return distance / (pi * turns)


def _groove_radius(distance: float, turns: float) -> float:
    return _groove_diameter(distance, turns) / 2


def _speed(rotation: float, distance: float, turns: float) -> float:
    return float(linear_speed(rotation_speed=rotation, groove_diameter=_groove_diameter(distance, turns)))


def _in_proportion(whole: float, part_time: float, whole_time: float) -> float:
    return whole * part_time / whole_time


def _contacts(frequency: float, duration: float) -> float:
    return float(vibration_contact_count(frequency=frequency, duration=duration))


def _dots(speed: float, frequency: float) -> float:
    return float(dot_spacing(sliding_speed=speed, frequency=frequency))


def _indentations(speed: float, period: float) -> float:
    return float(indentation_spacing(sliding_speed=speed, period=period))
