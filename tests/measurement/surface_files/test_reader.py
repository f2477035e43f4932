"""Surface files: detection by content, heights in metres, and provenance."""

import builtins
import hashlib
from pathlib import Path
from typing import Any

import numpy as np
from pytest import CaptureFixture, MonkeyPatch, approx, importorskip, mark, raises, skip

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_height_map, read_surface_file

SHARED = Path(__file__).parents[4] / "shared" / "data" / "surfaces"
STEP = np.array([[0.0, 1e-6, 2e-6], [np.nan, 3e-6, 4e-6]])


def measured(name: str) -> Path:
    importorskip("SurfaceTopography", exc_type=ImportError)
    if not (SHARED / name).exists():
        skip(f"{SHARED / name} is not here")
    return SHARED / name


def test_an_npy_file_takes_its_spacing_from_the_caller(tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", STEP)
    found = read_surface_file(tmp_path / "plate.npy", spacing_x=1e-6, spacing_y=2e-6)
    np.testing.assert_array_equal(found.height_map.height, STEP)
    assert (found.height_map.spacing_x, found.height_map.spacing_y) == (1e-6, 2e-6)
    assert found.format_name == "NPY"
    assert found.sha256 == hashlib.sha256((tmp_path / "plate.npy").read_bytes()).hexdigest()


def test_an_npy_file_without_spacing_is_refused_with_advice(tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", STEP)
    with raises(InvalidInput, match=r"plate\.npy: the distance of pixels is not in the file; give spacing_x"):
        read_height_map(tmp_path / "plate.npy")


def test_an_npy_file_in_micrometres_is_converted_to_metres(tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", 1e6 * STEP)
    found = read_height_map(tmp_path / "plate.npy", spacing_x=1e-6, spacing_y=1e-6, length_unit="um")
    np.testing.assert_allclose(found.height, STEP)


@mark.parametrize("damage", [lambda b: b[:-1], lambda b: b[:20], lambda b: b.replace(b"(2, 3)", b"(9999999, 3)")])
def test_a_damaged_npy_file_is_refused(damage: Any, tmp_path: Path) -> None:
    np.save(tmp_path / "whole.npy", STEP)
    (tmp_path / "plate.npy").write_bytes(damage((tmp_path / "whole.npy").read_bytes()))
    with raises(InvalidInput, match=r"plate\.npy: not a whole NPY file"):
        read_height_map(tmp_path / "plate.npy", spacing_x=1, spacing_y=1)


def test_objects_in_an_npy_file_are_not_unpickled(tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", np.array([[{}]]), allow_pickle=True)
    with raises(InvalidInput, match="not a whole NPY file"):
        read_height_map(tmp_path / "plate.npy", spacing_x=1, spacing_y=1)


@mark.parametrize(
    ("content", "stated"),
    [
        (np.zeros((2, 3, 4)), r"\(2, 3, 4\) of float64"),
        (np.array([["1", "2"]]), r"\(1, 2\) of <U1"),
        (np.ones((2, 2), dtype=bool), r"\(2, 2\) of bool"),
        (np.ones((2, 2), dtype=complex), r"\(2, 2\) of complex128"),
    ],
)
def test_what_is_no_matrix_of_numbers_in_an_npy_file_is_refused(content: Any, stated: str, tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", content)
    with raises(InvalidInput, match=rf"heights are a matrix of numbers, got shape {stated}"):
        read_height_map(tmp_path / "plate.npy", spacing_x=1, spacing_y=1)


@mark.parametrize("kind", ["i2", "u1", ">f4"])
def test_numbers_of_any_kind_in_an_npy_file_are_heights(kind: str, tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", np.array([[1, 2, 3], [4, 5, 6]], dtype=kind))
    found = read_height_map(tmp_path / "plate.npy", spacing_x=1e-6, spacing_y=1e-6, length_unit="nm")
    assert np.sort(found.height, axis=None) == approx(1e-9 * np.arange(1, 7))


def test_a_profile_in_an_npy_file_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "plate.npy", STEP[0])
    with raises(InvalidInput, match=r"a matrix of numbers, got shape \(3,\)"):
        read_height_map(tmp_path / "plate.npy", spacing_x=1, spacing_y=1)


def test_xyz_points_need_their_unit_and_are_converted_to_metres(tmp_path: Path) -> None:
    (tmp_path / "plate.txt").write_text("x y z\n0 0 1\n2 0 2\n0 3 3\n2 3 4\n")
    with raises(InvalidInput, match=r'XYZ text does not state its unit; give length_unit, such as "um"'):
        read_height_map(tmp_path / "plate.txt")
    found = read_height_map(tmp_path / "plate.txt", length_unit="um")
    assert found.height == approx(1e-6 * np.array([[1, 2], [3, 4]]))
    assert (found.spacing_x, found.spacing_y) == approx((2e-6, 3e-6))


def test_a_spacing_in_addition_to_that_of_the_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "plate.xyz").write_text("0 0 1\n2 0 2\n0 3 3\n2 3 4\n")
    with raises(InvalidInput, match="XYZ text states its spacing"):
        read_height_map(tmp_path / "plate.xyz", length_unit="um", spacing_x=1e-6, spacing_y=1e-6)


def test_a_missing_or_empty_file_is_refused_by_name(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"gone\.opd: cannot be read: No such file"):
        read_height_map(tmp_path / "gone.opd")
    (tmp_path / "empty.sur").touch()
    with raises(InvalidInput, match=r"empty\.sur: is empty"):
        read_height_map(tmp_path / "empty.sur")


def test_other_formats_without_the_extra_are_refused_with_advice(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    (tmp_path / "plate.sur").write_bytes(b"DIGITAL SURF" + bytes(600))
    real = builtins.__import__

    def without(name: str, *args: Any, **kwargs: Any) -> Any:
        if name.startswith("SurfaceTopography"):
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with raises(InvalidInput, match=r"pip install SurfaceTopography"):
        read_height_map(tmp_path / "plate.sur")


def dektak(points: int, *, tail: str) -> str:
    """Export of a Dektak profiler: heights of 10 nm steps every 0.5 um."""
    head = "Scan Parameters,\nMeas Title,step\nStylus,Radius: 12.5 um\n\nScan Data\n\nLateral um,Raw Micrometer,\n"
    return head + "".join(f"{0.5 * at:.3f},{0.01 * (at % 7):.4f},\n" for at in range(points)) + tail


@mark.parametrize("tail", ["", "\n\n", " \n\n"])
@mark.parametrize("points", [50, 3000])
def test_blank_lines_behind_the_points_of_a_dektak_export_are_no_damage(points: int, tail: str, tmp_path: Path) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    path = tmp_path / "step.csv"
    path.write_text(dektak(points, tail=tail), encoding="latin-1")
    found = read_surface_file(path).height_map
    assert found.spacing_x == approx(0.5e-6)
    assert found.height.ravel() == approx(np.array([1e-8 * (at % 7) for at in range(points)]), abs=1e-12)


def test_long_prose_is_no_failure_of_a_reader_that_was_not_tried(tmp_path: Path) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    path = tmp_path / "notes.txt"
    path.write_text("a page of notes about the plate\n" * 2000)
    with raises(
        InvalidInput, match=r"notes\.txt: is no surface file by its signature, and as text no table of heights"
    ):
        read_surface_file(path)


def test_what_a_reader_of_the_library_prints_does_not_reach_the_output(
    tmp_path: Path, capfd: CaptureFixture[str]
) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    path = tmp_path / "plate.dat"
    path.write_bytes(bytes(range(256)) * 300)
    with raises(InvalidInput, match="damaged, or of no format of SurfaceTopography"):
        read_surface_file(path)
    assert capfd.readouterr() == ("", "")


def test_a_file_of_no_known_format_is_refused(tmp_path: Path) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    (tmp_path / "plate.bin").write_bytes(bytes(range(256)) * 4)
    with raises(InvalidInput, match=r"plate\.bin: damaged, or of no format of SurfaceTopography"):
        read_height_map(tmp_path / "plate.bin")


# Sizes, spacings and missing pixels as the headers of the files state them.
@mark.parametrize(
    ("name", "shape", "spacing_x", "spacing_y", "missing"),
    [
        ("sur-2.sur", (484, 563), 3.4840002190321684e-6, 3.4840002190321684e-6, 117),
        ("x3p-2.x3p", (650, 650), 1.27656509837346e-07, 3.14582113527746e-07, 0),
        ("al3d-1.al3d", (296, 200), 4.38027e-07, 4.38027e-07, 0),
        ("metropro-1.dat", (480, 640), 1.0982520279867458e-06, 1.0982520279867458e-06, 0),
        ("opdx-3.opdx", (1, 3001), 0.016655562954266106e-6, 0.016655562954266106e-6, 0),
    ],
)
def test_files_of_other_instruments_are_read_in_metres(
    name: str, shape: tuple[int, int], spacing_x: float, spacing_y: float, missing: int
) -> None:
    found = read_surface_file(measured(name)).height_map
    assert found.height.shape == shape
    assert (found.spacing_x, found.spacing_y) == approx((spacing_x, spacing_y), rel=1e-12)
    assert np.count_nonzero(~found.measured) == missing


def test_a_sur_file_has_the_height_range_of_its_header() -> None:
    heights = read_height_map(measured("sur-2.sur")).height
    assert np.nanmin(heights) == approx(89120 * 1.0000000116860974e-10)
    assert np.nanmax(heights) == approx(103880 * 1.0000000116860974e-10)


def test_provenance_is_read_from_the_file() -> None:
    found = read_surface_file(measured("opdx-3.opdx"))
    assert found.instrument == "Bruker Dektak Profiler"
    assert found.title == "Reference-2021.11.02_50um.OPDx"
    assert str(found.measured_at) == "2021-02-11 23:39:13"
    assert read_surface_file(measured("x3p-2.x3p")).measured_at is None  # it gives the epoch for want of a date
