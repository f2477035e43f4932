"""The comparison of two computations: what differs by more than rounding differs, and so does every word."""

import io
import zipfile
from typing import Any

import numpy as np
import pytest
import xarray as xr
from tests.same import same, same_files, same_text


def dataset(value: float, unit: str = "N") -> xr.Dataset:
    """One force along one axis."""
    return xr.Dataset({"force": ("time", [value, np.nan], {"units": unit})}, coords={"time": [0.0, 0.1]})


ALIKE: list[tuple[Any, Any]] = [
    (0.1 + 0.2, 0.3),
    ({"a": [0.1 + 0.2, "N"], "b": None}, {"a": [0.3, "N"], "b": None}),
    ((1, 0.1 + 0.2), (1, 0.3)),
    (1, 1.0),
    (float("nan"), float("nan")),
    (np.array([0.1 + 0.2, np.nan]), np.array([0.3, np.nan])),
    (np.array(["a", "b"]), np.array(["a", "b"])),
    (np.array(0.1 + 0.2), np.float64(0.3)),
    (dataset(0.1 + 0.2), dataset(0.3)),
]
DIFFERENT: list[tuple[Any, Any]] = [
    (0.3 + 1e-11, 0.3),
    (2, 1),
    (True, 1.0),
    ("0.30000000000000004", "0.3"),
    (None, float("nan")),
    ({"a": 1, "b": 2}, {"b": 2, "a": 1}),
    ({"a": 1}, {"a": 1, "b": 2}),
    ([0.3], [0.3, 0.3]),
    ([0.3], {"0": 0.3}),
    (0.3, [0.3]),
    ([0.3], 0.3),
    (np.array([0.3]), np.array([0.3, 0.3])),
    (np.array([0.3]), np.array([[0.3]])),
    (np.array([1, 2]), np.array([1, 3])),
    (dataset(0.3), dataset(0.3 + 1e-11)),
    (dataset(0.3), dataset(0.3, unit="mN")),
]


@pytest.mark.parametrize(("one", "other"), ALIKE)
def test_results_that_differ_by_rounding_are_the_same(one: Any, other: Any) -> None:
    same(one, other)
    same(other, one)


@pytest.mark.parametrize(("one", "other"), DIFFERENT)
def test_results_that_differ_by_more_or_in_a_word_are_not(one: Any, other: Any) -> None:
    with pytest.raises(AssertionError):
        same(one, other)
    with pytest.raises(AssertionError):
        same(other, one)


def test_the_place_of_a_difference_is_named() -> None:
    with pytest.raises(AssertionError, match=r"\.forces\[1\]\.value"):
        same({"forces": [{"value": 1.0}, {"value": 2.0}]}, {"forces": [{"value": 1.0}, {"value": 2.1}]})


def test_texts_agree_where_their_words_are_equal_and_their_numbers_differ_by_rounding() -> None:
    same_text("ratio 0.30000000000000004 at 3 N", "ratio 0.3 at 3 N")
    same_text("x,1e-06,-2.5\n", "x,1.0e-06,-2.5\n")
    same_text("0.300001", "0.3", relative=1e-5)
    for one, other in (("0.3 N", "0.3 mN"), ("0.30001", "0.3"), ("1, 2", "1, 3"), ("N6", "N7"), ("1 2", "1")):
        with pytest.raises(AssertionError):
            same_text(one, other)


def archive(**texts: str) -> bytes:
    """Archive of texts by name."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as files:
        for name, text in texts.items():
            files.writestr(name, text)
    return content.getvalue()


def test_files_agree_by_name_and_content_also_within_archives() -> None:
    same_files({"a.csv": "0.30000000000000004"}, {"a.csv": b"0.3"})
    same_files({"a.zip": archive(one="0.30000000000000004")}, {"a.zip": archive(one="0.3")})
    for one, other in (
        ({"a.csv": "0.3"}, {"b.csv": "0.3"}),
        ({"a.csv": "0.3"}, {"a.csv": "0.4"}),
        ({"a.zip": archive(one="0.3")}, {"a.zip": archive(one="0.4")}),
        ({"a.zip": archive(one="0.3")}, {"a.zip": archive(two="0.3")}),
    ):
        with pytest.raises(AssertionError):
            same_files(one, other)
