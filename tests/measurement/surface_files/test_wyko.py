"""Wyko OPD files: all dialects against one picture, and refusals of damaged files with the byte."""

import io
import struct
import tracemalloc
from datetime import datetime
from pathlib import Path

import numpy as np
from pytest import approx, importorskip, mark, raises, skip

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.binary_formats import WykoOpd
from sonolube.measurement.surface_files.reader import SurfaceReading, read_surface_file
from sonolube.measurement.surface_files.surface_topography import SurfaceTopographyFormats

MEASURED = Path(__file__).parents[4] / "shared" / "data" / "surfaces" / "opd-1.opd"
Blocks = list[tuple[str, int, bytes]]

# As a picture, top row first: 3 columns, 2 rows, in waves; the pixel at the top right was not measured.
PICTURE = np.array([[0.5, 1.5, np.nan], [-1.0, 2.0, 3.0]])


def floats(picture: Floats) -> bytes:
    by_column = np.where(np.isnan(picture), 1e38, picture)[::-1].T.astype("<f4")
    return struct.pack("<HHH", *by_column.shape, 4) + by_column.tobytes()


def shorts(picture: Floats, multiplier: int) -> bytes:
    by_column = np.where(np.isnan(picture), 32767, picture * multiplier)[::-1].T.astype("<i2")
    return struct.pack("<HHH", *by_column.shape, 2) + by_column.tobytes()


def number(value: float) -> bytes:
    return struct.pack("<f", value)


def opd(blocks: Blocks, spare: int = 2) -> bytes:
    entries = len(blocks) + 1 + spare
    directory = struct.pack("<16shiH", b"Directory", 1, 24 * entries, 0xFFFF)
    for name, kind, content in blocks:
        directory += struct.pack("<16shiH", name.encode(), kind, len(content), 8)
    directory += bytes(24 * spare)
    return b"\x01\x00" + directory + b"".join(content for _, _, content in blocks)


SCALES: Blocks = [("Wavelength", 7, number(600.0)), ("Pixel_size", 7, number(2e-4)), ("Aspect", 7, number(1.5))]
PLAIN: Blocks = [*SCALES, ("RAW_DATA", 3, floats(PICTURE))]


def read(content: bytes) -> SurfaceReading:
    return WykoOpd().read(io.BytesIO(content), Path("plate.opd"))


@mark.parametrize("name", ["RAW_DATA", "RAW DATA", "Raw", "OPD", "SAMPLE_DATA"])
def test_waves_are_converted_to_metres_with_the_top_row_first(name: str) -> None:
    reading = read(opd([*SCALES, (name, 3, floats(PICTURE))]))
    np.testing.assert_allclose(reading.height, 600e-9 * PICTURE, rtol=1e-7)
    assert reading.spacing_x == approx(0.2e-6)
    assert reading.spacing_y == approx(0.3e-6)


@mark.parametrize(
    "multiplier",
    [(6, struct.pack("<h", 100)), (7, struct.pack("<h", 100)), (7, number(100)), (12, struct.pack("<i", 100))],
)
def test_every_declaration_of_the_multiplier_of_integers_is_read(multiplier: tuple[int, bytes]) -> None:
    reading = read(opd([*SCALES, ("Mult", *multiplier), ("RAW_DATA", 3, shorts(PICTURE, 100))]))
    np.testing.assert_allclose(reading.height, 600e-9 * PICTURE, rtol=1e-7)


def test_heights_of_one_byte_are_all_measured() -> None:
    content = struct.pack("<HHH", 2, 1, 1) + bytes([3, 255])
    reading = read(opd([*SCALES, ("OPD", 3, content)]))
    assert reading.height == approx(600e-9 * np.array([[3, 255]]))


def test_an_image_is_not_read_as_heights() -> None:
    image = ("Image", 3, struct.pack("<HHH", 1, 1, 1) + b"\x07")
    assert read(opd([image, *PLAIN])).height.shape == (2, 3)
    with raises(InvalidInput, match="no array of heights"):
        read(opd([*SCALES, image]))


def test_title_and_date_are_read() -> None:
    stamped: Blocks = [*PLAIN, ("Title", 5, b"plate 7\0\0"), ("Date", 5, b"7/31/2015"), ("Time", 5, b"16:19:48")]
    reading = read(opd(stamped))
    assert reading.title == "plate 7"
    assert reading.measured_at == datetime(2015, 7, 31, 16, 19, 48)
    assert read(opd([*PLAIN, ("DataSetName", 15, b"\x12\x01\x05plate")])).title == "plate"


def test_an_invalid_date_does_not_prevent_reading_the_heights() -> None:
    assert read(opd([*PLAIN, ("Date", 5, b"31.7.15"), ("Time", 5, b"late")])).measured_at is None


