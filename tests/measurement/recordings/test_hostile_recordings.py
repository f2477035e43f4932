"""Damaged and hostile recordings are read or refused with one line that names the file."""

import os
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout, read_mapping
from sonolube.measurement.recordings.reader import read_recording

CORPUS = Path(__file__).parent / "corpus"
SURFACE_FILES = Path(__file__).parents[1] / "surface_files" / "corpus"  # no recordings, and to be refused as such
MAPPINGS = Path(__file__).parents[3] / "examples" / "mappings"
GERMAN = RecordingMapping(
    channels={
        "friction_force": ChannelSource(column="Kraft", unit="N"),
        "rotation_speed": ChannelSource(column="Drehzahl"),
    },
    axis=ChannelSource(column="Zeit", unit="s"),
    text=TextLayout(separator=";", decimal_sign=",", lines_to_skip=2, missing=("---",)),
)
HOSTILE = (
    b"\xff" * 8,
    b"\x00" * 8,
    b"\xff\xff\xff\x7f",
    b"99999999999999999999",
    b"1e400",
    b"-inf",
    b"nan",
    b'"',
    b"\t",
    b"\n",
    b",",
    b"\x80",
    b"TDSm",
    b"_",
    "٣".encode(),
)


def mutated(content: bytes, rng: random.Random) -> bytes:
    """A file with one to four bytes flipped, pieces cut, doubled or moved, or a hostile piece put in."""
    out = bytearray(content)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(out) + 1)
        length = rng.choice((1, 2, 4, 8, 30))
        action = rng.randrange(6)
        if action == 0 and at < len(out):
            out[at] ^= 1 << rng.randrange(8)
        elif action == 1:
            del out[at : at + length]
        elif action == 2:
            out[at:at] = out[at : at + length]
        elif action == 3:
            piece = rng.choice(HOSTILE)
            out[at : at + len(piece)] = piece
        elif action == 4:
            out[at:at] = rng.choice(HOSTILE)
        else:
            del out[at:]
    return bytes(out)


def refusal_of(read: Callable[[], object]) -> str | None:
    try:
        read()
    except InvalidInput as refusal:
        return str(refusal)
    return None


def read_or_refuse(path: Path, mapping: RecordingMapping | None) -> bool:
    """Whether the file was read; anything but a recording or a clear refusal fails."""
    refusal = refusal_of(lambda: read_recording(path, mapping=mapping))
    assert refusal is None or (refusal.startswith(f"{path}: ") and "\n" not in refusal)
    return refusal is None


def fuzz(seeds: list[Path], *, count: int, folder: Path, seed: int = 0, mapping: RecordingMapping | None = None) -> int:
    """Read `count` mutations of the seeds; return how many were still readable."""
    rng = random.Random(seed)
    read = 0
    path = folder / "mutated.dat"
    contents = [seed.read_bytes() for seed in seeds]
    for _ in range(count):
        path.write_bytes(mutated(rng.choice(contents), rng))
        read += read_or_refuse(path, mapping)
    return read


@pytest.mark.parametrize("path", sorted([*CORPUS.iterdir(), *SURFACE_FILES.iterdir()]), ids=lambda path: path.name)
def test_every_file_of_the_corpus_is_read_or_refused_by_name(path: Path) -> None:
    read_or_refuse(path, GERMAN if path.name == "semicolons.txt" else None)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(
    ("pattern", "mapping"),
    [("*.lvm", None), ("*.csv", None), ("tabs.txt", None), ("semicolons.txt", GERMAN), ("*.tdms", None)],
    ids=["lvm", "csv", "tabs", "mapped", "tdms"],
)
def test_mutations_are_read_or_refused(pattern: str, mapping: RecordingMapping | None, tmp_path: Path) -> None:
    count = int(os.environ.get("SONOLUBE_FUZZ", "400"))
    fuzz(sorted(CORPUS.glob(pattern)), count=count, folder=tmp_path, mapping=mapping)


def test_mutations_of_tables_of_runs_are_read_or_refused(tmp_path: Path) -> None:
    rng = random.Random(2)
    german = (
        "# Lauf\nGeschwindigkeit (mm/s);Amplitude [µm];Reibkraft in N;Reibkraft ohne Ultraschall / N\n20,5;2;0,5;1\n"
    )
    contents = [path.read_bytes() for path in sorted(MAPPINGS.parent.glob("*-runs.csv"))]
    contents += [german.encode(encoding) for encoding in ("utf-8", "utf-16", "cp1252")]
    path = tmp_path / "mutated.csv"
    for _ in range(int(os.environ.get("SONOLUBE_FUZZ", "400"))):
        path.write_bytes(mutated(rng.choice(contents), rng))
        refusal = refusal_of(lambda: read_runs(path))
        assert refusal is None or (refusal.startswith(f"{path}: ") and "\n" not in refusal)


def test_mutations_of_a_mapping_are_read_or_refused(tmp_path: Path) -> None:
    rng, contents = random.Random(1), [path.read_bytes() for path in sorted(MAPPINGS.glob("*.toml"))]
    path = tmp_path / "mutated.toml"
    for _ in range(int(os.environ.get("SONOLUBE_FUZZ", "400"))):
        path.write_bytes(mutated(rng.choice(contents), rng))
        refusal = refusal_of(lambda: read_mapping(path))
        assert refusal is None or refusal.startswith(f"{path}: ")


