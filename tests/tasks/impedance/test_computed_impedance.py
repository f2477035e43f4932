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


BOLTED: dict[str, Any] = {
    "sizes": {"outer_radius": "15mm", "inner_radius": "6mm", "length": "20mm", "rod_radius": "4mm"},
    "points": 5,
    "tolerance": 0.9,
    "highest": "40kHz",
}
BOLTED["sizes"] |= {"back_length": "30mm", "front_length": "30mm"}


def test_the_stress_of_a_stack_has_its_preload_by_force_or_by_torque_and_says_where_it_opens() -> None:
    pressed = sl.impedance.compute("stack", amplitude="2um", preload=20e3, **BOLTED)
    turned = sl.impedance.compute("stack", amplitude="8um", torque="10 N m", clamp=["front.+z"], **BOLTED)
    (mode,) = pressed.object()["stresses"]["free"]
    # pi (15^2 - 6^2) mm2 and pi 4^2 mm2
    assert mode["stack_mean"]["value"] == approx(-33.7e6, rel=0.01)
    assert mode["rod_mean"]["value"] == approx(398e6, rel=0.01)
    assert mode["highest_rod_stress"]["value"] > mode["rod_mean"]["value"]
    assert pressed.caveats() == []
    assert turned.object()["preload"] == {"value": approx(10 / (0.2 * 8e-3)), "unit": "N"}
    assert list(turned.object()["stresses"]) == ["free"]  # the working end rests in the other
    opened, torque = turned.caveats()
    assert "the stack is in tension by" in opened
    assert "within about 30 %" in torque
    assert "stresses" not in sl.impedance.compute("stack", **BOLTED).object()


@pytest.mark.parametrize(
    ("part", "arguments", "complaint"),
    [
        ("stack", {"preload": 1e3}, "preload has no meaning without amplitude"),
        ("stack", {"amplitude": 1e-6, "preload": 1e3, "torque": 1.0}, "preload has no meaning beside torque"),
        ("stack", {"amplitude": 1e-6, "nut_factor": 0.3}, "nut_factor has no meaning without torque"),
        ("stack", {"amplitude": 1e-6, "torque": 1.0}, "torque needs the thread of a stack with rod_radius"),
        ("stack", {"amplitude": 1e-6, "preload": 1e3, "sizes": RING["sizes"]}, "stack has no rod that preloads"),
        ("stack", {"amplitude": -1e-6}, "amplitude"),
        ("collar", {"amplitude": 1e-6}, "collar has no working end in line with its stack"),
    ],
)
def test_a_stress_that_cannot_be_given_is_refused_before_anything_is_solved(
    part: str, arguments: dict[str, Any], complaint: str
) -> None:
    with raises(InvalidInput, match=complaint) as refusal:
        sl.impedance.compute(part, **arguments)
    assert "\n" not in str(refusal.value)


def test_a_part_that_states_its_own_constants_names_no_ceramic() -> None:
    found = sl.impedance.compute("collar")
    assert found.object()["ceramic"] is None
    assert found.text().splitlines()[0].startswith("collar of its own ceramic: ")
