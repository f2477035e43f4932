"""Uncertainty of a level of a recorded run, with and without a steady change of the force."""

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.laboratory.catalogue.measured import _mean_of


def level(change: float) -> xr.Dataset:
    """A minute at 400 Hz of 0.5 N with white noise of 30 mN and a steady change of the force. [N]"""
    time = np.arange(24_000) / 400
    noise = 0.03 * np.random.default_rng(5).standard_normal(time.size)
    return xr.Dataset({"friction_force": ("time", 0.5 + change * time / time[-1] + noise)}, {"time": time})


def test_a_force_without_a_steady_change_has_the_uncertainty_of_its_scatter() -> None:
    found = _mean_of(level(0.0), None)
    assert found is not None
    assert found[1] == approx(0.03 / np.sqrt(24_000), rel=0.3)


@pytest.mark.parametrize("change", [-0.2, 0.05])
def test_half_of_a_steady_change_counts_as_drift_of_the_gauge(change: float) -> None:
    found = _mean_of(level(change), None)
    assert found is not None
    level_found, uncertainty = found
    assert level_found == approx(0.5 + change / 2, abs=2e-3)
    assert uncertainty == approx(abs(change) / 2, rel=0.1)
