"""Exports of one friction signal in the forms of laboratories' programs: its samples and times, or a refusal."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.measurement.recordings.laboratory_exports import EXPORTS, FORCE, LOAD, TIME, write_export

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.reader import read_recording

REFUSED = {"signal-express.txt": "no column holds numbers"}
COEFFICIENTS = ("coefficient.csv", "csm.txt", "rtec.csv")
ROUNDED = {"rounded.csv": 0.01}  # s; of the clock


@pytest.mark.parametrize("name", [name for name in EXPORTS if name not in REFUSED])
def test_an_export_gives_the_signal(name: str, tmp_path: Path) -> None:
    path, mapping = write_export(name, tmp_path)
    recording = read_recording(path, mapping=mapping)
    channel = "friction_coefficient" if name in COEFFICIENTS else "friction_force"
    expected = FORCE / LOAD if name in COEFFICIENTS else FORCE
    assert recording[channel].to_numpy() == approx(expected, rel=1e-4)
    times = recording["time"].to_numpy()
    assert times - times[0] == approx(TIME, abs=ROUNDED.get(name, 1e-6))


@pytest.mark.parametrize("name", REFUSED)
def test_an_export_of_an_unknown_form_is_refused(name: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=REFUSED[name]):
        read_recording(write_export(name, tmp_path)[0])


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("summary.csv", "no row of samples, for it summarises the others, and left out: line 2002, 2003"),
        ("two-heads.csv", "no row of samples, for it repeats the labels, and left out: line 1002"),
        ("negative.csv", "friction_force is negative by the sign of the sensor"),
        ("rounded.csv", "the clock repeats itself"),
    ],
)
def test_what_is_assumed_or_left_out_is_said(name: str, said: str, tmp_path: Path) -> None:
    assert said in read_recording(write_export(name, tmp_path)[0]).attrs["caveats"]


def test_a_column_of_words_is_left_out_and_said(tmp_path: Path) -> None:
    rows = [f"{t:.3f},{f:.5f},sliding" for t, f in zip(TIME, FORCE, strict=True)]
    (tmp_path / "words.csv").write_text("\n".join(["time [s],friction_force [N],Phase", *rows]))
    assert read_recording(tmp_path / "words.csv").attrs["caveats"] == "column without numbers left out: 'Phase'"


@pytest.mark.parametrize(("order", "seconds"), [("{1}/{0}", None), ("{0}/{1}", None), ("{0}.{1}.", 86400.0)])
def test_a_date_whose_day_and_month_are_in_doubt_is_no_clock(order: str, seconds: float | None, tmp_path: Path) -> None:
    days = [order.format(f"{day:02d}", "05") + ("" if "." in order else "/") + "2026" for day in (3, 4)]
    rows = [f"{day} 12:00:00;{force:.3f}" for day, force in zip(np.repeat(days, 5), FORCE, strict=False)]
    path = tmp_path / "days.csv"
    path.write_text(
        "\n".join(
            ["Stamp;Friction force [N]", *(rows[0], *rows[5:6])] + [f"{days[1]} 12:00:0{n};1" for n in range(1, 9)]
        )
    )
    if seconds is None:
        with raises(InvalidInput, match="no column or property gives the time"):
            read_recording(path)
    else:
        assert float(np.diff(read_recording(path)["time"].to_numpy())[0]) == approx(seconds)


@pytest.mark.parametrize("cell", ["5.000", "12.345"])
def test_one_mark_before_three_digits_is_not_taken_for_thousands(cell: str, tmp_path: Path) -> None:
    rows = [f"{1 + t:.4f}".replace(".", ",") + f";{cell}" for t in TIME[:50]]
    (tmp_path / "doubt.csv").write_text("\n".join(["Zeit [s];Reibkraft [mN]", *rows]))
    with raises(InvalidInput, match="which is not a number"):
        read_recording(tmp_path / "doubt.csv")


def large(path: Path, *, rows: int = 60_000, changes: dict[int, str] | None = None, comma: bool = False) -> Path:
    """Text of more than a megabyte, some of its lines changed."""
    lines = ["Time [s];Friction force [N];Load [N]"]
    lines += [f"{n / 2000:.4f};{2 + 0.1 * np.sin(n / 9):.6f};5.000000" for n in range(rows)]
    lines = [line.replace(".", ",") for line in lines] if comma else lines
    for at, line in (changes or {}).items():
        lines[at] = line
    path.write_text("\n".join([*lines, ""]))
    return path


@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("changes", [{}, {5000: "2.4995;NaN;5.0"}, {5000: "2.4995;;5.0"}, {30_000: "Mean;2.0;5.0"}])
def test_a_large_text_is_read_as_a_small_one(
    comma: bool, changes: dict[int, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changes = {at: line.replace(".", ",") for at, line in changes.items()} if comma else changes
    path = large(tmp_path / "large.csv", changes=changes, comma=comma)
    quick = read_recording(path)
    monkeypatch.setattr("sonolube.measurement.recordings.large_text.LARGE", path.stat().st_size + 1)
    slow = read_recording(path)
    for name in ("time", "friction_force", "load"):
        assert quick[name].to_numpy() == approx(slow[name].to_numpy(), rel=1e-12, nan_ok=True)
    assert quick.attrs == slow.attrs


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("2.4995;2.0", "line 5001: has 2 cells where 3 columns are named"),
        ("2.4995;2.0;5.0;1", "line 5001: has 4 cells where 3 columns are named"),
        ("2.4995;2.O;5.0", "line 5001: 'Friction force .N.' is '2.O', which is not a number"),
        ("0.1;2.0;5.0", "line 5001: time decreases to 0.1 s"),
        ("2.4995;inf;5.0", "line 5001: 'Friction force .N.' is infinite"),
    ],
)
def test_a_line_of_a_large_text_is_refused_by_its_number(line: str, said: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=said):
        read_recording(large(tmp_path / "large.csv", changes={5000: line}))


def test_remarks_rules_and_comments_between_samples_are_no_samples(tmp_path: Path) -> None:
    rows = [f"{t:.3f} | {f:.5f} | 5.0" for t, f in zip(TIME, FORCE, strict=True)]
    rows[10:10] = ["# pause", "pause of the operator", "--- | --- | ---", ""]
    path = tmp_path / "remarks.txt"
    path.write_text("\n".join(["time [s] | friction force [N] | load [N]", *rows]))
    recording = read_recording(path)
    assert recording["friction_force"].to_numpy() == approx(FORCE, abs=1e-5)
    assert recording.attrs["caveats"] == "no row of samples, for it is a remark, and left out: line 13"
