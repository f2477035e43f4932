"""Command `uncertainty`: statistics, ranking, bands, identified structures and refusals."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.design import propagate
from sonolube.design.uncertainty import IdentifiedStructure
from sonolube.identification import Posterior, SingularDirection
from sonolube.rig import read_rig
from sonolube.tasks.design.uncertainty import UncertaintyAnswer

Program = Callable[..., Any]
FEW = ("--samples", "32")


@pytest.fixture
def uncertain(rigs: Path) -> Path:
    return rigs / "tribometer_uncertain.toml"


def test_statistics_and_ranking_are_in_the_answer_and_in_the_files(
    tmp_path: Path, sonolube: Program, uncertain: Path
) -> None:
    answer = sonolube("uncertainty", uncertain, *FEW, "--sobol", "--json", "--out", tmp_path).answer
    assert answer["points"] == 32 * 9
    assert answer["statuses"] == {"periodic": 32 * 9}
    assert answer["mean"]["lower"] < answer["mean"]["value"] < answer["mean"]["upper"]
    assert answer["mean"]["value"] == approx(0.39, abs=0.02)  # above 0.35 at the medians: a factor of two in Rq
    assert not answer["converged"]
    assert "not converged" in answer["caveats"][0]
    assert answer["uncertain"]["contact.normal_load"] == {
        "distribution": "normal, 3 N +- 60 mN",
        "truncated_fraction": 0.0,
    }
    ranking = answer["sobol"]
    assert {row["key"] for row in ranking} == set(answer["uncertain"])
    assert ranking[0]["first"]["value"] == max(row["first"]["value"] for row in ranking)
    assert all(row["deviation_if_known"] <= 1.001 * ranking[-1]["deviation_if_known"] for row in ranking)
    figure = [".png", ".svg", ".pdf"]
    assert [Path(path).suffix for path in answer["files"]] == [".html", *figure, *figure, ".nc"]
    with xr.open_dataset(answer["files"][-1]) as samples:
        assert samples["friction_ratio"].shape == (9, 32)


def test_the_lines_name_what_is_uncertain_and_the_remedy(tmp_path: Path, sonolube: Program, uncertain: Path) -> None:
    run = sonolube("uncertainty", uncertain, *FEW, "--of", "wear_rate_ratio", "--out", tmp_path)
    assert run.code == 0
    assert "32 points: wear rate with vibration over that without" in run.out
    assert "not converged" in run.out
    assert "take more samples" in run.out
    assert "contact.roughness.rms_height     lognormal, 6 um within a factor of 2" in run.out


def test_shares_stay_within_the_variance_and_only_entries_that_matter_are_advised(
    tmp_path: Path, sonolube: Program, uncertain: Path
) -> None:
    run = sonolube("uncertainty", uncertain, *FEW, "--sobol", "--out", tmp_path, "--full")
    advised, idle = run.out.split("which to measure better")[1].split("without effect: ")
    assert "contact.roughness.summit_radius" in idle.splitlines()[0]  # an exponential contact does not feel it
    assert "contact.roughness.summit_radius" not in advised
    assert "contact.roughness.rms_height" in advised
    assert all(float(share) <= 100 for share in re.findall(r"to (\d+)\)", advised))
    assert re.search(r"left out +the error of the model: \+-0\.1\d in the ratio", run.out)
    other = sonolube("uncertainty", uncertain, *FEW, "--of", "vibration_amplitude", "--out", tmp_path)
    assert "error of the model" not in other.out


def test_a_band_is_given_where_it_is_narrowest_and_widest(tmp_path: Path, sonolube: Program, uncertain: Path) -> None:
    over = ("--over", "sliding.sliding_speed=5mm/s:300mm/s:8:log")
    band = sonolube("uncertainty", uncertain, *FEW, *over, "--json", "--out", tmp_path).answer["band"]
    widest, narrowest = (band[name]["upper"] - band[name]["lower"] for name in ("widest", "narrowest"))
    assert widest > band["mean_width"] > narrowest
    assert band["narrowest"]["at"]["sliding.sliding_speed"] == approx(0.3)


@pytest.mark.parametrize(
    ("rig", "arguments", "line"),
    [
        ("tribometer", (), "the table uncertainty is missing"),
        ("tribometer_uncertain", ("--of", "friction"), "unknown outcome 'friction'; did you mean friction_ratio?"),
        ("tribometer_uncertain", ("--samples", "8"), "greater than or equal to 32"),
        (
            "tribometer_uncertain",
            ("--sobol", "--over", "sliding.sliding_speed=1mm/s"),
            "leave out --over and --identified",
        ),
        (
            "tribometer_uncertain",
            ("--over", "friction.model=kinematic,asperity_stick_slip", *FEW),
            "needs numbers to run over",
        ),
        ("collar", ("--identified",), "needs the tribometer's stack"),
    ],
)
def test_an_uncertainty_without_meaning_is_refused_in_one_line(
    rig: str, arguments: tuple[str, ...], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    assert line in sonolube("uncertainty", rigs / f"{rig}.toml", *arguments, "--out", tmp_path).refusal


def test_directions_that_the_facts_leave_free_are_listed(rigs: Path) -> None:
    draws = np.geomspace(1.0, 1000.0, 40)
    structure = IdentifiedStructure(
        posterior=Posterior(draws={"arm_damping": draws}, unidentified=("arm_damping",), potential_scale_reduction=1.3),
        unidentifiable_directions=(
            SingularDirection(exponents={"arm_damping": 0.99, "tip_mass": 0.01}, sensitivity=0.2),
        ),
    )
    rig = rigs / "tribometer.toml"
    result = propagate(rig, samples=32, joint_samples=structure.draws_by_key())
    answer = UncertaintyAnswer(rig=read_rig(rig), result=result, structure=structure)
    text = answer.text(line_length=None)
    assert "structure.arm_damping" in text
    assert "; no fact settles it" in text
    assert "left free by the facts, to a factor of e and more: arm_damping^+0.99\n" in text
    assert any("do not agree yet" in caveat for caveat in answer.caveats())
    assert answer.object()["identified"]["free"] == ["structure.arm_damping"]
