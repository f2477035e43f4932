"""Recipes: mappings of a user's instruments, by which later files are recognised."""

from pathlib import Path

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
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
