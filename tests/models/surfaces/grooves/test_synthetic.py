"""Synthetic scans have the volumes, form and roughness that were specified."""

import math

import numpy as np
from pytest import approx, mark, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import GrooveShape, GrooveTrack, ScannedField, disc_volume_loss, synthetic_groove

STRAIGHT = GrooveTrack(track_direction=0.0, track_curvature=0.0, track_offset=0.1e-3)
SHAPE = GrooveShape(groove_width=0.8e-3, groove_depth=60e-6, pile_up_height=5e-6, pile_up_width=0.1e-3)


def test_a_straight_groove_has_the_volume_of_its_section_times_the_length_of_the_field() -> None:
    made = synthetic_groove(SHAPE, track=STRAIGHT, seed=0)
    radius = (0.4e-3**2 + 60e-6**2) / (2 * 60e-6)
    angle = 2 * math.asin(0.4e-3 / radius)
    segment = radius**2 / 2 * (angle - math.sin(angle))  # of a circle
    assert SHAPE.cross_section_area == approx(segment, rel=1e-10)
    assert made.wear_volume == approx(segment * 2.4e-3, rel=1e-4)
    assert made.pile_up_volume == approx(2 * 2 / 3 * 5e-6 * 0.1e-3 * 2.4e-3, rel=1e-3)  # two parabolas


def test_a_ring_of_the_section_has_the_disc_volume_loss_of_the_standard() -> None:
    ball = (0.4e-3**2 + 60e-6**2) / (2 * 60e-6)
    ring = disc_volume_loss(groove_diameter=58.2e-3, groove_width=0.8e-3, tip_radius=ball)
    assert math.pi * 58.2e-3 * SHAPE.cross_section_area == approx(float(ring), rel=1e-10)


def test_the_scan_is_the_unworn_surface_less_the_depth() -> None:
    field = ScannedField(rms_height=0.0, missing_fraction=0.0)
    made = synthetic_groove(SHAPE, track=STRAIGHT, seed=4, field=field)
    pixel = field.spacing_x * field.spacing_y
    gone = float(np.sum(made.unworn.height - made.scan.height)) * pixel
    assert gone == approx(made.wear_volume - made.pile_up_volume)


def test_the_field_has_the_specified_tilt_waviness_roughness_and_missing_pixels() -> None:
    bare = GrooveShape(groove_width=1e-4, groove_depth=1e-15)
    tilted = synthetic_groove(bare, track=STRAIGHT, seed=1, field=ScannedField(waviness_amplitude=0.0, rms_height=0.0))
    assert np.ptp(tilted.unworn.height) == approx(5e-6)
    assert tilted.scan.missing_fraction == approx(0.05, abs=0.005)
    wavy = synthetic_groove(bare, track=STRAIGHT, seed=1, field=ScannedField(tilt=0.0, rms_height=0.0))
    assert np.ptp(wavy.unworn.height) == approx(2e-6, rel=1e-3)
    rough = synthetic_groove(bare, track=STRAIGHT, seed=1, field=ScannedField(tilt=0.0, waviness_amplitude=0.0))
    assert np.nanstd(rough.scan.height) == approx(0.6e-6, rel=0.02)


def test_indentations_do_not_change_the_mean_depth() -> None:
    shape = GrooveShape(groove_width=0.8e-3, groove_depth=60e-6, indentation_spacing=0.3e-3, indentation_fraction=0.2)
    dented, even = (synthetic_groove(which, track=STRAIGHT, seed=0).wear_volume for which in (shape, SHAPE))
    assert dented == approx(even, rel=1e-6)


@mark.parametrize("seed", range(2))
def test_the_same_seed_gives_the_same_scan(seed: int) -> None:
    one, other = (synthetic_groove(SHAPE, track=STRAIGHT, seed=seed).scan.height for _ in range(2))
    same(one, other)


def test_a_groove_deeper_than_half_its_width_is_refused() -> None:
    with raises(InvalidInput, match="groove_depth must lie between 0 and"):
        GrooveShape(groove_width=1e-4, groove_depth=60e-6)
