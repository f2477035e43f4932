"""Friction held by a controller in words and JSON: reference, margins, what was held at each speed, and saturation."""

from dataclasses import dataclass
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx

from sonolube.laboratory import Outputs, Verdict
from sonolube.report.blocks import Rows
from sonolube.report.results import held_friction as results

NAN = float("nan")


@dataclass
class Phase:
    start_time: float = 2.0
    sliding_speed: float = 0.02
    friction_force: float = 0.5
    tracking_error: float = 0.0123
    scatter: float = 0.01
    settling_time: float | None = 0.25
    voltage_peak_to_peak: float = 21.234
    saturated_fraction: float = 0.4


PHASES: Any = (Phase(), Phase(sliding_speed=0.04, settling_time=None, saturated_fraction=0.51))
DESIGN: Any = SimpleNamespace(
    controller=SimpleNamespace(
        process=SimpleNamespace(sample_interval=0.01),
        gains=SimpleNamespace(proportional_gain=0.4321, integral_time=0.025),
    ),
    margins=SimpleNamespace(gain_margin=3.5, phase_margin=pi / 3, delay_margin=1.5e-3, sensitivity_peak=1.59),
)
MEASURED, ON = Verdict(Outputs.MEASURED_OFF), Verdict(Outputs.CUT_THE_POWER, "drive hangs")
RIG: Any = SimpleNamespace(title="Own rig")
RUN: Any = SimpleNamespace(folder=Path("runs", "7"), recordings=(Path("runs", "7", "a.nc"),), facts={"tags": "hold"})


def held(*, intrinsic: float = 1.5, verdict: Verdict = MEASURED, reason: str = "", samples: int = 5) -> Any:
    return SimpleNamespace(
        outcome="completed", reason=reason, verdict=verdict, is_safe=verdict.is_off, time=np.zeros(samples),
        hold=SimpleNamespace(friction_force=0.5), intrinsic_friction_force=intrinsic,
    )  # fmt: skip


@pytest.fixture(autouse=True)
def phases(monkeypatch: MonkeyPatch) -> None:
    """Let every hold have reached two speeds."""
    monkeypatch.setattr(results, "hold_metrics", lambda found: PHASES)


def test_held_friction_is_said_at_each_speed_beside_reference_and_margins() -> None:
    title, rows = results.held_blocks(RIG, held(), DESIGN, RUN, simulated=True)
    assert title == "Own rig, friction held (virtual)"
    assert isinstance(rows, Rows)
    assert list(rows.rows) == [
        ("outcome", "completed"),
        ("motor and drive", "measured off"),
        ("reference", "500 mN; 1.5 N without vibration, before"),
        ("controller", "interval 10 ms, K_c 0.432, tau_I 25 ms (SIMC)"),
        ("margins told", "gain 3.50, phase 60.0 deg, delay 1.5 ms, Ms 1.59"),
        ("at 20 mm/s", "500 mN, error 12.3 mN rms, settled after 250 ms, 21.2 V peak to peak"),
        ("at 40 mm/s", "500 mN, error 12.3 mN rms, not settled, 21.2 V peak to peak"),
        ("record", str(RUN.folder)),
    ]
    title, rows = results.held_blocks(
        RIG, held(intrinsic=NAN, verdict=ON, reason="hot", samples=0), DESIGN, RUN, simulated=False
    )
    assert title == "Own rig, friction held"
    assert isinstance(rows, Rows)
    assert list(rows.rows)[:3] == [
        ("outcome", "completed: hot"), ("motor and drive", "cut the power: drive hangs"), ("reference", "500 mN"),
    ]  # fmt: skip
    assert not any(name.startswith("at ") for name, _ in rows.rows)


def test_saturation_for_more_than_half_of_the_time_is_said() -> None:
    assert results.saturation_lines(held()) == [
        "at 40 mm/s the voltage was at its limit or 0 for 51 % of the time: no reach is left"
    ]


def test_held_friction_in_json_has_margins_gains_and_phases_with_their_units() -> None:
    found = results.held_object(RIG, held(), DESIGN, RUN, simulated=True)
    assert (found["rig"], found["safe"], found["simulated"], found["tags"]) == ("Own rig", True, True, "hold")
    assert found["recordings"] == [str(RUN.recordings[0])]
    assert found["friction_force"] == {"value": 0.5, "unit": "N"}
    assert found["phase_margin"]["value"] == approx(pi / 3)
    assert found["integral_time"] == {"value": 0.025, "unit": "s"}
    assert found["intrinsic_friction_force"]["value"] == approx(1.5)
    second = found["phases"][1]
    assert second["settling_time"] == {"value": None, "unit": "s"}
    assert second["start_time"] == {"value": 2.0, "unit": "s"}
    assert second["scatter"] == {"value": 0.01, "unit": "N"}
    assert second["saturated_fraction"] == approx(0.51)
    assert second["tracking_error"] == {"value": 0.0123, "unit": "N"}
    unknown = results.held_object(RIG, held(intrinsic=NAN, samples=0), DESIGN, RUN, simulated=False)
    assert unknown["intrinsic_friction_force"]["value"] is None
    assert unknown["phases"] == []
