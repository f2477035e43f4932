"""Tests with vibration beside tests without: reduction, its interval, and whether so few tests can tell."""

from collections.abc import Sequence
from functools import partial

from sonolube.measurement.statistics.intervals import compare, ratio_interval
from sonolube.report.measured import friction_figures as figures
from sonolube.report.measured.sheet import (
    Sheet,
    SheetFigure,
    SheetSection,
    SheetValue,
    attempted_section,
    quantity_value,
    sheet_from_sections,
)

_LEVELS = ("steady_friction_force", "friction_force", "friction_coefficient")


def comparison_sheet(with_vibration: Sequence[Sheet], without_vibration: Sequence[Sheet]) -> Sheet:
    """Return what vibration takes from friction, by tests with and tests without it.

    Parameters
    ----------
    with_vibration, without_vibration : sequence of Sheet
        As `friction_sheet` gives them. Steady friction is compared where every test has it, else the mean.

    Returns
    -------
    Sheet
        With what is not known, where there are fewer than two tests of a kind.
    """
    every = [*with_vibration, *without_vibration]
    level = next((name for name in _LEVELS if all(_value(sheet, name) for sheet in every)), None)
    title = f"{len(with_vibration)} with vibration against {len(without_vibration)} without"
    if level is None:
        reason = "comparison: the tests have no level of friction in common"
        return sheet_from_sections([SheetSection(not_found=(reason,))], title=title, source={})
    on, off = (
        [found.value for sheet in sheets if (found := _value(sheet, level))]
        for sheets in (with_vibration, without_vibration)
    )
    drawn = SheetFigure(
        name="comparison",
        title="Tests with and without vibration",
        caption="Each test, and the mean of its kind.",
        draw=partial(figures.comparison, off, on, level),
    )
    parts = [
        attempted_section(partial(_reduction, on, off), what="interval of the reduction"),
        attempted_section(partial(_significance, on, off), what="significance"),
        SheetSection(figures=(drawn,)),
    ]
    if min(len(on), len(off)) < 2:
        mean = 1 - (sum(on) / len(on)) / (sum(off) / len(off))
        parts.insert(0, SheetSection(values=(quantity_value("friction_reduction", mean),)))
    return sheet_from_sections(parts, title=title, source={"compared": level.replace("_", " ")})


def _value(sheet: Sheet, name: str) -> SheetValue | None:
    return next((value for value in sheet.values if value.name == name), None)


def _reduction(on: Sequence[float], off: Sequence[float]) -> SheetSection:
    ratio = ratio_interval(on, off)
    interval = (1 - ratio.upper, 1 - ratio.lower) if ratio.bounded else None
    value = quantity_value("friction_reduction", 1 - ratio.ratio, interval=interval)
    return SheetSection(values=(value,), caveats=(ratio.reason,) if ratio.reason else ())


def _significance(on: Sequence[float], off: Sequence[float]) -> SheetSection:
    found = compare(off, on)
    values = (
        SheetValue(
            name="welch_p", label="Chance of so large a difference by scatter, Welch", value=found.welch_p, unit=""
        ),
        SheetValue(
            name="permutation_p",
            label="The same by permutation, without assuming normal scatter",
            value=found.permutation_p,
            unit="",
        ),
    )
    caveats: tuple[str, ...] = ()
    if found.smallest_permutation_p > 1 - found.confidence_level:
        caveats = (
            f"{len(on)} and {len(off)} tests cannot tell a difference at {found.confidence_level:.0%} without assuming"
            f" normal scatter: the chance is {found.smallest_permutation_p:.2g} at the least",
        )
    return SheetSection(values=values, caveats=caveats)
