"""Columns of files as stated, and their mapping."""

from pathlib import Path

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.column_statements import mapping_of_statements, stated_file_columns
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, mapping_toml, read_mapping
from sonolube.measurement.recordings.reader import read_recording


def test_labels_tell_quantity_and_unit_or_are_asked() -> None:
    labels = ["time (s)", "friction_force (N)", "Load [N]", "displacement", "X", "Zustand", "run"]
    cells = [["0"], ["1"], ["2"], ["3"], ["4"], ["dry"], ["A", "B"]]
    found = stated_file_columns(labels, [""] * 7, cells, None)
    assert [(each.statement, each.is_asked) for each in found] == [
        ("time s", False),
        ("friction_force N", False),
        ("normal_load N", True),
        ("displacement m", True),
        ("-", True),
        ("-", False),
        ("run", False),
    ]
    assert found[6].texts == ("A", "B")


def test_statements_make_a_mapping_that_reads_the_file(tmp_path: Path) -> None:
    path = tmp_path / "test.csv"
    path.write_text("Zeit,Kraft,Art\n0,1,a\n100,2,a\n200,3,b\n")
    mapping = mapping_of_statements({"Zeit": "time ms", "Kraft": "friction_force mN", "Art": "-"}, rows={"Art": "a"})
    (tmp_path / "mapping.toml").write_text(mapping_toml(mapping))
    recording = read_recording(path, mapping=read_mapping(tmp_path / "mapping.toml"))
    assert recording["time"].values == approx([0.0, 0.1])
    assert recording["friction_force"].values == approx([1e-3, 2e-3])


def test_a_sample_rate_stands_for_a_column_of_the_time(tmp_path: Path) -> None:
    path = tmp_path / "test.csv"
    path.write_text("Kraft\n1\n2\n3\n")
    mapping = mapping_of_statements({"Kraft": "friction_force N"}, sample_rate=10.0)
    assert read_recording(path, mapping=mapping)["time"].values == approx(np.array([0.0, 0.1, 0.2]))


def test_calibrations_of_a_mapping_stay() -> None:
    source = ChannelSource(column="U", unit="N", gain=12.5)
    before = RecordingMapping(channels={"friction_force": source})
    after = mapping_of_statements({"U": "friction_force mN"}, mapping=before)
    assert (after.channels["friction_force"].gain, after.channels["friction_force"].unit) == (12.5, "mN")


def test_what_is_refused_names_its_column() -> None:
    for statements, reason in (
        ({"A": "friction_fork N"}, "friction_force"),
        ({"A": "friction_force m"}, "no unit of friction_force"),
        ({"B": "friction_force N", "A": "friction_force N"}, "are both friction_force"),
    ):
        with raises(InvalidInput, match=reason) as refused:
            mapping_of_statements(statements)
        assert refused.value.key == "A"


def test_a_column_of_spreads_is_the_uncertainty_of_the_one_before_it() -> None:
    columns = stated_file_columns(["COF on", "SD", "COF off"], ["", "", ""], [["0.3"], ["0.02"], ["0.4"]], None)
    assert [column.statement for column in columns][1] == "friction_coefficient_uncertainty"
    assert not columns[1].is_asked


def test_up_to_sixty_different_words_are_offered_for_a_choice_of_rows() -> None:
    cells = [[f"run {number}" for number in range(count)] for count in (60, 61)]
    found = stated_file_columns(["Test", "Probe"], ["", ""], cells, None)
    assert [len(each.texts) for each in found] == [60, 0]
