"""Sheets of wear grooves: widths, areas and volumes of a ruled groove, and what their figures show."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from pytest import approx
from scipy.stats import t

from sonolube.charts import Chart, Line, Points, Rule, Zone
from sonolube.measurement.wear_track import WearTrack
from sonolube.models.surfaces import Groove, HeightMap
from sonolube.models.surfaces.grooves.track_marks import TrackMarks
from sonolube.report.measured.groove import (
    RingSettings,
    _view,
    cap_sheet,
    groove_sheet,
    marks_figure,
    ring_figure,
    ring_sheet,
    sections_figure,
    wear_reduction_sheet,
    worn_map_chart,
)
from sonolube.report.measured.sheet import Figure, Sheet
from sonolube.report.measured.surface import SurfaceSettings

SPACING = 5e-6
WIDTH, DEPTH = 0.4e-3, 20e-6  # of a parabola
AREA = 2 / 3 * WIDTH * DEPTH
SETTINGS = SurfaceSettings(spacing_x=SPACING, spacing_y=SPACING)


def values(sheet: Sheet) -> dict[str, float]:
    return {value.name: value.value for value in sheet.values}


def chart_of(figure: Figure) -> Chart:
    assert figure.drawing.chart is not None
    return figure.drawing.chart()


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A straight parabolic groove along x in the middle of a field of 1 mm by 1.2 mm, with a roughness of 50 nm."""
    y = SPACING * (np.arange(240) - 119.5)
    section = np.where(np.abs(y) < WIDTH / 2, -DEPTH * (1 - (2 * y / WIDTH) ** 2), 0.0)
    rough = 5e-8 * np.random.default_rng(2).standard_normal((240, 200))
    path = tmp_path_factory.mktemp("scans") / "ruled.npy"
    np.save(path, section[:, None] + rough)
    return path


@pytest.fixture(scope="module")
def measured(scan: Path) -> tuple[Sheet, Groove]:
    return groove_sheet(scan, settings=SETTINGS)


def test_a_ruled_groove_has_the_width_depth_and_volume_of_its_parabola(measured: tuple[Sheet, Groove]) -> None:
    sheet, _ = measured
    found = values(sheet)
    assert found["track_count"] == 1
    assert "track_number" not in found
    assert "groove_diameter" not in found  # straight
    assert found["groove_width"] == approx(WIDTH, rel=0.02)
    assert found["groove_depth"] == approx(DEPTH, rel=0.02)
    assert found["cross_section_area"] == approx(AREA, rel=0.01)
    assert found["wear_volume"] == approx(AREA * 1e-3, rel=0.02)
    assert found["net_volume"] == approx(AREA * 1e-3, rel=0.02)
    assert found["track_length"] == approx(1e-3, rel=0.01)
    assert sheet.title.endswith("/ruled.npy")
    assert [figure.title for figure in sheet.figures][:4] == ["The groove", "Cross-sections", "Map", "Abbott curve"]
    assert any("marks along the track" in line for line in sheet.not_found)


def test_of_several_tracks_the_one_that_was_measured_is_named(tmp_path: Path) -> None:
    y = SPACING * np.arange(400)
    height = np.zeros((400, 120))
    for middle in (0.5e-3, 1.5e-3):
        place = (y - middle) / (0.15e-3)
        height -= np.where(np.abs(place) < 1, 10e-6 * (1 - place**2), 0.0)[:, None]
    height += 5e-8 * np.random.default_rng(3).standard_normal(height.shape)
    np.save(tmp_path / "two.npy", height)
    sheet, _ = groove_sheet(tmp_path / "two.npy", settings=SETTINGS, track_number=2)
    names = [value.name for value in sheet.values]
    assert names[:2] == ["track_count", "track_number"]
    assert (values(sheet)["track_count"], values(sheet)["track_number"]) == (2, 2)


def test_sections_are_drawn_in_mm_and_um_within_the_field_with_their_edges_and_the_unworn_surface() -> None:
    across = np.array([-1e-3, 0.0, 1e-3])
    single = SimpleNamespace(
        arc_length=np.arange(21.0), transverse=across, height=1e-6 * np.arange(63.0).reshape(21, 3)
    )
    mean = SimpleNamespace(
        transverse=np.array([-1.5e-3, -1e-3, 0.0, 1e-3, 1.5e-3]), height=1e-6 * np.array([9.0, 0.0, -2.0, 0.5, 9.0])
    )
    groove: Any = SimpleNamespace(cross_sections=single, mean_cross_section=mean, groove_width=0.8e-3)
    (panel,) = chart_of(sections_figure(groove)).panels
    *grey, line, unworn, edges = panel.parts
    # of 21 sections nine evenly between the first and the last: 2, 4, ... 18
    assert len(grey) == 9
    for place, each in zip(range(2, 20, 2), grey, strict=True):
        assert isinstance(each, Line)
        assert each.x == approx([-1.0, 0.0, 1.0])
        assert each.y == approx(3 * place + np.arange(3.0))
    assert isinstance(line, Line)
    assert line.x == approx([-1.0, 0.0, 1.0])
    assert line.y == approx([0.0, -2.0, 0.5])
    assert isinstance(unworn, Rule)
    assert (unworn.value, unworn.along) == (0.0, "y")
    assert isinstance(edges, Points)
    assert edges.x == approx([-0.4, 0.4])
    assert edges.y == approx([0.0, 0.0])


