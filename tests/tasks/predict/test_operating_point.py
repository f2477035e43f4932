"""Tasks of one operating point in Python: the answer of the terminal by text and by numbers in SI."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig import read_rig
from sonolube.tasks.answer import Answer
from sonolube.tasks.predict.response_and_regime import regime, response, transient
from sonolube.tasks.predict.rig_record import contact, friction, thermal, wear
from sonolube.tasks.progress import TaskCancelled

Terminal = Callable[..., Mapping[str, Any]]
BODIES = {"pin": "stainless_steel_316", "disc": "aluminium_2024"}


@pytest.mark.parametrize(
    ("task", "text", "in_si"),
    [
        (contact, {"tangential_stiffness": "dong_2015"}, {}),
        (friction, {"model": "kinematic"}, {}),
        (wear, {}, {}),
        (
            thermal,
            {
                **BODIES,
                "duration": "1 min",
                "conductance": "100 mW/K",
                "vibration_heat": "2mW",
                "friction_ratio": "90 %",
            },
            {"duration": 60.0, "conductance": 0.1, "vibration_heat": 2e-3, "friction_ratio": 0.9},
        ),
        (
            regime,
            {**BODIES, "film_coefficient": "0.25", "asperity_pressure": "10 MPa", "smallest_gain": "10 %"},
            {"film_coefficient": 0.25, "asperity_pressure": 10e6, "smallest_gain": 0.1},
        ),
        (transient, {"duration": "10 ms"}, {"duration": 0.01}),
    ],
    ids=lambda each: getattr(each, "__name__", ""),
)
def test_text_numbers_in_si_and_the_terminal_give_one_answer(
    task: Callable[..., Answer],
    text: Mapping[str, str],
    in_si: Mapping[str, float],
    tribometer: Path,
    on_terminal: Terminal,
) -> None:
    options = [word for name, value in text.items() for word in (f"--{name.replace('_', '-')}", value)]
    by_text = task(tribometer, **text)
    same(by_text.json_object(), on_terminal(task.__name__, tribometer, *options))
    same(task(read_rig(tribometer), **{**text, **in_si}).json_object(), by_text.json_object())
    assert by_text.dataset().attrs["assumptions"]


def test_a_response_has_its_ends_by_names_without_those_of_python(tribometer: Path, on_terminal: Terminal) -> None:
    found = response(tribometer, lowest=15e3, highest="35 kHz")
    same(found.json_object(), on_terminal("response", tribometer, "--from", "15kHz", "--to", "35kHz"))
    same(float(found["amplitude_per_volt"].max()), found.object()["amplitude_per_volt"]["value"])
    with raises(InvalidInput, match=r"^lowest 35kHz must lie above 0 Hz and below highest 15kHz$"):
        response(tribometer, lowest="35kHz", highest="15kHz")


def test_several_heats_of_vibration_follow_one_another(tribometer: Path) -> None:
    two, last = (thermal(tribometer, **BODIES, vibration_heat=heat) for heat in ("1W, 2W", 2.0))
    same(two.object()["vibration_heat_rate"], last.object()["vibration_heat_rate"])
    assert two.object()["temperature_rise"] != last.object()["temperature_rise"]


def test_the_dataset_of_a_regime_has_the_coefficient_of_each_method(tribometer: Path) -> None:
    found = regime(tribometer, film_coefficient=0.1, asperity_pressure=10e6)
    coefficients = found["friction_coefficient"]
    assert coefficients.idxmin() == found.object()["best"] == "combined"
    assert float(coefficients.sel(lubrication="lubricant")) < float(coefficients.sel(lubrication="dry"))


def test_answers_are_drawn(tribometer: Path) -> None:
    assert response(tribometer).plot().axes
    assert thermal(tribometer, **BODIES).plot().axes
    with raises(InvalidInput, match="nothing that could be drawn"):
        wear(tribometer).plot()


def test_arguments_are_refused_by_their_names_in_python(tribometer: Path) -> None:
    with raises(InvalidInput, match=r"^pin: missing; give it"):
        thermal(tribometer)
    with raises(InvalidInput, match=r"^conductance 1e\+30 lies beyond any rig"):
        thermal(tribometer, **BODIES, conductance=1e30)
    with raises(InvalidInput, match=r"^vibration_heat 1mm is a length"):
        thermal(tribometer, **BODIES, vibration_heat="1mm")
    with raises(InvalidInput, match=r"^pin and disc belong together"):
        regime(tribometer, film_coefficient=0.1, asperity_pressure=1e7, pin="m50")
    with raises(InvalidInput, match=r"^film_coefficient 1000\.0 lies beyond any rig"):
        regime(tribometer, film_coefficient=1e3, asperity_pressure=1e7)
    with raises(UnknownName, match="did you mean kinematic"):
        friction(tribometer, model="kinematik")
    with raises(InvalidInput, match=r"^duration 5N is a force"):
        transient(tribometer, duration="5N")


def test_a_transient_reports_its_progress_and_is_cancelled(tribometer: Path) -> None:
    with raises(TaskCancelled, match="marching"):
        transient(tribometer, duration=0.01, cancelled=lambda: True)
    assert transient(tribometer, duration=0.01).object()["vibration_amplitude"]["value"] == approx(2.5e-6, rel=0.1)


def test_the_interval_beside_a_friction_ratio_rises_and_is_that_of_the_prediction(tribometer: Path) -> None:
    low, high = sl.friction(tribometer).object()["predicted_friction_ratio"]["interval_80"]
    assert 0 <= low < high
    assert [low, high] == approx(sl.predict(tribometer).object()["friction_ratio"]["interval_80"])


def test_a_curve_through_folds_refuses_ends_that_do_not_rise(tribometer: Path) -> None:
    with raises(InvalidInput, match=r"^lowest_voltage 0 must lie above 0 V and below highest_voltage"):
        response(tribometer, curve="voltage", lowest_voltage=0)
    with raises(InvalidInput, match=r"^lowest 0 must lie above 0 Hz and below highest"):
        response(tribometer, curve="frequency", lowest=0)
