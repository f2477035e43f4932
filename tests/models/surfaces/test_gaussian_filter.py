"""Gaussian regression filters against the transmission of ISO 16610 and local fits, with edges and missing pixels."""

from typing import Any

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.tiers import examples

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.surfaces import HeightMap, high_pass, low_pass, profile_low_pass

CUTOFF = 80e-6
ALPHA, GAMMA = 0.4697186393498257, 0.7309134280946760  # ISO 16610-21 and ISO 16610-31


def transmission(wavelength: float, order: int) -> float:
    if order == 0:
        return float(np.exp(-np.pi * (ALPHA * CUTOFF / wavelength) ** 2))
    u = np.pi * (GAMMA * CUTOFF / wavelength) ** 2
    return float((1 + u) * np.exp(-u))


def surface(height: Floats, spacing_x: float = 2e-6, spacing_y: float = 4e-6) -> HeightMap:
    return HeightMap(height=height, spacing_x=spacing_x, spacing_y=spacing_y)


def grid(rows: int, columns: int, spacing_x: float = 2e-6, spacing_y: float = 4e-6) -> tuple[Floats, Floats]:
    x, y = np.meshgrid(spacing_x * np.arange(columns), spacing_y * np.arange(rows))
    return x, y


def holes(shape: tuple[int, ...], share: float = 0.3) -> Floats:
    return np.where(np.random.default_rng(1).random(shape) < share, np.nan, 0.0)


@mark.parametrize("order", [0, 2])
@mark.parametrize("wavelength", [0.5 * CUTOFF, CUTOFF, 3 * CUTOFF])
def test_a_wave_of_a_profile_has_the_transmission_of_the_standard(wavelength: float, order: int) -> None:
    x = 1e-6 * np.arange(800)
    wave = np.cos(2 * np.pi * (x - x[400]) / wavelength)
    passed = profile_low_pass(height=wave, spacing_x=1e-6, cutoff_length=CUTOFF, order=order)
    inner = np.abs(x - x[400]) < 100e-6
    np.testing.assert_allclose(passed[inner], transmission(wavelength, order) * wave[inner], atol=1e-11)


@mark.parametrize("order", [0, 2])
@mark.parametrize("direction", [0.0, 0.6, np.pi / 2])
def test_half_of_a_wave_is_transmitted_at_the_cutoff_in_any_direction_and_on_any_grid(
    direction: float, order: int
) -> None:
    x, y = grid(160, 320)
    wave = np.cos(2 * np.pi * (x * np.cos(direction) + y * np.sin(direction)) / CUTOFF)
    passed = low_pass(surface(wave), cutoff_length=CUTOFF, order=order).height
    np.testing.assert_allclose(passed[70:90, 140:180], 0.5 * wave[70:90, 140:180], atol=1e-9)


@mark.parametrize("order", [0, 2])
@mark.parametrize("robust", [False, True])
def test_a_constant_is_reproduced_exactly_at_edges_and_beside_missing_pixels(order: int, robust: bool) -> None:
    z = 3.3e-6 + holes((40, 50), 0.6)
    np.testing.assert_array_equal(
        low_pass(surface(z), cutoff_length=CUTOFF, order=order, robust=robust).height, z + 0 * z
    )


@mark.parametrize("robust", [False, True])
@mark.parametrize("cutoff", [20e-6, CUTOFF, 1e-3])
def test_the_second_order_reproduces_a_paraboloid_at_edges_and_missing_pixels(cutoff: float, robust: bool) -> None:
    x, y = grid(60, 70)
    z = 1e-6 + 0.3 * x - 0.2 * y + 500 * x**2 - 900 * x * y + 700 * y**2
    passed = low_pass(surface(z + holes(z.shape)), cutoff_length=cutoff, order=2, robust=robust).height
    known = np.isfinite(passed)
    assert np.count_nonzero(known) > 0.6 * z.size
    np.testing.assert_allclose(passed[known], z[known], atol=1e-12 * np.ptp(z))


@mark.parametrize("seed", range(20))
def test_the_robust_filter_converges_where_all_residuals_are_rounding(seed: int) -> None:
    x, y = grid(60, 70)
    z = 1e-6 + 0.3 * x - 0.2 * y + 500 * x**2 - 900 * x * y + 700 * y**2
    gaps = np.where(np.random.default_rng(seed).random(z.shape) < 0.3, np.nan, 0.0)
    passed = low_pass(surface(z + gaps), cutoff_length=1e-3, order=2, robust=True).height  # a warning is an error here
    np.testing.assert_allclose(passed, z + gaps, atol=1e-12 * np.ptp(z))


@examples(25)
@given(seed=st.integers(0, 999), row=st.integers(0, 23), column=st.integers(0, 29), order=st.sampled_from([0, 2]))
def test_each_pixel_is_the_weighted_polynomial_fit_around_it(seed: int, row: int, column: int, order: int) -> None:
    z = np.random.default_rng(seed).normal(size=(24, 30)) + np.roll(holes((24, 30)), seed, axis=1)
    z[row, column] = 0.7
    x, y = grid(24, 30)
    u, v = (x - x[row, column]) / CUTOFF, (y - y[row, column]) / CUTOFF
    known = np.isfinite(z)
    weight = np.sqrt(np.exp(-np.pi * (u**2 + v**2) / (ALPHA if order == 0 else GAMMA) ** 2))[known]
    parts = [np.ones_like(u)] if order == 0 else [np.ones_like(u), u, v, u**2, u * v, v**2]
    design = np.stack([part[known] for part in parts], axis=1)
    fitted = np.linalg.lstsq(weight[:, None] * design, weight * z[known])[0]
    passed = low_pass(surface(z), cutoff_length=CUTOFF, order=order).height
    assert passed[row, column] == approx(fitted[0], abs=1e-8)


