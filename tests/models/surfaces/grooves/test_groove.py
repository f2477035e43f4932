"""Wear grooves of synthetic scans: detection, volumes against the exact ones, and scans without a groove."""

import math

import numpy as np
from pytest import approx, mark, raises
from scipy.ndimage import gaussian_filter

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    GrooveShape,
    GrooveTrack,
    HeightMap,
    ScannedField,
    SyntheticGroove,
    gaussian_surface,
    measure_groove,
    synthetic_groove,
)

FIELD = ScannedField(field_shape=(240, 320), spacing_x=7.5e-6, spacing_y=7.5e-6)
ARC = GrooveTrack(track_direction=0.7, track_curvature=1 / 29e-3, track_offset=0.1e-3)
RING_DIAMETERS = (25.2e-3, 25.4e-3, 34.3e-3, 58.2e-3, 60e-3, 66.04e-3)  # D 2.3 to 2.5


def published_size(seed: int, kind: str, field: ScannedField = FIELD) -> SyntheticGroove:
    rng = np.random.default_rng(seed)
    shape = GrooveShape(groove_width=rng.uniform(0.5e-3, 1.5e-3), groove_depth=rng.uniform(20e-6, 100e-6))
    bend = rng.choice([-1, 1]) * 2 / rng.choice(RING_DIAMETERS) if kind == "curved" else 0.0
    offset = rng.choice([-1, 1]) * rng.uniform(0.2e-3, 0.45e-3) if kind == "off-centre" else rng.uniform(-5e-5, 5e-5)
    track = GrooveTrack(track_direction=rng.uniform(0, math.pi), track_curvature=bend, track_offset=offset)
    return synthetic_groove(shape, track=track, seed=seed, field=field)


def synthetic(
    *, field: ScannedField = FIELD, seed: int = 1, track: GrooveTrack = ARC, **shape: float
) -> SyntheticGroove:
    return synthetic_groove(
        GrooveShape(**({"groove_width": 0.7e-3, "groove_depth": 40e-6} | shape)), track=track, seed=seed, field=field
    )


def test_a_parabolic_groove_is_measured_to_a_thousandth() -> None:
    rng = np.random.default_rng(5)
    x, y = np.meshgrid((np.arange(320) - 160) * 7.5e-6, (np.arange(240) - 120) * 7.5e-6)
    height = (
        4e-6 * x / 2.4e-3 + 1e-6 * np.sin(2 * np.pi * (x + 0.4 * y) / 1.1e-3) + 0.6e-6 * rng.standard_normal(x.shape)
    )
    height -= np.maximum(0.0, 50e-6 * (1 - ((y - 0.2e-3) / 0.4e-3) ** 2))  # a parabola 0.8 mm wide along the rows
    height[rng.random(x.shape) < 0.05] = np.nan
    groove = measure_groove(HeightMap(height=height, spacing_x=7.5e-6, spacing_y=7.5e-6))
    assert groove.wear_volume == approx(2 / 3 * 0.8e-3 * 50e-6 * 2.4e-3, rel=1e-3)
    assert groove.cross_section_area == approx(2 / 3 * 0.8e-3 * 50e-6, rel=1e-3)
    assert groove.groove_width == approx(0.8e-3, abs=2 * 7.5e-6)
    assert groove.groove_depth == approx(50e-6, abs=0.5e-6)
    assert groove.track_length == approx(2.4e-3, rel=0.02)
    assert groove.complete
    assert groove.caveat == ""


@mark.parametrize("kind", ["straight", "curved", "off-centre"])
def test_grooves_of_the_dissertations_size_are_all_found_and_measured_to_one_per_cent(kind: str) -> None:
    errors = []
    for seed in range(6):
        known = published_size(seed, kind)
        errors.append(abs(measure_groove(known.scan).wear_volume / known.wear_volume - 1))
    assert np.median(errors) < 0.002
    assert max(errors) < 0.01


def test_the_stated_uncertainty_covers_random_waviness() -> None:
    field = ScannedField(field_shape=(240, 320), spacing_x=7.5e-6, spacing_y=7.5e-6, waviness_amplitude=0.0)
    scores = []
    for seed in range(5):
        known = published_size(seed, "straight", field)
        waves = gaussian_surface(
            rms_height=1e-6,
            spectrum=GaussianCorrelationSpectrum(correlation_length=0.32e-3),
            shape=(480, 640),
            spacing_x=7.5e-6,
            spacing_y=7.5e-6,
            seed=seed,
        ).height[:240, :320]
        groove = measure_groove(known.scan.with_height(known.scan.height + waves))
        scores.append((groove.wear_volume - known.wear_volume) / groove.wear_volume_uncertainty)
    assert 0.4 < math.sqrt(np.mean(np.square(scores))) < 1.8


