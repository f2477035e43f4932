"""Rig at its operating point in words: error of its model, published tests under its conditions, lubrication, wear."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from pytest import MonkeyPatch, approx

from sonolube.example_files import example_file
from sonolube.report.results import rig_point as results
from sonolube.rig import read_rig
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS


def interval(low: float | None = 0.21) -> Any:
    return SimpleNamespace(
        low=low, high=0.53, median=low and 0.4, text="0.21 to 0.53", reason="" if low else "out of range"
    )


def test_the_error_of_the_model_is_said_with_the_tests_that_it_is_of() -> None:
    error: Any = SimpleNamespace(rms=0.1174, count=15)
    both = results.BeyondTheModel(error=error, interval=interval())
    assert both.rows() == [
        ("left out", "the error of the model: +-0.12 in the ratio on 15 published tests, each unseen"),
        ("predicted ratio", "0.21 to 0.53"),
    ]
    assert both.object() == {
        "model_error": {"rms": 0.1174, "tests": 15},
        "predicted_friction_ratio": {"median": 0.4, "interval_80": [0.21, 0.53], "reason": None},
    }
    unknown = results.BeyondTheModel(error=None, interval=interval(None))
    assert unknown.rows()[0] == ("left out", "the error of the model, which with these parameters is not known")
    assert unknown.object() == {
        "model_error": None,
        "predicted_friction_ratio": {"median": None, "interval_80": None, "reason": "out of range"},
    }
    without = results.BeyondTheModel(error=error, interval=None)
    assert without.rows() == [("left out", "the error of the model, which --interval states")]
    assert without.object() == {}


@pytest.mark.parametrize("is_normal", [True, False])
def test_the_error_on_published_tests_is_of_vibration_along_the_normal(
    is_normal: bool, monkeypatch: MonkeyPatch
) -> None:
    error = SimpleNamespace(rms=0.1, count=2)
    monkeypatch.setattr("sonolube.validation.assessment.unseen_error", lambda model: error)
    monkeypatch.setattr("sonolube.prediction.applicability.friction_interval", lambda rig, evidence: "interval")
    inner = SimpleNamespace(rig=SimpleNamespace(direction=SimpleNamespace(is_normal=is_normal)))
    monkeypatch.setattr("sonolube.rig.resolved_rig.resolved_rig", lambda rig: inner)
    rig: Any = SimpleNamespace()
    found: Any = results.beyond_the_model(rig, rig, interval=True)
    assert (found.error, found.interval) == (error if is_normal else None, "interval")
    assert results.beyond_the_model(rig, rig, interval=False) == results.BeyondTheModel(error=None, interval=None)


TEST: Any = SimpleNamespace(label="A-1", set_name="A", friction_ratio=0.37012, uncertainty=0.0461)


def test_a_published_test_is_said_with_its_uncertainty_and_source() -> None:
    source = NORMAL_VIBRATION_SETS["A"]
    assert results.measured_text(TEST) == f"friction ratio 0.37 +- 0.046: {source}"
    bare = SimpleNamespace(**(vars(TEST) | {"uncertainty": None}))
    assert results.measured_text(bare) == f"friction ratio 0.37: {source}"  # type: ignore[arg-type]
    assert results.measured_object(TEST) == {
        "test": "A-1", "set": source, "friction_ratio": 0.37012, "uncertainty": 0.0461,
    }  # fmt: skip


def test_the_reference_rig_is_that_of_published_tests_within_two_percent_of_every_condition() -> None:
    # D 4.1 prints tests of the reference rig at 3 N, 20.3 mm/s and 2.5 um
    rig = read_rig(example_file("tribometer").source)
    found = [test.label for test in results.measured_on(rig, vibration_amplitude=2.5e-6)]
    assert "A-1" in found
    assert [test.label for test in results.measured_on(rig, vibration_amplitude=2.5e-6 * 1.019)] == found
    for amplitude in (2.5e-6 * 1.025, 2.5e-6 / 1.025):
        assert "A-1" not in [test.label for test in results.measured_on(rig, vibration_amplitude=amplitude)]
    heavier = rig.replace("contact.normal_load", "3.1 N")
    assert "A-1" not in [test.label for test in results.measured_on(heavier, vibration_amplitude=2.5e-6)]
    higher = rig.replace("drive.frequency", "23 kHz")
    assert "A-1" not in [test.label for test in results.measured_on(higher, vibration_amplitude=2.5e-6)]


def test_a_rig_without_drive_or_along_the_plane_has_no_published_tests_beside_it() -> None:
    sideways: Any = SimpleNamespace(drive=object(), direction=SimpleNamespace(is_normal=False))
    undriven: Any = SimpleNamespace(drive=None, direction=SimpleNamespace(is_normal=True))
    assert results.measured_on(sideways, vibration_amplitude=1e-6) == ()
    assert results.measured_on(undriven, vibration_amplitude=1e-6) == ()


class Coefficients(NamedTuple):
    first: float
    second: float


@dataclass
class Wear:
    mechanism: str = "abrasive"
    vibration_effect: str = "less"
    reasons: tuple[str, ...] = ("hard on soft",)
    evidence: tuple[str, ...] = ("Table 2.5",)


def lubricated(share: float = 0.5, ratio: float | None = 2.0) -> Any:
    return SimpleNamespace(
        sliding_speed=0.02, nominal_pressure=1e6, asperity_load_fraction=share, coefficients=Coefficients(0.0712, 0.12),
        best="second", friction_model="kinematic", vibration_amplitude=2.5e-6, amplitude_source="file",
        amplitude_origin="stated", film_coefficient=0.0123, film_thickness=None if ratio is None else 0.4e-6,
        film_ratio=ratio,
    )  # fmt: skip


def test_methods_of_lubrication_have_their_coefficients_and_the_best_is_marked() -> None:
    assert results.method_rows(lubricated()) == [["first", "0.0712", ""], ["second", "0.12", "best"]]


@pytest.mark.parametrize(
    ("share", "regime"), [(0.91, "boundary"), (0.9, "mixed"), (0.11, "mixed"), (0.1, "full film"), (0.02, "full film")]
)
def test_the_regime_of_a_film_is_named_by_the_load_on_asperities(share: float, regime: str) -> None:
    rows = dict(results.regime_rows(lubricated(share), None))
    assert rows["film"] == f"400 nm, 2 times the rms height ({regime}), with a coefficient of 0.0123"


def test_a_regime_has_its_share_of_the_load_amplitude_and_the_kind_of_wear() -> None:
    wear: Any = Wear()
    assert results.regime_rows(lubricated(0.5, None), wear) == [
        ("on asperities", "50 % of the load through the lubricant"),
        ("friction model", "kinematic"),
        ("amplitude", "2.5 um: stated"),
        ("wear", "abrasive; vibration: less in such pairs (a rule, not a law)"),
        ("because", "hard on soft"),
        ("evidence", "Table 2.5"),
    ]
    found = results.regime_object(lubricated(0.5, None), wear)
    assert not {"film_ratio", "film_thickness", "film_coefficient"} & set(found)
    assert found["wear"] == {
        "kind": "abrasive", "effect": "less", "reasons": ["hard on soft"], "evidence": ["Table 2.5"],
    }  # fmt: skip
    film = results.regime_object(lubricated(), None)
    assert "wear" not in film
    assert film["film_thickness"] == {"value": 0.4e-6, "unit": "m"}
    assert film["friction_coefficient"] == {
        "first": {"value": approx(0.0712), "unit": ""}, "second": {"value": approx(0.12), "unit": ""},
    }  # fmt: skip
    assert (film["best"], film["nominal_pressure"]["value"]) == ("second", 1e6)
