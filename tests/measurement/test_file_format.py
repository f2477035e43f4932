"""Detection of file formats: signature before suffix before fallback."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import read_impedance
from sonolube.measurement.measured_files import HEAD_SIZE, detect_format, first_lines, read_head
from sonolube.measurement.recordings.reader import read_recording, recording_format_name


@dataclass(frozen=True)
class Signed:
    """A format known by its first bytes; the fallback has none."""

    name: str
    signature: bytes
    suffixes: tuple[str, ...] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        return head.startswith(self.signature)


FORMATS = (Signed("one", b"ONE", (".one",)), Signed("two", b"TWO", (".two",)), Signed("text", b""))


@mark.parametrize(
    ("head", "name", "detected"),
    [
        (b"TWO", "file.one", "two"),  # the signature precedes the suffix
        (b"???", "file.ONE", "one"),  # a suffix of any case precedes the fallback
        (b"???", "file.dat", "text"),
    ],
)
def test_the_signature_precedes_the_suffix_and_the_suffix_the_fallback(
    head: bytes, name: str, detected: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(head)
    found = detect_format(FORMATS, head, tmp_path / name)  # type: ignore[type-var]
    assert found is not None
    assert found.name == detected


def test_a_fallback_that_does_not_accept_a_file_leaves_it_without_format() -> None:
    refusing = (*FORMATS[:2], Signed("signed text", b"TEXT"))
    assert detect_format(refusing, b"???", Path("file.dat")) is None  # type: ignore[type-var]


def test_the_head_of_a_file_is_limited_and_its_lines_are_decoded(tmp_path: Path) -> None:
    path = tmp_path / "long.txt"
    path.write_bytes(b"\xef\xbb\xbffirst\r\nsecond\rthird\n" + b"x" * 2 * HEAD_SIZE)
    head = read_head(path)
    assert len(head) == HEAD_SIZE
    assert first_lines(head)[:3] == ["first", "second", "third"]


@mark.parametrize(
    ("suffix", "message"),
    [
        (".tdms", "byte 0: a segment must begin with TDSm"),
        (".mat", "cannot be read as MATLAB"),
        (".lvm", "line 1: an LVM file begins with 'LabVIEW Measurement'"),
        (".uff", "holds no time response"),
    ],
)
def test_a_file_without_the_signature_of_its_suffix_is_refused_by_that_format(
    suffix: str, message: str, tmp_path: Path
) -> None:
    path = tmp_path / f"damaged{suffix}"
    path.write_text("time,friction_force\n0,1\n1,2\n" * 20)
    with raises(InvalidInput, match=message):
        read_recording(path)


def test_a_misnamed_recording_is_read_by_its_content(tmp_path: Path) -> None:
    path = tmp_path / "misnamed.mat"
    corpus = Path(__file__).parent / "recordings" / "corpus"
    path.write_bytes((corpus / "two-segments.tdms").read_bytes())
    assert recording_format_name(path) == "TDMS"
    assert read_recording(path).attrs["file_format"] == "TDMS"


def test_a_touchstone_file_whose_comment_names_an_instrument_is_touchstone(tmp_path: Path) -> None:
    path = tmp_path / "exported.s1p"
    path.write_text("!Keysight Technologies,E4990A\n# Hz Z RI R 1\n1000 3 4\n2000 5 6\n")
    found = read_impedance(path)
    assert found.file_format == "touchstone"
    assert found.impedance == approx(np.array([3 + 4j, 5 + 6j]))
