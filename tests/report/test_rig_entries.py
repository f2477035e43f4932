"""What a rig file takes of measurements: read back by a rig, it is what was measured or made."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from tests.browser.scans import write_spectrum, write_stack_spectrum

import sonolube as sl
from sonolube.example_files import example_file
from sonolube.models.surfaces import HeightMap, contact_roughness, remove_form
from sonolube.rig import Rig, read_rig
from sonolube.tasks.measure.measured_files import MeasuredFiles

TRIBOMETER = example_file("tribometer").source


def entries(answer: MeasuredFiles) -> dict[str, str]:
    """Entries of a rig in the JSON of the one file of an answer."""
    (result,) = answer.json_object()["results"]
    found: dict[str, str] = result.get("rig_entries", {})
    return found


def rig_with(changes: dict[str, str]) -> Rig:
    return read_rig(TRIBOMETER, changes=[f"{key}={text}" for key, text in changes.items()])


def test_the_roughness_of_a_scan_is_that_of_the_rig(tmp_path: Path) -> None:
    heights = 1e-7 * np.random.default_rng(2).standard_normal((120, 90))
    np.save(tmp_path / "plate.npy", heights)
    own = entries(sl.measure.surface(tmp_path / "plate.npy", spacing="2 um"))
    assert set(own) == {f"contact.roughness.{name}" for name in ("rms_height", "summit_radius", "summit_density")}
    expected = contact_roughness(remove_form(HeightMap(height=heights, spacing_x=2e-6, spacing_y=2e-6)))
    found = rig_with(own).contact.roughness
    assert found is not None
    assert asdict(found) == approx(asdict(expected), rel=1e-3)


def test_the_stack_of_a_spectrum_is_that_of_which_it_was_made(tmp_path: Path) -> None:
    path = tmp_path / "start.toml"  # where the search begins
    path.write_text(TRIBOMETER.read_text(encoding="utf-8").replace('"2e9 N/m"', '"1e9 N/m"'), encoding="utf-8")
    own = entries(sl.measure.impedance(write_stack_spectrum(tmp_path), stack_of=path))
    found, true = rig_with(own).stack, rig_with({}).stack
    assert found is not None
    assert true is not None
    assert found.free_capacitance == approx(true.free_capacitance, rel=0.01)
    assert found.free_stroke_per_volt == approx(true.free_stroke_per_volt, rel=0.01)
    assert found.stack_stiffness == approx(true.stack_stiffness, rel=0.01)
    assert found.stack_damping == approx(true.stack_damping, rel=0.2)


@pytest.mark.parametrize("stack_of", [None, TRIBOMETER])
def test_a_circuit_or_a_spectrum_of_another_body_gives_a_rig_nothing(tmp_path: Path, stack_of: Path | None) -> None:
    assert entries(sl.measure.impedance(write_spectrum(tmp_path), stack_of=stack_of)) == {}
