"""Force gauge with hysteresis: properties of Preisach's model, and recovery of known loops."""

from itertools import pairwise
from unittest.mock import patch

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, fail, fixture, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.execution.compilation import Kernel, few_points
from sonolube.measurement.gauge.calibration import (
    PreisachCalibration,
    dissipated_energy,
    fit_branches,
    fit_preisach,
    force_from_branches,
    force_from_preisach,
    major_loop_dissipation,
)
from sonolube.measurement.gauge.preisach import PreisachPlane, preisach_output, relay_fractions

LEVELS = 6
PLANE = PreisachPlane(lowest=0.0, highest=6.0, levels=LEVELS)
WEIGHTS = np.random.default_rng(4).uniform(0.2, 1.0, PLANE.cells)
histories = st.lists(st.floats(0, 6), min_size=1, max_size=25)


def relays_one_by_one(history: list[float], fine: int = 40) -> float:
    """Sum over a dense crowd of single relays, each switched by hand: the model as its definition has it."""
    step = 1 / fine
    total = 0.0
    cell = 0
    for up in range(LEVELS):
        for down in range(up + 1):
            i, j = np.meshgrid(np.arange(fine), np.arange(fine), indexing="ij")
            alpha, beta = up + (i + 0.5) * step, down + (j + 0.5) * step
            real = alpha > beta if up > down else i >= j
            share = np.where(i == j, 0.5, 1.0) if up == down else np.ones_like(alpha)
            state = np.zeros_like(alpha, dtype=bool)
            for x in history:
                state = np.where(x >= alpha, True, np.where(x <= beta, False, state))
            total += WEIGHTS[cell] * float(np.sum(share * real * state) / np.sum(share * real))
            cell += 1
    return total


def output(history: list[float]) -> float:
    return float(preisach_output(PLANE, WEIGHTS, np.array(history))[-1])


@examples(25)
@given(history=histories)
def test_the_output_is_the_sum_of_single_relays(history: list[float]) -> None:
    assert output(history) == approx(relays_one_by_one(history), abs=0.02 * WEIGHTS.sum())


@settings(deadline=None)
@given(history=histories)
def test_relay_fractions_lie_between_zero_and_one_and_sum_to_the_output(history: list[float]) -> None:
    shares = relay_fractions(PLANE, np.array(history))
    assert shares.min() >= -1e-12
    assert shares.max() <= 1 + 1e-12
    assert shares @ WEIGHTS == approx(preisach_output(PLANE, WEIGHTS, np.array(history)))


@settings(deadline=None)
@given(history=histories, inner=histories, top=st.floats(0, 6))
def test_a_larger_extremum_wipes_out_smaller_ones(history: list[float], inner: list[float], top: float) -> None:
    below = [min(value, top) for value in inner]
    assert output([*history, 6.0, 0.0, *below, top, 0.0, 1.5]) == approx(output([0.0, top, 0.0, 1.5]), abs=1e-9)
    assert output([*history, 6.0]) == approx(WEIGHTS.sum())


@settings(deadline=None)
@given(low=st.floats(1, 3), high=st.floats(3, 5), before=histories)
def test_minor_loops_between_the_same_extrema_are_congruent(low: float, high: float, before: list[float]) -> None:
    along = np.linspace(low, high, 9)
    loops = []
    for past in ([6.0], [0.0], before):
        start = [*past, low, high]
        loop = [output([*start, *along[::-1], *along[:k]]) for k in range(1, 10)]
        loops.append(np.array(loop) - loop[0])
    assert loops[0] == approx(loops[1], abs=1e-9)
    assert loops[0] == approx(loops[2], abs=1e-9)


def test_the_energy_of_the_major_loop_is_that_of_its_relays() -> None:
    up = np.linspace(0, 6, 4001)
    x = np.concatenate([up, up[::-1]])
    calibration = PreisachCalibration(
        plane=PLANE, reversible=np.full(LEVELS, 9.0), weights=WEIGHTS, resting_force=1.0, force_deviation=0.0
    )
    force = force_from_preisach(calibration, displacement=x).applied_force
    assert dissipated_energy(displacement=x, applied_force=force) == approx(
        major_loop_dissipation(calibration), rel=1e-5
    )


def test_the_energy_of_an_ellipse_is_its_area() -> None:
    angle = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    x, force = 2e-6 * np.cos(angle), 5.0 * np.sin(angle + 0.3)
    assert abs(dissipated_energy(displacement=x, applied_force=force)) == approx(np.pi * 1e-5 * np.cos(0.3), rel=1e-5)


def ramps(turns: list[float], samples: int = 60) -> np.ndarray:
    legs = [np.linspace(a, b, samples, endpoint=False) for a, b in pairwise(turns)]
    return np.concatenate([*legs, [turns[-1]]])


CALIBRATION = [0.0, 1.0, 0.0, 0.8, 0.0, 0.6, 0.0, 0.4, 0.0, 0.2, 0.0, 1.0, 0.2, 1.0, 0.4, 1.0, 0.6, 1.0, 0.8, 1.0, 0.0]
TEST = [0.0, 0.9, 0.25, 0.7, 0.1, 0.5, 0.0]


