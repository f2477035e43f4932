"""XYZ text: points in any order restored to their grid, and refusals of what forms none."""

import io
from pathlib import Path

import numpy as np
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from pytest import approx, mark, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import SurfaceReading, read_surface_file
from sonolube.measurement.surface_files.xyz import XyzText, even_profile, grid_index


def read(text: str) -> SurfaceReading:
    return XyzText().read(io.BytesIO(text.encode()), Path("plate.xyz"))


@settings(deadline=None)
@given(
    height=arrays(np.float64, (3, 4), elements=st.floats(-1e3, 1e3)),
    order=st.permutations(range(12)),
    missing=st.integers(0, 11),
    origin=st.floats(-1e4, 1e4),
)
def test_points_in_any_order_give_the_map_they_were_written_from(
    height: Floats, order: list[int], missing: int, origin: float
) -> None:
    y, x = np.divmod(np.arange(12), 4)
    points = [(origin + 0.1967 * x[i], -origin + 0.55 * y[i], height.flat[i]) for i in order if i != missing]
    found = read("\n".join(f"{a:.9f} {b:.9f} {z:.17g}" for a, b, z in points))
    expected = height.copy()
    expected.flat[missing] = np.nan
    np.testing.assert_array_equal(found.height, expected)
    assert found.spacing_x == approx(0.1967, rel=1e-6)
    assert found.spacing_y == approx(0.55, rel=1e-6)


def test_rounded_positions_share_one_spacing() -> None:
    x = 0.196733 * np.arange(1000)
    found = read("\n".join(f"{a:.2f};{b};1" for b in (0, 1) for a in x))
    assert found.height.shape == (2, 1000)
    assert found.spacing_x == approx(0.196733, rel=1e-4)


@mark.parametrize("separator", [" ", "\t", ",", ";", ", ", "  "])
def test_every_usual_separator_is_read(separator: str) -> None:
    text = "\n".join(separator.join(point) for point in (("0", "0", "1"), ("1", "0", "2"), ("0", "1", "3")))
    np.testing.assert_array_equal(read(text).height, [[1, 2], [3, np.nan]])


def test_headers_and_comments_are_skipped_and_missing_heights_are_nan() -> None:
    text = "X [um]\tY [um]\tZ [um]\n# by hand\n0 0 1\n\n1 0 No Data\n0 1 Bad\n1 1 nan\n2 0 5e-1\n2 1 4\n"
    np.testing.assert_array_equal(read(text).height, [[1, np.nan, 0.5], [np.nan, np.nan, 4]])


@mark.parametrize(
    ("text", "said"),
    [
        ("", "byte 0: the file is empty"),
        ("hello\n", "byte 6: no point x y z found"),
        ("0 0 1\n1 0 2\n0 1\n", r"byte 12: a point has three numbers, x y z: '0 1\\n'"),
        ("0 0 1\n1 0 inf\n", "byte 6: a point has finite coordinates"),
        ("0 0 1\n1 0 1,5\n", "byte 6: a point has three numbers"),
        ("0 0 nan\n1 0 nan\n1 1 nan\n0 1 nan", "none of the 4 points has a height"),
        ("0 0 1\n0 0 1\n", "points of one position make no profile"),
        ("0 0 1\n1 0 1\n1 0 2\n", "more than one point at 1 along the profile"),
        ("0 0 1\n1 0 1\n1 1 1\n1 0 2\n", "more than one point at x = 1, y = 0"),
        ("0 0 1\n1 0 1\n2.4 1 1\n7.7 1 1\n", "lies off the grid of spacing"),
        ("\n".join(f"{i} {i} 1" for i in range(100)), "100 points fill too little of a 100 x 100 grid"),
        ("0" * 5000, "byte 0: a point has three numbers"),
        ("word\n" * 100, "byte 320: a point has three numbers"),
    ],
)
def test_points_that_form_no_grid_are_refused(text: str, said: str) -> None:
    with raises(InvalidInput, match=said) as refused:
        read(text)
    assert str(refused.value).startswith("plate.xyz: ")


def test_extreme_positions_are_refused_without_allocation() -> None:
    with raises(InvalidInput):
        read("0 0 1\n1e-300 0 1\n1e300 1 1\n-1e300 2 1\n")


@mark.parametrize("axis", ["x", "y"])
@mark.parametrize("value", ["1e300", "-1e300", "20000"])
def test_one_position_far_from_all_others_is_named(axis: str, value: str) -> None:
    points = [[str(x), str(y), "0.1"] for y in range(4) for x in range(4)]
    points[6]["xy".index(axis)] = value
    with raises(InvalidInput, match=rf"plate\.xyz: {axis} = \S+ lies far from all other points") as refused:
        read("\n".join(" ".join(point) for point in points))
    assert f"{axis} = {float(value):g} lies" in str(refused.value)


def test_a_spacing_of_many_kilometres_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "wide.xyz"
    path.write_text("\n".join(f"{x}e300 {y} 0.1" for y in range(4) for x in range(4)))
    with raises(InvalidInput, match=r"wide\.xyz: spacing must not exceed 1e\+06 m, got 1e\+294 m; check its unit"):
        read_surface_file(path, length_unit="um")


