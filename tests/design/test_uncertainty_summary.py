"""Bands and contact loss of propagated samples."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.charts import Bars, Note, Points, Rule
from sonolube.design.statistics import SobolIndices, saltelli_sample
from sonolube.design.uncertainty_summary import (
    contact_loss_probability,
    histogram_chart,
    outcome_band,
    outcome_quantiles,
    ranked_entries,
    sobol_chart,
)


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


def test_entries_rank_by_their_first_order_and_tell_the_deviation_that_would_remain() -> None:
    # y = 3 x0 + x1 of uniform entries: variances 9/12 and 1/12, shares of 0.9 and 0.1
    first, second = ranked_entries(propagated(lambda x: x[..., 1] + 3 * x[..., 0], 2))
    assert (first.key, second.key) == ("x0", "x1")
    assert (first.first.value, second.first.value) == approx((0.9, 0.1), abs=0.05)
    assert (first.total.value, second.total.value) == approx((0.9, 0.1), abs=0.05)
    whole = np.sqrt(10 / 12)
    assert first.deviation_if_known == approx(whole * np.sqrt(1 - first.first.value), rel=0.02)
    assert second.deviation_if_known == approx(whole * np.sqrt(1 - second.first.value), rel=0.02)
    assert first.first.lower <= first.first.value <= first.first.upper
    assert first.total.lower <= first.total.value <= first.total.upper


def test_quantiles_leave_out_samples_and_places_without_a_result() -> None:
    samples = np.array([[1.0, np.nan], [3.0, np.nan], [np.nan, np.nan]])
    found = outcome_quantiles(swept(samples), (0.25, 0.5))
    assert found[:, 0] == approx([1.5, 2.0])
    assert np.isnan(found[:, 1]).all()


def test_a_rig_that_never_vibrates_has_no_probability_of_lost_contact() -> None:
    assert contact_loss_probability(xr.Dataset({"contact_loss_fraction": ("sample", [np.nan, np.nan])})) is None


def drawn(samples: np.ndarray, **attrs: object) -> xr.Dataset:
    """Propagation of a friction ratio without swept keys."""
    coords = {"subsequence": ("sample", np.arange(samples.size) // 4)}
    known = {"outcome": "friction_ratio", "rig": "a rig", "seed": 0}
    return xr.Dataset({"friction_ratio": ("sample", samples)}, coords=coords, attrs=known | attrs)


def test_the_histogram_counts_in_percent_and_marks_mean_and_quantiles() -> None:
    samples = np.append(np.linspace(0.2, 0.8, 399), np.nan)
    (panel,) = histogram_chart(drawn(samples)).panels
    bars, *marks, mean = panel.parts
    assert isinstance(bars, Bars)
    assert bars.lengths.size == 13  # the root of 399 over 1.5
    assert bars.lengths.sum() == approx(100.0)
    assert bars.breadth == approx(0.6 / 13)
    assert bars.places[[0, -1]] == approx([0.2 + 0.3 / 13, 0.8 - 0.3 / 13])
    assert panel.y.highest == approx(1.05 * bars.lengths.max())
    assert isinstance(mean, Points)
    assert (mean.x[0], mean.y[0]) == approx((0.5, 0.0))
    rules = [part for part in marks if isinstance(part, Rule)]
    assert [rule.value for rule in rules] == approx(np.nanquantile(samples, [0.05, 0.25, 0.5, 0.75, 0.95]))
    assert [rule.label for rule in rules] == ["", "", "quantile with 95 % interval", "", ""]
    notes = [part for part in marks if isinstance(part, Note)]
    assert [note.text for note in notes] == ["5 %", "25 %", "50 %", "75 %", "95 %"]
    assert [note.x for note in notes] == approx([rule.value for rule in rules])
    assert panel.y.highest is not None
    assert all(bars.lengths.max() <= note.y <= panel.y.highest for note in notes)
    few = histogram_chart(drawn(np.linspace(0.2, 0.8, 32))).panels[0].parts[0]
    assert isinstance(few, Bars)
    assert few.lengths.size == 10


def test_bars_of_indices_stand_in_rising_order_with_their_intervals() -> None:
    indices = SobolIndices(
        first_order=np.array([0.5, 0.1]),
        total_order=np.array([0.8, 0.2]),
        first_order_interval=np.array([[0.4, 0.55], [0.0, 0.3]]),
        total_order_interval=np.array([[0.7, 0.9], [0.25, 0.4]]),
        standard_deviation=1.0,
        rows=64,
    )
    known = xr.Dataset(coords={"block": ["A", "B", "large", "small"]}, attrs={"outcome": "friction_ratio", "rig": "r"})
    (panel,) = sobol_chart(known, indices).panels
    first, total = panel.parts
    assert isinstance(first, Bars)
    assert isinstance(total, Bars)
    assert panel.y.words == ("small", "large")
    assert first.lengths == approx([10.0, 50.0])
    assert total.lengths == approx([20.0, 80.0])
    assert first.places == approx([0.2, 1.2])
    assert total.places == approx([-0.2, 0.8])
    assert np.asarray(first.error) == approx(np.array([[10.0, 10.0], [20.0, 5.0]]))
    assert np.asarray(total.error) == approx(np.array([[0.0, 10.0], [20.0, 10.0]]))  # a limit beyond its estimate
