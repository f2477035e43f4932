"""Recipes: mappings of a user's instruments, by which later files are recognised."""

from pathlib import Path

import pytest
from pytest import approx, raises

import sonolube
from sonolube.errors import InvalidInput
from sonolube.measurement.file_kind import file_kind
from sonolube.measurement.measured_runs import read_runs, run_caveats
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout
from sonolube.measurement.recordings.reader import keep_recipe, mapping_by_name, read_recording, recipe_folders

LABELS = "Clock;Bridge [\u00b5V]"
BRIDGE = RecordingMapping(
    channels={"friction_force": ChannelSource(column="Bridge [\u00b5V]", gain=0.02, unit="N", reading_unit="uV")},
    axis=ChannelSource(column="Clock", unit="s"),
    text=TextLayout(lines_to_skip=2),
)


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


def export(path: Path, *, preamble: int = 2, encoding: str = "utf-8") -> Path:
    rows = [f"{n / 100:.2f};{100 + n % 3}" for n in range(60)]
    head = [f"Remark {n}" for n in range(preamble)]
    path.write_bytes("\n".join([*head, LABELS, *rows, ""]).encode(encoding))
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
@pytest.mark.parametrize("preamble", [0, 2, 7])
def test_a_file_of_the_same_labels_is_read_by_the_recipe(preamble: int, encoding: str, tmp_path: Path) -> None:
    path = export(tmp_path / "run.csv", preamble=preamble, encoding=encoding)
    with raises(InvalidInput, match="no column or property gives the time"):
        read_recording(path)
    keep_recipe("bridge-2", BRIDGE, labels=LABELS)
    recording = read_recording(path)
    assert float(recording["friction_force"][1]) == approx(0.02 * 101)
    assert recording.attrs["mapping"] == "bridge-2"


def test_a_recipe_beside_a_file_comes_before_that_of_the_user(tmp_path: Path) -> None:
    kept = keep_recipe("bridge", BRIDGE, labels=LABELS)
    own = recipe_folders(tmp_path / "run.csv")[0]
    own.mkdir()
    (own / "bridge.toml").write_text(kept.read_text().replace("0.02", "0.04"))
    assert float(read_recording(export(tmp_path / "run.csv"))["friction_force"][0]) == approx(4.0)


def test_a_recipe_is_taken_by_its_name(tmp_path: Path) -> None:
    keep_recipe("bridge", BRIDGE, labels=LABELS)
    assert mapping_by_name("bridge").channels.keys() == {"friction_force"}
    with raises(InvalidInput, match="did you mean bridge"):
        mapping_by_name("brigde")


@pytest.mark.parametrize(
    ("name", "labels", "said"),
    [
        ("umt", LABELS, "umt is a mapping of sonolube; choose another name"),
        ("../bridge", LABELS, "a name of an instrument has letters, digits and hyphens, got '../bridge'"),
        ("", LABELS, "a name of an instrument has letters"),
        ("bridge", "0.1;2", "files are recognised by their labels, and these hold no words"),
    ],
)
def test_a_recipe_that_could_not_be_found_again_is_refused(name: str, labels: str, said: str) -> None:
    with raises(InvalidInput, match=said):
        keep_recipe(name, BRIDGE, labels=labels)


def test_a_damaged_recipe_is_named(tmp_path: Path) -> None:
    kept = keep_recipe("bridge", BRIDGE, labels=LABELS)
    kept.write_text("channels = 3")
    with raises(InvalidInput, match=r"bridge\.toml"):
        read_recording(export(tmp_path / "run.csv"))


RUNS = ("Hub A", "v [mm/s]", "Last [N]", "Kraft A", "Kraft B")
STATED = {"Hub A": "vibration_amplitude um", "Kraft A": "friction_force N", "Kraft B": "intrinsic_friction_force N"}


def runs(path: Path, *, separator: str = ";", title: str = "") -> Path:
    rows = [["1", "200", "5", "1.72", "2.10"], ["2", "200", "5", "1.30", "2.10"], ["3", "200", "5", "0.98", "2.10"]]
    path.write_text(title + "\n".join(separator.join(row) for row in (RUNS, *rows)))
    return path


@pytest.mark.parametrize(("separator", "title"), [(";", ""), ("\t", ""), (";", "Stand 3;;;;\n")])
def test_a_table_of_runs_of_the_same_labels_is_read_by_its_recipe(separator: str, title: str, tmp_path: Path) -> None:
    first, later = runs(tmp_path / "march.csv"), runs(tmp_path / "april.csv", separator=separator, title=title)
    with raises(InvalidInput):
        read_runs(later)
    kept = sonolube.mapping(first, column=STATED, instrument="stand-3")
    assert any(line.endswith("stand-3.toml") for line in kept.caveats())
    read = read_runs(later)
    assert 1 - read["friction_reduction"].to_numpy() == approx([1.72 / 2.10, 1.30 / 2.10, 0.98 / 2.10])
    assert read["vibration_amplitude"].to_numpy() == approx([1e-6, 2e-6, 3e-6])
    assert "read by the recipe 'stand-3'" in run_caveats(read)
    assert file_kind(later) == "runs"
    again = sonolube.mapping(later)
    assert "read by the recipe 'stand-3'" in again.caveats()
    assert again.object()["columns"]["Kraft A"] == {"quantity": "friction_force", "unit": "N"}


def test_a_table_of_runs_of_other_labels_is_not_read_by_a_recipe(tmp_path: Path) -> None:
    sonolube.mapping(runs(tmp_path / "march.csv"), column=STATED, instrument="stand-3")
    other = runs(tmp_path / "april.csv")
    other.write_text(other.read_text().replace("Kraft B", "Kraft C"))
    with raises(InvalidInput):
        read_runs(other)


def test_a_table_without_headings_makes_no_recipe(tmp_path: Path) -> None:
    path = tmp_path / "bare.csv"
    path.write_text("1;200;1.72;2.10\n2;200;1.30;2.10\n3;200;0.98;2.10\n")
    names = ("vibration_amplitude um", "sliding_speed mm/s", "friction_force N", "intrinsic_friction_force N")
    statements = {f"column {place}": name for place, name in enumerate(names, start=1)}
    with raises(InvalidInput, match="has no headings, by which later tables could be recognised"):
        sonolube.mapping(path, column=statements, instrument="bare")