def test_the_view_has_the_extent_of_the_field_with_the_first_row_at_the_back(measured: tuple[Sheet, Groove]) -> None:
    figure = _view(measured[1])
    try:
        axes: Any = figure.axes[0]
        assert axes.get_xlabel() == "x (mm)"
        assert np.ptp(axes.xy_dataLim.intervalx) == approx(1.0, rel=0.03)
        assert np.ptp(axes.xy_dataLim.intervaly) == approx(1.2, rel=0.03)
        assert axes.zz_dataLim.intervalx[0] == approx(-20.0, abs=0.5)
        assert axes.collections[0].get_clim() == approx((-20.0, 0.0), abs=0.5)
        low, high = axes.get_ylim()
        assert low > high
        width, depth, height = axes._box_aspect
        assert (depth / width, height / width) == approx((1.2, 0.35), rel=0.02)
    finally:
        plt.close("all")


def test_the_line_round_what_is_worn_is_interrupted_between_its_pieces() -> None:
    worn = np.zeros((40, 60), dtype=bool)
    worn[5:10, 5:10] = worn[20:30, 30:50] = True
    levelled = HeightMap(height=np.where(worn, -1e-6, 0.0), spacing_x=1e-6, spacing_y=1e-6)
    line = worn_map_chart(levelled, worn).panels[0].parts[1]
    assert isinstance(line, Line)
    assert np.flatnonzero(np.isnan(line.x)).size == 3  # before, between and behind
    assert np.isnan(line.x[[0, -1]]).all()
    assert np.array_equal(np.isnan(line.x), np.isnan(line.y))


def ring(areas: list[float], *, excluded: tuple[str, ...] = ()) -> WearTrack:
    """Ring of 50 mm whose volume is between those of the mean area less and more a tenth."""
    mean = float(np.mean(areas)) * math.pi * 0.05
    return WearTrack(
        wear_volume=mean,
        wear_volume_uncertainty=mean / 20,
        wear_volume_interval=(0.9 * mean, 1.1 * mean),
        pile_up_volume=1e-12,
        wear_rate=mean / 100,
        wear_rate_uncertainty=mean / 2000,
        wear_rate_interval=(0.9 * mean / 100, 1.1 * mean / 100),
        groove_diameter=0.05,
        sliding_distance=100.0,
        cross_section_area=np.array(areas),
        excluded_scans=excluded,
    )


def test_sections_of_a_ring_are_numbered_from_one_with_their_mean_and_interval_as_areas() -> None:
    (panel,) = chart_of(ring_figure(ring([1e-9, 2e-9, 3e-9]))).panels
    zone, mean, scans = panel.parts
    assert isinstance(zone, Zone)
    assert (zone.first[0], zone.last[0]) == approx((1800.0, 2200.0))
    assert zone.along == "y"
    assert isinstance(mean, Rule)
    assert mean.value == approx(2000.0)
    assert mean.along == "y"
    assert isinstance(scans, Points)
    assert scans.x == approx([1.0, 2.0, 3.0])
    assert scans.y == approx([1000.0, 2000.0, 3000.0])
    assert panel.x.ticks == (1.0, 2.0, 3.0)


def test_the_spectrum_of_marks_begins_behind_zero_and_has_its_peak_where_one_was_found() -> None:
    marks = TrackMarks(
        dot_spacing=50e-6,
        dot_spacing_uncertainty=1e-6,
        prominence=9.0,
        false_alarm_probability=1e-4,
        reason="",
        wavenumber=np.array([0.0, 1e4, 2e4]),
        profile_spectral_density=np.array([9.0, 1.0, 4.0]),
        background=np.array([5.0, 3.0, 2.0]),
    )
    (panel,) = chart_of(marks_figure(marks)).panels
    along, background, peak = panel.parts
    assert isinstance(along, Line)
    assert along.x == approx([1e4, 2e4])
    assert along.y == approx([1.0, 4.0])
    assert isinstance(background, Line)
    assert background.x == approx([1e4, 2e4])
    assert background.y == approx([3.0, 2.0])
    assert isinstance(peak, Rule)
    assert peak.value == approx(2e4)
    assert panel.y.logarithmic
    without = replace(marks, dot_spacing=None)
    assert len(chart_of(marks_figure(without)).panels[0].parts) == 2


