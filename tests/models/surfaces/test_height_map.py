"""Height maps: missing pixels, spacings and refused heights."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap

PATCH = HeightMap(height=np.array([[0.0, 1e-6, np.nan], [2e-6, 3e-6, 4e-6]]), spacing_x=1e-6, spacing_y=2e-6)


def test_missing_pixels_stay_missing() -> None:
    assert PATCH.missing_fraction == approx(1 / 6)
    assert not PATCH.measured[0, 2]


def test_columns_and_rows_keep_their_own_spacing() -> None:
    assert approx([0, 1e-6, 2e-6]) == PATCH.x
    assert approx([0, 2e-6]) == PATCH.y


@mark.parametrize(
    ("height", "message"),
    [
        (np.full((2, 2), np.nan), "must have a measured pixel, but all 4 are NaN"),
        (np.empty((0, 3)), "must have a measured pixel, but all 0 are NaN"),
        (np.array([[1.0, np.inf]]), "infinite"),
        (np.zeros(3), r"matrix of numbers, got shape \(3,\)"),
        (np.array([["a"]]), "matrix of numbers"),
    ],
)
def test_impossible_heights_are_refused(
    height: np.ndarray[tuple[int, ...], np.dtype[np.float64]], message: str
) -> None:
    with raises(InvalidInput, match=message):
        HeightMap(height=height, spacing_x=1e-6, spacing_y=1e-6)


def test_a_spacing_of_zero_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"spacing_y must be positive, got 0\.0 m"):
        HeightMap(height=np.zeros((2, 2)), spacing_x=1e-6, spacing_y=0.0)


def test_other_heights_must_keep_the_grid() -> None:
    with raises(InvalidInput, match=r"shape \(2, 3\), got \(3, 2\)"):
        PATCH.with_height(np.zeros((3, 2)))
