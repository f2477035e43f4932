"""Periodic marks along synthetic tracks: their spacing, and none where there are none."""

import numpy as np
from pytest import approx, mark
from scipy import fft

from sonolube.facts.metrics import indentation_spacing
from sonolube.models.surfaces import (
    GrooveShape,
    GrooveTrack,
    HeightMap,
    ScannedField,
    measure_groove,
    synthetic_groove,
    track_marks,
)
from sonolube.models.surfaces.grooves.track_marks import _false_alarm

FIELD = ScannedField(field_shape=(240, 320), spacing_x=7.5e-6, spacing_y=7.5e-6)
TRACK = GrooveTrack(track_direction=0.3, track_curvature=1 / 29e-3, track_offset=0.0)


@mark.parametrize("speed", [20.3e-3, 40.6e-3, 87e-3])
def test_the_spacing_of_indentations_is_speed_times_period(speed: float) -> None:
    spacing = float(indentation_spacing(sliding_speed=speed, period=0.01))  # D 2.4: 0.203, 0.406, 0.87 mm
    shape = GrooveShape(groove_width=0.7e-3, groove_depth=60e-6, indentation_spacing=spacing, indentation_fraction=0.05)
    found = track_marks(measure_groove(synthetic_groove(shape, track=TRACK, seed=2, field=FIELD).scan))
    assert found.dot_spacing == approx(spacing, rel=0.01)
    assert found.dot_spacing_uncertainty is not None
    assert found.dot_spacing_uncertainty < 0.01 * spacing


def test_dots_of_the_vibration_are_found_where_pixels_resolve_them() -> None:
    field = ScannedField(
        field_shape=(240, 320),
        spacing_x=0.5e-6,
        spacing_y=0.5e-6,
        tilt=0.1e-6,
        waviness_amplitude=0.0,
        rms_height=0.02e-6,
    )
    shape = GrooveShape(
        groove_width=50e-6, groove_depth=2e-6, indentation_spacing=3.95e-6, indentation_fraction=0.05
    )  # 87 mm/s at 22 kHz
    track = GrooveTrack(track_direction=0.3, track_curvature=0.0, track_offset=0.0)
    found = track_marks(measure_groove(synthetic_groove(shape, track=track, seed=0, field=field).scan))
    assert found.dot_spacing == approx(3.95e-6, rel=0.005)


def test_the_spectral_density_over_the_peak_of_a_wave_is_half_the_square_of_its_amplitude() -> None:
    y, x = ((n - n.mean()) * 5e-6 for n in np.mgrid[:160, :300].astype(float))
    amplitude, floor = 0.4e-6, np.maximum(0.0, 1 - (y / 0.2e-3) ** 2)
    noise = 0.02e-6 * np.random.default_rng(0).standard_normal(x.shape)
    height = noise - 15e-6 * floor + amplitude * np.cos(2 * np.pi * x / 0.1e-3) * (floor > 0)
    found = track_marks(measure_groove(HeightMap(height=height, spacing_x=5e-6, spacing_y=5e-6)))
    assert found.dot_spacing == approx(0.1e-3, rel=1e-3)
    peak = np.abs(found.wavenumber - 1e4) < 2e3
    # waves of both signs, of which one is in the spectrum
    above = np.trapezoid(found.profile_spectral_density[peak], found.wavenumber[peak])
    assert 2 * above == approx(amplitude**2 / 2, rel=0.05)


def test_marks_are_sought_in_the_fraction_of_the_width_that_is_asked_for() -> None:
    y, x = ((n - n.mean()) * 5e-6 for n in np.mgrid[:120, :240].astype(float))
    floor, ribbon = np.maximum(0.0, 1 - (y / 0.2e-3) ** 2), np.abs(np.abs(y) - 0.105e-3) < 0.012e-3
    noise = 0.02e-6 * np.random.default_rng(0).standard_normal(x.shape)
    height = noise - 15e-6 * floor + 0.4e-6 * np.cos(2 * np.pi * x / 0.1e-3) * ribbon
    groove = measure_groove(HeightMap(height=height, spacing_x=5e-6, spacing_y=5e-6))
    wide, narrow = (track_marks(groove, width_fraction=fraction, averaged_points=4) for fraction in (0.6, 0.42))
    assert wide.dot_spacing == approx(0.1e-3, rel=2e-3)
    assert narrow.dot_spacing is None


def test_profiles_that_are_all_alike_count_as_one_in_the_probability_of_a_false_alarm() -> None:
    # white noise without marks: as many alarms below a probability as it says
    rng, points, tracks = np.random.default_rng(0), 500, 1200
    length, size = float(points), fft.next_fast_len(8 * points)
    window, k = np.hanning(points + 2)[1:-1], fft.rfftfreq(size)
    searched = (k >= 2 / length) & (k <= 0.4)
    alarms = []
    for _ in range(tracks):
        profile = rng.standard_normal(points) * window / np.linalg.norm(window)
        spectra = np.tile(fft.rfft(profile, size)[searched], (6, 1))
        power = np.abs(spectra[0]) ** 2
        alarms.append(_false_alarm(k[searched], power, spectra, 1 + int(np.argmax(power[1:-1])), length))
    assert np.mean(np.array(alarms) < 0.05) < 0.065


def test_an_even_groove_has_no_marks_and_the_result_a_reason() -> None:
    shape = GrooveShape(groove_width=0.7e-3, groove_depth=60e-6)
    for seed in range(4):
        found = track_marks(measure_groove(synthetic_groove(shape, track=TRACK, seed=seed, field=FIELD).scan))
        assert found.dot_spacing is None
        assert "no periodic marks found" in found.reason


def test_the_pixel_grid_under_a_slanting_track_makes_no_marks() -> None:
    # pi/2 - 1.5 between track and pixel columns: it crosses one every 3.75 um/sin(0.0708), 53 um
    for seed in (1, 7, 13, 19):
        track = GrooveTrack(track_direction=1.5, track_curvature=0.0, track_offset=1.5e-4)
        shape = GrooveShape(groove_width=0.9e-3, groove_depth=60e-6)
        assert track_marks(measure_groove(synthetic_groove(shape, track=track, seed=seed).scan)).dot_spacing is None
