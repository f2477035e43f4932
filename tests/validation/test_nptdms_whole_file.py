"""The streaming TDMS reader against npTDMS reading whole files: samples, scaling, properties, segments, truncation."""

import struct
from pathlib import Path

import numpy as np
from nptdms import ChannelObject, GroupObject, RootObject, TdmsFile, TdmsWriter
from numpy.typing import NDArray
from pytest import approx, mark

from sonolube.measurement.recordings.raw_table import RawTable, one_line
from sonolube.measurement.recordings.tdms import Tdms

CORPUS = Path(__file__).parents[1] / "measurement" / "recordings" / "corpus"
DTYPES = ("<f8", "<f4", "<i2", "<u1", "<i4", "<u4", "<i8")
RATE = 400.0  # Hz


def samples(size: int, dtype: str, seed: int) -> NDArray[np.generic]:
    values = 100 * np.random.default_rng(seed).random(size)
    return values.astype(dtype)


def linear_scale(slope: float, intercept: float) -> dict[str, object]:
    return {
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": slope,
        "NI_Scale[0]_Linear_Y_Intercept": intercept,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
    }


def polynomial_scale(*coefficients: float) -> dict[str, object]:
    return {
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Polynomial",
        "NI_Scale[0]_Polynomial_Coefficients_Size": len(coefficients),
        "NI_Scale[0]_Polynomial_Input_Source": 0xFFFFFFFF,
        **{f"NI_Scale[0]_Polynomial_Coefficients[{power}]": value for power, value in enumerate(coefficients)},
    }


def compare_with_whole_file(path: Path, table: RawTable, *, complete: bool = True) -> None:
    """Every numeric channel of npTDMS's whole-file read, its samples, unit and time base, is a column of the table."""
    whole = TdmsFile.read(path)
    channels = [channel for group in whole.groups() for channel in group.channels()]
    numeric = [channel for channel in channels if len(channel) and getattr(channel.dtype, "kind", "O") in "fiub"]
    names = [channel.name for channel in channels]
    columns = {column.label: column for column in table.columns}
    assert len(columns) == len(numeric)
    rows = min(len(channel) for channel in numeric)
    for channel in numeric:
        full_name = f"{channel.group_name}/{channel.name}"
        column = columns[one_line(channel.name if names.count(channel.name) == 1 else full_name)]
        assert len(channel) == rows or not complete
        assert np.array_equal(column.values, np.asarray(channel[:rows], dtype=np.float64), equal_nan=True)
        assert column.unit == channel.properties.get("unit_string")
        assert column.interval == channel.properties.get("wf_increment")
        assert column.start == channel.properties.get("wf_start_offset", 0.0)


def in_blocks(path: Path, block_samples: int) -> RawTable:
    """The blocks of a file, put together."""
    blocks = list(Tdms().read_blocks(path, mapping=None, block_samples=block_samples))
    assert [block.first_row for block in blocks] == [block_samples * number for number in range(len(blocks))]
    columns = tuple(
        type(column)(
            label=column.label,
            values=np.concatenate([block.columns[place].values for block in blocks]),
            unit=column.unit,
            start=column.start,
            interval=column.interval,
        )
        for place, column in enumerate(blocks[0].columns)
    )
    return RawTable(columns=columns, format_name=Tdms.name)


def written(path: Path, *, segments: int, size: int = 50) -> Path:
    """Two groups of channels of every type, with properties, scales, and a text channel, in several segments."""
    with TdmsWriter(path) as writer:
        for segment in range(segments):
            objects = [
                RootObject({"title": "made"}),
                GroupObject("tribometer", {"operator": "none"}),
                *(
                    ChannelObject(
                        "tribometer",
                        f"channel {number}",
                        samples(size, dtype, 10 * segment + number),
                        {"unit_string": "N", "wf_increment": 1 / RATE, "wf_start_offset": 0.5},
                    )
                    for number, dtype in enumerate(DTYPES)
                ),
                ChannelObject("other", "channel 0", samples(size, "<f8", segment)),  # a name that both groups have
                ChannelObject("other", "linear", samples(size, "<i2", segment), linear_scale(0.25, -3.0)),
                ChannelObject("other", "polynomial", samples(size, "<f4", segment), polynomial_scale(1.0, 2.0, 0.5)),
                ChannelObject("other", "remarks", [f"remark {line}" for line in range(size)]),
            ]
            writer.write_segment(objects)
    return path


