"""One verdict an operating point: in range, extrapolated, outside the model's range, or contradicted by own runs."""

from dataclasses import replace
from pathlib import Path

import xarray as xr
from pytest import mark
from tests.same import same

import sonolube as sl
from sonolube.prediction import predict
from sonolube.prediction.verdict import Verdict, point_verdict, verdict_of_rig
from sonolube.rig import Rig, read_rig
from sonolube.tasks.predict.new import new

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


def test_the_rig_of_published_tests_is_in_range_without_a_reason() -> None:
    found = point_verdict(tribometer())
    assert (found.verdict, found.reasons) == (Verdict.IN_RANGE, ())
    assert found.text == "within the range of the friction model and of the published tests"


@mark.parametrize(
    ("change", "said"),
    [
        ("sliding.sliding_speed=1m/s", "sliding speed 1 m/s (3.5 mm/s to 266 mm/s)"),  # D Tables 2.3 and 4.2
        ("drive.frequency=40kHz", "40 kHz is outside the 16 kHz to 22 kHz"),
        ("friction.friction_coefficient=0.1", "counts as lubricated"),
        ("contact.roughness.rms_height=62um", "62 um is far above"),
        ("friction.in_plane_fraction=0.2", "compared with no published test, as a prediction is of vibration along"),
    ],
)
def test_what_no_published_test_is_like_is_extrapolated(change: str, said: str) -> None:
    found = point_verdict(read_rig(RIGS / "poisson_steel_steel.toml", changes=[change]))
    assert found.verdict == Verdict.EXTRAPOLATED
    assert said in found.text


def test_outside_the_model_goes_before_beyond_the_tests_and_own_runs_before_both() -> None:
    rig = tribometer("friction.model=dong_2015_full_period", "sliding.sliding_speed=1m/s")
    found = point_verdict(rig)
    assert found.object()["verdict"] == "outside_model_range"
    assert "beyond the Coulomb limit" in found.reasons[0]
    assert point_verdict(rig, contradiction="ratio 1 where 0.2 was predicted").verdict == Verdict.CONTRADICTED


def test_a_rig_without_vibration_is_in_range_and_one_without_amplitude_has_no_verdict() -> None:
    rig = new(pin="m50", disc="m50", load="5N", speed="0.2m/s", frequency="20kHz", amplitude="3um").rig
    assert point_verdict(replace(rig, vibration_amplitude=0.0)).verdict == Verdict.IN_RANGE
    assert verdict_of_rig(replace(rig, vibration_amplitude=None)) is None


def test_friction_wear_heat_simulation_and_prediction_give_one_verdict() -> None:
    for change in ("sliding.sliding_speed=0.1m/s", "sliding.sliding_speed=2m/s"):
        rig = tribometer(change)
        answers = [
            sl.friction(rig, interval=False),
            sl.wear(rig),
            sl.simulate(rig),
            sl.thermal(rig, pin="stainless_steel_316", disc="aluminium_2024"),
            sl.predict(rig, draws=100),
        ]
        objects = [answer.object() for answer in answers]
        assert len({each["verdict"] for each in objects}) == 1
        assert len({tuple(each["verdict_reasons"]) for each in objects}) == 1
        assert objects[0]["verdict"] == ("in_range" if "0.1" in change else "extrapolated")


def test_runs_that_contradict_the_prediction_are_its_verdict() -> None:
    settings = {"sliding_speed": ("run", [0.02, 0.03, 0.05]), "vibration_amplitude": ("run", [2e-6, 3e-6, 2.5e-6])}
    runs = xr.Dataset({"friction_reduction": ("run", [-0.2, -0.2, -0.2]), **settings})
    assert predict(tribometer(), runs=runs, draws=300).attrs["verdict"] == "contradicted_by_runs"


def test_sweep_study_and_map_lead_with_the_verdict_on_the_rigs_own_point() -> None:
    rig = tribometer("sliding.sliding_speed=2m/s")
    answers = (
        sl.sweep(rig, over={"drive.voltage_peak_to_peak": "14V,28V"}),
        sl.sweep(rig, of="speed", points=3),
        sl.map(rig, kind="frequency-voltage", over={"drive.frequency": "21kHz,22kHz"}),
    )
    expected = point_verdict(rig).object()
    for answer in answers:
        found = answer.object()
        same({name: found[name] for name in expected}, expected)
