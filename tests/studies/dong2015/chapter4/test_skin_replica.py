"""Section 4.4: rows of the skin replica and fits of the soft layers."""

import numpy as np
from pytest import approx

from dong2015.chapter4.skin_replica import skin_replica_rows, soft_layer_fits


def test_only_the_stiffening_layer_has_a_ratio_independent_of_the_load() -> None:
    # ratios of the printed forces: 0.21/0.57, 0.29/1.04, 0.44/1.42
    stiffening, linear = soft_layer_fits()
    for fit in (stiffening, linear):
        assert fit.measured == approx((0.36842, 0.27885, 0.30986), abs=1e-5)
    # one number for three ratios: least squares yields their mean
    assert stiffening.computed == approx(np.full(3, np.mean(stiffening.measured)), abs=1e-6)
    assert np.abs(np.subtract(linear.computed, linear.measured)).max() > 0.1


def test_the_stiffening_layer_is_within_a_sixth_of_each_printed_coefficient() -> None:
    rows = [row for row in skin_replica_rows() if row.id.startswith("soft-stiffening")]
    assert [row.published for row in rows] == [0.105, 0.096, 0.11]
    for row in rows:
        assert row.relative_error is not None
        assert abs(row.relative_error) < 1 / 6
        assert "fitted to the three loads" in row.note
        assert "assumed" in row.note