@mark.parametrize("segments", [1, 3])
def test_channels_of_every_type_scale_and_group_agree(segments: int, tmp_path: Path) -> None:
    path = written(tmp_path / "channels.tdms", segments=segments)
    compare_with_whole_file(path, Tdms().read(path))


@mark.parametrize("block_samples", [1, 7, 50, 64, 1000])
def test_blocks_of_any_size_agree(block_samples: int, tmp_path: Path) -> None:
    path = written(tmp_path / "channels.tdms", segments=3)
    compare_with_whole_file(path, in_blocks(path, block_samples))


def test_segments_of_different_lengths_and_appended_channels_agree(tmp_path: Path) -> None:
    path = tmp_path / "appended.tdms"
    with TdmsWriter(path) as writer:
        for size in (10, 1, 33):
            writer.write_segment([ChannelObject("g", "force", samples(size, "<f8", size), {"wf_increment": 0.1})])
            writer.write_segment([ChannelObject("g", "velocity", samples(size, "<f4", size + 1))])
    compare_with_whole_file(path, Tdms().read(path))


@mark.parametrize("name", ["two-segments.tdms", "truncated.tdms"])
def test_the_corpus_agrees(name: str) -> None:
    path = CORPUS / name
    compare_with_whole_file(path, Tdms().read(path), complete=name != "truncated.tdms")


def made_by_hand(*, interleaved: bool, big_endian: bool, rows: int = 12, chunks: int = 2) -> bytes:
    """A segment of two channels of doubles and one of 32-bit integers, in chunks, as LabVIEW lays it out."""
    order = ">" if big_endian else "<"

    def text(value: str) -> bytes:
        return struct.pack(order + "I", len(value)) + value.encode()

    names, types = ("force", "velocity", "count"), ("f8", "f8", "i4")
    codes = {"f8": 10, "i4": 3}
    description = struct.pack(order + "I", len(names))
    for name, kind in zip(names, types, strict=True):
        description += text(f"/'g'/'{name}'") + struct.pack(order + "IIIQ", 20, codes[kind], 1, rows)
        description += struct.pack(order + "I", 1) + text("wf_increment") + struct.pack(order + "Id", 10, 0.5)
    data = b""
    for chunk in range(chunks):
        columns = [samples(rows, order + kind, 3 * chunk + place) for place, kind in enumerate(types)]
        if interleaved:
            data += b"".join(column[row : row + 1].tobytes() for row in range(rows) for column in columns)
        else:
            data += b"".join(column.tobytes() for column in columns)
    contents = (1 << 1) | (1 << 2) | (1 << 3) | (interleaved << 5) | (big_endian << 6)
    lead_in = b"TDSm" + struct.pack("<I", contents)
    return (
        lead_in + struct.pack(order + "IQQ", 4713, len(description) + len(data), len(description)) + description + data
    )


@mark.parametrize("big_endian", [False, True])
@mark.parametrize("interleaved", [False, True])
def test_interleaved_and_contiguous_segments_of_either_byte_order_agree(
    interleaved: bool, big_endian: bool, tmp_path: Path
) -> None:
    path = tmp_path / "made.tdms"
    segment = made_by_hand(interleaved=interleaved, big_endian=big_endian)
    path.write_bytes(segment + segment)
    table = Tdms().read(path)
    compare_with_whole_file(path, table)
    assert table.columns[0].values[:12] == approx(samples(12, "<f8", 0))
    compare_with_whole_file(path, in_blocks(path, 10))


@mark.parametrize("interleaved", [False, True])
@mark.parametrize("missing", [1, 8, 20, 100, 239])
def test_a_truncated_last_segment_gives_the_samples_that_nptdms_finds(
    missing: int, interleaved: bool, tmp_path: Path
) -> None:
    path = tmp_path / "truncated.tdms"
    segment = made_by_hand(interleaved=interleaved, big_endian=False, chunks=1)
    path.write_bytes((segment + segment)[:-missing])
    table = Tdms().read(path)
    assert table.incomplete
    compare_with_whole_file(path, table, complete=False)
