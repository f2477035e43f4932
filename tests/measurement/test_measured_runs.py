"""Tables of measured runs: every column, empty cells, references without vibration, copies, refusals in one line."""

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from pytest import approx

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import (
    checked_ratios,
    copies_caveat,
    direction_words,
    read_runs,
    run_caveats,
    runs_text,
    setting,
    with_columns,
)
from sonolube.measurement.run_columns import DIRECTION_WORDS, RUN_COLUMNS
from sonolube.rig.vibration_direction import DirectionWord, VibrationDirection
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities


def table(folder: Path, text: str) -> Path:
    path = folder / "runs.csv"
    path.write_text(text)
    return path


def test_a_table_with_every_column_is_read_in_si(tmp_path: Path) -> None:
    head = ",".join(column.heading for column in RUN_COLUMNS)
    row = ",".join("a" if column.is_text else "2" for column in RUN_COLUMNS)
    runs = read_runs(table(tmp_path, f"{head}\n{row}\n"))
    for column in RUN_COLUMNS:
        if column.is_text:
            assert str(runs[column.name][0].item()) == "a"
        else:
            expected = to_si(f"2 {column.unit}", unit=quantities()[column.name].unit, name=column.name)
            assert float(runs[column.name][0]) == approx(expected)


def test_a_direction_may_be_a_word_or_an_angle(tmp_path: Path) -> None:
    words = "along,longitudinal,across,Transverse,normal,perpendicular,torsional,"
    text = "vibration_direction,friction_ratio\n" + "".join(f"{word},0.5\n" for word in words.split(","))
    runs = read_runs(table(tmp_path, text))
    expected = [0, 0, np.pi / 2, np.pi / 2, *[np.nan] * 4]
    assert runs["vibration_direction"].to_numpy() == approx(expected, nan_ok=True)
    assert direction_words(runs) == {"normal", "torsional"}
    mixed = read_runs(table(tmp_path, "vibration_direction [deg],friction_ratio\nacross,0.5\n30,0.4\n,0.3\n"))
    assert mixed["vibration_direction"].to_numpy() == approx([np.pi / 2, np.pi / 6, np.nan], nan_ok=True)
    assert direction_words(mixed) == frozenset()
    plain = read_runs(table(tmp_path, "vibration_direction [deg],friction_ratio\n30,0.4\n"))
    assert "vibration_direction_word" not in plain


def test_a_direction_that_is_neither_and_angles_without_a_unit_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="line 2: vibration_direction 'sideways' is no number"):
        read_runs(table(tmp_path, "vibration_direction [deg],friction_ratio\nsideways,0.4\n"))
    with pytest.raises(InvalidInput, match="vibration_direction has no unit"):
        read_runs(table(tmp_path, "vibration_direction,friction_ratio\nalong,0.4\n30,0.4\n"))


def test_words_for_directions_are_those_of_a_rig_file() -> None:
    assert set(DIRECTION_WORDS) == {*get_args(DirectionWord)}
    assert all(
        DIRECTION_WORDS[word] == approx(VibrationDirection(direction=word).angle)
        for word in ("along", "longitudinal", "across", "transverse")
    )


def test_a_path_may_be_text(tmp_path: Path) -> None:
    path = table(tmp_path, "friction_ratio\n0.5\n")
    assert read_runs(str(path)).equals(read_runs(path))


def test_empty_cells_are_not_measured_and_empty_results_are_left_out_with_their_lines(tmp_path: Path) -> None:
    text = "run,sliding_speed [mm/s],normal_load [N],friction_ratio\n1,20,,0.5\n2,30,3,\n3,40,3,0.7\n4,50,3,\n"
    runs = read_runs(table(tmp_path, text))
    assert runs["friction_reduction"].to_numpy() == approx([0.5, 0.3])
    assert setting(runs, "normal_load", 5.0) == approx([5.0, 3.0])
    assert run_caveats(runs) == ("2 of 4 runs have no friction yet and are left out (line 3, 5)",)


def test_a_plan_without_results_is_refused_with_the_columns_to_fill_in(tmp_path: Path) -> None:
    text = "run,sliding_speed [mm/s],friction_force [N],intrinsic_friction_force [N]\n1,20,,\n2,30,,\n"
    with pytest.raises(InvalidInput, match=r"no run has a result yet: fill in friction_reduction \[%\], or") as refusal:
        read_runs(table(tmp_path, text))
    assert "\n" not in str(refusal.value)


def test_each_row_takes_its_friction_from_the_columns_it_has(tmp_path: Path) -> None:
    head = "friction_reduction [%],friction_ratio,friction_force [N],intrinsic_friction_force [N]"
    runs = read_runs(table(tmp_path, f"{head}\n40,,,\n,0.7,,\n,,0.5,2\n"))
    assert runs["friction_reduction"].to_numpy() == approx([0.4, 0.3, 0.75])


def test_rows_at_amplitude_zero_give_the_dry_friction_of_their_speed(tmp_path: Path) -> None:
    rows = ["0,20,1.0", "0,20,1.2", "2,20,0.55", "0,40,2", "2,40,1"]
    text = "\n".join(["vibration_amplitude [um],sliding_speed [mm/s],friction_force [N]", *rows])
    runs = read_runs(table(tmp_path, text))
    assert runs["friction_reduction"].to_numpy() == approx([0.5, 0.5])
    assert runs["intrinsic_friction_force"].to_numpy() == approx([1.1, 2.0])


