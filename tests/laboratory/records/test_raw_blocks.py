"""Raw blocks: what was appended comes back, and no damage makes a wrong sample or an error of Python."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from tests.laboratory.records.recorded import CHANNELS, RATE, block_of, values_of

from sonolube.errors import InvalidInput
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import latest_samples, read_raw_blocks, scan_raw
from sonolube.laboratory.records.raw_blocks import PartClock, RawPart, raw_header, raw_record

HEADER = raw_header(RawPart(channels=CHANNELS, sample_rate=RATE, begun=1.8e9))
SIZES = (3, 1, 7, 2)
FIRSTS = (0, 3, 4, 11)
RECORDS = [
    raw_record(block_of(first, size), sequence=number)
    for number, (first, size) in enumerate(zip(FIRSTS, SIZES, strict=True))
]
WHOLE = HEADER + b"".join(RECORDS)
ENDS = np.cumsum([len(HEADER), *map(len, RECORDS)])
UNCHECKED = (HealthCheck.too_slow, HealthCheck.function_scoped_fixture)
ANY = settings(deadline=None, suppress_health_check=UNCHECKED, max_examples=300)


def file_of(folder: Path, content: bytes) -> Path:
    path = folder / "blocks-1.bin"
    path.write_bytes(content)
    return path


def true_samples(path: Path) -> list[int]:
    """Numbers of the samples of a file, each of which has its own values."""
    numbers: list[int] = []
    for block in read_raw_blocks(path):
        assert np.array_equal(block.values, values_of(block.first_sample, block.samples))
        numbers += range(block.first_sample, block.next_sample)
    assert numbers == sorted(set(numbers))
    return numbers


def test_blocks_come_back_with_channels_rate_and_counters(tmp_path: Path) -> None:
    path = file_of(tmp_path, WHOLE)
    part = scan_raw(path)
    assert (part.channels, part.sample_rate, part.samples, part.gaps, part.damaged) == (CHANNELS, RATE, 13, (), 0)
    assert part.whole_bytes == len(WHOLE)
    assert true_samples(path) == list(range(13))


@pytest.mark.parametrize("length", range(len(WHOLE)))
def test_a_file_cut_anywhere_has_the_whole_blocks_before_the_cut(tmp_path: Path, length: int) -> None:
    path = file_of(tmp_path, WHOLE[:length])
    if length < len(HEADER):
        with pytest.raises(InvalidInput, match="no file of raw blocks"):
            scan_raw(path)
        return
    whole = int(np.searchsorted(ENDS, length, side="right")) - 1
    assert true_samples(path) == list(range(sum(SIZES[:whole])))
    assert scan_raw(path).whole_bytes == ENDS[whole]


@ANY
@given(place=st.integers(0, len(WHOLE) - 1), flip=st.integers(1, 255))
def test_a_changed_byte_costs_its_block_alone_and_is_told(tmp_path: Path, place: int, flip: int) -> None:
    content = bytearray(WHOLE)
    content[place] ^= flip
    path = file_of(tmp_path, bytes(content))
    if place < len(HEADER):
        with pytest.raises(InvalidInput):
            scan_raw(path)
        return
    hit = int(np.searchsorted(ENDS, place, side="right")) - 1
    lost = set(range(FIRSTS[hit], FIRSTS[hit] + SIZES[hit]))
    assert set(true_samples(path)) == set(range(13)) - lost
    part = scan_raw(path)
    if hit == len(SIZES) - 1:
        assert part.whole_bytes == ENDS[-2]
    else:
        assert part.damaged == 1
    if 0 < hit < len(SIZES) - 1:
        assert [(gap.sample, gap.missing) for gap in part.gaps] == [(FIRSTS[hit], SIZES[hit])]


@ANY
@given(content=st.binary(max_size=400), keep=st.integers(0, len(WHOLE)), rest=st.integers(0, len(WHOLE)))
def test_any_bytes_are_read_or_refused_and_give_no_wrong_sample(
    tmp_path: Path, content: bytes, keep: int, rest: int
) -> None:
    for damaged in (content, HEADER + content, WHOLE[:keep] + content + WHOLE[rest:]):
        path = file_of(tmp_path, damaged)
        try:
            true_samples(path)
        except InvalidInput as refusal:
            text = str(refusal)
            assert text.startswith(str(path))


def test_a_block_that_is_repeated_or_goes_back_is_left_out(tmp_path: Path) -> None:
    back = raw_record(block_of(0, 3), sequence=9)
    path = file_of(tmp_path, WHOLE + RECORDS[1] + back + raw_record(block_of(13, 2), sequence=10))
    assert true_samples(path) == list(range(15))
    assert scan_raw(path).damaged == 1


def test_a_gap_in_the_sample_counter_is_told(tmp_path: Path) -> None:
    path = file_of(tmp_path, WHOLE + raw_record(block_of(20, 5), sequence=4))
    (gap,) = scan_raw(path).gaps
    assert (gap.sample, gap.missing) == (13, 7)


@pytest.mark.parametrize(("channels", "rate"), [((), RATE), (CHANNELS[:1] * 2, RATE), (CHANNELS, 0.0)])
def test_a_recording_without_channels_or_rate_is_refused(channels: tuple[()], rate: float) -> None:
    with pytest.raises(InvalidInput):
        raw_header(RawPart(channels=channels, sample_rate=rate, begun=0.0))


def test_a_header_keeps_free_units_infinite_ranges_and_the_clock(tmp_path: Path) -> None:
    channels = (
        Channel(name="ae", quantity="acoustic_emission", free_unit="V", lowest=-2.0),
        Channel(name="pin", quantity="temperature", highest=500.0),
    )
    clock = PartClock(name="slow", part=3, offset=-0.25, uncertainty=0.07, first_sample=40)
    header = raw_header(RawPart(channels=channels, sample_rate=12.5, begun=1.7e9, clock=clock))
    path = file_of(tmp_path, header + raw_record(block_of(40, 3), sequence=0) + raw_record(block_of(45, 2), sequence=1))
    part = scan_raw(path)
    assert part.channels == channels
    assert (part.clock, part.clock_name, part.sample_rate, part.begun) == (clock, "slow", 12.5, 1.7e9)
    assert (part.first_sample, part.samples, part.missing, part.blocks) == (40, 5, 2, 2)
    assert part.duration == pytest.approx(7 / 12.5)
    assert part.header_bytes == len(header)
    assert [block.sample_rate for block in read_raw_blocks(path)] == [12.5, 12.5]
    assert RawPart(channels=channels, sample_rate=1.0, begun=0.0).clock_name == ""


def test_several_gaps_are_told_each_and_summed(tmp_path: Path) -> None:
    later = [raw_record(block_of(first, 2), sequence=number) for number, first in ((4, 20), (5, 22), (6, 30))]
    part = scan_raw(file_of(tmp_path, WHOLE + b"".join(later)))
    assert [(gap.sample, gap.missing) for gap in part.gaps] == [(13, 7), (24, 6)]
    assert (part.missing, part.samples, part.blocks, part.damaged) == (13, 19, 7, 0)


def test_each_damaged_place_counts_once(tmp_path: Path) -> None:
    content = HEADER + RECORDS[0] + b"x" * 50 + RECORDS[1] + b"\xb5BLK" + RECORDS[2]
    part = scan_raw(file_of(tmp_path, content))
    assert (part.damaged, part.samples, part.whole_bytes) == (2, 11, len(content))


def test_a_record_is_found_behind_damage_across_the_pieces_that_are_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for searched in (5, 7, 64):
        monkeypatch.setattr("sonolube.laboratory.records.raw_blocks._SEARCHED", searched)
        for length in range(9):
            path = file_of(tmp_path, HEADER + RECORDS[0] + b"y" * length + RECORDS[1])
            assert true_samples(path) == [0, 1, 2, 3]


def test_a_record_without_samples_or_beyond_what_times_can_tell_is_none(tmp_path: Path) -> None:
    empty = raw_record(Block(first_sample=0, sample_rate=RATE, values=np.empty((0, 2))), sequence=0)
    assert true_samples(file_of(tmp_path, HEADER + empty + RECORDS[0])) == [0, 1, 2]
    last = raw_record(Block(first_sample=2**53, sample_rate=RATE, values=np.zeros((1, 2))), sequence=1)
    beyond = raw_record(Block(first_sample=2**53 + 1, sample_rate=RATE, values=np.zeros((1, 2))), sequence=1)
    assert scan_raw(file_of(tmp_path, HEADER + RECORDS[0] + last)).samples == 4
    assert scan_raw(file_of(tmp_path, HEADER + RECORDS[0] + beyond)).samples == 3


def test_the_latest_samples_are_those_behind_the_last_gap_and_no_more_than_were_asked_for(tmp_path: Path) -> None:
    path = file_of(tmp_path, WHOLE + raw_record(block_of(20, 5), sequence=4) + raw_record(block_of(25, 4), sequence=5))
    part, latest = latest_samples(path, duration=1.0)
    assert latest is not None
    assert (latest.first_sample, latest.samples, latest.sample_rate) == (20, 9, RATE)
    assert (part.samples, part.channels) == (0, CHANNELS)
    for duration, samples in ((0.006, 6), (0.0061, 7), (0.0, 1)):
        _, latest = latest_samples(path, duration=duration)
        assert latest is not None
        assert (latest.first_sample, latest.samples) == (29 - samples, samples)
        assert np.array_equal(latest.values, values_of(29 - samples, samples))
    assert latest_samples(file_of(tmp_path, HEADER), duration=1.0)[1] is None


def test_a_header_of_another_kind_of_payload_or_of_a_strange_clock_is_refused(tmp_path: Path) -> None:
    def header(content: bytes) -> bytes:
        length, checksum = (struct.pack("<I", each) for each in (len(content), zlib.crc32(content)))
        return b"SNLBLK1\n" + length + content + checksum

    channel = b'{"name": "a", "quantity": "temperature", "unit": "K", "lowest": null, "highest": null}'
    known = b'{"payload": "<f8", "sample_rate": 10.0, "begun": 1.0, "channels": [' + channel + b"]}"
    part = scan_raw(file_of(tmp_path, header(known)))
    assert (part.sample_rate, part.channels[0].highest) == (10.0, np.inf)
    clock = b'"begun": 1.0, "clock": {"name": "../x", "part": 1, "offset": 0, "uncertainty": 1, "first_sample": 0}'
    for old, new in (
        (b"<f8", b"<f4"),
        (b"10.0", b"0.0"),
        (b"10.0", b"Infinity"),
        (channel, b""),
        (b'"begun": 1.0', clock),
        (b'"begun"', b'"ended"'),
    ):
        with pytest.raises(InvalidInput, match="is no file of raw blocks, or its header is damaged"):
            scan_raw(file_of(tmp_path, header(known.replace(old, new))))
