"""Manufacturing deviations: corners of the worst case, samples of a quantile."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.design.optimisation import NOMINAL, Deviation, Tolerance, deviations, worst_or_quantile
from sonolube.errors import InvalidInput


def test_the_corners_move_stiffness_against_mass_and_a_quantile_samples_normal_deviations() -> None:
    corners = deviations(Tolerance(manufacturing_tolerance=0.05))
    assert corners[0] == NOMINAL
    assert max(each.stiffness / each.mass for each in corners) == approx(1.05 / 0.95)
    assert {each.gain for each in corners} == {1.0, 0.95, 1.05}
    sampled = deviations(Tolerance(manufacturing_tolerance=0.05, quantile=0.9))
    assert np.std([each.mass for each in sampled[1:]]) == approx(0.05, rel=0.5)
    values = np.arange(11.0)[:, np.newaxis]
    assert worst_or_quantile(values, Tolerance(manufacturing_tolerance=0.05)) == approx([10.0])
    assert worst_or_quantile(values, Tolerance(manufacturing_tolerance=0.05, quantile=0.5)) == approx([6.0])
    assert Deviation() == NOMINAL


@mark.parametrize("quantile", [0.4, 1.01, 1.5])
def test_a_quantile_outside_a_half_to_one_is_refused(quantile: float) -> None:
    with raises(InvalidInput, match="quantile must"):
        Tolerance(manufacturing_tolerance=0.1, quantile=quantile)
    assert Tolerance(manufacturing_tolerance=0.1, quantile=1.0).quantile == 1.0
