"""Lateral units of surface files: known for every reader, reported with their origin, doubted where the size is odd.

Run as a program it prints how each reader of SurfaceTopography comes to its lateral unit:
``python tests/measurement/surface_files/test_lateral_units.py``.
"""

import ast
import inspect
import sys
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, importorskip, mark, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_surface_file
from sonolube.measurement.surface_files.surface_topography import UNIT_BY_LIBRARY
from sonolube.measurement.surface_files.xyz import even_profile

# Readers that leave the lateral unit to the user in every file: their formats have none.
_WITHOUT_UNIT = {"h5", "mat", "npy", "npz", "hgt"}


def unit_constants(reader: Any) -> list[str]:
    """Constants that a reader of the library gives as the lateral unit of a channel; "" for one that it computes."""
    bindings = getattr(reader, "_channel_bindings", None)
    if bindings:
        return [each["unit"] if isinstance(each.get("unit"), str) else "" for each in bindings]
    found: list[str] = []
    for call in ast.walk(ast.parse(inspect.getsource(sys.modules[reader.__module__]))):
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "ChannelInfo":
            units = [each.value for each in call.keywords if each.arg == "unit"]
            constant = str(units[0].value) if units and isinstance(units[0], ast.Constant) else ""
            found.append(constant if units else "none")
    return found


def origins() -> dict[str, str]:
    """Origin of the lateral unit of each reader of the library, by format."""
    library = importorskip("SurfaceTopography.IO", exc_type=ImportError)
    return {
        str(reader.format()): (
            "constant"
            if set(found := unit_constants(reader)) - {"", "none"}
            else "none"
            if not found or set(found) == {"none"}
            else "file"
        )
        for reader in library.readers
    }


def test_every_reader_of_the_library_is_known_by_the_origin_of_its_lateral_unit() -> None:
    found = origins()
    assert len(found) > 35
    assert {name for name, origin in found.items() if origin == "constant"} == UNIT_BY_LIBRARY
    assert set(found) >= _WITHOUT_UNIT


def test_the_library_still_takes_the_nanometres_of_nms_for_millimetres() -> None:
    # The finding for its authors: IO/NMS.py binds dx_mm * 1000 to "µm". Once this fails, the library is mended.
    nms = importorskip("SurfaceTopography.IO.NMS", exc_type=ImportError)
    assert "C.header.dx_mm * 1000.0" in inspect.getsource(nms)


def test_steps_below_a_micrometre_in_metres_keep_their_unevenness(tmp_path: Path) -> None:
    # SurfaceTopography takes steps that differ by less than 1e-6 of any unit for even ones.
    (tmp_path / "line.txt").write_text("0 0\n1e-8 1e-9\n3e-8 2e-9\n4e-8 1e-9\n9e-8 0\n")
    found = read_surface_file(tmp_path / "line.txt", length_unit="m")
    assert found.height_map.height.shape == (1, 5)
    np.testing.assert_allclose(
        found.height_map.height[0], np.interp(np.linspace(0, 9, 5), [0, 1, 3, 4, 9], [0, 1e-9, 2e-9, 1e-9, 0])
    )
    assert any("steps are uneven, 0.444 to 2.22 of their mean" in caveat for caveat in found.caveats)


@mark.parametrize("text", ["0 5 1\n1 5 2\n2 5 4\n3 5 8\n", "5 0 1\n5 1 2\n5 2 4\n5 3 8\n", "0 1\n1 2\n2 4\n3 8\n"])
def test_points_on_one_line_and_text_of_two_columns_are_a_profile(text: str, tmp_path: Path) -> None:
    (tmp_path / "line.txt").write_text(text)
    found = read_surface_file(tmp_path / "line.txt", length_unit="um")
    np.testing.assert_allclose(found.height_map.height, 1e-6 * np.array([[1, 2, 4, 8]]))
    assert found.height_map.spacing_x == approx(1e-6)
    assert found.lateral_unit == "um, given by the user"
    assert found.caveats == (
        "heights range over 7 um, more than the field of 4 um: check the lateral unit"
        " (um, given by the user), and that of the heights",
    )


