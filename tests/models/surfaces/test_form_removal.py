"""Form removal: polynomials of known coefficients, with missing pixels, grooves and outliers."""

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, mark, raises
from tests.tiers import examples

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap, fit_form, remove_form

ROWS, COLUMNS = 60, 80
X, Y = np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS))


def surface(height: Floats) -> HeightMap:
    return HeightMap(height=height, spacing_x=1e-6, spacing_y=2e-6)


def polynomial(degree: int, seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return sum(
        (rng.normal() * 1e-6 * X**i * Y**j for i in range(degree + 1) for j in range(degree + 1 - i)), np.zeros_like(X)
    )


def holes(seed: int) -> Floats:
    return np.where(np.random.default_rng(seed).random(X.shape) < 0.3, np.nan, 0.0)


@examples(25)
@given(degree=st.integers(0, 12), seed=st.integers(0, 1000))
def test_a_polynomial_is_removed_entirely_whatever_pixels_are_missing(degree: int, seed: int) -> None:
    shape = polynomial(degree, seed)
    flat = remove_form(surface(shape + holes(seed)), degree=degree).height
    np.testing.assert_allclose(flat[np.isfinite(flat)], 0, atol=1e-18)
    assert fit_form(surface(shape + holes(seed)), degree=degree).height == approx(shape, abs=1e-17)


@settings(deadline=None)
@given(degree=st.integers(0, 6), seed=st.integers(0, 1000))
def test_the_fit_is_that_of_the_normal_equations_in_monomials(degree: int, seed: int) -> None:
    z = np.random.default_rng(seed).normal(size=X.shape) * 1e-6 + holes(seed)
    design = np.stack([(X**i * Y**j).ravel() for i in range(degree + 1) for j in range(degree + 1 - i)], axis=1)
    known = np.isfinite(z.ravel())
    coefficients = np.linalg.lstsq(design[known], z.ravel()[known])[0]
    np.testing.assert_allclose(
        fit_form(surface(z), degree=degree).height.ravel(), design @ coefficients, atol=1e-12 * np.nanmax(np.abs(z))
    )


def test_the_residual_is_orthogonal_to_the_form() -> None:
    remains = remove_form(surface(np.random.default_rng(3).normal(size=X.shape)), degree=2).height
    for part in (np.ones_like(X), X, Y, X * Y, X**2, Y**2):
        assert np.mean(remains * part) == approx(0, abs=1e-15)


@mark.parametrize("degree", [1, 2])
@mark.parametrize("width", [0.1, 0.3, 0.4])
def test_a_groove_does_not_tilt_the_robust_form(width: float, degree: int) -> None:
    noise = 5e-9 * np.random.default_rng(5).normal(size=X.shape)
    tilt = 20e-6 * X - 8e-6 * Y
    groove = np.where(np.abs(X - 0.35 - width / 2) < width / 2, -10e-6, 0.0)  # off the middle
    shape = fit_form(surface(tilt + groove + noise), degree=degree, robust=True).height
    assert np.max(np.abs(shape - tilt)) < 2e-9
    plain = fit_form(surface(tilt + groove + noise), degree=degree).height
    assert np.max(np.abs(plain - tilt)) > 500e-9


def test_the_robust_form_of_a_plane_with_a_groove_is_exact() -> None:
    tilt = 20e-6 * X - 8e-6 * Y
    groove = np.where(np.abs(X - 0.6) < 0.1, -10e-6 * (1 - ((X - 0.6) / 0.1) ** 2), 0.0)
    assert np.max(np.abs(fit_form(surface(tilt + groove), robust=True).height - tilt)) < 1e-12


def test_without_outliers_the_robust_form_is_nearly_that_of_least_squares() -> None:
    z = 1e-7 * np.random.default_rng(7).normal(size=X.shape) + 3e-6 * X
    robust, plain = fit_form(surface(z), robust=True).height, fit_form(surface(z)).height
    assert np.max(np.abs(robust - plain)) < 1e-7 * 3 / np.sqrt(X.size)


def test_the_form_is_fitted_to_the_reference_pixels_only() -> None:
    z = 1e-6 * X + np.where(X > 0.5, 5e-6 * Y, 0.0)
    shape = fit_form(surface(z), reference=X <= 0.5).height
    np.testing.assert_allclose(shape, 1e-6 * X, atol=1e-17)


def test_a_map_of_one_row_is_levelled_along_the_row() -> None:
    profile = HeightMap(height=np.array([[0.0, 1.0, 2.0, 3.0]]), spacing_x=1e-6, spacing_y=1e-6)
    np.testing.assert_allclose(remove_form(profile).height, 0, atol=1e-15)


def test_missing_pixels_stay_missing_and_have_a_form() -> None:
    z = 1e-6 * X
    z[3, 4] = np.nan
    assert np.isnan(remove_form(surface(z)).height[3, 4])
    assert fit_form(surface(z)).height[3, 4] == approx(1e-6 * X[3, 4])


@mark.parametrize(
    ("degree", "reference", "message"),
    [
        (-1, None, "degree must lie between 0 and 12, got -1"),
        (13, None, "degree must lie between 0 and 12, got 13"),
        (1, np.zeros(X.shape, bool), "reference has no measured pixel"),
        (1, np.ones((2, 2), bool), r"reference must be true or false for each of \(60, 80\) pixels"),
        (1, np.ones(X.shape), "reference must be true or false"),
        (1, np.eye(ROWS, COLUMNS, dtype=bool), "does not determine all 3 coefficients of the form; lower the degree"),
    ],
)
def test_an_undetermined_form_is_refused(degree: int, reference: np.ndarray | None, message: str) -> None:
    with raises(InvalidInput, match=message):
        fit_form(surface(X), degree=degree, reference=reference)


def test_the_robust_form_weighs_a_pixel_until_4_685_standard_deviations_and_no_further() -> None:
    # heights of +-1 in a chessboard: the standard deviation by the median absolute residual is 1.4826, the reach 6.946
    rows, columns = np.indices((60, 60))
    board = np.where((rows + columns) % 2 == 0, 1.0, -1.0)

    def lifted_by(height: float) -> float:
        z = board.copy()
        z[2, 2] = height
        return float(fit_form(surface(1e-6 * z), robust=True).height[2, 2] / 1e-6)

    without = lifted_by(1000.0)
    assert lifted_by(7.1) == approx(without, abs=1e-6)
    assert lifted_by(6.5) > without + 1e-5
