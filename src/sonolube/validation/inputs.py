"""Printed numbers as inputs of a computation, and the formulas that chapters share."""

from collections.abc import Iterable
from dataclasses import replace

from sonolube.metrics import friction_reduction, wear_rate, wear_reduction
from sonolube.published import PrintedNumber, statement
from sonolube.published.values import Computed, Published, cell


def said(statement_id: str) -> PrintedNumber:
    """Return a number of the running text."""
    return statement(statement_id).number


def in_table(table_id: str, column: str, row: int = 0) -> PrintedNumber:
    """Return a number of a table; `row` counts from 0."""
    return cell(table_id, column, row).number


def exact(number: PrintedNumber) -> PrintedNumber:
    """Return a number that was set, not rounded."""
    return replace(number, low=number.value, high=number.value, half_digit=0.0)


def setting(number: PrintedNumber) -> PrintedNumber:
    """Return a setting: exact where it is printed as a whole number, such as 11 turns or 4 h, rounded elsewhere."""
    return number if "." in number.text else exact(number)


def range_ends(number: PrintedNumber) -> tuple[PrintedNumber, PrintedNumber]:
    """Return the lower and the upper end of a printed range, each with half a digit to either side."""
    low, high = (
        replace(number, value=end, low=end - number.half_digit, high=end + number.half_digit)
        for end in (number.low, number.high)
    )
    return low, high


def published_ends(published: Published) -> tuple[Published, Published]:
    """Return the ends of a published range as two published numbers."""
    low, high = range_ends(published.number)
    return (
        replace(published, id=f"{published.id}-from", number=low),
        replace(published, id=f"{published.id}-to", number=high),
    )


def named(published: Published, suffix: str) -> Published:
    """Return the same published number for a row of its own, where several are computed for it."""
    return replace(published, id=f"{published.id}-{suffix}")


def largest(computed: Iterable[Computed]) -> Computed:
    """Return the largest of computed numbers."""
    return max(computed, key=lambda one: one.value)


def smallest(computed: Iterable[Computed]) -> Computed:
    """Return the smallest of computed numbers."""
    return min(computed, key=lambda one: one.value)


def friction_drop(intrinsic: float, reduced: float) -> float:
    """Return the friction reduction of two printed forces or coefficients. []"""
    return float(friction_reduction(intrinsic_friction_force=intrinsic, reduced_friction_force=reduced))


def wear_drop(intrinsic: float, reduced: float) -> float:
    """Return the wear reduction of two printed rates. []"""
    return float(wear_reduction(intrinsic_wear_rate=intrinsic, reduced_wear_rate=reduced))


def worn_per_metre(volume: float, distance: float) -> float:
    """Return the wear rate of a printed volume and distance. [m2]"""
    return float(wear_rate(wear_volume=volume, sliding_distance=distance))
