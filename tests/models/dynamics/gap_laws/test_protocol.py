"""Every contact law: stiffness, derivatives, loss of contact, decay length, and its branch in the kernels."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import (
    GAP_LAWS,
    ExponentialGap,
    GapLaw,
    HertzGap,
    LinearGap,
    TabulatedGap,
    force_decay_length,
)
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL, HERTZ, LINEAR, TABULATED

SEPARATION = np.linspace(2e-6, 40e-6, 200)
FORCE = 50 * np.exp(-SEPARATION / 2.3e-6 - (SEPARATION / 30e-6) ** 2)
LAWS: dict[str, GapLaw] = {
    "exponential": ExponentialGap(decay_length=2e-6),
    "sphere": HertzGap(tip_radius=5e-3, effective_modulus=1e11),
    "spring": LinearGap(normal_stiffness=5e6),
    "table": TabulatedGap(
        separation=SEPARATION, normal_force=FORCE, normal_stiffness=FORCE * (1 / 2.3e-6 + 2 * SEPARATION / (30e-6) ** 2)
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


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_stiffness_is_the_negative_derivative_of_the_force(law: GapLaw) -> None:
    x, step = np.array([-1e-7, 0.0, 5e-8]), 1e-12
    difference = (law.force(x - step, 3.0) - law.force(x + step, 3.0)) / (2 * step)
    assert law.stiffness(x, 3.0) == approx(difference, rel=1e-4)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_derivatives_by_load_and_parameters_are_central_differences(law: GapLaw) -> None:
    x = np.array([-1e-7, 0.0, 5e-8])
    for name, derivative in law.force_derivatives(x, 3.0).items():
        if name == "normal_load":
            above, below, step = law.force(x, 3.003), law.force(x, 2.997), 0.003
        else:
            step = 1e-3 * getattr(law, name)
            above, below = (
                replace(law, **{name: getattr(law, name) + change}).force(x, 3.0)  # type: ignore[type-var]
                for change in (step, -step)
            )
        assert derivative == approx((above - below) / (2 * step), rel=1e-5, abs=1e-9 * np.max(np.abs(derivative))), name


def test_the_kernels_refuse_a_law_that_they_do_not_evaluate() -> None:
    with raises(InvalidInput, match=r"gap_law must be one of ExponentialGap, .* tabulate any other law"):
        kernel_law(object())  # type: ignore[arg-type]


def test_every_law_of_the_table_has_a_branch_of_its_own_in_the_kernels() -> None:
    assert sorted(law.kind for law in GAP_LAWS.values()) == [EXPONENTIAL, HERTZ, LINEAR, TABULATED]
