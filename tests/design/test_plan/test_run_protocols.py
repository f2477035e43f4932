"""Protocols, table and figure of a plan made by hand."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx

from sonolube.charts import Points, Rule
from sonolube.design.test_plan.candidates import RigLimits
from sonolube.design.test_plan.comparison import BLOCKINGS, PlannedRun, RunPart
from sonolube.design.test_plan.plan import Procedure, Question
from sonolube.design.test_plan.run_protocols import has_results, has_voltage, plan_chart, run_protocols, run_table
from sonolube.measurement.measured_runs import read_runs

PROCEDURE = Procedure(intrinsic_distance=1.0, vibrated_distance=0.5, measuring_time=12.0)
RUNS = (
    PlannedRun(run=1, block=1, point=0, parts=(RunPart(specimen="1", vibrated=(False, True, False)),)),
    PlannedRun(
        run=2,
        block=2,
        point=1,
        parts=(RunPart(specimen="2b", vibrated=(True,)), RunPart(specimen="2a", vibrated=(False,))),
    ),
)


def plan_of(**changes: Any) -> Any:
    """Plan of two points among three candidates, the last of which exceeds a limit."""
    candidates = SimpleNamespace(
        normal_load=np.array([2.0, 4.0, 4.0]),
        sliding_speed=np.array([0.1, 0.05, 0.2]),
        vibration_amplitude=np.array([1e-6, 2e-6, 3e-6]),
        voltage_peak_to_peak=np.array([10.0, 20.0, 30.0]),
        voltage_offset=np.array([5.0, -15.0, 15.0]),
        refused=("", "", "too loud"),
    )
    known = SimpleNamespace(
        rig=SimpleNamespace(drive=SimpleNamespace(frequency=22e3)),
        candidates=candidates,
        batch=SimpleNamespace(points=(1, 0)),
        runs=RUNS,
        procedure=PROCEDURE,
        limits=RigLimits(),
        materials=("m50", "aluminium_2024"),
        friction_coefficient=0.4,
        information=np.array([0.3, 0.5, 0.9]),
        interval=np.array([[0.2, 0.3, 0.4], [0.6, 0.9, 0.8]]),
        median=np.array([0.35, 0.5, 0.6]),
        closure_medians={"one_model": np.array([0.3, 0.4, 0.5]), "other": np.array([0.5, 0.6, 0.7])},
        question=Question(difference=0.3),
    )
    for name, value in changes.items():
        setattr(known, name, value)
    known.candidate = lambda run: known.batch.points[run.point]
    known.states = lambda run, part: known.procedure.states(
        float(candidates.sliding_speed[known.candidate(run)]), part.vibrated
    )
    return known


def test_the_table_has_a_row_for_each_run_in_the_units_of_its_heads() -> None:
    lines = run_table(plan_of()).splitlines()
    assert lines == [
        "run,block,normal_load [N],sliding_speed [mm/s],voltage_peak_to_peak [V],vibration_amplitude [um],"
        "friction_force [N],intrinsic_friction_force [N],friction_coefficient,intrinsic_friction_coefficient",
        "1,1,4,50,20,2,,,,",
        "2,2,2,100,10,1,,,,",
    ]
    unknown = plan_of()
    unknown.candidates.voltage_peak_to_peak = np.full(3, np.nan)
    assert not has_voltage(unknown)
    assert run_table(unknown).splitlines()[1] == "1,1,4,50,2,,,,"


def test_a_sheet_that_is_filled_with_coefficients_is_read_back(tmp_path: Path) -> None:
    text = run_table(plan_of())
    assert not has_results(text)
    filled = text.replace("1,1,4,50,20,2,,,,", "1,1,4,50,20,2,,,0.2,0.4").replace(
        "2,2,2,100,10,1,,,,", "2,2,2,100,10,1,,,0.3,0.4"
    )
    assert has_results(filled)
    (tmp_path / "plan-runs.csv").write_text(filled)
    assert 1 - read_runs(tmp_path / "plan-runs.csv")["friction_reduction"].to_numpy() == approx([0.5, 0.75])


@pytest.mark.parametrize(
    ("rows", "found"), [("1,,\n", False), ("1,0.5,\n", True), ("1,,0.5\n", True), ("1, ,\n2,,\n", False), ("", True)]
)
def test_a_table_with_any_result_is_known_as_one(rows: str, found: bool) -> None:
    assert has_results("run,friction_force [N],intrinsic_friction_force [N]\n" + rows) is found
    assert has_results("run,other\n1,2\n")


def test_a_run_on_one_specimen_switches_the_vibration_on_and_off_and_waits_in_between() -> None:
    protocols = run_protocols(plan_of())
    assert list(protocols) == ["run-1-of-2", "run-2-with-of-2", "run-2-without-of-2"]
    first = protocols["run-1-of-2"]
    assert first.title == "Run 1: 4 N, 50 mm/s, 2 um"
    # at 50 mm/s: 20 s and 10 s to settle, 6 s, 12 s and 6 s to measure, and half a second of rest
    total = 0.5 + 20 + 6 + 10 + 12 + 10 + 6
    text = str(first.steps)
    waits = [step.duration for step in first.steps if step.kind == "wait"]
    assert waits == approx([0.5, 20.0, 6.0, 10.0, 12.0, 10.0, 6.0])
    (acquired,) = (step for step in first.steps if step.kind == "acquire")
    assert acquired.duration == approx(total)
    assert acquired.sample_rate == approx(400.0)
    drives = [step for step in first.steps if step.kind == "drive"]
    assert [each.voltage_peak_to_peak for each in drives] == approx([20.0, 0.0])
    assert (drives[0].voltage_offset, drives[0].frequency) == approx((-15.0, 22e3))
    assert "running-in" in text
    assert text.count("running-in") == 1
    (motor,) = (step for step in first.steps if step.kind == "motor_speed")
    assert motor.sliding_speed == approx(0.05)
    assert first.metadata.pin_material == "m50"


def test_limits_leave_a_margin_over_what_is_planned() -> None:
    # |-15| + 20/2 = 25 V, 5 % more; 3 times 0.4 times the 4 N of the heaviest point; 5 % more than the run
    limits = run_protocols(plan_of())["run-1-of-2"].limits
    assert limits.voltage_maximum == approx(1.05 * 25)
    assert limits.friction_force_maximum == approx(4.8)
    assert limits.duration_maximum == approx(1.05 * 64.5)
    stated = run_protocols(plan_of(limits=RigLimits(voltage_maximum=40.0)))["run-1-of-2"].limits
    assert stated.voltage_maximum == approx(40.0)


def test_runs_on_their_own_specimens_say_their_state_and_only_one_is_driven() -> None:
    protocols = run_protocols(plan_of())
    on, off = protocols["run-2-with-of-2"], protocols["run-2-without-of-2"]
    assert on.title == "Run 2 with: 2 N, 100 mm/s, 1 um"
    assert [step.kind for step in off.steps if step.kind == "drive"] == []
    assert [step.voltage_peak_to_peak for step in on.steps if step.kind == "drive"] == approx([10.0])
    assert [step.duration for step in on.steps if step.kind == "wait"] == approx([0.5, 5.0, 12.0])
    assert [step.duration for step in off.steps if step.kind == "wait"] == approx([0.5, 10.0, 12.0])
    assert off.metadata.specimen == "2a"
    assert "Mount pin and disc 2a (new)." in str(off.steps)
    pair = Procedure(intrinsic_distance=1.0, vibrated_distance=0.5, blocking=BLOCKINGS["pair"])
    assert "(the pair of this block)" in str(run_protocols(plan_of(procedure=pair))["run-1-of-2"].steps)


def test_an_operator_switches_a_vibration_whose_voltage_nobody_knows() -> None:
    unknown = plan_of(materials=None)
    unknown.candidates.voltage_peak_to_peak = np.full(3, np.nan)
    protocol = run_protocols(unknown)["run-1-of-2"]
    text = str(protocol.steps)
    assert "Switch the vibration on, 2 um zero to peak." in text
    assert "Switch the vibration off." in text
    assert protocol.metadata.pin_material == ""


def test_a_state_that_is_steady_at_once_has_no_time_to_settle() -> None:
    at_once = Procedure(intrinsic_distance=0.0, vibrated_distance=0.0)
    protocol = run_protocols(plan_of(procedure=at_once))["run-1-of-2"]
    assert [step.duration for step in protocol.steps if step.kind == "wait"] == approx([0.5, 6.0, 12.0, 6.0])


def test_the_chart_shades_what_can_be_made_and_numbers_the_points_of_the_plan() -> None:
    left, right = plan_chart(plan_of()).panels
    shaded, refused, chosen = left.parts
    assert isinstance(shaded, Points)
    assert shaded.x == approx([100.0, 50.0])  # by rising information, in mm/s
    assert shaded.y == approx([1.0, 2.0])
    assert shaded.shades == approx([0.3, 0.5])
    assert shaded.scale_ends == (0.0, 0.5)
    assert isinstance(refused, Points)
    assert (refused.x.tolist(), refused.y.tolist(), refused.label) == ([200.0], [3.0], "exceeds a limit")
    assert isinstance(chosen, Points)
    assert (chosen.x.tolist(), chosen.texts) == ([50.0, 100.0], ("1", "2"))
    assert left.x.ticks == approx((50.0, 100.0, 200.0))
    assert left.x.words == ("50", "100", "200")
    prediction, one, other, rule = right.parts
    assert isinstance(prediction, Points)
    assert (prediction.x.tolist(), prediction.y.tolist()) == ([1.0, 2.0], [0.5, 0.35])
    assert np.asarray(prediction.y_error) == approx(np.array([[0.2, 0.15], [0.4, 0.25]]))
    assert isinstance(one, Points)
    assert isinstance(other, Points)
    assert one.x == approx([0.86, 1.86])
    assert one.y == approx([0.4, 0.3])
    assert one.label == "one model"
    assert other.x == approx([1.14, 2.14])
    assert other.y == approx([0.6, 0.5])
    assert isinstance(rule, Rule)
    assert rule.value == approx(0.7)
    assert rule.along == "y"
    assert (right.x.lowest, right.x.highest) == (0.5, 2.5)
    assert right.x.words == ("1\n50 mm/s\n2 µm\n4 N", "2\n100 mm/s\n1 µm\n2 N")


def test_points_at_one_place_share_a_mark_and_many_are_not_described() -> None:
    crowded = plan_of(batch=SimpleNamespace(points=(1, 0, 1, 0, 1)))
    left, right = plan_chart(crowded).panels
    assert getattr(left.parts[-1], "texts", ()) == ("1, 3, 5", "2, 4")
    assert right.x.words == ("1", "2", "3", "4", "5")
    one_load = plan_of()
    one_load.candidates.normal_load = np.full(3, 4.0)
    assert plan_chart(one_load).panels[1].x.words == ("1\n50 mm/s\n2 µm", "2\n100 mm/s\n1 µm")
