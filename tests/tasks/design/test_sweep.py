"""Task `sweep` in Python: the numbers of the command, keys as text and in SI, and its folder."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput, UnknownName
from sonolube.tasks.design.sweep import sweep
from sonolube.tasks.progress import TaskCancelled

VOLTAGE = "drive.voltage_peak_to_peak"
SPEED = "sliding.sliding_speed"
LHS: dict[str, Any] = {"sample": "lhs", "points": 8, "seed": 3}
Terminal = Callable[..., dict[str, Any]]


@pytest.fixture
def rig(rigs: Path) -> sl.Rig:
    return sl.read_rig(rigs / "tribometer.toml")


def test_the_answer_is_that_of_the_command_and_of_single_points(rig: sl.Rig, rigs: Path, on_terminal: Terminal) -> None:
    swept = sl.sweep(rig, over={VOLTAGE: "2V:28V:5"})
    same(swept.json_object(), on_terminal("sweep", rigs / "tribometer.toml", "--over", f"{VOLTAGE}=2V:28V:5"))
    single = [sl.simulate(rig.replace(VOLTAGE, f"{volts} V")) for volts in np.linspace(2, 28, 5)]
    assert swept["friction_ratio"].to_numpy() == approx([float(one["friction_ratio"]) for one in single], abs=1e-6)
    assert "identified from resonance" in swept.dataset().attrs["assumptions"]
    assert swept.plot().axes


def test_numbers_in_si_text_and_drawn_points_make_the_same_kind_of_sweep(rig: sl.Rig) -> None:
    by_text = sweep(rig, over={VOLTAGE: "10 V, 20 V"}).dataset()
    same(sweep(rig, over={VOLTAGE: [10.0, 20.0]}).dataset(), by_text)
    drawn = sweep(rig, over={VOLTAGE: "10V:20V"}, **LHS).dataset()
    assert drawn["friction_ratio"].sizes == {"point": 8}
    assert float(drawn["voltage_peak_to_peak"].min()) >= 10
    again = sweep(rig, over={VOLTAGE: (10.0, 20.0)}, **LHS).dataset()
    same(again["friction_ratio"], drawn["friction_ratio"])


def test_a_sweep_that_was_stopped_goes_on_in_its_folder_where_the_terminal_ends_it(
    rig: sl.Rig, rigs: Path, tmp_path: Path, on_terminal: Terminal
) -> None:
    place, over, done = tmp_path / "terminal", {SPEED: "10mm/s:90mm/s:40"}, []

    def stop() -> bool:
        done.append(len(list(place.glob("chunk-*"))))
        return done[-1] >= 2

    with raises(TaskCancelled):
        sweep(rig, over=over, chunk=5, workers=1, keep=place, cancelled=stop)
    assert len(list(place.glob("chunk-*"))) < 8
    options = ("--over", f"{SPEED}={over[SPEED]}", "--chunk", "5")
    answer = on_terminal("sweep", rigs / "tribometer.toml", *options)
    whole = sweep(rig, over=over, chunk=5)
    same(whole.json_object(), answer)
    same(sweep(rig, over=over, chunk=5, keep=place).dataset(), whole.dataset())
    with raises(InvalidInput, match="holds another sweep"):
        sweep(rig, over={SPEED: [0.01]}, keep=place)


def test_progress_is_reported_by_stage(rig: sl.Rig) -> None:
    seen: list[tuple[str, int, int]] = []
    sweep(rig, over={VOLTAGE: [5.0, 10.0]}, progress=lambda *each: seen.append(each))
    assert seen[-1] == ("sweeping: points", 2, 2)


def test_a_study_of_one_quantity_is_that_of_the_command(rig: sl.Rig, rigs: Path, on_terminal: Terminal) -> None:
    study = sweep(rig, of="voltage", lowest="10V", highest="30V", points=3)
    ends = ("--from", "10V", "--to", "30V", "--points", "3")
    same(study.json_object(), on_terminal("sweep", rigs / "tribometer.toml", "--of", "voltage", *ends))
    assert study["friction_ratio"].sizes == {"voltage_peak_to_peak": 3}


def test_arguments_are_refused_by_their_names(rig: sl.Rig) -> None:
    with raises(InvalidInput, match=r"^over drive\.voltage_peak_to_peak=2V:28V must look like"):
        sweep(rig, over={VOLTAGE: "2V:28V"})
    with raises(InvalidInput, match="between two ends, got 3 numbers"):
        sweep(rig, over={VOLTAGE: [1.0, 2.0, 3.0]}, sample="lhs", points=4)
    with raises(InvalidInput, match=r"^workers has no meaning for of"):
        sweep(rig, of="load", workers=3)
    with raises(UnknownName, match="unknown of 'voltag'; did you mean voltage"):
        sweep(rig, of="voltag")  # type: ignore[arg-type]
    with raises(InvalidInput, match=r"^chunk must be finite and lie between 1 and inf, got 0"):
        sweep(rig, over={VOLTAGE: [1.0]}, chunk=0)
