"""Responses, curves, start-ups, lubricants and records of a rig by hand-made results: words, JSON and refusals."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from pytest import raises
from tests.same import approx
from tests.tasks.running import RigStandIn, running

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Rows, Table
from sonolube.tasks.predict import new, predict, response_and_regime as regimes, response_curve as curves, rig_record
from sonolube.tasks.predict.response_and_regime import ResponseAnswer, StartUpAnswer, regime, response
from sonolube.tasks.predict.response_curve import ResponseCurveAnswer
from sonolube.tasks.predict.rig_record import RigRecord

NAN = float("nan")
RIG: Any = RigStandIn(title="Own rig", name="own", normal_load=3.0, assumptions={}, sliding_speed=0.02)


def curve(**more: Any) -> Any:
    """Branch of five points over frequency, folded between the third and the fourth."""
    jump = SimpleNamespace(is_rising=True, at=22.1e3, before=1e-6, after=3e-6)
    back = SimpleNamespace(is_rising=False, at=21.5e3, before=2.5e-6, after=0.5e-6)
    values: dict[str, Any] = {
        "along": "frequency", "parameter": np.array([20e3, 22.1e3, 21.5e3, 22e3, 24e3]),
        "vibration_amplitude": np.array([0.5e-6, 1e-6, 2.5e-6, 3e-6, 2e-6]), "folds": np.array([1, 2]),
        "friction_ratio": np.array([0.9, 0.8, 0.1, 0.3, 0.4]), "stable": np.array([True, True, False, True, True]),
        "jumps": (jump, back), "complete": True, "rising": np.array([0, 1, 3, 4]), "falling": np.array([4, 3, 0]),
        "frequency": np.array([20e3, 22.1e3, 21.5e3, 22e3, 24e3]), "voltage_peak_to_peak": np.full(5, 28.0),
    }  # fmt: skip
    return SimpleNamespace(**(values | more))


def test_a_curve_in_words_has_its_largest_amplitude_least_stable_friction_folds_and_jumps() -> None:
    head, rows, table = ResponseCurveAnswer(rig=RIG, result=curve()).blocks()
    assert head == "Own rig, 3 N, 28 V peak to peak, 20 kHz to 24 kHz"
    assert rows == Rows(
        [
            ("largest amplitude", "3 um at 22 kHz"),
            ("least friction ratio", "0.300 at 22 kHz"),  # the least of all is unstable
            ("folds", "22.1 kHz, 21.5 kHz"),
        ]
    )
    assert table == Table(
        ["slow ramp", "jumps at", "amplitude before", "after"],
        [("up", "22.1 kHz", "1 um", "3 um"), ("down", "21.5 kHz", "2.5 um", "500 nm")],
    )
    plain = curve(jumps=(), folds=np.array([], int), friction_ratio=np.full(5, NAN))
    bare = ResponseCurveAnswer(rig=RIG, result=plain).blocks()
    assert bare[1:] == [Rows([("largest amplitude", "3 um at 22 kHz"), ("folds", "none")])]
    volts = curve(along="voltage", parameter=np.array([1.0, 3.0, 2.0, 4.0, 5.0]), frequency=np.full(5, 22e3))
    along = ResponseCurveAnswer(rig=RIG, result=volts)
    assert along.blocks()[0] == "Own rig, 3 N, 22 kHz, 1 V to 5 V"
    assert along.object()["folds"] == [{"value": 3.0, "unit": "V"}, {"value": 2.0, "unit": "V"}]


def test_a_curve_in_json_has_jumps_by_ramp_and_the_point_of_largest_amplitude() -> None:
    found = ResponseCurveAnswer(rig=RIG, result=curve()).object()
    assert (found["rig"], found["along"], found["is_complete"]) == ("Own rig", "frequency", True)
    assert found["jumps"][1] == {
        "ramp": "down", "at": {"value": 21.5e3, "unit": "Hz"}, "before": {"value": 2.5e-6, "unit": "m"},
        "after": {"value": 0.5e-6, "unit": "m"},
    }  # fmt: skip
    assert found["jumps"][0]["ramp"] == "up"
    assert found["vibration_amplitude"] == {"value": approx(3e-6), "unit": "m"}
    assert (found["frequency"]["value"], found["voltage_peak_to_peak"]["value"]) == approx((22e3, 28.0))


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"jumps": ()}, []),
        ({}, ["a slow ramp follows"]),
        ({"jumps": (), "complete": False}, ["the branch was left"]),
        ({"jumps": (), "rising": np.array([0, 2])}, ["part of what a ramp passes is unstable"]),
        ({"jumps": (), "falling": np.array([2])}, ["part of what a ramp passes is unstable"]),
    ],
)
def test_a_curve_says_what_it_leaves_out(more: dict[str, Any], words: list[str]) -> None:
    found = ResponseCurveAnswer(rig=RIG, result=curve(**more)).caveats()
    assert len(found) == len(words)
    assert all(line.startswith(word) for line, word in zip(found, words, strict=True))


def test_a_range_rises_from_above_zero_and_takes_the_usual_ends() -> None:
    with running(response, lowest="1 kHz"):
        assert curves.rising_range("lowest", None, "highest", None, usual=("1kHz", "100kHz")) == (1e3, 1e5)
        assert curves.rising_range("lowest", "2 kHz", "highest", 3e3, usual=(1.0, 2.0)) == (2e3, 3e3)
        for low, high in (("2 kHz", "2 kHz"), ("3 kHz", "2 kHz"), ("0 Hz", "1 Hz")):
            with raises(InvalidInput, match=f"^lowest {low} must lie above 0 Hz and below highest {high}$"):
                curves.rising_range("lowest", low, "highest", high, usual=(1.0, 2.0))


def followed(along: Any, monkeypatch: pytest.MonkeyPatch, **ends: Any) -> tuple[float, float]:
    asked: list[tuple[float, float]] = []

    def of_rig(resolved: Any, *, along: str, lowest: float, highest: float) -> Any:
        asked.append((lowest, highest))
        return curve(along=along)

    monkeypatch.setattr(curves, "rig_response_curve", of_rig)
    drive = SimpleNamespace(frequency=24e3, voltage_peak_to_peak=20.0)
    resolved: Any = SimpleNamespace(rig=SimpleNamespace(drive=drive, title="Own"))
    every = dict.fromkeys(("lowest", "highest", "lowest_voltage", "highest_voltage")) | ends
    with running(response, **ends):
        curves.followed_curve(resolved, along=along, **every)
    return asked[0]


def test_a_curve_runs_a_sixth_about_the_drive_or_from_a_twentieth_to_twice_its_voltage(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert followed("frequency", monkeypatch) == approx((20e3, 28e3))
    assert followed("frequency", monkeypatch, lowest="21kHz") == approx((21e3, 28e3))
    assert followed("voltage", monkeypatch) == approx((1.0, 40.0))
    assert followed("voltage", monkeypatch, highest_voltage="30V") == approx((1.0, 30.0))
    with raises(InvalidInput, match=r"^lowest_voltage has no meaning along the frequency"):
        followed("frequency", monkeypatch, lowest_voltage="1V")
    with raises(InvalidInput, match=r"^highest has no meaning along the voltage"):
        followed("voltage", monkeypatch, highest="30kHz")
    for drive in (None, SimpleNamespace(voltage_peak_to_peak=None)):
        resolved: Any = SimpleNamespace(rig=SimpleNamespace(drive=drive, title="Own"))
        with raises(InvalidInput, match=r"^Own: drive\.voltage_peak_to_peak is missing; a curve needs a drive$"):
            curves.followed_curve(
                resolved, along="voltage", lowest=None, highest=None, lowest_voltage=None, highest_voltage=None
            )


def test_a_response_has_its_natural_frequencies_and_its_largest_amplitude() -> None:
    result: Any = SimpleNamespace(
        frequency=np.array([20e3, 22.05e3, 24e3]), amplitude_per_volt=np.array([1e-8, 9e-8, 2e-8])
    )
    answer = ResponseAnswer(rig=RIG, result=result, natural_frequency=np.array([40.0, 22.051e3]))
    assert answer.blocks() == [
        "Own rig, 3 N, small motions",
        Rows([("natural frequencies", "40 Hz, 22.05 kHz"),
              ("largest amplitude", "90 nm per volt peak to peak at 22.05 kHz")]),
    ]  # fmt: skip
    found = answer.object()
    assert found["frequency"]["value"] == approx(22.05e3)
    assert found["amplitude_per_volt"]["value"] == approx(9e-8)
    assert found["resonances"][0] == {"value": 40.0, "unit": "Hz"}
    none = ResponseAnswer(rig=RIG, result=result, natural_frequency=np.array([]))
    rows = none.blocks()[1]
    assert isinstance(rows, Rows)
    assert rows.rows[0] == ("natural frequencies", "none")


def test_a_start_up_has_its_times_amplitudes_and_why_it_did_not_settle() -> None:
    result: Any = SimpleNamespace(
        settling_time=1.2e-3, vibration_amplitude=2.5e-6, mean_displacement=7e-7, beat_frequency=40.0,
        status="unsettled", reason="too short",
    )  # fmt: skip
    vibration: Any = SimpleNamespace(text="computed", source="structure")
    answer = StartUpAnswer(rig=RIG, vibration=vibration, result=result)
    assert answer.blocks() == [
        "Own rig, 3 N, from rest",
        Rows([("amplitude settles", "within 2 % after 1.2 ms"), ("amplitude", "2.5 um: computed"),
              ("mean displacement", "700 nm"), ("slow oscillation", "40 Hz"), ("status", "unsettled: too short")]),
    ]  # fmt: skip
    found = answer.object()
    assert (found["status"], found["reason"], found["amplitude_source"]) == ("unsettled", "too short", "structure")
    assert found["beat_frequency"] == {"value": 40.0, "unit": "Hz"}
    result.reason = ""
    rows = answer.blocks()[1]
    assert isinstance(rows, Rows)
    assert rows.rows[-1] == ("status", "unsettled")


def viscous(**given: Any) -> dict[str, tuple[str, Any]]:
    names = {"dynamic_viscosity": "viscosity", "tip_radius": "tip_radius", "inlet_ratio": "inlet_ratio",
             "pressure_viscosity": "pressure_viscosity"}  # fmt: skip
    return {name: (argument, given.get(argument)) for name, argument in names.items()}


def test_a_film_is_stated_by_two_numbers_or_follows_from_a_viscosity() -> None:
    both = {"film_coefficient": 0.1, "asperity_pressure": "10 MPa"}
    neither = dict.fromkeys(both)
    with running(regime, **both):
        found = regimes._stated_lubricant(both, viscous())  # type: ignore[arg-type]
        assert (found.film_coefficient, found.full_asperity_pressure) == approx((0.1, 1e7))
        for missing in both:
            with raises(InvalidInput, match=r"^give viscosity, or both film_coefficient and asperity_pressure$"):
                regimes._stated_lubricant(both | {missing: None}, viscous())  # type: ignore[arg-type]
        with raises(InvalidInput, match=r"^tip_radius belongs to viscosity: leave it out, or give that$"):
            regimes._stated_lubricant(both, viscous(tip_radius=1e-3))  # type: ignore[arg-type]
        pad = regimes._viscous_lubricant(neither, viscous(viscosity="0.1 Pa s", inlet_ratio=2.5))
        assert (pad.dynamic_viscosity, pad.inlet_ratio, pad.tip_radius) == (approx(0.1), approx(2.5), None)
        ball = regimes._viscous_lubricant(neither, viscous(viscosity=0.2, tip_radius="5 mm", pressure_viscosity=1e-8))
        assert (ball.dynamic_viscosity, ball.tip_radius, ball.pressure_viscosity) == approx((0.2, 5e-3, 1e-8))
        with raises(
            InvalidInput, match=r"^viscosity gives the film: leave out film_coefficient and asperity_pressure$"
        ):
            regimes._viscous_lubricant(neither | {"film_coefficient": 0.1}, viscous(viscosity=0.1))
        with raises(InvalidInput, match=r"^pressure_viscosity is of a ball: leave it out, or give tip_radius$"):
            regimes._viscous_lubricant(neither, viscous(viscosity=0.1, pressure_viscosity=1e-8))
        with raises(InvalidInput, match=r"^inlet_ratio is of a flat pad: leave out it or tip_radius$"):
            regimes._viscous_lubricant(neither, viscous(viscosity=0.1, tip_radius=1e-3, inlet_ratio=2.0))


@pytest.mark.parametrize("given", [{"pin": "steel"}, {"disc": "steel"}])
def test_both_materials_belong_together(given: dict[str, str]) -> None:
    with raises(InvalidInput, match=r"^pin and disc belong together: give both or neither$"):
        regime(RigStandIn(), **given)


@dataclass
class Point:
    friction_force: float | None = 1.2
    friction_ratio: float = 0.35
    raw_friction_ratio: float = 0.35
    vibration_amplitude: float | None = None
    amplitude_origin: str = "stated"
    status: str = "stable"
    caveats: tuple[str, ...] = ("rough",)


def test_a_record_has_its_quantities_with_meanings_its_texts_and_what_was_measured() -> None:
    measured: Any = SimpleNamespace(label="A-1", set_name="A", friction_ratio=0.4, uncertainty=None)
    answer = RigRecord(
        rig=RIG, result=Point(), measured=[measured], leading=["far"], rows=[("more", "1")], entries={"e": 2}
    )
    head, rows = answer.blocks()
    assert head == "Own rig, 3 N"
    assert isinstance(rows, Rows)
    known = dict(rows.rows)
    assert known["Friction force with vibration over that without"] == "0.35"
    assert known["amplitude"] == "stated"
    assert known["more"] == "1"
    assert known["measured A-1"].startswith("friction ratio 0.4: ")
    assert "status" not in known
    assert sum(text == "0.35" for text in known.values()) == 1  # the ratio by the formula is for JSON
    found = answer.object()
    assert (found["friction_force"], found["e"], found["status"]) == ({"value": 1.2, "unit": "N"}, 2, "stable")
    assert found["raw_friction_ratio"]["value"] == approx(0.35)
    assert found["measured"][0]["test"] == "A-1"
    assert "measured" not in RigRecord(rig=RIG, result=Point()).object()
    assert (answer.caveats(), answer.leading_caveats()) == (("rough",), ["far"])


@pytest.mark.parametrize(
    ("force", "text"),
    [(2.9e-6, "below 3 uN"), (-2.9e-6, "below 3 uN"), (3.1e-6, "3.1 uN"), (0.0, "0 N"), (None, "none")],
)
def test_a_force_of_less_than_a_millionth_of_the_load_is_nothing(force: float | None, text: str) -> None:
    answer = RigRecord(rig=RIG, result=Point())
    assert answer._text("friction_force", force) == text
    assert answer._text("vibration_amplitude", 1e-9) == "1 nm"


def test_a_material_that_nobody_states_is_asked_for() -> None:
    assert rig_record._material("steel", "pin") == "steel"
    with raises(InvalidInput, match=r"^pin: missing; give it, or contact\.softer\.role"):
        rig_record._material(None, "pin")


def test_a_model_of_friction_is_described_with_units_of_its_parameters() -> None:
    class Parameter(NamedTuple):
        name: str
        unit: str

    class Model:
        name, citation = "own", "D 3"
        given: tuple[Parameter, ...] = (Parameter("length", "m"), Parameter("share", ""))

        @classmethod
        def parameters(cls) -> tuple[Parameter, ...]:
            return cls.given

    model: Any = Model
    assert rig_record._described_model(model) == "own (length in m, share; D 3)"
    Model.given = ()
    assert rig_record._described_model(model) == "own (no parameters; D 3)"


def test_a_new_rig_takes_one_argument_for_one_thing_and_an_actuator_with_its_voltage() -> None:
    new.refuse_two_of_one({"amplitude": 1, "actuator": None, "pin_finish": "N6", "scan": "a"})
    new.refuse_two_of_one({"actuator": "sa", "voltage": "3V"})
    for pair in (("pin_finish", "pin_scan"), ("disc_finish", "scan"), ("decay_length", "stiffness"),
                 ("amplitude", "actuator")):  # fmt: skip
        with raises(InvalidInput, match=f"^give either {pair[0]} or {pair[1]}, got both$") as refused:
            new.refuse_two_of_one(dict.fromkeys(pair, 1))
        assert refused.value.key == pair[1]
    for alone in ("actuator", "voltage"):
        with raises(InvalidInput, match=r"^actuator and voltage belong together: give both or neither$"):
            new.refuse_two_of_one({alone: 1})


def test_the_vibration_of_a_new_rig_is_one_text() -> None:
    assert new.stated_vibration(2.5e-6, None, None) == "2.5e-06 m"
    assert new.stated_vibration("2.5 um", None, None) == "2.5 um"
    assert new.stated_vibration(None, "sa050510", 28) == "sa050510 28.0 V"
    assert new.stated_vibration(None, None, None) == ""
    assert new._read("load", 3, "N") == approx(3.0)
    assert new._read_optional("load", None, "N") is None
    assert new._read_optional("load", "5 N", "N") == approx(5.0)


def test_rigs_of_a_laboratory_come_with_their_runs_and_without_them_not_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(predict, "rig_of", lambda rig: f"rig {rig}")
    monkeypatch.setattr(predict, "required_runs", lambda runs: f"runs {runs}")
    read: Any = predict._rigs_with_runs
    assert read({"a": "1", "b": None}) == [("rig a", "runs 1")]
    assert read([("a", "1"), ("c", "2")]) == [("rig a", "runs 1"), ("rig c", "runs 2")]
    assert read(None) == []
