"""Horns in words: regions along the face of a Poisson horn, sizes, gain and stress of a tuned one beside a thin bar."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx

from sonolube.report.blocks import Rows
from sonolube.report.results.parts import horns as results
from sonolube.studies import study_horn_face

NAN = float("nan")


def face(node: float = 0.5e-3) -> Any:
    return SimpleNamespace(
        node=node, ratio=np.array([-0.75, 0.25, 1.0]), at=lambda place: 0.6 if place == node else NAN
    )


def rows_of(blocks: Any) -> dict[str, str]:
    assert isinstance(blocks[-1], Rows)
    return dict(blocks[-1].rows)


def test_the_face_has_its_node_and_regions_beside_those_of_the_table(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(results, "transition_region", lambda friction: (-8e-3, 7e-3))
    blocks = results.face_blocks("aluminium", study_horn_face("aluminium"), face())
    assert blocks[0] == "Poisson horn of aluminium, positions from the centre of the face"
    # Table 2.1: a quarter of an inch either way; the face ends after an inch and a half
    assert rows_of(blocks) == {
        "Node of the axial motion": "0.5 mm",
        "Friction at the node, of that at rest": "60%",
        "Transition region": "-8 mm to 7 mm",
        "the same, measured": "-6.35 mm to 6.35 mm (Table 2.1)",
        "Motor region, left": "-38.1 mm to -8 mm",
        "Motor region, right": "7 mm to 38.1 mm",
        "Greatest motor force, of the friction at rest": "75%",
    }
    found = results.face_object("aluminium", study_horn_face("aluminium"), face())
    assert found["node_position"] == {"value": 0.5e-3, "unit": "m"}
    assert found["transition_region"] == {"start": {"value": -8e-3, "unit": "m"}, "end": {"value": 7e-3, "unit": "m"}}
    assert found["measured_transition_region"]["start"]["value"] == approx(-6.35e-3)
    assert found["measured_transition_region"]["end"]["value"] == approx(6.35e-3)
    assert found["friction_ratio_at_node"] == {"value": 0.6, "unit": ""}
    assert found["least_friction_ratio"]["value"] == approx(-0.75)


def test_a_face_that_drives_nowhere_resists_up_to_its_ends(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(results, "transition_region", lambda friction: (NAN, NAN))
    held = face()
    held.ratio = np.array([0.25, 1.0])
    found = rows_of(results.face_blocks("steel", study_horn_face("steel"), held))
    assert found["Transition region"] == "-38.1 mm to 38.1 mm"
    assert found["Greatest motor force, of the friction at rest"] == "0%"
    assert found["the same, measured"] == "2.54 mm to 5.08 mm (Table 2.1)"
    content = results.face_object("steel", study_horn_face("steel"), held)
    assert content["transition_region"] == {"start": {"value": None, "unit": "m"}, "end": {"value": None, "unit": "m"}}


MATERIAL: Any = SimpleNamespace(
    name="titanium", properties={"fatigue_strength": 1, "yield_strength": 1},
    value=lambda name: {"fatigue_strength": 400e6, "yield_strength": 800e6}[name],
)  # fmt: skip


def horn(*, thin: bool = True, neighbours: int = 4, sizes: dict[str, float] | None = None) -> Any:
    mode = SimpleNamespace(
        frequency=20e3, frequency_error=3e-4, names=["rigid", "axial 1"], row=1,
        model=SimpleNamespace(mesh=SimpleNamespace(node_count=1234)),
    )  # fmt: skip
    near = (("bending 3", 19e3), ("torsion 1", 20.5e3), ("axial 2", 30e3), ("far", 40e3))
    return SimpleNamespace(
        tuned=SimpleNamespace(mode=mode, length=0.12345, frequency_per_length=-150e3),
        body=SimpleNamespace(
            name="stepped_horn", tuned_size="length", axis="x", sizes={"radius": 0.02} if sizes is None else sizes,
            thin=SimpleNamespace(length=0.125, displacement_gain=4.0) if thin else None,
        ),
        total_length=0.25, displacement_gain=3.456, node_position=0.0612, face_uniformity=0.9876, face_asymmetry=1.2e-3,
        stress_per_displacement=4e12, stress_change=0.015, neighbours=near[:neighbours],
    )  # fmt: skip


@pytest.fixture(autouse=True)
def loaded(monkeypatch: MonkeyPatch) -> None:
    """Let a tool lower the frequency by 2 Hz a gram."""
    monkeypatch.setattr(results, "loaded_frequency", lambda design, *, tool_mass: 20e3 - 2e3 * tool_mass)


def test_a_tuned_horn_is_said_beside_a_thin_bar_with_its_three_nearest_modes() -> None:
    blocks = results.horn_blocks(horn(), MATERIAL, tool_mass=0.01, vibration_amplitude=25e-6)
    assert blocks[0] == "stepped_horn of titanium: radius 20 mm"
    # 4e12 Pa/m: 400 MPa at 100 um, 800 MPa at 200 um, 100 MPa at 25 um
    assert rows_of(blocks) == {
        "length": "123.45 mm  (thin bar 125.00 mm)",
        "total length": "250.00 mm",
        "frequency": "20000 Hz +-6  axial 1",
        "trim": "-150.0 Hz/mm",
        "neighbours": "bending 3 -5.0%, torsion 1 +2.5%, axial 2 +50.0%",
        "gain": "3.46  (thin bar 4.00)",
        "node": "61.2 mm from the driven face",
        "face": "Umin/Umax 0.988, asymmetry 0.0012",
        "peak stress": "4.00 MPa per um of the working face",
        "at 25 um": "100 MPa, 25% of the fatigue limit, 12% of the yield point",
        "fatigue limit": "100 um, zero to peak",
        "yield point": "200 um, zero to peak",
        "tool": "10 g on the face: -20 Hz",
    }
    bare = results.horn_blocks(
        horn(thin=False, neighbours=0, sizes={}), MATERIAL, tool_mass=0.0, vibration_amplitude=None
    )
    assert bare[0] == "stepped_horn of titanium"
    found = rows_of(bare)
    assert (found["length"], found["gain"], found["neighbours"]) == ("123.45 mm", "3.46", "none below")
    assert not any(name.startswith("at ") for name in found)


def test_a_tuned_horn_in_json_has_the_stress_of_the_amplitude_that_is_asked_for() -> None:
    found = results.horn_object(horn(), MATERIAL, tool_mass=0.01, vibration_amplitude=25e-6)
    assert (found["part"], found["material"], found["mode"]) == ("stepped_horn", "titanium", "axial 1")
    assert found["thin_bar_length"] == {"value": 0.125, "unit": "m"}
    assert found["peak_stress"] == {"value": approx(100e6), "unit": "Pa"}
    assert found["vibration_amplitude"] == {"value": 25e-6, "unit": "m"}
    assert found["loaded_frequency"]["value"] == approx(19980.0)
    assert found["amplitude_limits"]["fatigue_strength"] == {"value": approx(100e-6), "unit": "m"}
    assert found["neighbours"][0]["gap"] == {"value": approx(-0.05), "unit": ""}
    assert len(found["neighbours"]) == 4
    assert found["total_length"]["value"] == approx(0.25)
    assert found["nodes"] == 1234
    bare = results.horn_object(horn(thin=False), MATERIAL, tool_mass=0.0, vibration_amplitude=None)
    assert bare["thin_bar_length"] is None
    assert "peak_stress" not in bare
