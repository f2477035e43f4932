"""Flextensional actuator: hand arithmetic on its printed numbers."""

from pytest import approx
from scipy.special import i0

from dong2015 import Verdict
from dong2015.chapter2.flextensional import flextensional_rows, gain_of_slow_test

ROWS = {row.id: row for row in flextensional_rows()}


def test_more_offset_at_the_same_voltage_peak_to_peak_has_no_effect() -> None:
    rows = [row for row in ROWS.values() if row.id.startswith("2.2.6-reduction")]
    assert len(rows) == 1
    assert "All three levels have 4 V peak to peak" in rows[0].note


def test_the_slow_test_requires_a_gain_of_three_at_resonance() -> None:
    # in the limit of slow sliding the ratio is exp(-beta)/I0(beta); at 3.5 mm/s somewhat more is left
    beta = gain_of_slow_test() * 52e-6 * 4 / 150 / 2 / 2e-6
    plateau = float(2.718281828**-beta / i0(beta))
    assert 0.2 < plateau < 0.3
    assert ROWS["2.2.5-speed-of-no-reduction-asperity-stick-slip"].computed == approx(
        1e3 * 0.75 * 2 * 3.14159265 * 16e3 * beta * 2e-6, rel=1e-6
    )
    assert ROWS["2.2.2-pulling-force-factor"].verdict is Verdict.REPRODUCED
