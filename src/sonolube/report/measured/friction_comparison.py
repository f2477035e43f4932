"""Sheet of tests with vibration beside tests without: friction reduction, its interval and its significance."""

from collections.abc import Sequence
from functools import partial

from sonolube.measurement.statistics.repeated_tests import compare_means, ratio_interval
from sonolube.report.measured import friction_figures as figures, sheet

_LEVELS = ("steady_friction_force", "friction_force", "mean_force", "mean_coefficient")


def comparison_sheet(with_vibration: Sequence[sheet.Sheet], without_vibration: Sequence[sheet.Sheet]) -> sheet.Sheet:
    """Friction reduction from tests with and without vibration, with its interval and its significance.

    With what is not known, where there are fewer than two tests of a kind.
    """
    every = [*with_vibration, *without_vibration]
    level = next((name for name in _LEVELS if all(_value(test, name) for test in every)), None)
    title = f"{len(with_vibration)} with vibration against {len(without_vibration)} without"
    if level is None:
        reason = "comparison: the tests have no level of friction in common"
        return sheet.joined([sheet.Sheet(not_found=(reason,))], title=title, source={})
    vibrated, still = (
        [value.value for test in sheets if (value := _value(test, level))]
        for sheets in (with_vibration, without_vibration)
    )
    figure = figures.comparison_figure(_named(without_vibration, still), _named(with_vibration, vibrated), level)
    sections = [
        sheet.attempted(partial(_reduction, vibrated, still), what="interval of the reduction"),
        sheet.attempted(partial(_significance, vibrated, still), what="significance"),
        sheet.Sheet(figures=(figure,)),
    ]
    if min(len(vibrated), len(still)) < 2:
        mean = 1 - (sum(vibrated) / len(vibrated)) / (sum(still) / len(still))
        sections.insert(0, sheet.Sheet(values=(sheet.quantity_value("friction_reduction", mean),)))
    return sheet.joined(sections, title=title, source={"compared": level.replace("_", " ")})


def _value(test: sheet.Sheet, name: str) -> sheet.Value | None:
    """Value of this name on a sheet; None where it has none."""
    return next((value for value in test.values if value.name == name), None)


def _named(tests: Sequence[sheet.Sheet], values: Sequence[float]) -> list[tuple[str, float]]:
    """Values with the titles of their tests."""
    return [(test.title, value) for test, value in zip(tests, values, strict=True)]


def _reduction(vibrated: Sequence[float], still: Sequence[float]) -> sheet.Sheet:
    """Friction reduction with its 95 % interval, by the ratio of means."""
    ratio = ratio_interval(vibrated, still)
    interval = (1 - ratio.upper, 1 - ratio.lower) if ratio.bounded else None
    value = sheet.quantity_value("friction_reduction", 1 - ratio.ratio, interval=interval)
    return sheet.Sheet(values=(value,), caveats=(ratio.reason,) if ratio.reason else ())


def _significance(vibrated: Sequence[float], still: Sequence[float]) -> sheet.Sheet:
    """Significance of the difference by Welch and by permutation tests."""
    test = compare_means(still, vibrated)
    values = (
        sheet.Value("welch_p", "p value of the difference, Welch test", test.welch_p, ""),
        sheet.Value("permutation_p", "p value of the difference, permutation test", test.permutation_p, ""),
    )
    caveats: tuple[str, ...] = ()
    if test.smallest_permutation_p > 1 - test.confidence_level:
        caveats = (
            f"{len(vibrated)} and {len(still)} tests are too few for significance at {test.confidence_level:.0%}"
            f" without assuming normal scatter: the least possible p value is {test.smallest_permutation_p:.2g}",
        )
    return sheet.Sheet(values=values, caveats=caveats)
