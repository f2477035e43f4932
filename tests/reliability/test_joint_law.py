"""One law for all directions: moments of its lengths by independent draws, and its limits."""

from dataclasses import replace
from math import exp, log

import numpy as np
from one_law_scores import LawScores, law_scores, law_verdict
from pytest import approx
from reliability.joint_law import SLIP_RATIO, JointLaw, SharedLength, plane_rows

from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, published_rigs
from sonolube.prediction.hierarchy import OwnParameters

MU, KAPPA, TAU, TAU_L, ERROR = log(0.36), 0.2, 0.5, 0.6, 0.3
ROW = np.array([MU, KAPPA, log(TAU), log(TAU_L), log(0.1), 0.0, log(1.5e-6)])


def test_lengths_are_those_of_a_latent_decay_length_and_a_latent_slip_ratio() -> None:
    # ln l = ln l_0 + kappa + tau_l z, ln s = mu + tau z' + ln l, and l over the amplitude has the amplitude's error
    rng = np.random.default_rng(0)
    at = replace(published_rigs()[0].at, amplitude_spread=ERROR, amplitude_factor=2.0)
    found = SharedLength(ROW[:6], rng.standard_normal((200_000, 3)), at)
    z, slip, error = rng.standard_normal((3, 200_000))
    length = KAPPA + TAU_L * z
    ratio, memory = length - ERROR * error - log(2), MU + TAU * slip + length + log(REFERENCE_DECAY_LENGTH)
    for own, drawn in ((found.log_factor, ratio), (found.log_parameter, memory)):
        assert own.mean() == approx(drawn.mean(), abs=0.01)
        assert own.std() == approx(drawn.std(), rel=0.01)
    correlation = TAU_L**2 / np.sqrt((TAU_L**2 + ERROR**2) * (TAU_L**2 + TAU**2))
    assert np.corrcoef(found.log_factor, found.log_parameter)[0, 1] == approx(correlation, abs=0.01)


def test_within_the_plane_the_slip_length_has_the_scatter_of_both() -> None:
    (mu, *_, sigma, _) = plane_rows(ROW[None])[0]
    assert exp(mu) == approx(0.36 * exp(KAPPA) * REFERENCE_DECAY_LENGTH)
    assert exp(plane_rows(ROW[None])[0, 2]) == approx(np.hypot(TAU, TAU_L))
    assert sigma == approx(log(0.1))


def test_without_one_slip_a_rig_along_the_normal_has_the_memory_length_that_ships() -> None:
    rig, deviates = published_rigs()[0], np.random.default_rng(1).standard_normal((50, 3))
    rows = np.tile(ROW, (50, 1))
    found = JointLaw(is_one_slip=False).rig_draws(rows, deviates, rig, conditioned=False).parameters
    along = np.array([log(1.5e-6), *ROW[1:6]])
    shipped = OwnParameters(np.tile(along, (50, 1)), deviates, rig.at)
    assert found.log_parameter == approx(shipped.log_parameter)
    assert found.log_factor == approx(shipped.log_factor)


def test_the_prior_of_the_slip_ratio_is_mindlins_within_a_factor_of_e() -> None:
    drawn = JointLaw().draws(4096)
    assert approx(0.3 * 1.2) == SLIP_RATIO
    assert np.median(drawn[:, 0]) == approx(log(SLIP_RATIO), abs=0.02)
    assert drawn[:, 0].std() == approx(1.0, rel=0.03)


def scores(name: str, along: str, crps_along: float, within: str, crps_within: float) -> LawScores:
    return LawScores(name=name, along=along, crps_along=crps_along, within=within, crps_within=crps_within)


def test_a_law_is_worse_by_a_larger_crps_or_by_fewer_tests_within() -> None:
    shipped = scores("two", "13/17/18 of 20", 0.126, "4/7/7 of 7", 0.080)
    assert not scores("same", "13/17/18 of 20", 0.126, "4/7/7 of 7", 0.080).is_worse_than(shipped)
    assert scores("fewer", "13/16/18 of 20", 0.1, "4/7/7 of 7", 0.05).is_worse_than(shipped)
    assert scores("larger", "13/17/18 of 20", 0.126, "4/7/7 of 7", 0.081).is_worse_than(shipped)
    better = scores("better", "14/17/18 of 20", 0.12, "4/7/7 of 7", 0.07)
    said = law_verdict([shipped, better])
    assert said.startswith("Worse than the two laws that ship in no score: better. Against them, better: CRPS -0.006")


def test_the_page_says_of_each_law_that_was_tried_how_much_worse_it_is() -> None:
    found = law_scores()
    assert found[0].name == "two laws (shipped)"
    # as the room of prediction has them: 13, 17 and 18 of 20, and 0.126 and 0.080
    assert found[0].counts == [13, 17, 18, 4, 7, 7]
    assert (found[0].crps_along, found[0].crps_within) == approx((0.126, 0.080), abs=6e-4)
    said = law_verdict(found)
    assert all(f"{one.name}: CRPS" in said for one in found[1:])
