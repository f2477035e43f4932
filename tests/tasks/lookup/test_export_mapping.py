"""Task `mapping` of exports of recordings: what each column is taken for, gains of sensors, and recipes."""

from pathlib import Path

import numpy as np
import pytest
from pytest import raises
from tests.measurement.recordings.laboratory_exports import FORCE, write_export
from tests.same import approx

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.reader import read_recording

SENSORS = {
    "keysight.csv": "1",
    "picoscope.csv": "Channel A",
    "tektronix-mdo.csv": "CH1",
    "siglent.csv": "CH1",
    "rigol.csv": "CH1",
    "digilent.csv": "Channel 1 (V)",
}


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.mark.parametrize("name", ["units-row.csv", "german.csv", "origin.txt", "clock.csv", "run.tdms", "trb.csv"])
def test_columns_that_are_known_are_shown_with_what_is_read(name: str, tmp_path: Path) -> None:
    path, _ = write_export(name, tmp_path)
    answer = sl.mapping(path)
    shown = answer.text(line_length=None)
    assert "2000 samples in 10 s" in shown or "2000 samples in 9.99 s" in shown
    assert f"friction_force {np.mean(FORCE):.3g} N" in shown
    (tmp_path / "mapping.toml").write_text(next(iter(answer.files().values())))
    recording = read_recording(path, mapping=tmp_path / "mapping.toml")
    assert recording["friction_force"].to_numpy() == approx(FORCE, rel=1e-5)


@pytest.mark.parametrize("name", SENSORS)
def test_an_oscilloscope_is_asked_for_its_sensor_and_known_again(name: str, tmp_path: Path) -> None:
    path, _ = write_export(name, tmp_path)
    with raises(InvalidInput, match=r"no column is known to be friction: state what '.+' is by column"):
        sl.mapping(path)
    answer = sl.mapping(path, column={SENSORS[name]: "friction_force 2 N/V"}, instrument="oscilloscope")
    assert "kept as" in answer.text()
    again = read_recording(path)
    assert again.attrs["mapping"] == "oscilloscope"
    assert again["friction_force"].to_numpy() == approx(FORCE, rel=1e-5)


def test_a_recipe_of_what_is_no_text_is_refused(tmp_path: Path) -> None:
    path, _ = write_export("run.tdms", tmp_path)
    with raises(InvalidInput, match="is no text, by whose labels later files could be recognised"):
        sl.mapping(path, instrument="daq")


def test_a_label_that_is_none_of_the_file_is_refused_with_the_closest(tmp_path: Path) -> None:
    path, _ = write_export("digilent.csv", tmp_path)
    with raises(InvalidInput, match=r"has no column 'Chanel 1'"):
        sl.mapping(path, column={"Chanel 1": "friction_force 2 N/V"})


def test_a_decimal_sign_has_no_meaning_for_the_export_of_a_recording(tmp_path: Path) -> None:
    path, _ = write_export("plain.csv", tmp_path)
    with raises(InvalidInput, match="decimal_sign has no meaning for"):
        sl.mapping(path, decimal_sign=",")