def test_a_ring_has_the_volume_of_its_mean_section_and_lists_the_whole_scans_only(
    measured: tuple[Sheet, Groove],
) -> None:
    groove = measured[1]
    cut = replace(groove, complete=False, caveat="cut", groove_width=9e-3)
    grooves: list[tuple[str, Groove | str]] = [
        ("a", replace(groove, cross_section_area=1e-9, groove_width=0.3e-3)),
        ("b", "no groove"),
        ("c", cut),
        ("d", replace(groove, cross_section_area=3e-9, groove_width=0.5e-3)),
    ]
    settings = RingSettings(groove_diameter=0.05, sliding_distance=100.0, tip_radius=4e-3)
    sheet, found = ring_sheet("ring", grooves, settings=settings)
    around = math.pi * 0.05
    assert values(sheet)["ring_volume"] == approx(2e-9 * around)
    assert values(sheet)["wear_rate"] == approx(2e-9 * around / 100)
    assert values(sheet)["ring_net_volume"] == approx(found.net_volume)
    (table,) = sheet.tables
    assert [row[0] for row in table.rows] == ["a", "d"]
    assert [row[1] for row in table.rows] == approx([1e-9, 3e-9])
    assert len(sheet.caveats) == 2
    # ASTM G99 for a flat worn by a ball: pi R d^3 / (6 r), with R the radius of the ring and d the mean width
    assert values(sheet)["geometric_volume"] == approx(math.pi * 0.025 * 0.4e-3**3 / (6 * 4e-3), rel=2e-3)
    without, _ = ring_sheet("ring", grooves, settings=replace(settings, tip_radius=None))
    assert "geometric_volume" not in values(without)


def test_a_reduction_of_single_rings_says_that_specimens_were_not_compared() -> None:
    one = wear_reduction_sheet([ring([4e-9, 4.1e-9, 3.9e-9])], [ring([1e-9, 1.1e-9, 0.9e-9])])
    assert values(one)["wear_reduction"] == approx(0.75)
    assert "that between specimens: test more specimens" in one.caveats[0]
    assert one.title == "1 ring with vibration against 1 without"
    two = wear_reduction_sheet(
        [ring([4e-9, 4.1e-9]), ring([4.2e-9, 4.1e-9])], [ring([1e-9, 1.1e-9]), ring([1e-9, 0.9e-9])]
    )
    assert two.caveats == ()


def test_the_scar_of_a_pin_has_the_diameter_and_volume_of_its_flat(tmp_path: Path) -> None:
    radius, scar = 2e-3, 0.3e-3
    side = 4e-6 * (np.arange(200) - 99.5)
    far = np.hypot(*np.meshgrid(side, side))
    height = np.minimum(np.sqrt(radius**2 - far**2) - radius, np.sqrt(radius**2 - (scar / 2) ** 2) - radius)
    np.save(tmp_path / "pin.npy", height + 2e-8 * np.random.default_rng(1).standard_normal(height.shape))
    settings = SurfaceSettings(spacing_x=4e-6, spacing_y=4e-6)
    sheet = cap_sheet(tmp_path / "pin.npy", settings=settings, tip_radius=radius)
    # a cap of the ball below the chord of the scar
    cap = radius - math.sqrt(radius**2 - scar**2 / 4)
    assert values(sheet)["pin_volume"] == approx(math.pi * cap**2 * (radius - cap / 3), rel=0.02)
    assert values(sheet)["scar_diameter"] == approx(scar, rel=0.02)
    assert values(sheet)["tip_radius"] == approx(radius, rel=1e-6)
    assert [figure.title for figure in sheet.figures] == ["Scar of the pin"]


def test_students_interval_of_three_scans_is_that_of_the_sheet(measured: tuple[Sheet, Groove]) -> None:
    grooves = [(str(area), replace(measured[1], cross_section_area=area * 1e-9)) for area in (1, 2, 3)]
    sheet, _ = ring_sheet("ring", grooves, settings=RingSettings(groove_diameter=0.05, sliding_distance=100.0))
    rate = next(value for value in sheet.values if value.name == "wear_rate")
    half = float(t.ppf(0.975, 2)) * 1e-9 / math.sqrt(3) * math.pi * 0.05 / 100
    middle = 2e-9 * math.pi * 0.05 / 100
    assert rate.interval == approx((middle - half, middle + half), rel=1e-6)
