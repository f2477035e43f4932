"""Tracks of a field: how many, in which order, and what is none."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove, SeveralGrooves
from sonolube.models.surfaces import HeightMap, measure_groove

PIXEL = 10e-6
Y, X = ((n - n.mean()) * PIXEL for n in np.mgrid[:180, :240].astype(float))
ACROSS, ALONG = Y * np.cos(0.3) - X * np.sin(0.3), X * np.cos(0.3) + Y * np.sin(0.3)


def parabola(distance: Floats, width: float, depth: float) -> Floats:
    return np.asarray(depth * np.maximum(0.0, 1 - (2 * distance / width) ** 2))


def scan(*depths: Floats) -> HeightMap:
    noise = 0.3e-6 * np.random.default_rng(3).standard_normal(X.shape)
    return HeightMap(height=noise - np.sum(depths, axis=0), spacing_x=PIXEL, spacing_y=PIXEL)


DEEP, SHALLOW = parabola(ACROSS - 0.4e-3, 0.4e-3, 10e-6), parabola(ACROSS + 0.3e-3, 0.3e-3, 8e-6)


def test_two_tracks_are_listed_and_not_measured_as_one() -> None:
    with raises(SeveralGrooves, match=r"2 wear tracks in the field: 1 at .* wide, 8 um deep; 2 at .* 10 um deep"):
        measure_groove(scan(DEEP, SHALLOW))


@mark.parametrize(("number", "depth", "width"), [(1, SHALLOW, 0.3e-3), (2, DEEP, 0.4e-3)])
def test_each_of_two_tracks_is_measured_by_its_number(number: int, depth: Floats, width: float) -> None:
    groove = measure_groove(scan(DEEP, SHALLOW), track_number=number)
    assert groove.track_count == 2
    assert groove.groove_width == approx(width, rel=0.01)
    assert groove.wear_volume == approx(float(depth.sum()) * PIXEL**2, rel=0.01)


def test_a_number_beyond_the_tracks_is_refused() -> None:
    with raises(InvalidInput, match="track_number must be 1 to 1, got 2: one wear track in the field"):
        measure_groove(scan(DEEP), track_number=2)


@mark.parametrize(
    ("feature", "what"),
    [
        (parabola(ACROSS, 0.03e-3, 5e-6), "is a scratch, or too narrow for this field"),
        (parabola(ACROSS, 0.2e-3, 15e-6) * (np.abs(ALONG) < 0.5e-3), "mm long, where a track crosses the field"),
        (parabola(np.hypot(X, Y), 0.5e-3, 25e-6), "mm long, where a track crosses the field"),
    ],
    ids=["narrow scratch", "short scratch", "pit"],
)
def test_scratches_and_pits_are_no_grooves(feature: Floats, what: str) -> None:
    with raises(NoGroove, match=what):
        measure_groove(scan(feature))


def test_a_scratch_beside_a_track_does_not_change_it() -> None:
    scratch = parabola(Y + 0.6e-3, 0.03e-3, 5e-6) * (np.abs(X) < 0.4e-3)
    track = parabola(ACROSS, 0.4e-3, 15e-6)
    groove = measure_groove(scan(track, scratch))
    assert groove.track_count == 1
    low, high = groove.wear_volume_interval
    assert low <= float(track.sum()) * PIXEL**2 <= high
    assert groove.groove_width == approx(0.4e-3, rel=0.01)


def test_a_few_spurious_pixels_where_a_track_was_not_measured_do_not_make_it_short() -> None:
    track = scan(parabola(ACROSS, 0.4e-3, 15e-6)).height
    unmeasured = (np.abs(ACROSS) < 0.25e-3) & (np.abs(ALONG) > 0.55e-3)
    spurious = np.random.default_rng(1).random(X.shape) < 0.01
    height = np.where(unmeasured, np.where(spurious, 0.0, np.nan), track)
    groove = measure_groove(HeightMap(height=height, spacing_x=PIXEL, spacing_y=PIXEL))
    assert groove.track_count == 1
    assert groove.groove_width == approx(0.4e-3, rel=0.02)


def test_an_even_floor_has_no_marks_and_says_how_probable_its_peak_is() -> None:
    from sonolube.models.surfaces import track_marks

    marks = track_marks(measure_groove(scan(DEEP)))
    assert marks.dot_spacing is None
    assert marks.false_alarm_probability > 0.01
    assert marks.reason.startswith("no periodic marks found (largest peak")
