"""Edges and depth of sections that are known in closed form, with and without correlated noise."""

import numpy as np
from pytest import approx, mark

from sonolube.checks import Floats
from sonolube.models.surfaces.grooves.section_curve import SectionCurve, section_curve

S = (np.arange(64) - 31.7) / 56  # the edges of the groove, at -0.5 and 0.5, lie between points
LAG = np.abs(S[:, None] - S)


def parabola(s: Floats) -> Floats:
    return np.asarray(np.minimum(0.0, 4 * s**2 - 1))


def trapezium(s: Floats) -> Floats:
    return -np.clip(np.minimum((s + 0.5) / 0.3, (0.5 - s) / 0.2), 0.0, 1.0)


def noise_covariance(deviation: float) -> Floats:
    return np.asarray(deviation**2 * np.exp(-LAG * 28) + 1e-3 * deviation**2 * np.eye(S.size))


def measured(heights: Floats, deviation: float, cut: tuple[bool, bool] = (False, False)) -> SectionCurve:
    found = section_curve(S, heights, noise_covariance(deviation), (-0.5, 0.5), cut)
    assert found is not None
    return found


def repeated(heights: Floats, deviation: float, times: int) -> list[SectionCurve]:
    rng, root = np.random.default_rng(1), np.linalg.cholesky(noise_covariance(deviation))
    return [measured(heights + root @ rng.standard_normal(S.size), deviation) for _ in range(times)]


def test_a_parabola_without_noise_is_found_with_its_edges_and_depth() -> None:
    found = measured(parabola(S), 1e-4)
    assert (found.left, found.right) == approx((-0.5, 0.5), abs=5e-4)
    assert found.depth == approx(1.0, abs=5e-4)
    assert found.deepest == approx(0.0, abs=0.02)
    assert found.left_slope == approx(4.0, rel=0.05)


def test_leaning_flanks_and_a_flat_floor_without_noise_are_found() -> None:
    found = measured(trapezium(S), 1e-4)
    assert (found.left, found.right) == approx((-0.5, 0.5), abs=2e-3)
    assert found.depth == approx(1.0, abs=5e-3)


def test_a_section_cut_by_the_field_ends_where_the_points_do() -> None:
    s = S[S > 0.1]
    cov = noise_covariance(1e-4)[np.ix_(S > 0.1, S > 0.1)]
    found = section_curve(s, parabola(s), cov, (float(s[0]), 0.5), (True, False))
    assert found is not None
    assert found.left == approx(float(s[0]), abs=0.02)
    assert found.right == approx(0.5, abs=1e-3)
    assert found.left_slope == np.inf


@mark.parametrize("deviation", [0.01, 0.05])
def test_errors_of_a_parabola_in_correlated_noise_scatter_as_stated(deviation: float) -> None:
    found = repeated(parabola(S), deviation, 30)
    widths = np.array([(each.right - each.left - 1) / each.width_deviation for each in found])
    depths = np.array([(each.depth - 1) / each.depth_deviation for each in found])
    for scores in (widths, depths):
        assert abs(np.mean(scores)) < 0.6
        assert 0.6 < np.sqrt(np.mean(scores**2)) < 1.4


def test_a_flat_floor_in_strong_noise_is_too_deep_by_less_than_its_uncertainty() -> None:
    found = repeated(trapezium(S), 0.1, 40)
    scores = [(each.depth - 1) / each.depth_deviation for each in found]
    assert abs(np.mean(scores)) < 0.6
    assert np.mean(np.abs(scores) < 1.96) > 0.8


def test_too_few_points_between_the_edges_are_no_section() -> None:
    assert section_curve(S, parabola(S), noise_covariance(0.01), (-0.03, 0.03), (False, False)) is None