def test_the_diameter_of_the_track_follows_from_one_scan() -> None:
    known = synthetic(groove_depth=80e-6, field=ScannedField(rms_height=0.1e-6))
    assert measure_groove(known.scan).track.groove_diameter == approx(58e-3 - 0.2e-3, rel=0.03)


@mark.parametrize("height", [3e-6, 20e-6])
def test_ridges_are_separated_from_the_groove(height: float) -> None:
    known = synthetic(pile_up_height=height, pile_up_width=0.1e-3)
    groove = measure_groove(known.scan)
    assert groove.wear_volume == approx(known.wear_volume, rel=3e-3)
    assert groove.pile_up_volume == approx(known.pile_up_volume, rel=0.02)
    assert groove.net_volume == approx(known.wear_volume - known.pile_up_volume, rel=5e-3)


@mark.parametrize(("thickness", "missed"), [(10e-6, 0.25), (40e-6, 0.2)])  # of it, at the rim, by smoothing
def test_material_adhering_in_the_groove_counts_as_pile_up(thickness: float, missed: float) -> None:
    known = synthetic(groove_width=0.9e-3)
    transverse, arc_length = ARC.curvilinear_coordinates(known.scan)
    stuck = np.hypot(transverse - 0.1e-3, arc_length) < 0.1e-3
    height = np.where(stuck, known.unworn.height + thickness, known.scan.height)
    groove = measure_groove(known.scan.with_height(height))
    depth = np.maximum(0.0, known.unworn.height - known.scan.height)
    below_it = float(np.nansum(depth[stuck])) / 0.95 * 7.5e-6**2  # 5 % of the pixels are missing
    assert groove.pile_up_volume == approx(math.pi * 0.1e-3**2 * thickness, rel=missed, abs=0)
    assert groove.wear_volume == approx(known.wear_volume - below_it, rel=5e-3)


def test_indentations_are_not_taken_for_waviness() -> None:
    known = synthetic(indentation_spacing=0.4e-3, indentation_fraction=0.1)
    assert measure_groove(known.scan).wear_volume == approx(known.wear_volume, rel=3e-3)


def test_a_groove_cut_by_the_field_is_measured_inside_it_with_a_caveat() -> None:
    track = GrooveTrack(track_direction=0.05, track_curvature=0.0, track_offset=-0.9e-3)
    known = synthetic(groove_width=1.2e-3, groove_depth=60e-6, track=track)
    groove = measure_groove(known.scan)
    assert not groove.complete
    assert "an edge of the groove lies outside the field" in groove.caveat
    assert groove.wear_volume == approx(known.wear_volume, rel=5e-3)


def test_a_groove_across_a_corner_is_found() -> None:
    track = GrooveTrack(track_direction=0.8, track_curvature=0.0, track_offset=-0.9e-3)
    known = synthetic(groove_width=0.8e-3, groove_depth=60e-6, track=track)
    assert measure_groove(known.scan).wear_volume == approx(known.wear_volume, rel=5e-3)


def test_half_a_scan_represents_the_rest_with_a_caveat() -> None:
    known = synthetic()
    height = known.scan.height.copy()
    height[:, :125] = np.nan
    groove = measure_groove(known.scan.with_height(height))
    assert groove.wear_volume == approx(known.wear_volume, rel=5e-3)
    assert "of the groove was not measured" in groove.caveat


def test_debris_beside_the_groove_does_not_change_the_volume() -> None:
    known = synthetic()
    height = known.scan.height.copy()
    height[20:40, 250:270] += 30e-6
    assert measure_groove(known.scan.with_height(height)).wear_volume == approx(known.wear_volume, rel=3e-3)


def test_pixels_need_not_be_square() -> None:
    known = synthetic(field=ScannedField(field_shape=(240, 200), spacing_x=12e-6, spacing_y=7.5e-6))
    assert measure_groove(known.scan).wear_volume == approx(known.wear_volume, rel=3e-3)


def test_the_volume_does_not_depend_on_rotation_or_reflection_of_the_scan() -> None:
    known = synthetic()
    variants: list[Floats] = [known.scan.height.T, known.scan.height[::-1], known.scan.height[:, ::-1]]
    for height in variants:
        rotated = HeightMap(height=height, spacing_x=7.5e-6, spacing_y=7.5e-6)
        assert measure_groove(rotated).wear_volume == approx(known.wear_volume, rel=2e-3)


def test_a_shallow_groove_is_measured_within_its_uncertainty_or_refused() -> None:
    refused = 0
    for seed in range(6):
        known = synthetic(groove_depth=2e-6, seed=seed)
        try:
            groove = measure_groove(known.scan)
        except NoGroove:
            refused += 1
            continue
        assert abs(groove.wear_volume - known.wear_volume) < 4 * groove.wear_volume_uncertainty
    assert refused > 0  # 2 um among 1 um of waviness


