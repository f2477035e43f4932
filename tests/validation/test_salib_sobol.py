"""Sobol indices against SALib: the same sample matrices in, the same first-order and total-order indices out.

Both programs use Saltelli's first-order estimator and Jansen's total-order estimator (Saltelli et al. 2010, table 2, b
and f) over the variance of the matrices A and B together. They differ in the mean that outcomes are counted from, that
of A and B here and that of all matrices in SALib, which adds to each first-order index

    (mean(y_A, y_B) - mean(all y)) mean(y_AB - y_A) / Var(y_A, y_B) .

With this term the indices agree to rounding. The intervals are percentiles of a bootstrap here and 1.96 standard
deviations of one in SALib, which agree where the estimates are nearly normal.

Source: J. Herman, W. Usher, J. Open Source Softw. 2, 97 (2017), doi:10.21105/joss.00097.
"""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from SALib.analyze import sobol as salib_analysis
from SALib.sample import sobol as salib_sampling
from SALib.test_functions import Ishigami, Sobol_G

from sonolube.checks import Floats
from sonolube.design import propagate, saltelli_sample, sobol_indices

ROWS = 4096
G_COEFFICIENTS = np.array([0.0, 1.0, 4.5, 9.0, 99.0])


def problem(inputs: int) -> dict[str, object]:
    return {"num_vars": inputs, "names": [f"x{i}" for i in range(inputs)], "bounds": [[0.0, 1.0]] * inputs}


def ishigami(points: Floats) -> Floats:
    x = np.pi * (2 * points.reshape(-1, 3) - 1)
    return np.asarray(Ishigami.evaluate(x)).reshape(points.shape[:-1])


def sobol_g(points: Floats) -> Floats:
    x = points.reshape(-1, G_COEFFICIENTS.size)
    return np.asarray(Sobol_G.evaluate(x, G_COEFFICIENTS)).reshape(points.shape[:-1])


def ishigami_closed_form() -> tuple[Floats, Floats]:
    # T. Ishigami, T. Homma, ISUMA 1990, with a = 7 and b = 0.1
    alone = np.array([0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 49 / 8, 0.0])
    together = 0.01 * np.pi**8 * (1 / 18 - 1 / 50) * np.array([1, 0, 1])
    variance = alone.sum() + together[0]
    return alone / variance, (alone + together) / variance


def sobol_g_closed_form() -> tuple[Floats, Floats]:
    # I. M. Sobol', Math. Comput. Simul. 55, 271 (2001): V_i = 1/(3 (1 + a_i)^2), V = prod(1 + V_i) - 1
    alone = 1 / (3 * (1 + G_COEFFICIENTS) ** 2)
    product = np.prod(1 + alone)
    return alone / (product - 1), alone * product / (1 + alone) / (product - 1)


FUNCTIONS = {"ishigami": (ishigami, 3, ishigami_closed_form), "g-function": (sobol_g, 5, sobol_g_closed_form)}


def salib_order(blocks: Floats) -> Floats:
    """Rows A, A_B by input, B for each sample, as SALib orders them, from the blocks A, B, A_B by input."""
    return np.moveaxis(np.concatenate([blocks[:1], blocks[2:], blocks[1:2]]), 0, 1).reshape(-1, *blocks.shape[2:])


def block_order(rows: Floats, inputs: int) -> Floats:
    """Blocks A, B, A_B by input from the rows of SALib."""
    blocks = np.moveaxis(rows.reshape(-1, inputs + 2, *rows.shape[1:]), 1, 0)
    return np.concatenate([blocks[:1], blocks[-1:], blocks[1:-1]])


def centring_term(outcomes: Floats) -> Floats:
    a, b, a_b = outcomes[0], outcomes[1], outcomes[2:]
    both = np.concatenate([a, b])
    return np.asarray((both.mean() - outcomes.mean()) * (a_b - a).mean(axis=1) / both.var())


def assert_same_indices(outcomes: Floats) -> None:
    inputs = outcomes.shape[0] - 2
    expected = salib_analysis.analyze(
        problem(inputs), salib_order(outcomes), calc_second_order=False, num_resamples=10, seed=1
    )
    indices = sobol_indices(outcomes, resamples=10)
    assert indices.total_order == approx(expected["ST"], rel=1e-9, abs=1e-12)
    assert indices.first_order + centring_term(outcomes) == approx(expected["S1"], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_indices_from_saltelli_samples_are_those_of_salib_and_of_the_closed_form(name: str) -> None:
    function, inputs, closed_form = FUNCTIONS[name]
    outcomes = function(saltelli_sample(inputs, samples=ROWS)[0])
    assert_same_indices(outcomes)
    first, total = closed_form()
    indices = sobol_indices(outcomes)
    assert indices.first_order == approx(first, abs=5e-3)
    assert indices.total_order == approx(total, abs=5e-3)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_indices_from_the_samples_of_salib_are_those_of_salib(name: str) -> None:
    function, inputs, closed_form = FUNCTIONS[name]
    rows = salib_sampling.sample(problem(inputs), 1024, calc_second_order=False, seed=3)
    outcomes = function(block_order(rows, inputs))
    assert_same_indices(outcomes)
    assert sobol_indices(outcomes).total_order == approx(closed_form()[1], abs=0.02)


def test_both_programs_take_column_i_of_a_b_from_b() -> None:
    for blocks in (
        saltelli_sample(4, samples=64)[0],
        block_order(salib_sampling.sample(problem(4), 64, calc_second_order=False, seed=3), 4),
    ):
        a, b = blocks[:2]
        for i in range(4):
            expected = a.copy()
            expected[:, i] = b[:, i]
            assert np.array_equal(blocks[2 + i], expected)


def test_the_estimators_are_those_of_salib_to_rounding() -> None:
    outcomes = ishigami(saltelli_sample(3, samples=256)[0])
    centred = outcomes - outcomes[:2].mean()
    indices = sobol_indices(outcomes, resamples=10)
    for i in range(3):
        matrices = centred[0], centred[2 + i], centred[1]
        assert indices.first_order[i] == approx(salib_analysis.first_order(*matrices), rel=1e-12, abs=1e-14)
        assert indices.total_order[i] == approx(salib_analysis.total_order(*matrices), rel=1e-12, abs=1e-14)


def test_the_bootstrap_intervals_have_the_width_of_those_of_salib() -> None:
    outcomes = ishigami(saltelli_sample(3, samples=1024)[0])
    indices = sobol_indices(outcomes)
    expected = salib_analysis.analyze(
        problem(3), salib_order(outcomes), calc_second_order=False, num_resamples=1000, seed=1
    )
    assert np.ptp(indices.first_order_interval, axis=1) / 2 == approx(expected["S1_conf"], rel=0.15)
    assert np.ptp(indices.total_order_interval, axis=1) / 2 == approx(expected["ST_conf"], rel=0.15)


def test_the_indices_of_a_rigs_friction_ratio_are_those_of_salib() -> None:
    rig_file = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer_uncertain.toml"
    outcomes = propagate(rig_file, samples=64, indices=True)["friction_ratio"].values
    assert np.isfinite(outcomes).all()
    assert_same_indices(outcomes)
