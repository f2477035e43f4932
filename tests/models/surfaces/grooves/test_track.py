"""Tracks, lines and arcs through a field, and curvilinear coordinates about them."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx

from sonolube.models.surfaces import GrooveTrack, HeightMap

FIELD = HeightMap(height=np.zeros((31, 41)), spacing_x=20e-6, spacing_y=30e-6)
tracks = st.builds(
    GrooveTrack,
    track_direction=st.floats(0, math.pi),
    track_curvature=st.sampled_from([0.0, 1e-9, 17.0, -40.0, 500.0]),
    track_offset=st.floats(-3e-4, 3e-4),
)


@given(track=tracks)
def test_the_pixel_position_inverts_the_curvilinear_coordinates(track: GrooveTrack) -> None:
    row, column = track.pixel_position(FIELD, *track.curvilinear_coordinates(FIELD))
    rows, columns = np.indices(FIELD.height.shape)
    assert row == approx(rows, abs=1e-7)
    assert column == approx(columns, abs=1e-7)


def test_the_transverse_distance_is_the_radius_less_the_distance_to_the_centre() -> None:
    track = GrooveTrack(track_direction=0.0, track_curvature=1 / 2e-3, track_offset=0.3e-3)
    transverse, _ = track.curvilinear_coordinates(FIELD)
    x, y = FIELD.x - FIELD.x[-1] / 2, FIELD.y - FIELD.y[-1] / 2
    to_centre = np.hypot(x[None, :], y[:, None] - 2e-3)  # the centre lies to the left of the direction
    assert transverse == approx(1.7e-3 - to_centre, abs=1e-15)
    assert track.groove_diameter == approx(3.4e-3)


def test_the_arc_length_is_the_angle_times_the_radius() -> None:
    track = GrooveTrack(track_direction=0.0, track_curvature=1 / 2e-3, track_offset=0.3e-3)
    _, arc_length = track.curvilinear_coordinates(FIELD)
    x, y = FIELD.x - FIELD.x[-1] / 2, FIELD.y - FIELD.y[-1] / 2
    assert arc_length == approx(1.7e-3 * np.arctan2(x[None, :], 2e-3 - y[:, None]), abs=1e-15)


def test_a_straight_track_has_an_infinite_diameter() -> None:
    track = GrooveTrack(track_direction=1.0, track_curvature=0.0, track_offset=0.0)
    assert track.groove_diameter == math.inf