def test_a_shallow_groove_in_a_flat_surface_is_measured() -> None:
    known = synthetic(groove_depth=2e-6, field=ScannedField(waviness_amplitude=0.0))
    groove = measure_groove(known.scan)
    assert groove.wear_volume == approx(known.wear_volume, abs=4 * groove.wear_volume_uncertainty)
    assert groove.wear_volume_uncertainty < 0.01 * groove.wear_volume


@mark.parametrize("waviness", [0.0, 1e-6, 10e-6])
def test_a_rough_wavy_plane_has_no_groove(waviness: float) -> None:
    field = ScannedField(field_shape=(240, 320), spacing_x=7.5e-6, spacing_y=7.5e-6, waviness_amplitude=waviness)
    for seed in range(5):
        with raises(NoGroove, match="no groove found"):
            measure_groove(synthetic(groove_depth=1e-15, field=field, seed=seed).scan)


@mark.parametrize("width", [2.2e-3, 3e-3, 6e-3])
def test_a_groove_that_fills_the_field_is_refused(width: float) -> None:
    track = GrooveTrack(track_direction=0.05, track_curvature=0.0, track_offset=0.0)
    with raises(NoGroove):
        measure_groove(synthetic(groove_width=width, groove_depth=60e-6, track=track).scan)


def test_a_bump_is_no_groove() -> None:
    known = synthetic()
    with raises(NoGroove):
        measure_groove(known.scan.with_height(-known.scan.height))


@mark.parametrize("shape", [(3, 4), (1, 400), (400, 1)])
def test_too_few_pixels_are_refused(shape: tuple[int, int]) -> None:
    with raises(InvalidInput, match="detection of a groove requires at least 100 measured blocks"):
        measure_groove(HeightMap(height=np.zeros(shape), spacing_x=1e-6, spacing_y=1e-6))


def test_a_flat_surface_has_no_groove() -> None:
    with raises(NoGroove, match="flat"):
        measure_groove(HeightMap(height=np.zeros((100, 100)), spacing_x=1e-6, spacing_y=1e-6))


def test_the_shallow_shoulders_of_a_groove_belong_to_its_width() -> None:
    step = 5e-6
    y, _ = ((n - n.mean()) * step for n in np.mgrid[:160, :100].astype(float))
    section = np.interp(np.abs(y), [0, 0.12e-3, 0.17e-3, 0.25e-3], [-10e-6, -10e-6, -3e-6, 0])
    noise = 0.03e-6 * np.random.default_rng(0).standard_normal(y.shape)
    groove = measure_groove(HeightMap(height=section + noise, spacing_x=step, spacing_y=step))
    assert groove.groove_width == approx(0.5e-3, rel=0.06)  # 0.34 mm by the steep flanks alone


def test_a_rougher_floor_widens_the_interval_of_the_depth() -> None:
    step = 10e-6
    y, _ = ((n - n.mean()) * step for n in np.mgrid[:120, :160].astype(float))
    shape = 12e-6 * np.maximum(0.0, 1 - (y / 0.25e-3) ** 2)
    widths: dict[float, list[float]] = {1.0: [], 6.0: []}
    for seed in (5, 6, 7):  # one interval also holds a difference of two splines, which is random
        roughness = gaussian_filter(np.random.default_rng(seed).standard_normal(y.shape), 1.5)
        roughness *= 0.3e-6 / roughness.std()
        for times, found in widths.items():
            height = roughness * np.where(np.abs(y) < 0.25e-3, times, 1.0) - shape
            groove = measure_groove(HeightMap(height=height, spacing_x=step, spacing_y=step))
            found.append(float(np.ptp(groove.groove_depth_interval)))
    assert np.mean(widths[6.0]) > 1.3 * np.mean(widths[1.0])


def test_cross_sections_are_perpendicular_to_the_track() -> None:
    known = synthetic(field=ScannedField(rms_height=0.0, waviness_amplitude=0.0, missing_fraction=0.0))
    groove = measure_groove(known.scan)
    sections = groove.cross_sections
    middle = sections.height[:, np.abs(sections.transverse) < 5e-6]
    np.testing.assert_allclose(middle[np.isfinite(middle)], -40e-6, atol=0.1e-6)
    expected = -GrooveShape(groove_width=0.7e-3, groove_depth=40e-6).depth_at(
        sections.transverse, 0 * sections.transverse
    )
    height = np.nanmedian(sections.height, axis=0)
    np.testing.assert_allclose(height, expected, atol=0.6e-6)  # half a pixel of the steepest flank


def test_an_exact_groove_is_measured_exactly() -> None:
    known = synthetic(field=ScannedField(tilt=0.0, rms_height=0.0, waviness_amplitude=0.0, missing_fraction=0.0))
    assert measure_groove(known.scan).wear_volume == approx(known.wear_volume, rel=1e-4)
