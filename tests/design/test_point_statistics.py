"""Counts and extremes over the points of a dataset."""

import numpy as np
import xarray as xr

from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts, status_counts

RATIO = np.array([[0.5, np.nan, 0.2], [0.9, 0.3, np.nan]])


def points(**variables: object) -> xr.Dataset:
    grid = {name: (("row", "column"), np.asarray(values)) for name, values in variables.items()}
    return xr.Dataset({"ratio": (("row", "column"), RATIO), **grid})


def test_statuses_are_counted_by_text_and_by_code() -> None:
    text = points(status=[["found", "refused", "found"], ["found", "found", "refused"]])
    codes = points(status=[[0, 1, 0], [0, 0, 1]])
    codes["status"].attrs["flag_meanings"] = "found refused"
    assert status_counts(text) == status_counts(codes) == {"found": 4, "refused": 2}


def test_only_points_without_a_result_have_their_reasons_counted() -> None:
    text = points(reason=[["", "too loud", ""], ["", "noted", "too slow"]])
    assert failure_counts(text, outcome="ratio") == {"too loud": 1, "too slow": 1}
    codes = points(reason=[[0, 1, 0], [0, 0, 1]]).assign(reason_text=("reasons", ["", "too loud"]))
    assert failure_counts(codes, outcome="ratio") == {"too loud": 2}


def test_the_extremes_pass_over_points_without_a_result() -> None:
    assert extreme_place(points(), outcome="ratio") == 2
    assert extreme_place(points(), outcome="ratio", highest=True) == 3
    least, most = (extreme_point(points(), outcome="ratio", highest=highest) for highest in (False, True))
    assert least is not None
    assert most is not None
    assert (float(least["ratio"]), float(most["ratio"])) == (0.2, 0.9)


def test_there_is_no_extreme_without_results() -> None:
    empty = xr.Dataset({"ratio": ("row", [np.nan, np.nan])})
    assert extreme_place(empty, outcome="ratio") is None
    assert extreme_point(empty, outcome="ratio") is None
