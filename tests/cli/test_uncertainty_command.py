"""The command `uncertainty`: what it tells, writes and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import CaptureFixture, approx, raises

from sonolube.cli import main
from sonolube.cli.uncertainty_output import Identified, uncertainty_lines
from sonolube.design import propagate
from sonolube.identification import Posterior, SingularDirection
from sonolube.rig import read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
UNCERTAIN = str(RIGS / "tribometer_uncertain.toml")
FEW = ("--samples", "32")


def answer(capsys: CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with raises(SystemExit) as end:
        main(("uncertainty", *arguments))
    out, err = capsys.readouterr()
    return int(str(end.value.code)), out, err


def test_it_tells_spread_and_ranking_and_writes_them(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, UNCERTAIN, *FEW, "--sobol", "--json", "--out", str(tmp_path))
    told = json.loads(out)
    assert code == 0
    assert told["points"] == 32 * 9
    assert told["statuses"] == {"periodic": 32 * 9}
    assert told["mean"]["lower"] < told["mean"]["value"] < told["mean"]["upper"]
    assert told["mean"]["value"] == approx(0.36, abs=0.02)
    assert not told["converged"]
    assert told["uncertain"]["contact.normal_load"] == {
        "distribution": "normal, 3 N +- 60 mN",
        "truncated_fraction": 0.0,
    }
    assert {row["key"] for row in told["sobol"]} == set(told["uncertain"])
    assert told["sobol"][0]["first"]["value"] == max(row["first"]["value"] for row in told["sobol"])
    assert all(row["deviation_if_known"] <= 1.001 * told["sobol"][-1]["deviation_if_known"] for row in told["sobol"])
    assert [Path(path).suffix for path in told["files"]] == [".html", ".png", ".svg", ".png", ".svg", ".nc"]
    with xr.open_dataset(told["files"][-1]) as found:
        assert found["friction_ratio"].shape == (9, 32)


def test_its_lines_say_what_is_uncertain_and_what_to_do(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, UNCERTAIN, *FEW, "--of", "wear_rate_ratio", "--out", str(tmp_path))
    assert code == 0
    assert "32 points: wear rate with vibration over wear rate without" in out
    assert "not converged" in out
    assert "take more --samples" in out
    assert "contact.roughness.rms_height       normal, 6 um +- 600 nm" in out


def test_a_band_is_told_where_it_is_widest(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    over = ("--over", "sliding.sliding_speed=5mm/s:300mm/s:8:log")
    code, out, _ = answer(capsys, UNCERTAIN, *FEW, *over, "--json", "--out", str(tmp_path))
    band = json.loads(out)["band"]
    assert code == 0
    widest, narrowest = (band[word]["upper"] - band[word]["lower"] for word in ("widest", "narrowest"))
    assert widest > band["mean_width"] > narrowest
    assert band["narrowest"]["at"]["sliding.sliding_speed"] == approx(0.3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((str(RIGS / "tribometer.toml"),), "the table uncertainty is missing"),
        ((UNCERTAIN, "--of", "friction"), "unknown outcome 'friction'; did you mean friction_ratio?"),
        ((UNCERTAIN, "--samples", "8"), "greater than or equal to 32"),
        ((UNCERTAIN, "--sobol", "--over", "sliding.sliding_speed=1mm/s"), "leave out --over and --identified"),
        ((UNCERTAIN, "--over", "friction.model=kinematic,asperity_stick_slip", *FEW), "needs numbers to run over"),
        ((str(RIGS / "collar.toml"), "--identified"), "needs the tribometer's stack"),
    ],
)
def test_what_cannot_be_had_is_refused_in_one_line(
    arguments: tuple[str, ...], said: str, tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    code, out, err = answer(capsys, *arguments, "--out", str(tmp_path))
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.strip().splitlines()) == 1


def test_what_facts_leave_free_is_said() -> None:
    draws = np.geomspace(1.0, 1000.0, 40)
    drawn = Identified(
        posterior=Posterior(draws={"arm_damping": draws}, unidentified=("arm_damping",), potential_scale_reduction=1.3),
        unidentifiable_directions=(
            SingularDirection(exponents={"arm_damping": 0.99, "tip_mass": 0.01}, sensitivity=0.2),
        ),
    )
    rig = RIGS / "tribometer.toml"
    result = propagate(rig, samples=32, joint_samples=drawn.draws_by_key())
    told = "\n".join(uncertainty_lines(read_rig(rig), result, drawn, []))
    assert "structure.arm_damping" in told
    assert "; no fact settles it" in told
    assert "left free by the facts, to a factor of e and more: arm_damping^+0.99\n" in told
    assert "do not agree yet" in told
