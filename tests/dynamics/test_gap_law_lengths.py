"""Where contacts are lost and over what they change, and the Bessel functions behind exponential ones."""

import numpy as np
import pytest
from pytest import approx
from scipy.special import ive

from sonolube.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.gap_law import length_of_change
from sonolube.dynamics.harmonic_balance.bessel import bessel_logarithm, bessel_ratio

SEPARATION = np.linspace(2e-6, 40e-6, 200)
FORCE = 50 * np.exp(-SEPARATION / 2.3e-6 - (SEPARATION / 30e-6) ** 2)
LAWS: dict[str, GapLaw] = {
    "exponential": ExponentialGap(decay_length=2e-6),
    "sphere": HertzGap(tip_radius=5e-3, effective_modulus=1e11),
    "spring": LinearGap(normal_stiffness=5e6),
    "table": TabulatedGap(
        separation=SEPARATION,
        normal_force=FORCE,
        normal_stiffness=FORCE * (1 / 2.3e-6 + 2 * SEPARATION / (30e-6) ** 2),
    ),
}
LOADS = np.array([0.5, 3.0, 10.0])


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_contact_is_lost_where_a_hundredth_of_the_load_is_left(law: GapLaw) -> None:
    assert law.force(law.loss_displacement(LOADS), LOADS) == approx(0.01 * LOADS, rel=1e-6)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_force_at_rest_falls_over_the_length_of_change(law: GapLaw) -> None:
    small = 1e-5 * length_of_change(law, LOADS)
    fall = (law.force(-small, LOADS) - law.force(small, LOADS)) / (2 * small)
    assert length_of_change(law, LOADS) == approx(LOADS / fall, rel=1e-6)


def test_bessel_functions_are_scipys() -> None:
    x = np.r_[0.0, np.geomspace(1e-3, 600.0, 2000)]
    assert bessel_ratio(x) == approx(ive(1, x) / ive(0, x), rel=2e-6)
    assert bessel_logarithm(x) == approx(x + np.log(ive(0, x)), abs=2e-6)
