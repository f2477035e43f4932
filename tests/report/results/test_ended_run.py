"""Runs that have ended, are watched or were only gone through: outcome, record and next command in words."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.facts.protocol import protocol_by_name_or_file, protocol_names
from sonolube.laboratory import Outputs, RunState, State, Verdict
from sonolube.laboratory.dry_run import dry_run
from sonolube.laboratory.records import Observation
from sonolube.report.blocks import Rows, Table, Verbatim
from sonolube.report.results import ended_run as results
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection

FOLDER = Path("runs", "0715 brass")
ONE, TWO = FOLDER / "part-1.nc", FOLDER / "part-2.nc"


def note(kind: str = "event", **facts: str | float) -> Any:
    return SimpleNamespace(kind=kind, facts=facts, time=0.0, sample=None)


def run(
    parts: Mapping[Path, tuple[str, ...]],
    *,
    notes: tuple[Any, ...] = (),
    facts: Mapping[str, Any] | None = None,
    samples: int = 4,
    reason: str = "",
    caveats: tuple[str, ...] = (),
) -> Any:
    """Run of three newtons, then five, whose mean friction is four."""
    summary = SimpleNamespace(
        title="Brass on steel", outcome="stopped" if reason else "completed", reason=reason, duration=12.5,
        samples=samples, folder=FOLDER,
    )  # fmt: skip
    return SimpleNamespace(
        summary=summary,
        folder=FOLDER,
        part_channels=dict(parts),
        recordings=tuple(parts),
        notes=notes,
        facts=dict(facts or {}),
        caveats=caveats,
        clocks={"slow": (FOLDER / "slow.nc",)},
        channels={"friction_force": SimpleNamespace(described="friction_force [N]"),
                  "voltage": SimpleNamespace(described="voltage [V]")},
        dataset=lambda: xr.Dataset(
            {name: ("time", np.array([3.0, 5.0])) for name in dict.fromkeys(sum(parts.values(), ()))}
        ),
    )  # fmt: skip


QUOTED = "'runs/0715 brass'"
FILES = "'runs/0715 brass/part-1.nc' 'runs/0715 brass/part-2.nc'"
SECOND = "'runs/0715 brass/part-2.nc'"
LIFTED = (note("conditions", normal_load=0),)


@pytest.mark.parametrize(
    ("parts", "more", "command"),
    [
        ({ONE: ("friction_force", "normal_load")}, {"notes": LIFTED}, f"identify decay-length {QUOTED}"),
        ({ONE: ("friction_force",), TWO: ("friction_force", "normal_load")}, {"notes": LIFTED},
         f"identify decay-length {QUOTED}"),
        # lifted, but without a channel of the load: friction alone
        ({ONE: ("friction_force",), TWO: ("normal_load",)}, {"notes": LIFTED},
         "measure friction 'runs/0715 brass/part-1.nc'"),
        # a load of zero in another event than conditions, or conditions with a load, lifts nothing
        ({ONE: ("friction_force", "normal_load")}, {"notes": (note("trip", normal_load=0),)},
         f"measure friction {QUOTED}"),
        ({ONE: ("friction_force", "normal_load")}, {"notes": (note("conditions", normal_load=3.0),)},
         f"measure friction {QUOTED}"),
        ({ONE: ("friction_force", "displacement"), TWO: ("friction_force", "displacement")}, {},
         f"measure calibration 'runs/0715 brass/part-1.nc' --apply {SECOND}"),
        ({ONE: ("friction_force",), TWO: ("displacement", "friction_force")}, {}, f"measure calibration {SECOND}"),
        ({ONE: ("friction_force",), TWO: ("voltage",)}, {}, "measure friction 'runs/0715 brass/part-1.nc'"),
        ({ONE: ("voltage", "current"), TWO: ("voltage",)}, {}, "measure impedance 'runs/0715 brass/part-1.nc'"),
        ({ONE: ("voltage",), TWO: ("voltage", "current")}, {}, f"measure impedance {SECOND}"),
        ({ONE: ("gaussmeter",)}, {"facts": {"groove_diameter": 0.0412}},
         f"measure rotation {QUOTED} --groove-diameter 41.2mm"),
        ({ONE: ("gaussmeter",)}, {"facts": {"groove_diameter": "wide"}}, f"lab show {QUOTED}"),
        ({ONE: ("temperature",)}, {"facts": {"groove_diameter": 0.04}}, f"lab show {QUOTED}"),
    ],
)  # fmt: skip
def test_the_next_command_is_for_the_channels_that_were_recorded(
    parts: dict[Path, tuple[str, ...]], more: dict[str, Any], command: str
) -> None:
    assert results.next_command(run(parts, **more)) == f"sonolube {command}"


def test_a_run_in_words_has_outcome_state_of_the_outputs_record_and_next_command() -> None:
    state = RunState(State.SAFE, verdict=Verdict(Outputs.CONFIRMED_OFF, "by its own word"))
    title, rows, after = results.run_blocks(state, run({ONE: ("friction_force",)}), simulated=True)
    assert title == "Brass on steel (virtual)"
    assert isinstance(rows, Rows)
    assert list(rows.rows) == [
        ("outcome", "completed"),
        ("motor and drive", "confirmed off, by its own word"),
        ("recorded", "12.5 s, 4 samples of each channel"),
        ("channels", "friction_force [N], voltage [V]"),
        ("mean friction", "4 N"),
        ("record", str(FOLDER)),
    ]
    assert after == Verbatim("  next: sonolube measure friction " + QUOTED)


def test_a_run_that_failed_says_why_and_to_cut_the_power_and_has_no_next_command() -> None:
    failed = run({}, reason="limit of friction")
    state = RunState(State.FAILED, verdict=Verdict(Outputs.CUT_THE_POWER, "drive hangs"))
    title, rows = results.run_blocks(state, failed, simulated=False)
    assert title == "Brass on steel"
    assert isinstance(rows, Rows)
    known = dict(rows.rows)
    assert known["outcome"] == "stopped: limit of friction"
    assert known["motor and drive"] == "cut the power: drive hangs"
    assert "mean friction" not in known


@pytest.mark.parametrize(
    ("channel", "samples", "mean"),
    [("friction_force", 10_000_000, 4.0), ("friction_force", 10_000_001, None), ("voltage", 4, None)],
)
def test_the_mean_friction_is_of_recordings_of_up_to_ten_million_samples(
    channel: str, samples: int, mean: float | None
) -> None:
    found = results.run_object(
        RunState(State.SAFE, verdict=Verdict(Outputs.MEASURED_OFF)),
        run({ONE: (channel,)}, samples=samples, facts={"tags": "a, b"}),
        simulated=False,
    )
    assert found == {
        "title": "Brass on steel",
        "outcome": "completed",
        "reason": "",
        "state": "safe",
        "outputs": "measured off",
        "simulated": False,
        "folder": str(FOLDER),
        "recordings": [str(ONE)],
        "clocks": {"slow": [str(FOLDER / "slow.nc")]},
        "samples": samples,
        "duration": {"value": 12.5, "unit": "s"},
        "tags": "a, b",
        "friction_force": {"value": None if mean is None else approx(mean), "unit": "N"},
    }


def test_a_virtual_run_says_that_it_measures_nothing_and_where_its_protocol_overrules_the_rig() -> None:
    rig: Any = SimpleNamespace(normal_load=5.0, direction=NORMAL)
    assert results.run_caveats(run({}, caveats=("gap",)), rig) == ["gap", results.SIMULATED]
    turned: Any = SimpleNamespace(normal_load=5.0, direction=VibrationDirection(direction="along"))
    said = "the vibration is along the sliding, of which no wear law is: it wears as without vibration"
    assert results.run_caveats(run({}), turned) == [said, results.SIMULATED]
    set_load = run({}, facts={"normal_load": 3.0})
    assert results.run_caveats(set_load, rig) == [
        "the protocol sets 3 N, and the rig file 5 N: the test is at 3 N",
        results.SIMULATED,
    ]
    # a millionth of the load is rounding, more is another load
    for load, count in ((5.0 * (1 + 0.9e-6), 1), (5.0 * (1 + 1.2e-6), 2), (5.0 * (1 - 1.2e-6), 2)):
        assert len(results.run_caveats(run({}, facts={"normal_load": load}), rig)) == count
    assert results.run_caveats(set_load, None) == [results.SIMULATED]
    oiled = run({}, notes=(note(lubricant="oil"), note(lubricant=""), note(lubricant="oil"), note(lubricant="fat")))
    assert results.run_caveats(oiled, None) == [
        "the virtual rig knows no lubricant: with oil, fat its friction is that without",
        results.SIMULATED,
    ]


@pytest.mark.parametrize("refusals", [(), ("step 2: too fast",)])
def test_a_dry_run_is_possible_without_refusals_which_stand_last(refusals: tuple[str, ...]) -> None:
    protocol = protocol_by_name_or_file(protocol_names()[0])
    found = replace(dry_run(protocol, rig=None), duration=90.0, refusals=refusals)
    title, points, sums, *refused = results.dry_run_blocks(protocol, found)
    assert title == protocol.title
    assert isinstance(points, Table)
    assert (tuple(points.heads), len(points.rows)) == (("",) * 4, len(found.points))
    assert isinstance(sums, Rows)
    assert sums.rows
    assert refused == [f"  impossible: {each}" for each in refusals]
    content = results.dry_run_object(protocol, found)
    assert (content["title"], content["possible"]) == (protocol.title, not refusals)
    assert content["refusals"] == list(refusals)
    assert content["duration"] == {"value": 90.0, "unit": "s"}


def seen(**changes: Any) -> Observation:
    """Look at a running test of 60 s, 12.25 s after its begin."""
    values: dict[str, Any] = {
        "folder": FOLDER,
        "known": SimpleNamespace(title="Brass on steel", facts={"simulated": True}),
        "outcome": "running",
        "reason": "",
        "state": "running",
        "step": "2.1",
        "step_kind": "set_drive",
        "protocol_time": 12.25,
        "duration": 60.0,
        "set_points": {"sliding_speed": 0.02, "rotation_speed": 1.5},
        "means": {"friction_force": (1.5, "N"), "temperature": (None, "K"), "voltage_peak_to_peak": (20.0, "V")},
        "trips": ("friction above 2 N",),
        "gaps": 2,
        "silence": 6.4,
    }
    return Observation(**(values | changes))


def test_a_look_at_a_run_is_one_line_with_step_times_means_set_points_and_faults() -> None:
    assert results.observation_line(seen()) == (
        "running; step 2.1 set drive; 12.2 s of 60.0 s, 47.8 s left;"
        " friction force 1.5 N, temperature no number, voltage peak to peak 20 V; set sliding speed 20 mm/s;"
        " friction above 2 N; samples are missing in 2 places; nothing was written for 6 s"
    )
    bare = seen(step="", duration=None, means={}, set_points={}, trips=(), gaps=0)
    assert results.observation_line(bare) == "running; 12.2 s"


def test_means_that_are_set_and_a_rotation_that_follows_from_the_speed_are_not_said_twice() -> None:
    both = seen(
        means={"normal_load": (3.0, "N"), "voltage_peak_to_peak": (20.0, "V"), "current": (0.1, "A")},
        set_points={"voltage_peak_to_peak": 28.0, "rotation_speed": 2.0},
    )
    assert results.means_text(both) == "normal load 3 N"  # the current is not among what is shown
    assert results.set_points_text(both).startswith("set voltage peak to peak 28 V, rotation speed ")


@pytest.mark.parametrize(
    ("changes", "silent"),
    [({}, True), ({"silence": 5.0}, False), ({"silence": 5.1}, True), ({"means": {}}, False),
     ({"outcome": "completed"}, False)],
)  # fmt: skip
def test_silence_of_more_than_five_seconds_is_reported_of_a_run_that_records(
    changes: dict[str, Any], silent: bool
) -> None:
    assert any("nothing was written" in each for each in results.warnings(seen(**changes))) == silent


def test_an_observation_in_json_has_silence_while_it_runs_alone() -> None:
    found = results.observation_object(seen())
    assert found["folder"] == str(FOLDER)
    assert (found["title"], found["simulated"]) == ("Brass on steel", True)
    assert {name: found[name] for name in ("outcome", "reason", "state", "step", "step_kind")} == {
        "outcome": "running", "reason": "", "state": "running", "step": "2.1", "step_kind": "set_drive",
    }  # fmt: skip
    assert [found[name] for name in ("protocol_time", "duration", "time_left", "silence")] == [
        {"value": value, "unit": "s"} for value in (12.25, 60.0, 47.75, 6.4)
    ]
    assert found["means"]["temperature"] == {"value": None, "unit": "K"}
    assert found["set_points"]["sliding_speed"] == {"value": 0.02, "unit": "m/s"}
    assert (found["trips"], found["gaps"]) == (["friction above 2 N"], 2)
    ended = results.observation_object(seen(outcome="completed", known=SimpleNamespace(title="", facts={})))
    assert ended["silence"] == {"value": None, "unit": "s"}
    assert ended["simulated"] is False


def test_the_reason_belongs_to_the_state_of_a_running_test_and_to_the_outcome_of_one_that_ended() -> None:
    title, paused = results.observation_blocks(seen(state="paused", reason="by hand"))
    assert title == "0715 brass: Brass on steel"
    assert isinstance(paused, Rows)
    assert list(paused.rows) == [
        ("outcome", "running"),
        ("state", "paused: by hand"),
        ("step", "2.1 set drive"),
        ("time", "12.2 s of 60.0 s, 47.8 s left"),
        ("last second", "friction force 1.5 N, temperature no number, voltage peak to peak 20 V"),
        ("set", "sliding speed 20 mm/s"),
        ("limit", "friction above 2 N"),
    ]
    _, ended = results.observation_blocks(
        seen(outcome="stopped", state="safe", reason="by hand", step="", means={}, set_points={}, trips=())
    )
    assert isinstance(ended, Rows)
    assert list(ended.rows)[:2] == [("outcome", "stopped: by hand"), ("state", "safe")]
    assert [name for name, _ in ended.rows] == ["outcome", "state", "time"]


def test_a_killed_run_says_how_its_record_is_completed_and_limits_are_no_caveats() -> None:
    killed = seen(outcome="unfinished", gaps=1)
    assert results.observation_caveats(killed) == [
        "samples are missing in 1 places",
        "the program died during the run, and motor or drive may be on; sonolube lab recover 'runs/0715 brass'"
        " completes its record",
        results.SIMULATED,
    ]
    real = seen(known=SimpleNamespace(title="", facts={}), gaps=0, silence=0.1)
    assert results.observation_caveats(real) == []
