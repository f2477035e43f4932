"""Wear of tracks and its reduction: geometry, Student's interval by hand, and coverage."""

import math
from dataclasses import replace

import numpy as np
from pytest import approx, fixture, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.wear_track import (
    WearTrack,
    measure_wear_track,
    wear_reduction_between_tracks,
    wear_track_from_grooves,
)
from sonolube.models.surfaces import (
    Groove,
    GrooveShape,
    GrooveTrack,
    HeightMap,
    ScannedField,
    measure_groove,
    synthetic_groove,
)

FIELD = ScannedField(field_shape=(240, 320), spacing_x=7.5e-6, spacing_y=7.5e-6)
SHAPE = GrooveShape(groove_width=0.7e-3, groove_depth=75e-6)
DIAMETER, DISTANCE = 58.2e-3, 292.5  # D Table 2.2


def scan(seed: int, depth: float = 75e-6) -> HeightMap:
    track = GrooveTrack(track_direction=0.1 * seed, track_curvature=2 / DIAMETER, track_offset=0.0)
    shape = GrooveShape(groove_width=0.7e-3, groove_depth=depth)
    return synthetic_groove(shape, track=track, seed=seed, field=FIELD).scan


@fixture(scope="module")
def groove() -> Groove:
    return measure_groove(scan(0))


def worn(groove: Groove, areas: list[float]) -> WearTrack:
    grooves = [replace(groove, cross_section_area=area) for area in areas]
    return wear_track_from_grooves(grooves, groove_diameter=DIAMETER, sliding_distance=DISTANCE)


def test_scans_around_a_track_give_its_volume() -> None:
    found = measure_wear_track((scan(seed) for seed in range(4)), groove_diameter=DIAMETER, sliding_distance=DISTANCE)
    volume = math.pi * DIAMETER * SHAPE.cross_section_area
    assert found.wear_volume == approx(volume, rel=1e-3)
    assert found.wear_rate == approx(volume / DISTANCE, rel=1e-3)  # 2.2e-11 m2, as D Table 2.5
    assert found.excluded_scans == ()


def test_a_scan_without_groove_is_excluded_with_its_reason() -> None:
    scans = [scan(0), scan(1, depth=1e-15), scan(2)]
    found = measure_wear_track(scans, groove_diameter=DIAMETER, sliding_distance=DISTANCE)
    assert found.cross_section_area.size == 2
    assert found.excluded_scans[0].startswith("scan 2: no groove found")


def test_the_confidence_interval_is_students_by_hand(groove: Groove) -> None:
    found = worn(groove, [3e-8, 4e-8, 5e-8])
    around = math.pi * DIAMETER
    assert found.wear_volume == approx(4e-8 * around)
    assert found.wear_volume_uncertainty == approx(1e-8 / math.sqrt(3) * around)
    half = 4.302653 * 1e-8 / math.sqrt(3) * around  # t of 2 degrees of freedom
    assert found.wear_volume_interval == approx((4e-8 * around - half, 4e-8 * around + half))


def test_a_single_scan_is_refused(groove: Groove) -> None:
    with raises(InvalidInput, match="a wear track needs two scans with a whole groove, got 1"):
        worn(groove, [3e-8])
    cut = replace(groove, complete=False, caveat="cut")
    with raises(InvalidInput, match=r"got 1 \(scan 2: cut\)"):
        wear_track_from_grooves([groove, cut], groove_diameter=DIAMETER, sliding_distance=DISTANCE)


def test_the_reduction_is_that_of_the_mean_rates(groove: Groove) -> None:
    without, with_vibration = (worn(groove, [4e-8, 4.1e-8, 3.9e-8]), worn(groove, [2e-8, 2.1e-8, 1.9e-8]))
    found = wear_reduction_between_tracks([without], [with_vibration])
    assert found.wear_reduction == approx(0.5)
    assert found.wear_reduction_uncertainty == approx(0.5 * math.hypot(0.1 / 4, 0.1 / 2) / math.sqrt(3), rel=1e-6)
    assert not found.between_specimens
    assert found.interval[0] < 0.5 < found.interval[1]


def test_the_interval_of_the_reduction_has_its_nominal_coverage(groove: Groove) -> None:
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(400):
        off, on = (
            [worn(groove, list(mean * rng.normal(1, 0.05, 2) + 0 * mean)) for _ in range(3)] for mean in (4e-8, 2e-8)
        )
        found = wear_reduction_between_tracks(off, on)
        assert found.between_specimens
        covered += found.interval[0] <= 0.5 <= found.interval[1]
    assert 0.92 <= covered / 400 <= 0.99


def test_a_reduction_without_tracks_of_both_kinds_is_refused(groove: Groove) -> None:
    with raises(InvalidInput, match="a track worn without vibration and one worn with it"):
        wear_reduction_between_tracks([], [worn(groove, [1e-8, 2e-8])])
