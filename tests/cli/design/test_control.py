"""Command `control`: controller, source, page, caveats and refusals."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

Program = Callable[..., Any]


def test_the_collar_gets_a_controller_its_source_and_its_page(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    options = ("--friction", "1.5N", "--duration", "40ms", "--json", "--out", tmp_path)
    answer = sonolube("control", rigs / "collar.toml", *options).answer
    assert answer["friction_force"] == {"value": 1.5, "unit": "N"}
    assert answer["phase_margin"]["value"] == approx(1.07, abs=0.01)
    assert answer["settling_time"]["value"] == approx(0.0102, abs=2e-4)
    assert "resonance" not in answer["assumptions"]  # which the structure gives
    assert {Path(name).suffix for name in answer["files"]} == {".html", ".png", ".svg", ".pdf", ".nc", ".c", ".csv"}
    assert all(Path(name).stat().st_size > 0 for name in answer["files"])
    assert not re.search(r"https?:", (tmp_path / "control.html").read_text(encoding="utf-8"), re.IGNORECASE)


def test_vibration_suppresses_stick_slip_on_an_elastic_holder(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    options = ("--friction", "0.5N", "--duration", "20ms", "--stick-slip", "--json", "--out", tmp_path)
    answer = sonolube("control", rigs / "tribometer.toml", *options).answer
    without, within = (answer["stick_slip"][name]["stick_slip_amplitude"]["value"] for name in ("without", "with"))
    assert within < 0.5 * without
    assert answer["stick_slip"]["with"]["damping"]["value"] > answer["stick_slip"]["without"]["damping"]["value"]
    assert "a holder of 20 kN/m and 50 g" in answer["assumptions"]["stick-slip"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--friction", "0.1N"], "friction_force must lie between"),
        (["--friction", "3mm"], "--friction"),
        (["--voltage-limit", "0V"], "voltage_maximum must be positive, got 0.0 V"),
        (["--duration", "1ms"], "intervals"),
        (["--delay", "-1ms"], "dead_time must not be negative"),
        (["--feed-forward", "efficiency", "--efficiency", "-1m2/N"], "intercept must be positive"),
    ],
)
def test_a_refusal_is_one_line_with_the_cause(
    arguments: list[str], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    assert line in sonolube("control", rigs / "collar.toml", *arguments, "--out", tmp_path).refusal
    assert not any(tmp_path.iterdir())


def test_without_a_structure_the_resonance_is_an_assumption_and_tracking_that_loses_it_a_caveat(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    rig = tmp_path / "collar.toml"
    text = (rigs / "collar.toml").read_text(encoding="utf-8")
    tables = r"^\[(stack|structure|assumptions)\][^\[]*"
    rig.write_text(re.sub(tables, "", text, flags=re.MULTILINE), encoding="utf-8")
    options = ("--friction", "1.5N", "--warming", "150K", "--warming-time", "10ms", "--duration", "0.1s", "--json")
    answer = sonolube("control", rig, *options, "--out", tmp_path).answer
    assert "quality factor 50" in answer["assumptions"]["resonance"]
    assert sum("lost the resonance" in caveat for caveat in answer["caveats"]) == 1


def test_a_target_may_be_a_coefficient_or_a_force(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    targets = [
        sonolube("control", rigs / "tribometer.toml", "--friction", text, "--out", tmp_path, "--json").answer
        for text in ("0.2", "0.6N")
    ]
    assert [target["friction_force"]["value"] for target in targets] == approx([0.6, 0.6])
    assert targets[0]["phase_margin"]["value"] == approx(targets[1]["phase_margin"]["value"])
    refused = sonolube("control", rigs / "tribometer.toml", "--friction", "-1N", "--out", tmp_path)
    assert "--friction -1N must be positive" in refused.refusal
