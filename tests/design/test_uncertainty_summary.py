"""Bands and contact loss of propagated samples."""

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.design.uncertainty_summary import contact_loss_probability, outcome_band


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
