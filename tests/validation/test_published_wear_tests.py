"""Published wear tests, and the error of the wear models on them, against printed numbers and hand computations."""

from math import exp, log, sqrt
from pathlib import Path

from pytest import approx, mark

import sonolube as sl
from sonolube.models.wear import WEAR_MODELS
from sonolube.report.results.rig_point import worn_on
from sonolube.rig import read_rig
from sonolube.validation.published_wear_tests import wear_model_errors, wear_tests

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def test_the_ratios_are_those_of_the_printed_rates_reductions_and_words() -> None:
    ratios = [test.wear_rate_ratio for test in wear_tests()]
    assert ratios[:6] == approx(
        [1.214 / 2.237, 1.338 / 2.581, 1.248 / 2.430, 1.509 / 2.414, 1.381 / 2.554, 1.392 / 2.551]
    )
    assert ratios[6:11] == approx([1.0, 1.0, 1 - 0.53, 1 - 0.73, 1 - 0.726])
    assert ratios[11] is None
    assert wear_tests()[-1].overall_wear_rate == approx(0.0057e-9)  # mm3/m, erratum E31
    assert [test.label for test in wear_tests()] == [f"W-{number}" for number in range(1, 13)]


def test_the_error_of_the_default_model_follows_from_table_3_3_and_the_printed_rates() -> None:
    # D's model has 2.566e-2 mm3/m without and 1.354e-2 with vibration on the tribometer (Tables 3.3 and 3.4), 0.528
    found = wear_model_errors("dong_2015_half_period")
    ratio = 1.3545 / 2.5657
    measured = [1.214 / 2.237, 1.338 / 2.581, 1.248 / 2.430, 1.509 / 2.414, 1.381 / 2.554, 1.392 / 2.551]
    errors = [ratio - each for each in (*measured, 1.0, 1.0, 0.47, 0.27)]
    assert found.ratio_rms == approx(sqrt(sum(each**2 for each in errors) / 10), rel=1e-3)
    assert found.ratio_count == 10
    off, on = (2.237, 2.581, 2.430, 2.414, 2.554, 2.551), (1.214, 1.338, 1.248, 1.509, 1.381, 1.392)
    logs = [*(log(2.5657 / each) for each in off), *(log(1.3545 / each) for each in on)]
    assert found.rate_factor == approx(exp(sqrt(sum(each**2 for each in logs) / 12)), rel=1e-3)
    assert (found.rate_count, found.out_of_range) == (12, ("W-11", "W-12"))
    assert found.largest_factor == approx(2.5657 / 2.237, rel=1e-3)
    assert found.largest_label == "W-1"


@mark.parametrize("model", list(WEAR_MODELS))
def test_every_wear_model_has_a_finite_error(model: str) -> None:
    found = wear_model_errors(model)
    assert 0 < found.ratio_rms < 1
    assert 1 < found.rate_factor <= found.largest_factor
    assert found.ratio_count + len(found.out_of_range) in (11, 12)


@mark.parametrize(
    ("name", "labels"),
    [
        ("tribometer", ["W-1", "W-4", "W-5", "W-6"]),
        ("welder_flat", ["W-12"]),
        ("welder_round", ["W-11"]),
        ("collar", []),
    ],
)
def test_what_was_measured_on_a_rig_stands_beside_it(name: str, labels: list[str]) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    amplitude = 2.5e-6 if rig.vibration_amplitude is None else rig.vibration_amplitude
    assert [test.label for test in worn_on(rig, vibration_amplitude=amplitude)] == labels


def test_wear_states_its_error_and_what_was_measured_in_words_and_json() -> None:
    answer = sl.wear(RIGS / "welder_flat.toml")
    found, errors = answer.object(), wear_model_errors("dong_2015_load_balanced")
    assert found["model_error"]["wear_rate_ratio"] == {"rms": approx(errors.ratio_rms, rel=1e-12), "tests": 11}
    assert found["model_error"]["wear_rate"]["largest_test"] == "W-12"
    (measured,) = found["measured"]
    assert measured["wear_rate"] == {"value": approx(0.0057e-9), "unit": "m2"}
    rows = dict(answer.rows)
    assert rows["measured W-12"].startswith("0.0057 mm3/m of a test with the vibration off and on")
    assert "on 11 published tests" in rows["error of the model"]
    round_tip = dict(sl.wear(RIGS / "welder_round.toml").rows)["measured W-11"]
    assert "a reduction of 72.6 %" in round_tip
