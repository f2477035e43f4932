"""Order of a plan: what a drift of friction leaves of the effect of vibration, and the first run."""

from collections import Counter

import numpy as np
import pytest

from sonolube.design.test_plan.comparison import BLOCKINGS, INTERLEAVED, RunState, randomised_runs
from sonolube.design.test_plan.plan import Procedure

EFFECT, DRIFT = -0.3, 2e-3  # N, N/s
PROCEDURE = Procedure(intrinsic_distance=11.61, vibrated_distance=7.21, measuring_time=12.0)


def difference_of_means(states: tuple[RunState, ...]) -> float:
    """Mean with less mean without vibration of a force that drifts in proportion to time, by thousands of samples."""
    impulse, measured = {False: 0.0, True: 0.0}, {False: 0.0, True: 0.0}
    start = 0.0
    for state in states:
        begin, start = start + state.settling, start + state.duration
        times = begin + (np.arange(1000) + 0.5) / 1000 * (start - begin)
        force = 0.9 + EFFECT * state.vibrated + DRIFT * times
        impulse[state.vibrated] += float(force.mean()) * state.measuring
        measured[state.vibrated] += state.measuring
    return impulse[True] / measured[True] - impulse[False] / measured[False]


@pytest.mark.parametrize("speed", [0.02, 0.0655, 0.3])
def test_a_linear_drift_leaves_the_effect_of_vibration_as_it_is(speed: float) -> None:
    assert difference_of_means(PROCEDURE.states(speed, INTERLEAVED)) == pytest.approx(EFFECT, abs=1e-12)


def test_without_and_then_with_vibration_takes_the_drift_for_an_effect() -> None:
    # the middles of the two windows of 12 s are 12 s and the settling of 7.21 m apart
    biased = difference_of_means(PROCEDURE.states(0.1, (False, True)))
    assert biased - EFFECT == pytest.approx(DRIFT * (12 + np.ceil(7.21 / 0.1)), rel=1e-9)


def test_each_state_is_measured_as_long_as_asked_for_after_it_has_settled() -> None:
    states = PROCEDURE.states(0.1, INTERLEAVED)
    for on in (False, True):
        assert sum(state.measuring for state in states if state.vibrated == on) == pytest.approx(12.0)
    assert [state.settling for state in states] == [117.0, 73.0, 73.0]  # 11.61 and 7.21 m at 0.1 m/s


@pytest.mark.parametrize("seed", range(4))
def test_the_first_point_is_run_first_and_every_block_has_each_point_once(seed: int) -> None:
    runs = randomised_runs(5, 6, blocking=BLOCKINGS["day"], specimens=1, seed=seed)
    assert runs[0].point == 0
    assert set(Counter((run.block, run.point) for run in runs).values()) == {1}
    assert [run.run for run in runs] == list(range(1, 31))
    assert {run.parts[0].vibrated for run in runs} == {INTERLEAVED}


def test_states_on_specimens_of_their_own_begin_in_turn_so_that_a_drift_cancels_over_pairs_of_blocks() -> None:
    runs = randomised_runs(3, 4, blocking=BLOCKINGS["day"], specimens=2, seed=0)
    tests = [(run.point, part.vibrated[0]) for run in runs for part in run.parts]
    for point in range(3):
        steps = [place if on else -place for place, (at, on) in enumerate(tests) if at == point]
        assert sum(steps) == 0  # a drift by one unit a test
    assert {run.specimens for run in runs if run.block == 2} == {(f"{n}b", f"{n}a") for n in (4, 5, 6)}


def orders(seed: int) -> list[list[int]]:
    """Points of each block in their order, six blocks of eight points."""
    runs = randomised_runs(8, 6, blocking=BLOCKINGS["day"], specimens=1, seed=seed)
    return [[run.point for run in runs if run.block == block] for block in range(1, 7)]


def test_the_order_differs_between_blocks_and_seeds_and_is_kept_by_a_seed() -> None:
    assert orders(1) == orders(1) != orders(2)
    assert len(set(map(tuple, orders(1)))) == 6
    assert list(range(8)) not in orders(1)[1:]


def test_every_point_takes_every_place_of_a_later_block_equally_often() -> None:
    places = np.array([order.index(0) for seed in range(200) for order in orders(seed)[1:]])
    counted = np.bincount(places, minlength=8)
    # 125 expected of 1000, standard deviation 10.5
    assert np.all(np.abs(counted - 125) < 45)