def test_a_profile_with_a_few_missing_points_keeps_its_steps() -> None:
    at = np.delete(np.arange(100.0), [7, 40])
    height, spacing, notes = even_profile(0.3 * at[::-1], at[::-1])
    np.testing.assert_array_equal(height[0], np.where(np.isin(np.arange(100), [7, 40]), np.nan, np.arange(100)))
    assert spacing == approx(0.3)
    assert notes == ()


def test_text_whose_header_states_its_units_is_not_taken_for_points_without_unit(tmp_path: Path) -> None:
    importorskip("SurfaceTopography", exc_type=ImportError)
    matrix = "# Channel: Height\n# Width: 12.0 µm\n# Height: 8.0 µm\n# Value units: m\n" + "1e-6 0 0\n" * 4
    (tmp_path / "matrix.txt").write_text(matrix, encoding="utf-8")
    found = read_surface_file(tmp_path / "matrix.txt")
    assert found.height_map.height.shape == (4, 3)
    assert found.height_map.spacing_x == approx(4e-6)
    rows = "".join(f"{8.6722 + 0.0005 * i:.6f};{106.6 + 1e-5 * (i % 2):.6f};1\n" for i in range(50))
    (tmp_path / "line.hfm").write_text("X;Y;valid\n[mm];[mm];[1/0]\n" + rows)
    found = read_surface_file(tmp_path / "line.hfm")
    assert found.height_map.height.shape == (1, 50)
    assert found.height_map.spacing_x == approx(0.5e-6)
    assert found.lateral_unit == "mm, stated in the file"


def plate(path: Path) -> Path:
    np.save(path / "plate.npy", 1e-9 * np.arange(12.0).reshape(3, 4))
    return path / "plate.npy"


@mark.parametrize(
    ("spacing", "said"),
    [
        (0.15, "the field is 600 mm x 450 mm, beyond the 0.5 m that profilometers reach"),
        (0.1, None),
        (1e-6, None),
        (0.2e-6, "the field is 800 nm x 600 nm, which only a force microscope scans"),
        (1e-9, "heights range over 11 nm, more than the field of 4 nm x 3 nm"),
    ],
)
def test_an_implausible_size_is_a_caveat(spacing: float, said: str | None, tmp_path: Path) -> None:
    found = read_surface_file(plate(tmp_path), spacing_x=spacing, spacing_y=spacing)
    assert (found.caveats == ()) == (said is None)
    assert said is None or any(said in caveat for caveat in found.caveats)


def test_a_reader_that_stops_in_its_own_code_is_told_as_a_damaged_file(tmp_path: Path, monkeypatch: Any) -> None:
    library = importorskip("SurfaceTopography.IO", exc_type=ImportError)

    class Reader:
        channels: Any = ()

        def __init__(self, path: str) -> None: ...

        @staticmethod
        def can_read(head: bytes) -> Any:
            return library.MagicMatch.YES

        @staticmethod
        def name() -> str:
            return "MATLAB"

        @staticmethod
        def format() -> str:
            return "mat"

    class Stopping(Reader):
        channels = property(lambda self: [][0])

    (tmp_path / "plate.sur").write_bytes(bytes(100))
    monkeypatch.setattr(library, "readers", [Reader])
    with raises(InvalidInput, match="SurfaceTopography takes it for MATLAB, but finds no heights in it"):
        read_surface_file(tmp_path / "plate.sur")
    monkeypatch.setattr(library, "readers", [Stopping])
    with raises(InvalidInput, match=r"a damaged MATLAB file, or a variant of it .* stops with IndexError\)"):
        read_surface_file(tmp_path / "plate.sur")


if __name__ == "__main__":
    for name, origin in sorted(origins().items()):
        print(f"{name:10s} {origin}")  # noqa: T201
