"""NMS files of NanoFocus: heights in micrometres, a grid in nanometres, and refusals of damaged headers."""

import io
import struct
from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.binary_formats import NanoFocusNms
from sonolube.measurement.surface_files.reader import SurfaceReading


def nms(numbers: np.ndarray, *, step_nm: float = 312.5, bottom: float = 2.0, top: float = 6.0, **parts: int) -> bytes:
    """Bytes of a file by the layout of musurf-reader: 16-bit numbers, then intensities."""
    rows, columns = numbers.shape
    header = bytearray(3468)
    struct.pack_into("<4i2d", header, 0, parts.get("kind", 2), 1, 0, 65535, bottom, top)
    header[32:41] = b"OM_MS_2.0"
    header[52:73] = b"Confocal Height Image"
    header[1076:1092] = b"2022-02-09T13:25"
    struct.pack_into("<2I2d", header, 1368, columns, rows, step_nm, 2 * step_nm)
    struct.pack_into("<i", header, 1416, 1)
    intensity = np.where(numbers == 0, 0, 90).astype(np.uint8)
    return bytes(header) + numbers.astype("<u2").tobytes() + intensity.tobytes()


def read(content: bytes) -> SurfaceReading:
    return NanoFocusNms().read(io.BytesIO(content), Path("plate.nms"))


def test_a_pixel_of_312_nanometres_makes_a_field_of_160_micrometres() -> None:
    found = read(nms(np.full((4, 512), 7)))
    assert found.spacing_x == approx(312.5e-9)
    assert found.spacing_y == approx(625e-9)
    assert 512 * (found.spacing_x or 0) == approx(160e-6)
    assert (found.lateral_unit, found.unit_origin) == ("nm", "fixed by the format")
    assert (found.title, str(found.measured_at)) == ("Confocal Height Image", "2022-02-09 13:25:00")


def test_the_lowest_and_highest_number_are_the_stated_heights_and_zero_intensity_is_not_measured() -> None:
    found = read(nms(np.array([[65535, 1], [0, 32768]])))
    expected = [[6e-6, 2e-6 + 4e-6 / 65535], [np.nan, 2e-6 + 4e-6 * 32768 / 65535]]
    np.testing.assert_allclose(found.height, expected, rtol=1e-12)


@mark.parametrize(
    ("content", "said"),
    [
        (b"OM_MS_1.0" * 500, "byte 32: not an NMS file of version OM_MS_2.0"),
        (nms(np.ones((2, 2)))[:900], "byte 900: the file ends within the header"),
        (nms(np.ones((2, 2)))[:-1], "byte 3479: 2 x 2 pixels should end at byte 3480"),
        (nms(np.ones((2, 2)), kind=3), "byte 0: heights of type 3"),
        (nms(np.ones((2, 2)), bottom=6.0), "byte 8: numbers 0 to 65535 stand for 6 um to 6 um"),
        (nms(np.ones((2, 2)), step_nm=-1.0), "byte 1376: distances of pixels of -1 nm and -2 nm"),
    ],
)
def test_damaged_files_are_refused_with_the_byte(content: bytes, said: str) -> None:
    with raises(InvalidInput, match=said) as refused:
        read(content)
    assert str(refused.value).startswith("plate.nms: ")


@examples(200)
@given(at=st.integers(0, 3467), value=st.binary(min_size=1, max_size=16))
def test_any_change_of_the_header_is_read_or_refused_in_one_line(at: int, value: bytes) -> None:
    content = bytearray(nms(np.ones((2, 3))))
    content[at : at + len(value)] = value
    try:
        outcome = f"plate.nms: byte of {read(bytes(content)).height.size}"
    except InvalidInput as refused:
        outcome = str(refused)
    assert outcome.startswith("plate.nms: byte ")
    assert "\n" not in outcome
