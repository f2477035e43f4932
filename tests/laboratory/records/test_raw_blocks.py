"""Raw blocks: what was appended comes back, and no damage makes a wrong sample or an error of Python."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from tests.laboratory.records.recorded import CHANNELS, RATE, block_of, values_of

from sonolube.errors import InvalidInput
from sonolube.laboratory.records import read_raw_blocks, scan_raw
from sonolube.laboratory.records.raw_blocks import RawPart, raw_header, raw_record

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
