"""Tables of a page that count points by status and by the reason of their failure."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sonolube.design.point_statistics import status_counts
from sonolube.report.page import PageTable

if TYPE_CHECKING:
    import xarray as xr


def status_tables(points: "xr.Dataset", failures: Mapping[str, int]) -> list[PageTable]:
    """Number of points of each status, and of those without a result by reason, where there are any."""
    tables = [count_table("Points by status", "points", status_counts(points))]
    if failures:
        rows = tuple((reason, f"{count}") for reason, count in failures.items())
        tables.append(PageTable(title="Points without a result", heads=("reason", "points"), rows=rows))
    return tables


def failure_objects(failures: Mapping[str, int]) -> list[dict[str, Any]]:
    """Reasons for which points have no result, with their number, for JSON."""
    return [{"reason": reason, "points": count} for reason, count in failures.items()]


def count_table(title: str, counted: str, counts: Mapping[str, int], *, total: int | None = None) -> PageTable:
    """Counts by status with their fractions."""
    whole = sum(counts.values()) if total is None else total
    rows = tuple((name, f"{count}", f"{count / whole:.1%}") for name, count in counts.items())
    return PageTable(title=title, heads=("status", counted, "share"), rows=rows)
