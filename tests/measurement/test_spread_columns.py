"""Columns of standard deviations in tables of runs, told by their own headings or by the column before them."""

from math import hypot, sqrt
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

import sonolube
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import read_runs, run_caveats
from sonolube.measurement.run_headings import run_heading, spread_headings

ON, OFF, OF_ON, OF_OFF = 1.72, 2.10, 0.05, 0.04
REDUCTION = hypot(OF_ON, ON / OFF * OF_OFF) / OFF  # standard uncertainty of 1 - ON/OFF, to first order


def written(folder: Path, *heads: str, cells: str = "1.72;0.05;2.10;0.04") -> Path:
    path = folder / "runs.csv"
    rows = [f"{amplitude};200;5;{cells}" for amplitude in (1, 2, 3)]
    path.write_text("\n".join([";".join(["Amplitude [um]", "Speed [mm/s]", "Load [N]", *heads]), *rows]))
    return path


@pytest.mark.parametrize(
    "heads",
    [
        ("Reibkraft mit US [N]", "Standardabweichung", "Reibkraft ohne US [N]", "Standardabweichung"),
        ("Friction force on [N]", "SD", "Friction force off [N]", "SD"),
        ("Friction force on [N]", "+/-", "Friction force off [N]", "± [N]"),
        ("Friction force on [N]", "Std. friction force on [N]", "Friction force off [N]", "s.d. of friction force off"),
        ("COF on", "SD", "COF off", "std dev"),
        ("mu mit US", "s.d. of mu mit US", "mu ohne US", "uncertainty of mu ohne US"),
    ],
)
def test_spreads_are_the_uncertainties_of_their_columns(heads: tuple[str, ...], tmp_path: Path) -> None:
    runs = read_runs(written(tmp_path, *heads))
    assert runs["friction_reduction_uncertainty"].to_numpy() == approx(np.full(3, REDUCTION), rel=1e-9)
    assert sum("is taken as the " in line for line in run_caveats(runs)) == 2


def test_a_spread_keeps_the_unit_of_its_column_and_one_of_its_own(tmp_path: Path) -> None:
    heads = ("Friction force on [mN]", "SD", "Friction force off [mN]", "SD [N]")
    runs = read_runs(written(tmp_path, *heads, cells="1720;50;2100;0.04"))
    assert runs["friction_force_uncertainty"].to_numpy() == approx(np.full(3, OF_ON))
    assert runs["intrinsic_friction_force_uncertainty"].to_numpy() == approx(np.full(3, OF_OFF))


def test_a_spread_behind_the_load_is_that_of_the_load(tmp_path: Path) -> None:
    path = written(tmp_path, "SD", "COF on", "COF off", cells="0.2;0.344;0.420")
    assert read_runs(path)["normal_load_uncertainty"].to_numpy() == approx(np.full(3, 0.2))


def test_a_spread_that_is_written_as_zero_is_one_below_its_last_digit(tmp_path: Path) -> None:
    runs = read_runs(written(tmp_path, "COF on", "SD", "COF off", cells="0.344;0.000;0.420"))
    assert runs["friction_coefficient_uncertainty"].to_numpy() == approx(np.full(3, 0.0005 / sqrt(3)))


@pytest.mark.parametrize(
    ("heads", "label"),
    [
        (("COF on", "COF off", "SD", "Remark"), "SD"),  # of either coefficient
        (("COF on", "SD [%]", "COF off", "Remark"), "SD [%]"),  # of the coefficient, or of its value
        (("COF on", "COF off", "Wear", "Wear SD [a.u.]"), "Wear SD [a.u.]"),
        (("COF on", "COF off", "Vib. amplitude SD [um]", "Remark"), "Vib. amplitude SD [um]"),
    ],
)
def test_a_spread_of_a_column_that_is_not_clear_is_left_out_and_said(
    heads: tuple[str, ...], label: str, tmp_path: Path
) -> None:
    cells = "0.344;0.420;0.05;1" if heads[1] == "COF off" else "0.344;5;0.420;1"
    runs = read_runs(written(tmp_path, *heads, cells=cells))
    assert "friction_reduction_uncertainty" not in runs
    assert any("left out: " in line and repr(label) in line for line in run_caveats(runs))


def test_hours_are_no_standard_deviations() -> None:
    labels = ["Zeit [Std]", "Load [N]", "SD"]
    assert set(spread_headings(labels, [run_heading(label) for label in labels])) == {2}


def test_a_standard_lubricant_is_no_spread_and_is_asked_for(tmp_path: Path) -> None:
    with raises(InvalidInput, match="it looks like a lubricant"):
        read_runs(written(tmp_path, "COF on", "COF off", "Std. oil type", cells="0.344;0.420;PAO 4"))


def test_the_command_mapping_shows_spreads_and_writes_them(tmp_path: Path) -> None:
    path = written(tmp_path, "Kraft A", "SD", "Kraft B", "SD")
    statements = {"Kraft A": "friction_force N", "Kraft B": "intrinsic_friction_force N"}
    answer = sonolube.mapping(path, column=statements)
    shown = answer.object()["columns"]
    assert shown["SD #1"] == {"quantity": "friction_force_uncertainty", "unit": "N"}
    assert shown["SD #2"] == {"quantity": "intrinsic_friction_force_uncertainty", "unit": "N"}
    ((name, content),) = answer.files().items()
    (tmp_path / name).write_text(content, encoding="utf-8")
    runs = read_runs(path, mapping=tmp_path / name)
    assert runs["friction_reduction_uncertainty"].to_numpy() == approx(np.full(3, REDUCTION), rel=1e-9)


def test_predict_and_fit_weigh_the_runs_by_their_spreads(tmp_path: Path) -> None:
    known = {"pin": "brass", "disc": "304", "load": "5N", "speed": "0.2m/s", "frequency": "20kHz"}
    rig = sonolube.new(**known, amplitude="2um").rig
    path = written(tmp_path, "Friction force on [N]", "SD", "Friction force off [N]", "SD")
    predicted = sonolube.predict(rig, runs=path).dataset()["measured_uncertainty"]
    fitted = sonolube.fit(path, rig=rig, model=["kinematic-fitted"]).dataset()["friction_ratio_uncertainty"]
    assert predicted.to_numpy() == approx(np.full(3, REDUCTION), rel=1e-9)
    assert fitted.to_numpy() == approx(np.full(3, REDUCTION), rel=1e-9)
