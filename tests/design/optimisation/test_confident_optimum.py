"""Designs that reach a reduction with a chance: the chance itself, what is out of reach, rigs without a prediction."""

from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, fixture, raises

import sonolube as sl
from sonolube.design.optimisation.confident_optimum import computed_chances
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.tasks.design.optimise import optimise

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
NEAR = {"drive.frequency": "20.6kHz:20.9kHz"}


@fixture(scope="module")
def rig() -> sl.Rig:
    return sl.read_rig(RIGS / "tribometer.toml")


@fixture(scope="module")
def answers(rig: sl.Rig) -> dict[str, Any]:
    return {
        "plain": optimise(rig, target_reduction=0.4, over=NEAR),
        "confident": optimise(rig, target_reduction=0.4, confidence=0.7, over=NEAR),
    }


def test_the_best_design_has_the_chance_that_is_asked_for(rig: sl.Rig, answers: dict[str, Any]) -> None:
    best = answers["confident"].optimum.best
    amplitude = float(best.evaluation.quantities["vibration_amplitude"][0])
    chances = computed_chances(rig)
    exact = float(chances.of(0.4, vibration_amplitude=amplitude, frequency=best.frequency))
    assert answers["confident"].chance.chance == approx(exact)
    assert 0.695 <= exact < 0.75  # and no more amplitude than that asks for
    ratios = chances.prediction.ratios(chances.inputs.at(vibration_amplitude=amplitude).conditions)[:, 0]
    assert np.mean(ratios <= 0.6) == approx(exact, abs=0.03)


def test_a_chance_costs_amplitude_and_power(answers: dict[str, Any]) -> None:
    assert answers["plain"].chance.chance < 0.65
    assert answers["plain"].chance.wanted is None
    plain, confident = (answers[name].optimum.best for name in ("plain", "confident"))
    assert confident.objective("power") > 1.05 * plain.objective("power")
    assert confident.voltage_peak_to_peak > plain.voltage_peak_to_peak


def test_the_answer_leads_with_what_is_predicted(answers: dict[str, Any]) -> None:
    found = answers["confident"].json_object()["predicted"]
    low, high = found["friction_ratio"]["interval_80"]
    assert low < found["friction_ratio"]["median"] < high
    assert found["confidence"] == approx(0.7)
    assert "40 % less friction with 7" in answers["confident"].chance.text


def test_a_chance_that_no_voltage_gives_is_out_of_reach_with_the_highest_one(rig: sl.Rig) -> None:
    with raises(
        OutsideRange, match=r"80 % less friction with 9 chances in 10; no voltage up to 30 V .* more than"
    ) as no:
        optimise(rig, target_reduction=0.8, confidence=0.9, voltage_limit=30.0, over=NEAR)
    assert str(no.value).endswith("; one run of your own would tell")


def test_of_a_lubricated_contact_no_chance_is_known(rig: sl.Rig) -> None:
    oiled = sl.read_rig(RIGS / "tribometer.toml", changes=["friction.friction_coefficient=0.05"])
    with raises(InvalidInput, match="need a dry contact, or runs of your own"):
        optimise(oiled, target_reduction=0.4, confidence=0.7, over=NEAR)
    with raises(InvalidInput, match="confidence must lie between 0 and 100 %, got 150 %"):
        optimise(rig, target_reduction=0.4, confidence=1.5, over=NEAR)