def bouc_wen(x: np.ndarray) -> np.ndarray:
    """Force of a spring beside a Bouc-Wen element, by small steps: k x + z, dz = (A - |z|^n (beta s + gamma)) dx."""
    fine = np.interp(np.arange(0, x.size - 1, 0.01), np.arange(x.size), x)
    z, at_samples = 0.0, [0.0]
    for place, dx in enumerate(np.diff(fine), start=1):
        z += (40.0 - 30.0 * (np.sign(dx * z) + 0.2) * abs(z)) * dx
        if place % 100 == 0:
            at_samples.append(z)
    return np.asarray(10.0 * x[: len(at_samples)] + np.array(at_samples))


@fixture(scope="module")
def holder() -> tuple[np.ndarray, np.ndarray]:
    x = ramps(CALIBRATION)
    force = bouc_wen(x)
    return 1e-6 * x[: force.size], force


def test_loops_of_a_bouc_wen_holder_are_recovered_within_four_percent(holder: tuple[np.ndarray, np.ndarray]) -> None:
    calibration = fit_preisach(displacement=holder[0], applied_force=holder[1], levels=14)
    x = ramps(TEST)
    truth = bouc_wen(x)
    found = force_from_preisach(calibration, displacement=1e-6 * x[: truth.size])
    miss = found.applied_force - truth
    assert np.sqrt(np.mean(miss**2)) < 0.04 * np.ptp(holder[1])
    branches = fit_branches(displacement=holder[0], applied_force=holder[1])
    plain = force_from_branches(branches, displacement=1e-6 * x[: truth.size]).applied_force - truth
    assert np.sqrt(np.mean(miss**2)) < 0.6 * np.sqrt(np.mean(plain**2))


def test_loops_of_a_preisach_holder_are_recovered_within_their_noise() -> None:
    x = ramps([6 * turn for turn in CALIBRATION])
    noise = 0.01 * WEIGHTS.sum()
    force = 2.0 + 4 * x - preisach_output(PLANE, WEIGHTS, x) + noise * np.random.default_rng(0).standard_normal(x.size)
    found = fit_preisach(displacement=x, applied_force=force, levels=LEVELS)
    assert found.force_deviation == approx(noise, rel=0.1)
    assert found.resting_force == approx(2.0, abs=3 * noise)
    test = ramps([6 * turn for turn in TEST])
    known = force_from_preisach(found, displacement=test, displacement_uncertainty=0.01)
    truth = 2.0 + 4 * test - preisach_output(PLANE, WEIGHTS, test)
    assert np.mean(np.abs(known.applied_force - truth) < 2 * known.applied_force_uncertainty) > 0.95


def test_the_uncertainty_of_the_sensor_is_multiplied_by_the_stiffness() -> None:
    x = ramps([0.0, 1e-6, 0.0])
    found = force_from_preisach(
        fit_preisach(displacement=x, applied_force=3e6 * x), displacement=x, displacement_uncertainty=1e-8
    )
    assert found.applied_force == approx(3e6 * x, abs=1e-6)
    assert found.applied_force_uncertainty == approx(0.03, rel=1e-3)


def test_polynomial_branches_are_recovered_from_their_loop() -> None:
    x = ramps([0.0, 1.0, 0.0], samples=200)
    rising = np.arange(x.size) < 200
    force = np.where(rising, 2 * x - x**2, x**3)
    found = fit_branches(displacement=x, applied_force=force)
    again = force_from_branches(found, displacement=x, displacement_uncertainty=0.01)
    assert again.applied_force == approx(force, abs=1e-3)
    assert again.applied_force_uncertainty[100] == approx(0.01 * abs(2 - 2 * x[100]), rel=0.02)


def test_a_reading_outside_the_calibrated_range_is_refused() -> None:
    x = ramps([0.0, 1e-6, 0.0])
    found = fit_preisach(displacement=x, applied_force=3e6 * x)
    with raises(OutsideRange, match=r"displacement must lie between 0 and 1e-06 m, .* got 2e-06 m"):
        force_from_preisach(found, displacement=[0.0, 2e-6])
    with raises(InvalidInput, match="displacement does not vary"):
        fit_preisach(displacement=np.ones(50), applied_force=np.ones(50))
    with raises(InvalidInput, match="5 samples are too few for 16 levels"):
        fit_preisach(displacement=np.arange(5.0), applied_force=np.ones(5))
    with raises(InvalidInput, match="levels must lie between 2 and 64"):
        PreisachPlane(lowest=0.0, highest=1.0, levels=65)


def test_a_few_samples_are_converted_without_compiling_and_alike() -> None:
    x = np.array(ramps(TEST)) * 6.0
    compiled = preisach_output(PLANE, WEIGHTS, x), relay_fractions(PLANE, x)
    with few_points(), patch.object(Kernel, "compiled", property(lambda kernel: fail("compiled for a few samples"))):
        plain = preisach_output(PLANE, WEIGHTS, x), relay_fractions(PLANE, x)
    for one, other in zip(compiled, plain, strict=True):
        assert one == approx(other, abs=1e-12)
