"""Loss of contact and decay length of every contact law."""

import numpy as np
import pytest
from pytest import approx

from sonolube.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap, force_decay_length

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
def test_contact_is_lost_where_the_force_is_a_hundredth_of_the_load(law: GapLaw) -> None:
    assert law.force(law.loss_displacement(LOADS), LOADS) == approx(0.01 * LOADS, rel=1e-6)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_force_at_equilibrium_decays_over_the_decay_length(law: GapLaw) -> None:
    small = 1e-5 * force_decay_length(law, LOADS)
    fall = (law.force(-small, LOADS) - law.force(small, LOADS)) / (2 * small)
    assert force_decay_length(law, LOADS) == approx(LOADS / fall, rel=1e-6)
