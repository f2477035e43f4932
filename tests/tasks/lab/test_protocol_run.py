"""Runs of protocols and held friction by stand-ins: who answers prompts, what is refused before, and outcomes."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of
from tests.tasks.running import running

from sonolube.errors import InvalidInput
from sonolube.example_files import example_file
from sonolube.facts.protocol import protocol_by_name_or_file, protocol_names
from sonolube.laboratory import RunControl
from sonolube.laboratory.virtual_tribometer import Disturbances
from sonolube.report.results.ended_run import SIMULATED
from sonolube.rig import read_rig
from sonolube.rig.vibration_direction import NORMAL
from sonolube.tasks.lab import friction_hold, protocol_run
from sonolube.tasks.lab.friction_hold import HoldAnswer, hold
from sonolube.tasks.lab.protocol_run import RunAnswer, run
from sonolube.tasks.progress import TaskCancelled, watched

TRIBOMETER = example_file("tribometer").source


def test_a_map_of_devices_takes_no_arguments_of_the_virtual_tribometer() -> None:
    with running(run, seed=3):
        assert protocol_run.device_file("virtual") is None
        with raises(InvalidInput, match=r"^seed has no meaning with device_map MAP\.toml, whose tests take their time"):
            protocol_run.device_file("map.toml")
    with running(run):
        assert protocol_run.device_file("map.toml") == Path("map.toml")


def test_prompts_are_answered_by_the_operator_of_real_devices_and_taken_as_done_by_simulated_ones(
    monkeypatch: MonkeyPatch,
) -> None:
    kinds = ["wait"]
    monkeypatch.setattr(protocol_run, "flattened", lambda protocol: [SimpleNamespace(kind=kind) for kind in kinds])
    real: Any = SimpleNamespace(simulated=False)
    virtual: Any = SimpleNamespace(simulated=True)
    asked: Any = SimpleNamespace()
    operator: Any = lambda prompt: "mine"  # noqa: E731
    assert protocol_run._answering(asked, virtual, operator)(asked) is True
    assert protocol_run._answering(asked, real, operator) is operator
    assert protocol_run._answering(asked, real, None)(asked) is False
    kinds.append("prompt")
    with raises(InvalidInput, match="the protocol asks an operator"):
        protocol_run._answering(asked, real, None)


def test_a_cancelled_run_is_stopped_in_order() -> None:
    control, calls = RunControl(), [False]

    def report() -> None:
        with watched(None, lambda: calls[0]), protocol_run.run_stage("running", control) as advance:
            advance("step", 1, 2)
            reasons = [control.stop_reason]
            calls[0] = True
            advance("step", 2, 2)
            assert [*reasons, control.stop_reason] == ["", "cancelled"]

    with raises(TaskCancelled):
        report()


@pytest.mark.parametrize(
    ("refusals", "text"),
    [((), None), (("too hot",), r"^impossible by a dry run: too hot; anyway runs it all the same$"),
     (("too hot", "a", "b"), r"^impossible by a dry run: too hot \(and 2 more by dry_run\); anyway runs")],
)  # fmt: skip
def test_what_a_dry_run_refuses_is_said_first_with_the_number_of_the_others(
    refusals: tuple[str, ...], text: str | None, monkeypatch: MonkeyPatch
) -> None:
    found = SimpleNamespace(refusals=refusals)
    monkeypatch.setattr(names_of(protocol_run).dry_runs, "dry_run", lambda protocol, *, rig: found)
    asked: Any = SimpleNamespace()
    if text is None:
        protocol_run._require_possible_dry(asked, None)
    else:
        with raises(InvalidInput, match=text):
            protocol_run._require_possible_dry(asked, None)


def test_a_virtual_rig_is_at_the_load_and_on_the_groove_of_the_protocol(monkeypatch: MonkeyPatch) -> None:
    made: list[Any] = []

    def tribometer(rig: Any, **named: Any) -> None:
        made.append((rig.normal_load, named))

    monkeypatch.setattr(protocol_run, "virtual_tribometer", tribometer)
    rig = read_rig(TRIBOMETER)
    metadata = SimpleNamespace(normal_load=None, groove_diameter=None, thermocouple="actuator")
    plan: Any = SimpleNamespace(rig=rig, seed=4, protocol=SimpleNamespace(metadata=metadata), evidence=None)
    protocol_run._virtual_rig(plan)
    metadata.normal_load, metadata.groove_diameter, metadata.thermocouple = 7.0, 0.05, "contact"
    protocol_run._virtual_rig(plan, real_time=True)
    usual = {"groove_diameter": names_of(protocol_run).GROOVE_DIAMETER}
    shared = {"seed": 4, "evidence": None}
    later = {"groove_diameter": 0.05, "disturbances": Disturbances(contact_share=1.0)}
    assert made == [
        (approx(3.0), usual | shared | {"real_time": False, "disturbances": Disturbances(contact_share=0.0)}),
        (7.0, shared | later | {"real_time": True}),
    ]
    plan.rig = None
    with raises(InvalidInput, match=r"^device_map virtual needs rig, whose friction it takes$"):
        protocol_run._virtual_rig(plan)


def recorded(outcome: str = "completed", *, has_recording: bool = True) -> Any:
    return SimpleNamespace(
        summary=SimpleNamespace(outcome=outcome), caveats=("gap",), notes=(), facts={},
        recordings=("a",) if has_recording else (), dataset=lambda: xr.Dataset({"a": 1.0}),
    )  # fmt: skip


def test_a_run_has_assumptions_of_its_rig_and_the_mark_of_a_simulation_where_it_is_one() -> None:
    rig: Any = SimpleNamespace(assumptions={"mass": "guessed"}, normal_load=3.0, direction=NORMAL)
    state: Any = SimpleNamespace()
    virtual = RunAnswer(result=state, run=recorded(), simulated=True, rig=rig)
    assert (virtual.assumptions(), virtual.caveats()) == ({"mass": "guessed"}, ("gap", SIMULATED))
    real = RunAnswer(result=state, run=recorded("stopped"), simulated=False, rig=rig)
    assert (real.assumptions(), real.caveats()) == ({}, ("gap",))
    assert (virtual.is_failure, real.is_failure) == (False, True)
    assert RunAnswer(result=state, run=recorded(), simulated=True).assumptions() == {}
    assert virtual.dataset().attrs["caveats"] == f"gap\n{SIMULATED}"


def test_a_dry_run_takes_no_arguments_of_a_run_and_is_refused_unless_anyway(monkeypatch: MonkeyPatch) -> None:
    name = protocol_names()[0]
    found = run(name, dry_run=True)
    assert isinstance(found, protocol_run.DryRunAnswer)
    assert found.protocol == protocol_by_name_or_file(name)
    assert list(found.figures()) == ["dry-run"]
    for argument, value in (("yes", True), ("anyway", True), ("tag", ["a"]), ("seed", 3)):
        with raises(InvalidInput, match=f"^{argument} has no meaning with dry_run, which runs nothing"):
            run(name, dry_run=True, **{argument: value})  # type: ignore[arg-type]

    def refuse(*_: object) -> None:
        raise InvalidInput("impossible")

    monkeypatch.setattr(protocol_run, "_require_possible_dry", refuse)
    with raises(InvalidInput, match=r"^impossible$"):
        run(name, rig=TRIBOMETER)


@pytest.mark.parametrize(
    ("more", "asks", "answers"),
    [({}, False, "mine"), ({"yes": True}, False, True), ({"real_time": True}, True, "mine")],
)
def test_a_run_hands_its_arguments_on(
    more: dict[str, Any], asks: bool, answers: Any, monkeypatch: MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []
    rig = SimpleNamespace(devices="devices")
    monkeypatch.setattr(protocol_run, "_require_possible_dry", lambda *_: None)
    monkeypatch.setattr(protocol_run, "_virtual_rig", lambda plan, *, real_time=False: rig)

    def record(plan: Any, devices: Any, **named: Any) -> RunAnswer:
        asked.append((plan, devices, named))
        return RunAnswer(result=SimpleNamespace(), run=recorded(), simulated=True)  # type: ignore[arg-type]

    monkeypatch.setattr(protocol_run, "run_and_record", record)
    run(
        protocol_names()[0], rig=TRIBOMETER, seed=5, tag=["a"], fact={"operator": "Ann"}, out=tmp_path,
        operator=lambda prompt: "mine", **more,  # type: ignore[arg-type, return-value]
    )  # fmt: skip
    ((plan, devices, named),) = asked
    assert (plan.seed, list(plan.tags), plan.facts, plan.name) == (5, ["a"], {"operator": "Ann"}, protocol_names()[0])
    assert (devices, named["out"], named["virtual"], named["asks"]) == ("devices", tmp_path, rig, asks)
    assert named["operator"](None) == answers


def speeds(**more: Any) -> list[tuple[float, float]]:
    rig: Any = SimpleNamespace(sliding_speed=0.02)
    found = friction_hold._speeds(rig, **({"step_to": None, "step_at": None, "run_time": 10.0} | more))
    return [(each.time, each.sliding_speed) for each in found]


def test_the_speed_doubles_after_half_of_the_time_unless_stated() -> None:
    assert speeds() == [(0.0, 0.02), (5.0, 0.04)]
    with running(hold, step_at="2 s"):
        assert speeds(step_to=0.03, step_at="2 s") == [(0.0, 0.02), (2.0, 0.03)]
        with raises(InvalidInput, match=r"^step_at 0s must be positive$"):
            speeds(step_at="0s")


def test_a_rig_that_holds_friction_has_a_drive() -> None:
    rig = read_rig(TRIBOMETER)
    assert friction_hold._driven(rig) == (rig, rig.drive)
    bare: Any = SimpleNamespace(drive=None, file=None, title="Own")
    with raises(InvalidInput, match=r"^Own: has no drive, by which friction is held; add the table drive$"):
        friction_hold._driven(bare)
    assert friction_hold._temperature("60 degC") == approx(333.15)


def test_held_friction_has_a_figure_and_a_table_once_it_was_held_and_fails_before_its_time(
    monkeypatch: MonkeyPatch,
) -> None:
    monkeypatch.setattr(names_of(friction_hold).results, "saturation_lines", lambda held: ["no reach"])
    monkeypatch.setattr(names_of(friction_hold).closed_loop, "held_friction_dataset", lambda held, *, title: title)
    held: Any = SimpleNamespace(time=np.zeros(2), outcome="completed", hold=SimpleNamespace(friction_force=1.5))
    rig: Any = SimpleNamespace(assumptions={"a": "b"}, title="Own")
    values: dict[str, Any] = {"rig": rig, "design": None, "held": held, "run": recorded(), "assumed": {"c": "d"},
                              "folder": Path("f")}  # fmt: skip
    virtual = HoldAnswer(**values, simulated=True)
    assert virtual.caveats() == ("gap", "no reach", SIMULATED)
    assert HoldAnswer(**values, simulated=False).caveats() == ("gap", "no reach")
    assert virtual.assumptions() == {"a": "b", "c": "d"}
    assert virtual.figures()["held-friction"].caption == "Friction held at 1.5 N by the drive voltage."
    assert virtual.files() == {"held-friction.nc": "Friction held on Own"}
    assert not virtual.is_failure
    held.time, held.outcome = np.zeros(0), "stopped"
    assert (virtual.figures(), virtual.files(), virtual.is_failure) == ({}, {}, True)