def test_a_grid_is_restored_with_its_missing_lines() -> None:
    index, spacing = grid_index(np.array([9.0, 3.0, 5.0, 3.0 + 1e-9, 9.0]), axis="x")
    assert index.tolist() == [3, 0, 1, 0, 3]
    assert spacing == approx(2.0)
    assert grid_index(np.array([0.0, 1.0, 2.08, 3.0]), axis="x")[0].tolist() == [0, 1, 2, 3]
    with raises(InvalidInput, match=r"y = 2\.12 lies off the grid of spacing 1 of its neighbours"):
        grid_index(np.array([0.0, 1.0, 2.12, 3.0]), axis="y")
    with raises(InvalidInput, match="points of one x make no surface"):
        grid_index(np.array([4.0, 4.0]), axis="x")


def test_an_even_profile_keeps_its_heights_in_the_order_of_its_positions() -> None:
    height, spacing, notes = even_profile(np.array([4.0, 0.0, 2.05]), np.array([7.0, 5.0, np.nan]))
    np.testing.assert_array_equal(height, [[5.0, np.nan, 7.0]])
    assert (spacing, notes) == (2.0, ())


def test_a_profile_that_lacks_up_to_a_tenth_of_its_points_has_gaps() -> None:
    x = np.delete(np.arange(21.0), [4, 9])  # 19 of 21
    height, spacing, notes = even_profile(x, x**2)
    assert height.shape == (1, 21)
    assert np.flatnonzero(np.isnan(height[0])).tolist() == [4, 9]
    assert height[0, 20] == 400.0
    assert spacing == approx(1.0)
    assert notes == ()
    fewer = np.delete(np.arange(21.0), [4, 9, 14])  # 18 of 21
    height, spacing, notes = even_profile(fewer, 3 * fewer)
    assert height[0] == approx(3 * np.linspace(0, 20, 18))
    assert spacing == approx(20 / 17)
    assert notes == ("steps are uneven, 0.85 to 1.7 of their mean: heights interpolated at even steps",)


def test_a_profile_without_length_or_heights_is_refused() -> None:
    with raises(InvalidInput, match="points of one position make no profile"):
        even_profile(np.array([1.0]), np.array([2.0]))
    with raises(InvalidInput, match="none of the 2 points has a height"):
        even_profile(np.array([1.0, 2.0]), np.array([np.nan, np.nan]))
    with raises(InvalidInput, match="too few of the points have a height to interpolate"):
        even_profile(np.array([0.0, 1.0, 5.3, 9.0]), np.array([np.nan, 1.0, np.nan, np.nan]))


def test_a_position_is_remote_beyond_a_thousand_extents_of_the_others() -> None:
    points = [f"{x} {y} 1" for x in (0, 1, 1000.9) for y in (0, 1)]
    with raises(InvalidInput, match="fill too little of a 1002 x 2 grid"):
        read("\n".join(points))
    with raises(InvalidInput, match=r"x = 1001\.5 lies far from all other points"):
        read("\n".join(f"{x} {y} 1" for x in (0, 1, 1001.5) for y in (0, 1)))
    with raises(InvalidInput, match="x = -1001 lies far"):
        read("\n".join(f"{x} {y} 1" for x in (0, 1, -1001) for y in (0, 1)))


def test_a_grid_is_filled_by_a_twentieth_at_least() -> None:
    diagonal = [f"{i} {i} 1" for i in range(20)]
    found = read("\n".join(diagonal))  # 20 of 400
    assert found.height.shape == (20, 20)
    assert not found.states_unit
    with raises(InvalidInput, match="21 points fill too little of a 21 x 21 grid"):
        read("\n".join([*diagonal, "20 20 1"]))


def test_points_along_y_are_a_profile_too() -> None:
    found = read("3 0 7\n3 2 8\n3 4 9\n")
    np.testing.assert_array_equal(found.height, [[7, 8, 9]])
    assert (found.spacing_x, found.spacing_y) == (2.0, 2.0)
    two = read("0 5\n1 6\n")
    np.testing.assert_array_equal(two.height, [[5, 6]])


@mark.parametrize(
    ("head", "known"),
    [
        (b"header\n0 0 1\n1 0 2\n2 0 3\n", True),
        (b"a\n0 1\n1 2\n2 3\n", True),
        (b"0 0 1\n1 0 2\n2 0 3\n", False),  # three lines may be anything
        (b"a\n0 0 1\n1 0\n2 0 3\n", False),
        (b"a\nb\nc\nd\n", False),
        (b"a\n0 0 1\n1 0 2\n2 0 \0\n", False),
        (b"# Width: 12.34 um\n0 0 1\n1 0 2\n2 0 3\n", False),  # a unit that another reader knows
    ],
)
def test_a_text_is_known_by_its_last_lines(head: bytes, known: bool) -> None:
    assert XyzText().recognises(head, Path("plate.txt")) == known
