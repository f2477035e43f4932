"""A prediction in words, from draws whose intervals are known: boundaries of each sentence from both sides."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, mark
from tests.prediction.linear_rigs import conditions, measured_rig

from sonolube.prediction import interval
from sonolube.prediction.applicability import Applicability
from sonolube.prediction.inputs import own_runs, rig_inputs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import Laboratory, RunCheck, rig_prediction
from sonolube.prediction.rig_statement import basis_words, heat_words, prediction_attributes, statement, wear_sentence
from sonolube.rig import read_rig
from sonolube.rig.datasets import LabelledArray, LabelledArrays

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def prediction(
    *,
    reduction: tuple[float, float] = (0.2, 0.6),
    left: tuple[float, ...] = (0.5, 0.8),
    labels: tuple[str, ...] = ("one run", "the other"),
    **attributes: Any,
) -> xr.Dataset:
    """Prediction with draws even between the ends of the 80 % interval of the reduction, and beyond."""
    low, high = reduction
    middle, half = (low + high) / 2, (high - low) / 2 / 0.8
    return xr.Dataset(
        {
            "friction_reduction": ("draw", np.linspace(middle - half, middle + half, 1001)),
            "measure_label": ("measure", np.array(labels[: len(left)], dtype=str)),
            "measure_share_left": ("measure", np.array(left)),
        },
        attrs={"contradiction": "", "wear": "", "unknown": 0, "heat": "no materials"} | attributes,
    )


def outcome(low: float, high: float) -> str:
    return statement(prediction(reduction=(low, high)))[0].removesuffix(
        " The vibration is along the normal of the contact."
    )


@mark.parametrize(
    ("low", "high", "words"),
    [
        (0.21, 0.58, "Friction falls by about 40 %. Likely between 21 and 58 % (8 chances in 10)."),
        (-0.004, 0.3, "Friction falls by about 15 %. Likely between 0 and 30 % (8 chances in 10)."),  # half a per cent
        (-0.006, 0.3, "Friction falls by about 15 %. Likely between 1 % more and 30 % less (8 chances in 10)."),
        (-0.3, 0.14, "Friction rises by about 8 %. Likely between 30 % more and 14 % less (8 chances in 10)."),
        (-0.2, -0.1, "Friction rises by about 15 %. Likely between 10 and 20 % more (8 chances in 10)."),
        (-0.004, 0.0049, "Friction does not change."),
        (-0.004, 0.0051, "Friction hardly changes. Likely between 0 and 1 % (8 chances in 10)."),
        (-0.0051, 0.004, "Friction hardly changes. Likely between 1 % more and 0 % less (8 chances in 10)."),
    ],
)
def test_the_change_of_friction_is_said_by_its_median_and_its_interval(low: float, high: float, words: str) -> None:
    assert outcome(low, high) == words


@mark.parametrize(("own", "words"), [(0, "none of yours"), (1, "1 run of yours"), (3, "3 runs of yours")])
def test_the_tests_behind_a_prediction_are_counted(own: int, words: str) -> None:
    found = statement(prediction(basis=basis_words(20, own)))[0]
    assert f"(8 chances in 10), from 20 published tests on other rigs and {words}. " in found


def test_an_unknown_change_and_an_untested_direction_are_said() -> None:
    found = statement(prediction(unknown=1))[0]
    assert found.startswith("Friction falls by anything from 0 to 100 %")
    assert found.endswith("along the normal of the contact.")
    along = statement(prediction(tested="Vibration along the sliding, tested"))[0]
    assert along == (
        "Vibration along the sliding, tested: friction falls by about 40 %."
        " Likely between 20 and 60 % (8 chances in 10)."
    )


def test_sentences_stand_in_their_order_and_empty_ones_are_left_out() -> None:
    found = statement(prediction(contradiction="No.", wear="Wear falls."))
    assert found[0] == "No."
    assert found[2] == "Wear falls."
    assert len(found) == 5
    assert len(statement(prediction())) == 3


def test_what_to_measure_is_a_run_here_or_the_best_of_the_others() -> None:
    assert statement(prediction(left=(0.5, 0.8)))[1] == (
        "One run at this point would leave 50 % of the width here, 80 % at twice the speed."
    )
    labels = ("run", "far", "stiffness by A", "stiffness by B", "stiffness by C")
    best = statement(prediction(left=(0.5, 0.8, 0.9, 0.3, 0.7), labels=labels))[1]
    assert best == (
        "One run at this point would leave 50 % of the width here, 80 % at twice the speed;"
        " stiffness by B would leave 30 %."
    )
    assert statement(prediction(left=(0.5, 0.8, 0.4), labels=labels))[1].endswith("stiffness by A would leave 40 %.")
    assert statement(prediction(left=()))[1] == "Own runs, fitted by `sonolube fit`, tell what vibration does here."


def test_heat_limits_from_fifty_kelvin_of_the_face_or_five_hundred_of_a_real_spot_on() -> None:
    # draws even from 0 to d: the upper end of the 80 % interval is 0.9 d; the spot is hotter by the ratio per watt
    rig = read_rig(RIGS / "tribometer.toml")  # 3 N at three times 410 MPa: a radius of 28 um
    for face, per_watt, verb in ((49.0, 10.0, "does not limit"), (51.0, 1.0, "limits"), (40.0, 12.6, "limits")):
        drawn = {"mean_temperature_rise": np.linspace(0, face / 0.9, 1001)}
        words = heat_words(rig, None, None, drawn, (1.0, per_watt))
        spot = f"{float(f'{face * per_watt:.2g}'):g}"
        assert words == (
            f"Heat of friction {verb}: at most (80 %) {face:.0f} K in the mean over the nominal face, {spot} K of flash"
            " temperature where one real spot of 28 um radius carries the load"
        )


def test_heat_without_materials_or_hardness_says_what_is_missing() -> None:
    rig, drawn = read_rig(RIGS / "tribometer.toml"), {"mean_temperature_rise": np.linspace(0, 10, 101)}
    assert heat_words(rig, None, None, {}, ("no materials", "no materials")) == "Heat is not computed: no materials"
    bare = replace(rig, contact=replace(rig.contact, pair=replace(rig.contact.pair, yield_strength=np.inf)))
    words = heat_words(bare, None, None, drawn, (1.0, "no hardness"))
    assert words.startswith("Heat of friction does not limit the nominal face: at most (80 %) 9 K")
    assert words.endswith("is not known: the bodies do not yield; give the hardness of the softer one")


def test_the_power_to_supply_stands_behind_the_heat() -> None:
    found = statement(prediction(heat="Heat", power_to_supply=6.234, power_is_at_least=0))[2]
    assert found == "Heat; the amplifier has to supply 6.23 W."
    bound = statement(prediction(heat="Heat", power_to_supply=6.234, power_is_at_least=1))[2]
    assert bound == "Heat; the amplifier has to supply at least 6.23 W."


def test_heat_and_power_that_are_not_known_are_said_with_the_reason() -> None:
    assert statement(prediction(heat="Heat is not computed: no materials"))[2] == (
        "Heat is not computed: no materials; power is not known: capacitance or voltage is missing."
    )


def test_an_interval_has_the_probability_that_is_asked_for() -> None:
    found = prediction(reduction=(0.2, 0.6))
    assert interval(found, "friction_reduction") == approx((0.2, 0.6))
    assert interval(found, "friction_reduction", 0.4) == approx((0.3, 0.5))
    values = LabelledArray(dims=("draw",), values=np.random.default_rng(0).permutation(np.linspace(0, 1, 1001)))
    labelled = LabelledArrays(variables={"friction_ratio": values}, coordinates={}, attrs={})
    for probability in (0.5, 0.6, 0.8, 0.95):
        low, high = interval(labelled, "friction_ratio", probability)
        assert (low, high) == approx(((1 - probability) / 2, (1 + probability) / 2))


def test_wear_is_not_known_where_runs_contradict_and_not_predicted_within_the_plane() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    assert wear_sentence(rig, ratios=None, contradicted=False).startswith("Wear is not predicted: ")
    lubricated = wear_sentence(rig, ratios=None, contradicted=False, is_lubricated=True)
    assert lubricated.startswith("What vibration does to wear is not known of a lubricated contact")
    assert "is not known where the runs contradict" in wear_sentence(rig, ratios=np.ones(9), contradicted=True)
    assert wear_sentence(rig, ratios=np.ones(9), contradicted=False).startswith("Wear does not change")


def attributes(
    *, ratios: list[float] | None = None, any_ratio: bool = False, laboratory: Laboratory | None = None, **change: Any
) -> dict[str, Any]:
    """Attributes of a prediction of the reference rig, with own runs whose check is as given."""
    rig = read_rig(RIGS / "tribometer.toml")
    inputs = rig_inputs(rig)
    found = rig_prediction(learned().friction, inputs.at(), count=100)
    own = None
    if ratios is not None:
        data = xr.Dataset({"friction_reduction": ("run", 1 - np.array(ratios))})
        own = own_runs(data, inputs, title="own")
        tested = measured_rig(ratios, conditions([2e-6] * len(ratios), [0.02] * len(ratios)))
        blank: Any = SimpleNamespace(probability=1.0, outlier_probability=np.ones(len(ratios)), left_out=tested, **{})
        check = RunCheck.__new__(RunCheck)
        for name, value in (vars(blank) | change).items():
            setattr(check, name, value)
        found = replace(found, check=check)
    limits = Applicability(refusal=None, caveats=("first",), any_ratio=any_ratio)
    return dict(prediction_attributes(rig, inputs, own, found, limits, laboratory))


def test_a_prediction_without_runs_has_the_numbers_of_its_rig() -> None:
    found = attributes()
    assert found["title"].startswith("Modified pin-on-disc tribometer")
    assert found["caveats"].split("\n")[0] == "first"
    assert found["contradiction"] == ""
    assert found["runs"] == 0
    assert found["unknown"] == 0
    assert found["vibration_amplitude"] == approx(2.5e-6)
    assert found["sliding_speed"] == approx(20.3e-3)
    assert found["friction_law"] == "asperity_stick_slip"
    assert found["friction_model"] == "asperity_stick_slip"
    assert 0 < found["friction_ratio_by_the_rigs_model"] < 1
    assert found["power_to_supply"] == approx(43.9, rel=2e-3)
    assert found["charging_power"] == approx(360e-9 * 28**2 * 22e3)
    assert found["power_is_at_least"] == 0
    assert "tested" not in found
    assert "actuator.amplitude_per_volt: 2.5 um at 28 V" in found["assumptions"]
    assert attributes(any_ratio=True)["unknown"] == 1
    assert attributes(any_ratio=True, ratios=[0.5, 0.4])["unknown"] == 0


def test_the_run_that_contradicts_most_is_named_with_what_was_predicted() -> None:
    found = attributes(
        ratios=[0.5, 1.2, 0.05], probability=0.002, lows=np.array([0.2, 0.3, 0.4]), highs=np.array([0.6, 0.7, 0.8])
    )
    assert found["contradiction"].startswith(
        "Your runs contradict every model (probability 0.002): ratio 1.20 where 0.30 to 0.70 (95 %) was predicted;"
    )
    below = attributes(
        ratios=[0.5, 0.8, 0.05], probability=0.002, lows=np.array([0.2, 0.3, 0.4]), highs=np.array([0.6, 0.7, 0.8])
    )
    assert "ratio 0.05 where 0.40 to 0.80" in below["contradiction"]
    assert found["runs"] == 3
    assert attributes(ratios=[0.5, 0.4], probability=0.06)["contradiction"] == ""


def test_each_run_that_disagrees_with_the_others_is_named_by_its_number() -> None:
    found = attributes(
        ratios=[0.5, 0.42, 0.9], left_out=np.array([0.47, 0.44, 0.46]), outlier_probability=np.array([0.9, 0.8, 0.003])
    )
    (line,) = (each for each in found["caveats"].split("\n") if "disagrees" in each)
    assert line == (
        "run 3 disagrees with the others: ratio 0.90 where they give 0.46 (probability 0.003); it counts less:"
        " repeat it"
    )


def test_caveats_of_a_laboratory_stand_among_those_of_the_prediction() -> None:
    odd = Laboratory(posterior=learned().friction, taught_by=("a",), contradicting=("odd rig",))
    assert "odd rig: its runs contradict every model" in attributes(laboratory=odd)["caveats"]
