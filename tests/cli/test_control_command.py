"""The command `control` as its users meet it."""

import json
from pathlib import Path

import pytest
from pytest import approx

from sonolube.cli import main

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["control", *arguments])
    code = ended.value.code
    assert isinstance(code, int)
    return code


def test_the_collar_gets_a_controller_its_source_and_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = run(str(RIGS / "collar.toml"), "--friction", "1.5N", "--duration", "40ms", "--json", "--out", str(tmp_path))
    answer = json.loads(capsys.readouterr().out)
    assert code == 0
    assert answer["friction_force"] == {"value": 1.5, "unit": "N"}
    assert answer["phase_margin"]["value"] == approx(1.07, abs=0.01)
    assert answer["settling_time"]["value"] < 0.01
    assert "quality factor 50" in answer["assumptions"]["resonance"]
    assert {Path(name).suffix for name in answer["files"]} == {".html", ".png", ".svg", ".nc", ".c", ".csv"}
    assert all(Path(name).stat().st_size > 0 for name in answer["files"])
    assert "http" not in (tmp_path / "control.html").read_text(encoding="utf-8").lower()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
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
    arguments: list[str], complaint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(str(RIGS / "collar.toml"), *arguments, "--out", str(tmp_path)) == 2
    told = capsys.readouterr().err.strip()
    assert complaint in told
    assert "\n" not in told
    assert not any(tmp_path.iterdir())


def test_a_resonance_that_runs_away_is_a_caveat(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ("--friction", "1.5N", "--warming", "150K", "--warming-time", "10ms", "--duration", "0.1s", "--json")
    assert run(str(RIGS / "collar.toml"), *arguments, "--out", str(tmp_path)) == 0
    (caveat,) = json.loads(capsys.readouterr().out)["caveats"]
    assert "lost the resonance" in caveat
