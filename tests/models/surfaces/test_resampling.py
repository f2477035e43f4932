"""Block means against brute force, sections of analytic surfaces against closed forms."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap
from sonolube.models.surfaces.resampling import block_means, line_section


def scan(height: np.ndarray, *, spacing_x: float = 2e-6, spacing_y: float = 2e-6) -> HeightMap:
    return HeightMap(height=height, spacing_x=spacing_x, spacing_y=spacing_y)


@given(
    rows=st.integers(1, 40), columns=st.integers(1, 40), most=st.integers(1, 12), seed=st.integers(0, 10),
    spacing_y=st.sampled_from([1e-6, 2e-6, 7e-6]),
)  # fmt: skip
def test_cells_are_the_means_of_their_measured_pixels(
    rows: int, columns: int, most: int, seed: int, spacing_y: float
) -> None:
    rng = np.random.default_rng(seed)
    height = np.where(rng.random((rows, columns)) < 0.3, np.nan, rng.standard_normal((rows, columns)))
    height[0, 0] = 1.0
    found = block_means(scan(height, spacing_y=spacing_y), most=most)
    (wide, high), (cells_y, cells_x) = found.size, found.height.shape
    assert max(cells_x, cells_y) <= most
    assert (found.x.size, found.y.size) == (cells_x, cells_y) == (-(-columns // wide), -(-rows // high))
    for row in range(cells_y):
        for column in range(cells_x):
            block = height[row * high : (row + 1) * high, column * wide : (column + 1) * wide]
            known = [value for value in block.ravel() if value == value]
            expected = sum(known) / len(known) if known else np.nan
            assert found.height[row, column] == pytest.approx(expected, abs=1e-12, nan_ok=True)
            first, last = column * wide, min((column + 1) * wide, columns) - 1
            assert found.x[column] == pytest.approx(2e-6 * (first + last) / 2, abs=1e-18)
            first, last = row * high, min((row + 1) * high, rows) - 1
            assert found.y[row] == pytest.approx(spacing_y * (first + last) / 2, abs=1e-18)


def test_blocks_of_a_map_with_uneven_spacings_are_as_nearly_square_as_they_can_be() -> None:
    found = block_means(scan(np.zeros((100, 1000)), spacing_x=1e-6, spacing_y=5e-6), most=100)
    assert found.size == (10, 2)


@given(
    ends=st.tuples(*[st.floats(0, 1)] * 4), slopes=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
)  # fmt: skip
def test_a_section_of_a_plane_is_a_straight_line(
    ends: tuple[float, float, float, float], slopes: tuple[float, float]
) -> None:
    x, y = 2e-6 * np.arange(50), 3e-6 * np.arange(30)
    surface = scan(slopes[0] * x + slopes[1] * y[:, None], spacing_y=3e-6)
    start, end = ((share_x * x[-1], share_y * y[-1]) for share_x, share_y in (ends[:2], ends[2:]))
    length = np.hypot(end[0] - start[0], end[1] - start[1])
    if length == 0:
        return
    found = line_section(surface, start=start, end=end)
    from_start = np.dot(slopes, start)
    rise = np.dot(slopes, end) - from_start
    assert found.distance[[0, -1]] == pytest.approx([0, length])
    assert np.diff(found.distance).max() <= 2e-6 * (1 + 1e-9)
    assert found.height == pytest.approx(from_start + rise * found.distance / length, abs=1e-15)


@pytest.mark.parametrize("angle", [0.0, 20.0, -35.0])
def test_a_section_across_a_cylinder_is_an_ellipse(angle: float) -> None:
    # a cylinder of radius R along y, cut at an angle to x: the section is its arc stretched by 1/cos
    radius, spacing = 500e-6, 1e-6
    x = spacing * np.arange(401)
    surface = scan(
        np.tile(-np.sqrt(radius**2 - (x - x.mean()) ** 2), (401, 1)), spacing_x=spacing, spacing_y=spacing
    )  # fmt: skip
    reach = 190e-6 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    middle = np.array([x.mean(), 200e-6])
    found = line_section(surface, start=tuple(middle - reach), end=tuple(middle + reach))
    across = (found.distance - found.distance[-1] / 2) * np.cos(np.radians(angle))
    sagitta = spacing**2 / (8 * radius)  # of the chord between two pixels, with the greatest slope 1.1 there
    assert found.height == pytest.approx(-np.sqrt(radius**2 - across**2), abs=1.5 * sagitta)


def test_pixels_at_their_centres_are_read_as_they_are_and_missing_ones_only_where_they_count() -> None:
    height = np.arange(12.0).reshape(3, 4)
    height[1, 2] = np.nan
    surface = scan(height)
    row = line_section(surface, start=(0.0, 2e-6), end=(6e-6, 2e-6))
    np.testing.assert_allclose(row.height, height[1])
    assert np.isfinite(line_section(surface, start=(0.0, 0.0), end=(6e-6, 0.0)).height).all()
    between = line_section(surface, start=(0.0, 1e-6), end=(6e-6, 1e-6))
    np.testing.assert_array_equal(np.isnan(between.height), [False, False, True, False])


def test_a_profile_has_a_section_along_itself() -> None:
    found = line_section(scan(np.arange(5.0)[None, :]), start=(0.0, 0.0), end=(8e-6, 0.0))
    np.testing.assert_allclose(found.height, np.arange(5.0))


@pytest.mark.parametrize(
    ("start", "end", "reason"),
    [
        ((-2e-6, 0.0), (4e-6, 0.0), r"x = -2 um is outside the field, -1 um to 7 um"),
        ((0.0, 0.0), (4e-6, 6e-6), r"y = 6 um is outside the field, -1 um to 5 um"),
        ((0.0, 0.0), (float("nan"), 0.0), r"x = nan um is outside"),
        ((1e-6, 1e-6), (1e-6, 1e-6), r"both ends are the same point"),
    ],
)
def test_a_section_beyond_the_field_is_refused(
    start: tuple[float, float], end: tuple[float, float], reason: str
) -> None:
    with pytest.raises(InvalidInput, match=reason):
        line_section(scan(np.zeros((3, 4))), start=start, end=end)
