"""Columns and channels of one label are refused, or chosen by their numbers; none is taken silently."""

from pathlib import Path

import numpy as np
import pyuff
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, Selection
from sonolube.measurement.recordings.raw_table import numbered_labels
from sonolube.measurement.recordings.reader import read_recording

TWO_FORCES = "time [s],Force [N],Force [N],Speed [m/s]\n0,1,10,5\n1,2,20,5\n2,3,30,5\n"


def friction(column: str, axis: str | None = None) -> RecordingMapping:
    return RecordingMapping(
        channels={"friction_force": ChannelSource(column=column)},
        axis=None if axis is None else ChannelSource(column=axis),
    )


def written(folder: Path, text: str, name: str = "test.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def vibrometer(folder: Path, directions: tuple[int, int]) -> Path:
    path = folder / "vibrometer.uff"
    sets = [
        pyuff.prepare_58(
            binary=0, id1="x", id2="x", id3="x", id4="x", id5="x", func_type=1, rsp_node=4, rsp_dir=direction,
            ref_node=1, ref_dir=3, data=at + np.arange(4.0), x=np.arange(4) * 1e-3, abscissa_spacing=1,
            abscissa_min=0.0, abscissa_inc=1e-3, ordinate_axis_units_lab="m/s", abscissa_spec_data_type=17,
            ordinate_spec_data_type=11, orddenom_spec_data_type=0, ver_num=0, load_case_id=0, rsp_ent_name="NONE",
            ref_ent_name="NONE", z_axis_value=0.0, ord_data_type=4,
        )
        | {"ordinate_axis_lab": "Velocity"}
        for at, direction in enumerate(directions, start=1)
    ]  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")
    return path


def test_a_mapping_that_names_one_of_two_equal_columns_is_refused_with_their_numbers(tmp_path: Path) -> None:
    with raises(InvalidInput) as refused:
        read_recording(written(tmp_path, TWO_FORCES), mapping=friction("Force [N]", "time [s]"))
    assert "2 columns are named 'Force [N]'" in str(refused.value)
    assert "'Force [N] #1' to 'Force [N] #2'" in str(refused.value)
    assert "\n" not in str(refused.value)


@mark.parametrize(("number", "expected"), [(1, [1, 2, 3]), (2, [10, 20, 30])])
def test_a_mapping_chooses_among_equal_columns_by_number(tmp_path: Path, number: int, expected: list[float]) -> None:
    mapping = friction(f"Force [N] #{number}", "time [s]")
    found = read_recording(written(tmp_path, TWO_FORCES), mapping=mapping)
    assert found.friction_force.values == approx(expected)
    assert found.friction_force.attrs["source_unit"] == "N"


def test_an_option_chooses_among_equal_columns_by_number(tmp_path: Path) -> None:
    path = written(tmp_path, TWO_FORCES)
    chosen = RecordingMapping(channels={}, selection=Selection(channels=("Force [N] #2",)))
    assert read_recording(path, mapping=chosen).force.values == approx([10, 20, 30])
    with raises(InvalidInput, match=r"2 columns are named 'force'.*'Force \[N\] #1' to 'Force \[N\] #2'"):
        read_recording(path)


@mark.parametrize("second", ["0,0\n2,2\n4,4\n", "5,0\n6,1\n7,2\n"])
def test_two_times_that_differ_are_refused_with_their_numbers(tmp_path: Path, second: str) -> None:
    rows = [f"{at},1,{row}" for at, row in enumerate(second.splitlines())]
    path = written(tmp_path, "\n".join(["time,force,time,wear", *rows]) + "\n")
    with raises(InvalidInput, match=r"2 columns are named 'time' and differ; .*'?time #1"):
        read_recording(path)
    found = read_recording(path, mapping=friction("force", "time #2"))
    assert found.time.values == approx([float(row.split(",")[0]) for row in second.splitlines()])


def test_a_time_that_is_repeated_for_every_channel_is_read(tmp_path: Path) -> None:
    path = written(tmp_path, "time,force,time,wear\n0,1,0,2\n1,1,1,2\n")
    assert set(read_recording(path).data_vars) == {"force", "wear"}


def test_responses_of_equal_labels_are_chosen_by_their_degree_of_freedom(tmp_path: Path) -> None:
    path = vibrometer(tmp_path, (1, 3))
    mapping = RecordingMapping(channels={"vibration_velocity": ChannelSource(column="Velocity node 4 direction 3")})
    assert read_recording(path, mapping=mapping).vibration_velocity.values[0] == approx(2)
    mapping = RecordingMapping(channels={"vibration_velocity": ChannelSource(column="Velocity")})
    with raises(InvalidInput, match=r"has no column 'Velocity'; .*Velocity node 4 direction"):
        read_recording(path, mapping=mapping)


def test_responses_of_equal_labels_and_degrees_of_freedom_are_chosen_by_number(tmp_path: Path) -> None:
    path, label = vibrometer(tmp_path, (3, 3)), "Velocity node 4 direction 3"
    with raises(InvalidInput, match="2 columns are named 'Velocity node 4 direction 3'"):
        read_recording(path, mapping=RecordingMapping(channels={"vibration_velocity": ChannelSource(column=label)}))
    mapping = RecordingMapping(channels={"vibration_velocity": ChannelSource(column=f"{label} #2")})
    assert read_recording(path, mapping=mapping).vibration_velocity.values[0] == approx(2)


def test_numbered_labels_differ_even_from_labels_that_look_numbered() -> None:
    assert numbered_labels(["F", "F", "F #1", ""]) == ["F #2", "F #3", "F #1", ""]
