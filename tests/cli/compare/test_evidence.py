"""Commands `evidence`: sources listed, files checked, points drawn, a posterior learned, and `predict` by it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx

Program = Callable[..., Any]


@pytest.fixture
def own(rigs: Path) -> Path:
    return rigs.parent / "evidence" / "own_tests.toml"


def test_the_list_names_each_source_with_its_points_and_what_is_not_printed(sonolube: Program) -> None:
    run = sonolube("evidence", "list")
    first, *rest = run.out.splitlines()
    assert first == "27 published points of 4 sources"
    assert "Luo et al.: 5 points on 1 rig, 5 within the plane" in rest
    assert "not printed: contact area, motion along the normal" in run.out
    content = sonolube("evidence", "list", "--json").answer
    luo = content["sources"][-1]["rigs"][0]
    # Luo et al. 2024, figure 5b: 0.503 N of 3.27 N at 0.05 mm/s
    assert luo["points"][0]["friction_ratio"] == {"value": approx(0.503 / 3.27), "unit": ""}
    assert luo["points"][0]["sliding_speed"] == {"value": approx(0.05e-3), "unit": "m/s"}


def test_files_are_checked_one_line_each_and_a_fault_is_named(own: Path, tmp_path: Path, sonolube: Program) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(own.read_text("utf-8").replace("30 mm/s", "30 mm"), "utf-8")
    run = sonolube("evidence", "check", own, wrong)
    assert run.code == 1
    assert run.out.splitlines() == ["own_tests.toml: Invented example: 3 points on 1 rig, 3 along the normal"]
    assert f"{wrong}: rigs.0.sliding_speed: 30 mm is a length" in run.err
    assert sonolube("evidence", "check", wrong).code == 2


def test_the_points_are_drawn_by_source_and_written(own: Path, tmp_path: Path, sonolube: Program) -> None:
    assert sonolube("evidence", "plot", own, "--out", tmp_path).code == 0
    assert (tmp_path / "evidence.png").stat().st_size > 10_000
    with xr.open_dataset(tmp_path / "evidence.nc") as data:
        assert data.sizes["point"] == 30
        assert float(data["friction_ratio"].sel(point="table 1, row 3")) == approx(1.3 / 3.1)
        assert data["vibration_amplitude"].attrs["units"] == "m"
        assert data["source"].values.tolist().count("Invented example") == 3


def test_a_posterior_is_learned_and_predicts_in_place_of_the_shipped_one(
    own: Path, rigs: Path, tmp_path: Path, sonolube: Program
) -> None:
    stubborn = tmp_path / "papers" / "stubborn.toml"
    stubborn.parent.mkdir()
    text = own.read_text("utf-8")
    for force in ("2.7 N +- 0.1", "2.1 N +- 0.1", "1.3 N +- 0.15"):
        text = text.replace(force, "3.0 N +- 0.1")
    stubborn.write_text(text, "utf-8")
    posterior = tmp_path / "posterior.json"
    learned = sonolube("evidence", "learn", stubborn.parent, "--out", posterior, "--json").answer
    assert learned["files"] == [str(posterior)]
    scores = learned["blind_scores"]
    assert [each["tests"] for each in scores.values()] == [20, 3, 20, 3, 23, 7]
    assert learned["fingerprint"] in posterior.read_text("utf-8")

    rig = rigs / "tribometer.toml"
    plain = sonolube("predict", rig, "--out", tmp_path, "--json").answer
    found = sonolube("predict", rig, "--evidence", posterior, "--out", tmp_path, "--json").answer
    assert found["friction_ratio"]["median"] > plain["friction_ratio"]["median"]
    assert plain["evidence"] is None
    assert found["evidence"]["file"] == "posterior.json"
    assert found["evidence"]["sources"][-1] == "N. N., J. Invented Res. 1, 1 (2026)"
    said = "learned from published tests and 3 points of Invented example (posterior.json)"
    assert any(said in caveat for caveat in found["caveats"])
    with xr.open_dataset(tmp_path / "tribometer-prediction.nc") as data:
        assert data.attrs["evidence_fingerprint"] in posterior.read_text("utf-8")
        assert np.median(data["friction_ratio"]) == approx(found["friction_ratio"]["median"])


def test_a_file_that_is_no_posterior_is_refused_in_one_line(own: Path, rigs: Path, sonolube: Program) -> None:
    run = sonolube("predict", rigs / "tribometer.toml", "--evidence", own)
    assert run.code == 2
    assert f"{own}: not valid JSON" in run.err
    assert run.err.count("\n") == 1
