"""Task `impedance compute` in Python: the numbers of the command, quantities in SI, bytes of files, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.tasks.files import NamedBytes

Program = Callable[..., Any]

RING: dict[str, Any] = {
    "sizes": {"outer_radius": 5e-3, "inner_radius": "2.5mm", "length": "12mm"},
    "points": 20,
    "tolerance": 0.05,
    "clamp": ["ring1.-z"],
}
RING_OPTIONS = (
    *("--set", "outer_radius=5mm", "--set", "inner_radius=2.5mm", "--set", "length=12mm"),
    *("--points", "20", "--tolerance", "0.05", "--clamp", "ring1.-z"),
)


def shape(content: Any) -> Any:
    """Names, texts and units of an answer, its numbers left out."""
    if isinstance(content, dict):
        return {key: shape(value) for key, value in content.items()}
    if isinstance(content, list):
        return [shape(value) for value in content]
    return None if isinstance(content, int | float) else content


def frequencies(answer: dict[str, Any], support: str) -> tuple[list[float], float]:
    """Frequencies of the modes under a support, and their relative error as stated."""
    found = answer["spectra"][support]
    modes = [mode[name]["value"] for mode in found["modes"] for name in ("series_frequency", "parallel_frequency")]
    return modes, found["frequency_error"]["value"]


def test_spectra_in_python_have_the_numbers_of_the_command(sonolube: Program, tmp_path: Path) -> None:
    call = ("impedance", "compute", "stack", *RING_OPTIONS, "--from", "10kHz", "--to", "105kHz")
    command = sonolube(*call, "--out", tmp_path, "--json").answer
    found = sl.impedance.compute("stack", lowest=10e3, highest="105 kHz", **RING)
    del command["files"]
    assert shape(found.json_object()) == shape(command)
    for support in ("free", "clamped"):  # two meshes of a stack may differ, within the error that each states
        (here, error), (there, other) = (frequencies(each, support) for each in (found.json_object(), command))
        assert here == approx(there, rel=error + other)
    data = found.dataset()
    assert list(data["support"].to_numpy()) == ["free", "clamped"]
    assert data["frequency"].to_numpy() == approx(np.linspace(10e3, 105e3, 20))
    assert (data["impedance"].dims, data["impedance"].attrs["units"]) == (("support", "frequency"), "ohm")
    text = found.text()
    assert "k_eff" in text
    table = tmp_path / "stack-impedance-free.csv"
    measured = NamedBytes(table.name, table.read_bytes())
    over = sl.impedance.compute("stack", lowest=10e3, highest=105e3, measured=measured, **RING)
    assert over.object()["measured"]["file"] == table.name
    assert shape(over.object()["spectra"]) == shape(found.object()["spectra"])


def test_arguments_are_refused_by_their_names() -> None:
    with raises(InvalidInput, match=r"^lowest must lie below highest, got 60kHz and 1000\.0"):
        sl.impedance.compute("stack", lowest="60kHz", highest=1000.0)
    with raises(InvalidInput, match=r"^poled x: stack has its own; leave it out, or take another part"):
        sl.impedance.compute("stack", poled="x")
    with raises(InvalidInput, match=r"^points must be finite and lie between 2"):
        sl.impedance.compute("stack", points=1)
