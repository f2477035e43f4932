"""Paths of surface points against orbits drawn point by point."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.fem import trajectory_ellipse

sizes = st.floats(0.05, 20.0)
angles = st.floats(-3.1, 3.1)


def orbit(u: complex, v: complex, samples: int = 20_000) -> np.ndarray:
    turn = np.exp(1j * np.linspace(0, 2 * np.pi, samples, endpoint=False))
    return np.stack([(u * turn).real, (v * turn).real])


@given(a=sizes, b=sizes, one=angles, other=angles)
def test_half_axes_are_the_largest_and_smallest_distance_of_the_orbit(
    a: float, b: float, one: float, other: float
) -> None:
    u, v = a * np.exp(1j * one), b * np.exp(1j * other)
    path = trajectory_ellipse(axial_displacement=u, normal_displacement=v)
    radius = np.hypot(*orbit(u, v))
    assert path.major_semi_axis == approx(radius.max(), rel=1e-6)
    assert abs(path.minor_semi_axis) == approx(radius.min(), rel=1e-6, abs=1e-3 * radius.max())


@given(a=sizes, b=sizes, one=angles, other=angles)
def test_the_sign_of_the_short_axis_is_that_of_the_area_swept(a: float, b: float, one: float, other: float) -> None:
    u, v = a * np.exp(1j * one), b * np.exp(1j * other)
    x, y = orbit(u, v)
    swept = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    path = trajectory_ellipse(axial_displacement=u, normal_displacement=v)
    assert np.pi * path.major_semi_axis * path.minor_semi_axis == approx(swept, rel=1e-6, abs=1e-9)


@given(a=sizes, b=sizes, lag=st.floats(0.2, 1.3))
def test_the_long_axis_points_where_the_orbit_reaches_farthest(a: float, b: float, lag: float) -> None:
    u, v = complex(a), b * np.exp(-1j * lag)
    x, y = orbit(u, v)
    far = int(np.argmax(np.hypot(x, y)))
    path = trajectory_ellipse(axial_displacement=u, normal_displacement=v)
    turned = float(path.inclination) - np.arctan2(y[far], x[far])
    assert abs(np.sin(turned)) < 5e-3
    assert path.phase == approx(lag)


def test_motions_in_step_run_on_a_straight_line() -> None:
    path = trajectory_ellipse(axial_displacement=[3.0, 3.0j], normal_displacement=[4.0, -4.0j])
    assert path.minor_semi_axis == approx([0.0, 0.0], abs=1e-12)
    assert path.major_semi_axis == approx([5.0, 5.0])
    assert path.inclination == approx([np.arctan2(4, 3), -np.arctan2(4, 3)])


def test_an_infinite_displacement_is_refused() -> None:
    with raises(InvalidInput, match="normal_displacement must be finite"):
        trajectory_ellipse(axial_displacement=1.0, normal_displacement=np.inf)
