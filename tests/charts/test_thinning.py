"""Thinned curves: a needle of one sample among a million stays, and short curves are left as they are."""

import numpy as np
from hypothesis import given, strategies as st

from sonolube.charts import envelope


@given(size=st.integers(1, 20_000), bins=st.integers(1, 2000), seed=st.integers(0, 99))
def test_the_greatest_and_least_values_of_a_curve_stay(size: int, bins: int, seed: int) -> None:
    x, y = np.arange(float(size)), np.random.default_rng(seed).standard_normal(size)
    places, values = envelope(x, y, bins=bins)
    assert (values.min(), values.max()) == (y.min(), y.max())
    assert places.size == values.size <= 2 * bins
    assert (np.diff(places) >= 0).all()
    assert x[0] <= places[0]
    assert places[-1] <= x[-1]


def test_a_missing_value_hides_no_other() -> None:
    y = np.zeros(10_000)
    y[5000], y[5001] = np.nan, 7.0
    assert np.nanmax(envelope(np.arange(10_000.0), y, bins=10)[1]) == 7.0