def refuse(tmp_path: Path, name: str, content: bytes, match: str, **options: object) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=match) as caught:
        read_recording(path, **options)  # type: ignore[arg-type]
    assert str(caught.value).startswith(f"{path}: ")


CSV: Callable[[str], bytes] = lambda rows: f"time,friction_force\n{rows}".encode()  # noqa: E731


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    refuse(tmp_path, "empty.csv", b"", "is empty")


def test_an_unknown_signature_is_refused_with_its_first_bytes(tmp_path: Path) -> None:
    refuse(tmp_path, "picture.dat", b"\x89PNG\r\n\x1a\n\0\0", r"byte 0: begins with b'\\x89PNG")


def test_time_that_decreases_is_refused_with_its_line(tmp_path: Path) -> None:
    refuse(tmp_path, "back.csv", CSV("0,1\n1,1\n0.5,1\n"), r"line 4: time decreases to 0\.5 s")


def test_time_that_repeats_is_refused_with_its_line(tmp_path: Path) -> None:
    refuse(tmp_path, "twice.csv", CSV("0,1\n1,1\n1,1\n"), r"line 4: time repeats 1 s")


def test_a_channel_without_a_value_is_refused(tmp_path: Path) -> None:
    refuse(tmp_path, "nan.csv", CSV("0,NaN\n1,NA\n"), "no column holds numbers|holds no value|no channel")


def test_an_infinite_value_is_refused_with_its_line(tmp_path: Path) -> None:
    refuse(tmp_path, "inf.csv", CSV("0,1\n1,inf\n"), r"line 3: 'friction_force' is infinite")


def test_a_word_among_numbers_is_refused_with_its_line(tmp_path: Path) -> None:
    refuse(tmp_path, "word.csv", CSV("0,1\n1,2\n2,overload\n"), r"line 4: 'friction_force' is 'overload'")


def test_lines_after_a_quoted_line_break_are_counted_correctly(tmp_path: Path) -> None:
    content = b'time,note,friction_force\n0,"a\nb",1\n1,x,oops\n'
    refuse(tmp_path, "quoted.csv", content, r"line 4: 'friction_force' is 'oops'")


def test_a_short_row_is_refused_with_its_line(tmp_path: Path) -> None:
    refuse(tmp_path, "short.csv", CSV("0,1\n1\n"), r"line 3: has 1 cells where 2 columns")


def test_an_open_quote_is_refused_where_it_opens(tmp_path: Path) -> None:
    refuse(tmp_path, "quote.csv", CSV('0,1\n1,"2\n2,3\n'), r"line 3: ")


def test_a_unit_of_another_dimension_is_refused(tmp_path: Path) -> None:
    refuse(tmp_path, "unit.csv", b"time [s],friction_force [mm]\n0,1\n1,2\n", "is a length; expected a force")


def test_hostile_lengths_are_refused_with_the_byte() -> None:
    with pytest.raises(InvalidInput, match="byte 0: announces a segment of 9223372036854775808 bytes"):
        read_recording(CORPUS / "segment-of-2-63-bytes.tdms")
    with pytest.raises(InvalidInput, match="byte 0: announces 9223372036854775808 bytes of description"):
        read_recording(CORPUS / "description-of-2-63-bytes.tdms")


def test_a_wrong_second_segment_is_refused_with_its_byte(tmp_path: Path) -> None:
    content = (CORPUS / "two-segments.tdms").read_bytes()
    at = content.rindex(b"TDSm")
    refuse(
        tmp_path, "wrong.tdms", content[:at] + b"XXXX" + content[at + 4 :], f"byte {at}: a segment must begin with TDSm"
    )


def test_a_line_break_in_a_channels_name_breaks_no_message(tmp_path: Path) -> None:
    content = (CORPUS / "two-segments.tdms").read_bytes()
    at = content.rindex(b"friction_force")
    broken = content[:at] + b"friction\nforce" + content[at + 14 :]
    refuse(tmp_path, "name.tdms", broken, r"different numbers of samples \([^\n]*friction force 4[^\n]*\)")


def test_absurd_counts_are_refused_with_the_line() -> None:
    with pytest.raises(InvalidInput, match="line 22: Channels is '99999999999999', not a count"):
        read_recording(CORPUS / "absurd-channels.lvm")


@pytest.mark.parametrize("lines", range(1, 22))
def test_an_lvm_file_cut_in_its_headers_is_refused(lines: int, tmp_path: Path) -> None:
    content = (CORPUS / "one-x-column.lvm").read_bytes().splitlines(keepends=True)
    refuse(tmp_path, "cut.lvm", b"".join(content[:lines]), r"line \d+: ")


def test_a_file_of_only_its_signature_is_refused(tmp_path: Path) -> None:
    refuse(tmp_path, "magic.tdms", b"TDSm", "too short for a TDMS file")
    refuse(tmp_path, "magic.mat", b"MATLAB 5.0 MAT-file", "cannot be read as MATLAB")
    refuse(tmp_path, "magic.h5", b"\x89HDF\r\n\x1a\n", "cannot be read as HDF5")
    refuse(tmp_path, "magic.nc", b"CDF\x01", "cannot be read as netCDF 3")
    refuse(tmp_path, "magic.uff", b"    -1\n    58\n", "holds no time response")


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"gone\.csv: cannot be read: No such file"):
        read_recording(tmp_path / "gone.csv")
