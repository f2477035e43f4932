"""Bands and contact loss of propagated samples."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.design.statistics import saltelli_sample
from sonolube.design.uncertainty_summary import contact_loss_probability, outcome_band, ranked_entries


def swept(samples: np.ndarray) -> xr.Dataset:
    speed = ("speed", [0.01, 0.02], {"key": "sliding.sliding_speed"})
    return xr.Dataset({"ratio": (("sample", "speed"), samples)}, coords={"speed": speed}, attrs={"outcome": "ratio"})


def test_a_uniform_sample_has_the_quantiles_of_its_distribution() -> None:
    even = np.linspace(0, 1, 1001)
    band = outcome_band(swept(np.stack([even, 3 * even], axis=1)))
    assert band.narrowest is not None
    assert band.widest is not None
    assert band.narrowest.at == {"sliding.sliding_speed": 0.01}
    assert (band.narrowest.lower, band.narrowest.median, band.narrowest.upper) == approx((0.05, 0.5, 0.95))
    assert band.widest.at == {"sliding.sliding_speed": 0.02}
    assert band.mean_width == approx((0.9 + 2.7) / 2)


def test_a_band_without_results_has_no_places() -> None:
    band = outcome_band(swept(np.full((4, 2), np.nan)))
    assert (band.mean_width, band.narrowest, band.widest) == (None, None, None)


def test_contact_loss_is_counted_among_the_points_with_a_vibration() -> None:
    lost = xr.Dataset({"contact_loss_fraction": ("sample", [0.0, 0.2, 0.1, np.nan])})
    assert contact_loss_probability(lost) == approx(2 / 3)
    assert contact_loss_probability(xr.Dataset()) is None


def propagated(outcome: Callable[[np.ndarray], np.ndarray], inputs: int) -> xr.Dataset:
    points, _ = saltelli_sample(inputs, samples=64, seed=3)
    names = [f"x{place}" for place in range(inputs)]
    attrs = {"outcome": "y", "seed": 3, "uncertain": names}
    return xr.Dataset({"y": (("block", "sample"), outcome(points))}, attrs=attrs)


def test_no_share_of_the_variance_is_above_one_or_below_zero() -> None:
    # all of the variance is that of the first entry: its estimates scatter about 1, those of the other about 0
    alone, idle = ranked_entries(propagated(lambda points: np.exp(3 * points[..., 0]) + 1e-3 * points[..., 1], 2))
    for share in (alone.first, alone.total, idle.first, idle.total):
        assert all(0 <= end <= 1 for end in (share.value, share.lower, share.upper))
    assert alone.first.upper == 1
    assert alone.first.value > 0.8


def test_only_entries_that_the_outcome_depends_on_matter() -> None:
    # y = x0 + 3 x1 + x0 x2 does not hold x3
    ranked = ranked_entries(
        propagated(lambda x: x[..., 0] + 3 * x[..., 1] + 3 * x[..., 0] * (x[..., 2] - 0.5) + 0 * x[..., 3], 4)
    )
    assert {row.key: row.matters for row in ranked} == {"x0": True, "x1": True, "x2": True, "x3": False}
    assert ranked[-1].key == "x3"
    assert ranked[-1].total.upper == 0
