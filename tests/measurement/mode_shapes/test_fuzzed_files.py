"""Damaged files of modes, and any bytes, are read or refused with one line that names the file."""

import random
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import mark
from reliability.damage import mutated
from tests.mode_files import frd_text, write_universal_file
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes.formats import UnitSystem, read_mode_shapes
from sonolube.rig.file.modes_file import MODE_COLUMNS, read_modes

NUMBERS = {
    "frequency": [1e3, 2e3],
    "position": 10 * np.arange(12.0).reshape(4, 3),
    "shape": np.arange(24.0).reshape(2, 4, 3),
    "mass": [1.0, 2.0],
}
TABLE = (
    "natural_frequency [kHz],quality_factor,drive_participation [N/V],contact_participation,modal_mass [g]\n"
    "0,1,0,1,300\n20,500,3,0.5,200\n"
)
LISTS = (
    "natural_frequency = [0, 2e4]\ndamping_ratio = [0, 1e-3]\ndrive_participation = [0, 3]\n"
    'contact_participation = [1, 0.5]\nclamped_capacitance = "4 nF"\n'
)


def seed(suffix: str, folder: Path) -> bytes:
    path = folder / f"seed{suffix}"
    if suffix == ".unv":
        write_universal_file(path, factors=(1e3, 1.0), **NUMBERS)  # type: ignore[arg-type]
        return path.read_bytes()
    return {".frd": frd_text(**NUMBERS), ".csv": TABLE, ".toml": LISTS}[suffix].encode()  # type: ignore[arg-type]


def outcome(content: bytes, path: Path) -> str:
    """Read the content as a file; anything but modes or a refusal that names the file is a failure."""
    path.write_bytes(content)
    units = UnitSystem(length_unit="mm", force_unit="N") if path.suffix == ".frd" else None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            if path.suffix in (".csv", ".toml"):
                values = [np.asarray(v, float) for k, v in read_modes(path).items() if k in MODE_COLUMNS]
            else:
                found = read_mode_shapes(path, units=units)
                values = [found.natural_frequency, found.shape]
        except InvalidInput as refused:
            refusal = str(refused)
        else:
            assert all(np.all(np.isfinite(each)) for each in values)
            assert values[0].min() >= 0
            return "read"
    assert refusal.startswith(f"{path}: ")
    assert "\n" not in refusal
    return "refused"


@mark.parametrize("suffix", [".unv", ".frd", ".csv", ".toml"])
def test_a_damaged_file_of_modes_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    rng, content = random.Random(0), seed(suffix, tmp_path)
    counts = Counter(outcome(mutated(content, rng, others=[content]), tmp_path / f"i{suffix}") for _ in range(600))
    assert outcome(content, tmp_path / f"i{suffix}") == "read"
    assert counts["read"] > 0
    assert counts["refused"] > 0


@examples(200)
@given(content=st.binary(max_size=300), head=st.sampled_from([b"", b"    -1\n    55\n", b"    1C\n    2C"]))
def test_any_bytes_are_read_or_refused_as_modes(content: bytes, head: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".unv", ".frd"):
            outcome(head + content, Path(folder) / f"input{suffix}")
