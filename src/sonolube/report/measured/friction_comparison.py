"""Sheet of tests with vibration beside tests without: friction reduction, its interval and its significance."""

from collections.abc import Sequence
from functools import partial

from sonolube.measurement.statistics.repeated_tests import compare_means, ratio_interval
from sonolube.report.measured import friction_figures as figures
from sonolube.report.measured.sheet import (
    Sheet,
    SheetSection,
    SheetValue,
    attempted_section,
    quantity_value,
    sheet_from_sections,
)

_LEVELS = ("steady_friction_force", "friction_force", "friction_coefficient")


def comparison_sheet(with_vibration: Sequence[Sheet], without_vibration: Sequence[Sheet]) -> Sheet:
    """Friction reduction from tests with and without vibration, with its interval and its significance.

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
    vibrated, still = (
        [value.value for sheet in sheets if (value := _value(sheet, level))]
        for sheets in (with_vibration, without_vibration)
    )
    figure = figures.comparison(still, vibrated, level)
    sections = [
        attempted_section(partial(_reduction, vibrated, still), what="interval of the reduction"),
        attempted_section(partial(_significance, vibrated, still), what="significance"),
        SheetSection(figures=(figure,)),
    ]
    if min(len(vibrated), len(still)) < 2:
        mean = 1 - (sum(vibrated) / len(vibrated)) / (sum(still) / len(still))
        sections.insert(0, SheetSection(values=(quantity_value("friction_reduction", mean),)))
    return sheet_from_sections(sections, title=title, source={"compared": level.replace("_", " ")})


def _value(sheet: Sheet, name: str) -> SheetValue | None:
    """Value of this name on a sheet; None where it has none."""
    return next((value for value in sheet.values if value.name == name), None)


def _reduction(vibrated: Sequence[float], still: Sequence[float]) -> SheetSection:
    """Friction reduction with its 95 % interval, by the ratio of means."""
    ratio = ratio_interval(vibrated, still)
    interval = (1 - ratio.upper, 1 - ratio.lower) if ratio.bounded else None
    value = quantity_value("friction_reduction", 1 - ratio.ratio, interval=interval)
    return SheetSection(values=(value,), caveats=(ratio.reason,) if ratio.reason else ())


def _significance(vibrated: Sequence[float], still: Sequence[float]) -> SheetSection:
    """Significance of the difference by Welch and by permutation tests."""
    test = compare_means(still, vibrated)
    values = (
        SheetValue("welch_p", "p value of the difference, Welch test", test.welch_p, ""),
        SheetValue("permutation_p", "p value of the difference, permutation test", test.permutation_p, ""),
    )
    caveats: tuple[str, ...] = ()
    if test.smallest_permutation_p > 1 - test.confidence_level:
        caveats = (
            f"{len(vibrated)} and {len(still)} tests are too few for significance at {test.confidence_level:.0%}"
            f" without assuming normal scatter: the least possible p value is {test.smallest_permutation_p:.2g}",
        )
    return SheetSection(values=values, caveats=caveats)