def test_uncertain_forces_and_wear_rates_give_those_of_their_ratios(tmp_path: Path) -> None:
    head = (
        "friction_force [N],intrinsic_friction_force [N],friction_force_uncertainty [N],"
        "intrinsic_friction_force_uncertainty [N],wear_rate [mm3/m],intrinsic_wear_rate [mm3/m]"
    )
    runs = read_runs(table(tmp_path, f"{head}\n1,2,0.06,0.16,1,4\n"))
    assert float(runs["friction_reduction_uncertainty"][0]) == approx(np.hypot(0.03, 0.04))
    assert float(runs["wear_rate_ratio"][0]) == approx(0.25)


def test_coefficients_and_the_zero_of_a_force_give_the_uncertainty_of_their_ratio(tmp_path: Path) -> None:
    # r = 0.5 of 0.4: sqrt(0.01^2 + (0.5 * 0.02)^2) / 0.4
    head = (
        "friction_coefficient,intrinsic_friction_coefficient,friction_coefficient_uncertainty,"
        "intrinsic_friction_coefficient_uncertainty"
    )
    by_coefficient = read_runs(table(tmp_path, f"{head}\n0.2,0.4,0.01,0.02\n"))
    assert float(by_coefficient["friction_reduction_uncertainty"][0]) == approx(np.sqrt(2e-4) / 0.4)
    # a zero that is off by u moves the ratio 0.25 of 2 N by (1 - 0.25) u / 2 N
    by_zero = "friction_force [N],intrinsic_friction_force [N],force_zero_uncertainty [N]\n0.5,2,0.04\n"
    runs = read_runs(table(tmp_path, by_zero))
    assert float(runs["friction_reduction_uncertainty"][0]) == approx(0.75 * 0.04 / 2)


def test_rows_without_vibration_serve_their_run_before_those_of_their_speed(tmp_path: Path) -> None:
    rows = "1,off,2.0\n1,on,1.0\n2,off,4.0\n2,on,1.0\n3,on,1.5\n"
    runs = read_runs(table(tmp_path, f"Run,Ultrasound,Friction force [N]\n{rows}"))
    assert 1 - runs["friction_reduction"].to_numpy() == approx([0.5, 0.25, 0.5])  # the third by the mean, 3 N


def test_what_a_table_was_read_as_is_one_line(tmp_path: Path) -> None:
    text = "Load [N],Speed [mm/s],Amplitude [um],COF on,COF off\n5,20,1,0.3,0.4\n5,20,2,0.2,0.4\n"
    assert runs_text(read_runs(table(tmp_path, text))) == (
        "runs.csv: 2 runs with vibration amplitude, sliding speed 20 mm/s, normal load 5 N; friction ratio 0.5 to 0.75"
        " by friction coefficient with and without vibration"
    )


def test_equal_rows_count_and_are_said_unless_their_names_differ(tmp_path: Path) -> None:
    rows = "sliding_speed [mm/s],friction_ratio{}\n" + "20,0.5{}\n" * 3
    (caveat,) = copies_caveat(read_runs(table(tmp_path, rows.format("", "", "", ""))))
    assert caveat.startswith("2 of 3 runs equal another in every digit; they count as repeats")
    assert copies_caveat(read_runs(table(tmp_path, rows.format(",run", ",a", ",b", ",c")))) == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sliding_speed [N],friction_ratio\n1,0.5\n", r"line 1: sliding_speed: N is a force; expected a speed"),
        ("voltage [V],friction_ratio\n1,0.5\n", r"column 'voltage \[V\]' must name a quantity"),
        ("run,run,friction_ratio\n1,1,0.5\n", "two columns are named run"),
        ("friction_force [N],intrinsic_friction_force [N]\n1,-2\n", "intrinsic_friction_force must be positive"),
        ("run\n1\n", r"needs a column friction_reduction \[%\]"),
    ],
)
def test_tables_that_cannot_be_read_are_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InvalidInput, match=message) as refusal:
        read_runs(table(tmp_path, text))
    assert "\n" not in str(refusal.value)


def test_a_ratio_beyond_what_vibration_does_is_refused_with_its_run(tmp_path: Path) -> None:
    runs = read_runs(table(tmp_path, "friction_ratio\n0.5\n3.5\n"))
    with pytest.raises(InvalidInput, match=r"run 2 has a friction ratio of 3\.5"):
        checked_ratios(runs, title="mine")


def test_a_missing_column_is_named_with_its_unit(tmp_path: Path) -> None:
    runs = read_runs(table(tmp_path, "friction_ratio\n0.5\n"))
    with pytest.raises(InvalidInput, match=r"need a column actuator_power: add actuator_power \[W\]"):
        with_columns(runs, "actuator_power")


def test_friction_without_vibration_serves_its_own_speed_also_within_one_run(tmp_path: Path) -> None:
    path = tmp_path / "runs.csv"
    rows = ["day 1,20,0,1.0", "day 1,20,2,0.4", "day 1,60,0,2.0", "day 1,60,2,1.0", "day 2,60,0,4.0", "day 2,60,2,1.0"]
    path.write_text("\n".join(["run,sliding_speed [mm/s],vibration_amplitude [um],friction_force [N]", *rows]))
    assert read_runs(path)["friction_reduction"].to_numpy() == approx([0.6, 0.5, 0.75])