@mark.parametrize("order", [0, 2])
def test_the_filtered_surface_does_not_depend_on_the_shape_of_the_pixels(order: int) -> None:
    def bumps(x: Floats, y: Floats) -> Floats:
        return np.asarray(
            np.exp(-(np.hypot(x - 150e-6, y - 120e-6) ** 2) / 3.6e-9) + np.sin(x / 40e-6) * np.cos(y / 50e-6)
        )

    fine = low_pass(surface(bumps(*grid(240, 300, 1e-6, 1e-6)), 1e-6, 1e-6), cutoff_length=CUTOFF, order=order)
    long = low_pass(surface(bumps(*grid(60, 150, 2e-6, 4e-6)), 2e-6, 4e-6), cutoff_length=CUTOFF, order=order)
    # Away from the edges, where a coarser grid ends elsewhere.
    np.testing.assert_allclose(long.height[30:32, 70:80], fine.height[120:128:4, 140:160:2], atol=2e-4)


def test_an_isolated_pixel_keeps_its_own_height() -> None:
    z = np.full((200, 200), np.nan)
    z[:20] = 0.0
    z[190, 190] = 1.0
    for order in (0, 2):
        assert low_pass(surface(z), cutoff_length=40e-6, order=order).height[190, 190] == approx(1.0, abs=1e-6)


def test_waviness_and_roughness_add_up_to_the_surface() -> None:
    z = np.random.default_rng(2).normal(size=(50, 60)) + holes((50, 60))
    parts: dict[str, Any] = {"cutoff_length": CUTOFF, "order": 2}
    whole = low_pass(surface(z), **parts).height + high_pass(surface(z), **parts).height
    np.testing.assert_allclose(whole, z, atol=1e-14)


def test_a_robust_high_pass_keeps_the_depth_of_a_groove() -> None:
    x, y = grid(120, 150)
    waviness = 2e-6 * np.sin(x / 120e-6) * np.cos(y / 150e-6)
    noise = 2e-8 * np.random.default_rng(4).normal(size=x.shape)
    groove = np.where(np.abs(x - 150e-6) < 15e-6, -5e-6, 0.0)
    worn = surface(waviness + noise + groove)
    plain = high_pass(worn, cutoff_length=200e-6, order=2).height
    robust = high_pass(worn, cutoff_length=200e-6, order=2, robust=True).height
    bottom = groove < 0
    assert robust[bottom].mean() == approx(-5e-6, rel=0.01)
    assert abs(plain[bottom].mean() + 5e-6) > 0.5e-6


def test_profiles_are_filtered_separately_and_like_maps_of_one_row() -> None:
    z = np.random.default_rng(6).normal(size=(2, 3, 90)) + holes((2, 3, 90))
    for order in (0, 2):
        found = profile_low_pass(height=z, spacing_x=2e-6, cutoff_length=CUTOFF, order=order)
        alone = profile_low_pass(height=z[1, 2], spacing_x=2e-6, cutoff_length=CUTOFF, order=order)
        row = low_pass(surface(z[1, 2][None]), cutoff_length=CUTOFF, order=order).height[0]
        np.testing.assert_allclose(found[1, 2], alone, atol=1e-12)
        np.testing.assert_allclose(alone, row, atol=1e-12)


def test_large_maps_are_filtered_in_strips_without_a_seam() -> None:
    x, y = grid(2100, 1100)
    z = 1e-6 * np.sin(x / 70e-6) * np.sin(y / 90e-6)
    whole = low_pass(surface(z), cutoff_length=40e-6, order=2).height
    around_seam = low_pass(surface(z[1700:2100]), cutoff_length=40e-6, order=2).height
    np.testing.assert_allclose(whole[1800:2000], around_seam[100:300], atol=1e-18)


@mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"cutoff_length": 0.0}, InvalidInput, r"cutoff_length must be positive, got 0\.0 m"),
        ({"cutoff_length": 19e-6}, OutsideRange, "cutoff_length must be at least 5 pixels of 4e-06 m"),
        ({"cutoff_length": CUTOFF, "order": 1}, InvalidInput, "order must be 0 or 2, got 1"),
    ],
)
def test_an_impossible_cutoff_or_order_is_refused(arguments: Any, error: type[Exception], message: str) -> None:
    with raises(error, match=message):
        low_pass(surface(np.zeros((9, 9))), **arguments)


def test_a_profile_without_a_measured_point_is_refused() -> None:
    with raises(InvalidInput, match="an array of profiles with a measured point"):
        profile_low_pass(height=[np.nan, np.nan], spacing_x=1e-6, cutoff_length=CUTOFF)


def test_the_robust_filter_weighs_a_pixel_until_three_standard_deviations_and_no_further() -> None:
    # heights of +-1 in a chessboard have the median absolute residual 1, so that ISO 16610-31's bisquare ends at 4.4478
    rows, columns = np.indices((60, 60))
    board = np.where((rows + columns) % 2 == 0, 1.0, -1.0)

    def lifted_by(height: float) -> float:
        z = board.copy()
        z[30, 30] = height
        z[30, 31] = -board[30, 31]  # so that the others have no mean
        smooth = low_pass(surface(1e-6 * z, 2e-6, 2e-6), cutoff_length=60e-6, robust=True).height
        return float(smooth[30, 30] / 1e-6)

    def bend(*heights: float) -> float:
        first, middle, last = map(lifted_by, heights)
        return abs(first - 2 * middle + last)

    # beyond the reach the height enters by the first smooth alone, which has no weights and is linear in it
    assert bend(4.5, 5.0, 5.5) < 1e-7
    assert bend(4.0, 4.4, 4.8) > 1e-5
