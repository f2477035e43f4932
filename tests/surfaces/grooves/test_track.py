"""Tracks: lines and arcs through a field, and positions beside and along them."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from sonolube.surfaces import GrooveTrack, HeightMap

FIELD = HeightMap(height=np.zeros((31, 41)), spacing_x=20e-6, spacing_y=30e-6)
tracks = st.builds(
    GrooveTrack,
    track_direction=st.floats(0, math.pi),
    track_curvature=st.sampled_from([0.0, 1e-9, 17.0, -40.0, 500.0]),
    track_offset=st.floats(-3e-4, 3e-4),
)


@given(track=tracks)
def test_a_pixel_is_found_again_from_where_it_lies_beside_and_along_the_track(track: GrooveTrack) -> None:
    row, column = track.place(FIELD, *track.curvilinear_coordinates(FIELD))
    rows, columns = np.indices(FIELD.height.shape)
    assert row == approx(rows, abs=1e-7)
    assert column == approx(columns, abs=1e-7)


def test_pixels_lie_as_far_from_an_arc_as_from_its_centre_less_the_radius() -> None:
    track = GrooveTrack(track_direction=0.0, track_curvature=1 / 2e-3, track_offset=0.3e-3)
    across, _ = track.curvilinear_coordinates(FIELD)
    x, y = FIELD.x - FIELD.x[-1] / 2, FIELD.y - FIELD.y[-1] / 2
    to_centre = np.hypot(x[None, :], y[:, None] - 2e-3)  # the centre lies to the left of the direction
    assert across == approx(1.7e-3 - to_centre, abs=1e-15)
    assert track.groove_diameter == approx(3.4e-3)


def test_length_along_an_arc_is_its_angle_times_the_radius() -> None:
    track = GrooveTrack(track_direction=0.0, track_curvature=1 / 2e-3, track_offset=0.3e-3)
    _, along = track.curvilinear_coordinates(FIELD)
    x, y = FIELD.x - FIELD.x[-1] / 2, FIELD.y - FIELD.y[-1] / 2
    assert along == approx(1.7e-3 * np.arctan2(x[None, :], 2e-3 - y[:, None]), abs=1e-15)


def test_a_straight_track_is_an_arc_of_no_finite_diameter() -> None:
    track = GrooveTrack(track_direction=1.0, track_curvature=0.0, track_offset=0.0)
    assert track.groove_diameter == math.inf
