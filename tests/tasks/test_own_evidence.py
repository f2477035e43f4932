"""Own evidence as an argument: every task that predicts takes the same file, says so, and gives one prediction."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, fixture, mark, raises

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.prediction.evidence_posterior import EvidencePosterior, LearnedSource, read_evidence_posterior
from sonolube.prediction.posterior import learned
from sonolube.prediction.within_plane import plane_posterior
from sonolube.tasks.design.sweep import ParametricStudyAnswer
from sonolube.tasks.lab.protocol_run import RunAnswer
from sonolube.tasks.own_evidence import evidence_of

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
RIG, MAPPED = RIGS / "tribometer.toml", RIGS / "power_map.toml"
ALONG = ["vibration.direction=along", "friction.model=coulomb"]
AXES = {"sliding.sliding_speed": "10mm/s,20mm/s", "drive.voltage_peak_to_peak": "5V,10V"}


_VIBRATED = """title = "vibrated"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "1 s"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"

[[steps]]
kind = "voltage_steps"
voltages = ["25.9 V"]
step_duration = "0.8 s"
frequency = "22 kHz"
unipolar = true
"""


@fixture(scope="module")
def file(tmp_path_factory: Any) -> Path:
    """Posterior whose decay and slip lengths are twice the shipped ones."""
    normal, plane = learned().friction.hyperparameters.copy(), plane_posterior().hyperparameters.copy()
    normal[:, 1] += np.log(2)
    plane[:, 0] += np.log(2)
    source = LearnedSource(
        title="Own", citation="Own 2026", opened="full text", points=3, points_within_plane=2, shipped=False
    )
    found = EvidencePosterior(
        hyperparameters=normal, plane_hyperparameters=plane, fingerprint="1", shipped_fingerprint="2", sources=(source,)
    )
    return found.write(tmp_path_factory.mktemp("evidence") / "own.json")


TASKS: dict[str, Callable[[Path], Any]] = {
    "predict": lambda file: sl.predict(RIG, evidence=file, draws=200),
    "friction": lambda file: sl.friction(RIG, evidence=file),
    "uncertainty": lambda file: sl.uncertainty(RIGS / "tribometer_uncertain.toml", samples=32, evidence=file),
    "map": lambda file: sl.map(MAPPED, over=AXES, target_reduction="60%", evidence=file),
    "map without a target": lambda file: sl.map(MAPPED, over=AXES, evidence=file),
    "plan": lambda file: sl.plan(RIG, speed="20:80:3mm/s", vibration="1:2.5:2um", points=2, evidence=file),
    "sweep": lambda file: sl.sweep(RIG, of="speed", points=3, evidence=file),
    "sweep of keys": lambda file: sl.sweep(RIG, over={"sliding.sliding_speed": "20mm/s,50mm/s"}, evidence=file),
    "control": lambda file: sl.control(RIG, duration="40ms", evidence=file),
    "lab virtual": lambda file: sl.lab.virtual(MAPPED, dry_run=True, evidence=file),
}


@mark.parametrize("name", TASKS)
def test_each_task_says_what_it_was_learned_from(name: str, file: Path) -> None:
    caveats = " ".join(TASKS[name](file).caveats())
    assert "learned from published tests and 3 points of Own (own.json), in place of the posterior" in caveats
    assert "write it again by sonolube evidence learn" in caveats  # as its fingerprint is invented


def test_within_the_plane_the_points_there_are_named(file: Path) -> None:
    rig = sl.read_rig(RIG, changes=ALONG)
    for answer in (sl.friction(rig, evidence=file), sl.predict(rig, evidence=file, draws=200)):
        said = "learned from published tests, 2 points within the plane of Own and 3 points of Own (own.json)"
        assert said in " ".join(answer.caveats())


@mark.parametrize("changes", [[], ALONG])
def test_friction_has_the_interval_that_predict_has(changes: list[str], file: Path) -> None:
    rig = sl.read_rig(RIG, changes=changes)
    low, high = sl.friction(rig, evidence=file).object()["predicted_friction_ratio"]["interval_80"]
    draws = sl.predict(rig, evidence=file)["friction_ratio"]
    assert (low, high) == approx(np.quantile(draws, [0.1, 0.9]), rel=1e-9)
    without = sl.friction(rig).object()["predicted_friction_ratio"]["interval_80"]
    assert high > without[1] + 0.01  # over a longer length vibration does less


def test_studies_and_control_have_the_interval_that_predict_has(file: Path) -> None:
    expected = np.quantile(sl.predict(RIG, evidence=file)["friction_ratio"], [0.1, 0.9])
    answer = sl.sweep(RIG, of="voltage", lowest="14V", highest="28V", points=2, evidence=file)
    assert isinstance(answer, ParametricStudyAnswer)
    found = [answer.study[name].values.ravel()[-1] for name in ("lowest_predicted_ratio", "highest_predicted_ratio")]
    assert found == approx(expected, rel=0.02)
    reach = sl.control(RIG, duration="40ms", evidence=file).object()["predicted_least_friction"]["interval_80"]
    force = sl.predict(RIG, evidence=file)["friction_force"].quantile([0.1, 0.9]).values
    assert reach == approx(force, rel=0.03)


def test_a_virtual_tribometer_draws_its_friction_from_the_posterior(file: Path, tmp_path: Path) -> None:
    protocol = tmp_path / "vibrated.toml"
    protocol.write_text(_VIBRATED)
    answers = [sl.lab.run(protocol, rig=MAPPED, seed=2, out=tmp_path, evidence=each) for each in (None, file)]
    without, within = (each.run for each in answers if isinstance(each, RunAnswer))
    before, after = (each.dataset()["friction_force"].values[-100:].mean() for each in (without, within))
    assert after > 1.1 * before  # over twice the length vibration does less
    assert "3 points of Own (own.json)" in str(within.facts["evidence"])
    assert "evidence" not in without.facts


def test_a_file_and_its_posterior_are_one_argument(file: Path) -> None:
    read = read_evidence_posterior(file)
    assert evidence_of(read) is read
    assert evidence_of(None) is None
    found = evidence_of(str(file))
    assert found is not None
    assert found.hyperparameters == approx(read.hyperparameters)


def test_evidence_that_would_not_be_used_is_refused(file: Path) -> None:
    with raises(InvalidInput, match="evidence has no meaning without interval"):
        sl.friction(RIG, interval=False, evidence=file)
    with raises(InvalidInput, match=r"evidence has no meaning where nothing is predicted: .*soft or floating"):
        sl.map(RIGS / "pom_on_steel.toml", over={"sliding.sliding_speed": "10mm/s,20mm/s"}, evidence=file)
    with raises(InvalidInput, match="evidence has no meaning without interval of friction_ratio"):
        sl.uncertainty(RIGS / "tribometer_uncertain.toml", of="vibration_amplitude", samples=32, evidence=file)
    with raises(InvalidInput, match="evidence has no meaning with dry_run"):
        sl.lab.run("map_test", rig=MAPPED, dry_run=True, evidence=file)
    for task in (sl.lab.hold, lambda rig, **given: sl.lab.run("map_test", rig=rig, **given)):
        with raises(InvalidInput, match=r"evidence has no meaning with device_map MAP\.toml, whose friction is"):
            task(MAPPED, device_map=file, evidence=file)
    with raises(InvalidInput, match=r"evidence has no meaning here: contact\.roughness\.rms_height changes the rig"):
        sl.sweep(RIG, over={"contact.roughness.rms_height": "1um,2um"}, evidence=file)
    with raises(InvalidInput, match=r"evidence has no meaning where nothing is predicted: .*soft or floating"):
        sl.sweep(RIGS / "pom_on_steel.toml", of="speed", points=2, evidence=file)
    with raises(InvalidInput, match=r"evidence has no meaning where nothing is predicted: .*soft or floating"):
        sl.control(RIGS / "pom_on_steel.toml", duration="40ms", evidence=file)
    with raises(InvalidInput, match=r"gone\.json: no such file"):
        sl.friction(RIG, evidence=file.parent / "gone.json")