def test_without_a_pixel_size_there_is_no_spacing() -> None:
    assert read(opd([SCALES[0], PLAIN[3]])).spacing_x is None


@mark.parametrize(
    ("content", "said"),
    [
        (b"", "byte 0: the file is empty"),
        (b"\x01\x00Direc", "byte 7: the file ends within the directory"),
        (b"PK\x03\x04" + bytes(40), "byte 2: not a Wyko OPD file"),
        (opd(PLAIN)[:-1], r"byte 98: block 'RAW_DATA' should end at byte 212, but the file ends at 211"),
        (opd(PLAIN)[:60], "byte 60: the file ends within the directory"),
        (
            b"\x01\x00" + struct.pack("<16shiH", b"Directory", 1, 2**31 - 8, 8),
            "byte 20: a directory of 2147483640 bytes",
        ),
        (opd(PLAIN)[:20] + struct.pack("<i", -24) + opd(PLAIN)[24:], "byte 20: a directory of -24 bytes"),
        (opd(PLAIN[1:]), "no block 'Wavelength'"),
        (opd([("Wavelength", 7, number(0)), *PLAIN[1:]]), "Wavelength must be positive and finite, got 0.0"),
        (opd([("Wavelength", 7, number(np.nan)), *PLAIN[1:]]), "Wavelength must be positive and finite, got nan"),
        (opd([("Wavelength", 5, b"six"), *PLAIN[1:]]), "block 'Wavelength' of type 5 and 3 bytes is no number"),
        (opd([*SCALES, ("Mult", 6, b"\0\0"), PLAIN[3]]), "Mult must be positive"),
        (opd([*SCALES, ("OPD", 3, b"\x01")]), "the file ends within array 'OPD'"),
        (opd([*SCALES, ("OPD", 3, struct.pack("<HHH", 2, 2, 3) + bytes(12))]), "elements of 3 bytes"),
        (opd([*SCALES, ("OPD", 3, struct.pack("<HHH", 65535, 65535, 4) + bytes(16))]), "65535 x 65535 elements"),
        (opd([*SCALES, ("OPD", 3, struct.pack("<HHH", 0, 5, 4))]), "0 x 5 elements"),
        (opd([*SCALES, ("OPD", 3, floats(np.full((2, 3), np.nan)))]), "none of the 6 pixels was measured"),
    ],
)
def test_invalid_content_is_refused_with_its_byte(content: bytes, said: str) -> None:
    with raises(InvalidInput, match=said) as refused:
        read(content)
    assert str(refused.value).startswith("plate.opd: ")


def test_a_stated_size_of_gigabytes_allocates_no_memory() -> None:
    claim = bytearray(opd([*SCALES, ("OPD", 3, struct.pack("<HHH", 65535, 65535, 4) + bytes(64))]))
    struct.pack_into("<i", claim, 2 + 4 * 24 + 18, 2**31 - 1)
    tracemalloc.start()
    with raises(InvalidInput, match="truncated or damaged"):
        read(bytes(claim))
    assert tracemalloc.get_traced_memory()[1] < 100_000
    tracemalloc.stop()


@mark.parametrize(
    "content",
    [
        opd([*SCALES, ("RAW_DATA", 3, floats(PICTURE))]),
        opd([*SCALES, ("Mult", 6, struct.pack("<h", 100)), ("OPD", 3, shorts(PICTURE, 100))]),
        opd([*SCALES, ("Mult", 7, struct.pack("<h", 100)), ("SAMPLE_DATA", 3, shorts(PICTURE, 100))]),
    ],
)
def test_the_dialects_agree_with_surface_topography(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "plate.opd").write_bytes(content)
    compare_with_surface_topography(tmp_path / "plate.opd")


def test_a_measured_file_agrees_with_surface_topography() -> None:
    if not MEASURED.exists():
        skip(f"{MEASURED} is not here")
    compare_with_surface_topography(MEASURED)
    found = read_surface_file(MEASURED)
    assert found.height_map.height.shape == (480, 640)
    assert 640 * found.height_map.spacing_x == approx(125.909140e-6, rel=1e-8)
    assert 480 * found.height_map.spacing_y == approx(94.431855e-6, rel=1e-8)
    assert found.measured_at == datetime(2015, 7, 7, 16, 19, 48)


def compare_with_surface_topography(path: Path) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    own, other = read_surface_file(path).height_map, SurfaceTopographyFormats().read(io.BytesIO(), path)
    np.testing.assert_array_equal(np.isnan(own.height), np.isnan(other.height))
    np.testing.assert_allclose(own.height, other.height, rtol=1e-14)
    assert own.spacing_x == approx(other.spacing_x, rel=1e-14)
    assert own.spacing_y == approx(other.spacing_y, rel=1e-14)
