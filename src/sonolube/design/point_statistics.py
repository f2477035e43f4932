"""Counts and extremes over the points of a dataset: statuses, reasons of failure, and the point of an optimum."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


def status_counts(points: "xr.Dataset") -> dict[str, int]:
    """Number of points of each status."""
    values, counts = np.unique(points["status"].values, return_counts=True)
    names = points["status"].attrs.get("flag_meanings", "").split()
    return {str(names[value] if names else value): int(count) for value, count in zip(values, counts, strict=True)}


def failure_counts(points: "xr.Dataset", *, outcome: str) -> dict[str, int]:
    """Number of points without a result, by the reason."""
    failed = np.isnan(points[outcome].values)
    reasons, counts = np.unique(points["reason"].values[failed], return_counts=True)
    if "reason_text" in points:
        reasons = points["reason_text"].values[reasons]
    return {str(reason): int(count) for reason, count in zip(reasons, counts, strict=True)}


def extreme_place(points: "xr.Dataset", *, outcome: str, highest: bool = False) -> int | None:
    """Flat index of the point at which an outcome is least or greatest.

    In row-major order; None where no point has a result.
    """
    values = points[outcome].values
    if np.isnan(values).all():
        return None
    return int((np.nanargmax if highest else np.nanargmin)(values))


def extreme_point(points: "xr.Dataset", *, outcome: str, highest: bool = False) -> "xr.Dataset | None":
    """Point at which an outcome is least or greatest.

    The dataset at that point; None where no point has a result.
    """
    place = extreme_place(points, outcome=outcome, highest=highest)
    if place is None:
        return None
    index = np.unravel_index(place, points[outcome].shape)
    return points.isel(dict(zip(points[outcome].dims, map(int, index), strict=True)))
