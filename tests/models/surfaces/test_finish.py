"""Surface finishes: grades, processes, Rq from Ra and Rz of random profiles, and summits of scanned surfaces."""

import math
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import si_value
from sonolube.measurement.surface_files.reader import read_height_map
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    SpectralMoments,
    gaussian_surface,
    height_parameters,
    nayak_summit_statistics,
    remove_form,
    rms_height_from_maximum_height,
    rms_height_from_roughness_average,
    sampling_dependence,
    surface_finish,
    surface_finish_names,
    typical_summits,
)

SCANS = Path(__file__).parents[4] / "shared" / "data" / "surfaces"


def test_grades_are_the_upper_limits_of_iso_1302() -> None:
    limits = [0.025, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.3, 12.5, 25, 50]
    for number, limit in enumerate(limits, start=1):
        grade = surface_finish(f"N{number}")
        assert grade.roughness_average_high == approx(limit * 1e-6)
        assert grade.roughness_average_low == approx(limit * 0.5e-6)


def test_a_process_with_a_grade_has_the_grades_roughness_and_the_processs_title() -> None:
    both = surface_finish("Ground n6")
    assert (both.name, both.title) == ("ground N6", "Ground, grade N6 of ISO 1302")
    assert both.roughness_average_high == approx(0.8e-6)
    assert both == surface_finish("n6 ground")


def test_a_grade_that_the_process_does_not_give_is_noted() -> None:
    assert "lapped surfaces have Ra 0.05 to 0.4 um" in surface_finish("lapped N12").note
    assert "lapped" not in surface_finish("lapped N4").note


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("grinding", "ground"),
        ("EDM", "electrical_discharge_machined"),
        ("wire-EDM", "electrical_discharge_machined"),
        ("cold drawn", "drawn"),
        ("sand cast", "sand_cast"),
        ("Superfinished", "superfinished"),
    ],
)
def test_processes_are_found_by_what_people_write(written: str, name: str) -> None:
    assert surface_finish(written).name == name


def test_every_finish_has_a_range_and_a_source() -> None:
    names = surface_finish_names()
    assert len(names) >= 35
    assert names[-12:] == tuple(f"N{number}" for number in range(1, 13))
    for name in names:
        known = surface_finish(name)
        assert 0 < known.roughness_average_low < known.arithmetic_mean_height < known.roughness_average_high
        assert len(known.source) > 10


def test_finer_processes_are_finer() -> None:
    means = [surface_finish(name).arithmetic_mean_height for name in ("lapped", "ground", "turned", "forged")]
    assert means == sorted(means)


def test_an_unknown_finish_is_refused_with_a_near_one() -> None:
    with raises(UnknownName, match=r"unknown surface finish 'grond'; did you mean ground\?"):
        surface_finish("grond")
    with raises(InvalidInput, match="surface finish must be a process, a grade, or both"):
        surface_finish("N6 N7")
    with raises(InvalidInput, match="surface finish must be a process"):
        surface_finish(" ")


def random_profiles() -> np.ndarray:
    spectrum = GaussianCorrelationSpectrum(correlation_length=10e-6)
    return gaussian_surface(
        rms_height=1e-6, spectrum=spectrum, shape=(64, 4000), spacing_x=1e-6, spacing_y=5e-6, seed=3
    ).height


def test_rq_of_gaussian_heights_follows_from_ra() -> None:
    heights = random_profiles()
    estimate = rms_height_from_roughness_average(arithmetic_mean_height=float(np.mean(np.abs(heights))))
    assert estimate.rms_height == approx(float(np.std(heights)), rel=0.01)


@pytest.mark.parametrize("row", [*(f"2.4 {row}" for row in range(1, 8)), *(f"2.10 {row}" for row in range(1, 4))])
def test_the_range_of_rq_holds_the_surfaces_of_the_dissertation(row: str) -> None:
    table, number = row.split()
    ra, rq = (si_value(f"table-{table}-{name}-{number}") for name in ("arithmetic_mean_height", "rms_height"))
    estimate = rms_height_from_roughness_average(arithmetic_mean_height=ra)
    assert estimate.low <= rq <= estimate.high


def test_the_range_of_rq_holds_sections_of_random_profiles_and_a_sine() -> None:
    sections = random_profiles().reshape(-1, 800)  # five sections of 0.8 mm to a profile
    maximum = float(np.mean(np.ptp(sections, axis=1)))
    estimate = rms_height_from_maximum_height(mean_section_height=maximum)
    assert estimate.low <= float(np.std(sections)) <= estimate.high
    sine = rms_height_from_maximum_height(mean_section_height=2.0)
    assert sine.low < math.sqrt(0.5) <= sine.high * (1 + 1e-12)


def test_the_summits_are_those_of_a_gaussian_surface_by_nayaks_theory() -> None:
    known = typical_summits(rms_height=1e-6)
    # moments that give this radius and density, and the height
    fourth = math.pi * (3 / (8 * known.summit_radius)) ** 2
    second = fourth / (6 * math.pi * math.sqrt(3) * known.summit_density)
    moments = SpectralMoments(height_variance=1e-12, slope_variance=second, curvature_variance=fourth)
    found = nayak_summit_statistics(moments)
    assert found.summit_radius == approx(known.summit_radius)
    assert found.summit_density == approx(known.summit_density)
    assert moments.bandwidth > 1.5
    assert known.summit_density * 1e-6 * known.summit_radius == approx(0.04)
    assert math.sqrt(second) == approx(0.157, rel=0.01)  # sqrt(pi/2) times a mean absolute slope of 0.125


@pytest.mark.parametrize("name", ["al3d-1.al3d", "x3p-2.x3p", "metropro-1.dat", "opd-1.opd"])
def test_scanned_surfaces_have_summits_within_the_factors(name: str) -> None:
    path = SCANS / name
    if not path.exists():
        pytest.skip(f"{name} is not beside the project; see shared/data")
    pytest.importorskip("SurfaceTopography")
    surface = remove_form(read_height_map(path))
    found = sampling_dependence(surface, sampling_interval=[1e-6], method="moments")
    known = typical_summits(rms_height=height_parameters(surface).rms_height)
    assert abs(math.log(found.summit_radius[0] / known.summit_radius)) < math.log(known.radius_factor)
    assert abs(math.log(found.summit_density[0] / known.summit_density)) < math.log(known.density_factor)


def test_the_summits_of_polished_surfaces_are_known_worse() -> None:
    polished, ground = typical_summits(rms_height=0.02e-6), typical_summits(rms_height=0.5e-6)
    assert polished.radius_factor > ground.radius_factor > 2
    assert "polishing" in polished.reason
    assert "\n" not in ground.reason


def test_a_height_that_is_not_positive_is_refused() -> None:
    with raises(InvalidInput, match="rms_height must be positive"):
        typical_summits(rms_height=-1e-6)
    with raises(InvalidInput, match="arithmetic_mean_height must be positive"):
        rms_height_from_roughness_average(arithmetic_mean_height=0.0)
