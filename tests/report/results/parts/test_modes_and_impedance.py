"""Modes and impedance spectra in words: errors of frequencies, modes of other programs, capacitance, stresses."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx

from sonolube.report.blocks import Rows, Table
from sonolube.report.results.parts import modes_and_impedance as results
from sonolube.rig.file.structures import MODE_LISTS


def part(rigid: int = 1) -> Any:
    found = SimpleNamespace(
        modes=SimpleNamespace(rigid_body_count=rigid), nodes=[100, 400, 900],
        natural_frequency=np.array([0.0, 20e3, 31e3]), frequency_error=np.array([0.0, 3e-4, 1e-3]),
    )  # fmt: skip
    return SimpleNamespace(
        found=found, part=SimpleNamespace(name="bar", material="steel"), names=["rigid", "axial 1", "bending 2"]
    )


def test_modes_of_a_part_leave_rigid_motions_out_and_have_their_errors() -> None:
    head, rows = results.modes_blocks(part())
    assert head == "bar of steel: 1 rigid motions, 900 nodes in the last of 3 meshes"
    assert isinstance(rows, Rows)
    # 0.0003 of 20 kHz are 6 Hz, 0.001 of 31 kHz 31 Hz
    assert list(rows.rows) == [("axial 1", "20.00 kHz ± 6 Hz"), ("bending 2", "31.00 kHz ± 3e+01 Hz")]
    assert results.modes_blocks(part(rigid=0))[0] == "bar of steel: held, 900 nodes in the last of 3 meshes"


def test_modes_in_json_have_their_uncertainties_in_hertz_and_the_structure_where_it_is_made() -> None:
    found = results.modes_object(part(), None)
    assert (found["part"], found["material"], found["rigid_motions"]) == ("bar", "steel", 1)
    assert found["nodes"] == [100, 400, 900]
    assert "structure" not in found
    first = found["modes"][0]
    assert first["uncertainty"] == {"value": approx(6.0), "unit": "Hz"}
    assert first["natural_frequency"] == {"value": 20e3, "unit": "Hz"}
    assert (first["name"], first["text"]) == ("axial 1", "20.00 kHz ± 6 Hz")
    assert results.modes_object(part(), "a = 1")["structure"] == {"a": 1}


LISTS = {
    "natural_frequency": np.array([0.0, 20e3, 30e3]),
    "damping_ratio": np.array([0.01, 0.005, 0.0]),
    "drive_participation": np.array([0.0, -0.4, 0.2]),
    "contact_participation": np.array([1.0, 2.0, 3.0]),
}
PEAK = 0.8 / (2 * 0.005 * (2 * np.pi * 20e3) ** 2)  # |b c|/(2 zeta omega^2), 5.07 nm/V


def test_the_amplitude_at_resonance_is_the_drive_over_twice_the_damped_stiffness() -> None:
    assert set(LISTS) == set(MODE_LISTS)
    found = results.resonant_displacement(LISTS)
    assert found[1] == approx(PEAK)
    assert np.isnan(found[[0, 2]]).all()  # a rigid motion, and a mode without damping


def test_modes_of_another_program_are_numbered_with_quality_factor_and_participations() -> None:
    title, note, table = results.foreign_blocks("Modes of x", LISTS, ["in kg"])
    assert (title, note) == ("Modes of x", "  in kg")
    assert isinstance(table, Table)
    assert [list(row) for row in table.rows] == [
        ["1", "rigid", "50", "1", "0", "-"],
        ["2", "20000.0 Hz", "100", "2", "-0.4", "5.07 nm"],
        ["3", "30000.0 Hz", "-", "3", "0.2", "-"],
    ]
    assert list(table.heads) == ["mode", "frequency", "Q", "contact kg^-1/2", "drive N/V kg^-1/2", "tip per volt"]


def test_modes_of_another_program_in_json_and_as_a_dataset_have_their_units() -> None:
    second = results.foreign_object(LISTS, "b = 2")["modes"][1]
    assert second["drive_participation"] == {"value": -0.4, "unit": "N/V kg**-0.5"}
    assert second["contact_participation"] == {"value": 2.0, "unit": "kg**-0.5"}
    assert second["displacement_per_volt"]["value"] == approx(PEAK)
    assert second["damping_ratio"]["value"] == approx(0.005)
    assert results.foreign_object(LISTS, "b = 2")["modes"][0]["displacement_per_volt"]["value"] is None
    assert results.foreign_object(LISTS, "b = 2")["structure"] == {"b": 2}
    found = results.foreign_dataset(LISTS)
    assert found["mode"].values.tolist() == [1, 2, 3]
    assert found["displacement_per_volt"].attrs["units"] == "m/V"
    assert found["natural_frequency"].values == approx(LISTS["natural_frequency"])
    assert found["contact_participation"].attrs["units"] == "kg**-0.5"


def spectrum() -> Any:
    mode = SimpleNamespace(name="axial 1", series_frequency=20e3, parallel_frequency=21e3, coupling_factor=0.3049)
    return SimpleNamespace(
        port=SimpleNamespace(
            model=SimpleNamespace(mesh=SimpleNamespace(node_count=1234)), frequency_error=2.5e-3,
            reduction=SimpleNamespace(clamped_capacitance=1.5e-9 - 1e-12j),
        ),
        response=SimpleNamespace(frequency=np.array([100.0, 200.0])), low_frequency_capacitance=2e-9,
        coupled_modes=(mode,), tip_displacement_at=lambda frequency: 5e-9 if frequency == 20e3 else np.nan,
    )  # fmt: skip


def test_a_spectrum_has_its_capacitance_at_the_lowest_frequency_and_the_least_impedance_measured() -> None:
    measured: Any = SimpleNamespace(
        impedance=np.array([3 + 4j, 0.6 - 0.8j, 2.0]), frequency=np.array([19e3, 20.123e3, 21e3]),
        file_name="own.csv", sha256="abc",
    )  # fmt: skip
    head, table, least = results.blocks({"free": spectrum()}, measured)
    assert head == "  free: 2 nF at 100 Hz, 1234 nodes, resonances +-0.003"
    assert table == Table(
        ("mode", "f_s", "f_p", "k_eff", "tip per volt"), [("axial 1", "20000 Hz", "21000 Hz", "0.305", "5 nm")]
    )
    assert least == "  measured: least impedance 1 ohm at 20.12 kHz in own.csv"
    assert len(results.blocks({"free": spectrum()}, None)) == 2


def test_impedance_in_json_has_electrodes_spectra_and_the_origin_of_sizes() -> None:
    sizes = [SimpleNamespace(name="length", value=0.1, printed=True, source="D"),
             SimpleNamespace(name="width", value=0.2, printed=False, source="guess")]  # fmt: skip
    body: Any = SimpleNamespace(electrodes=SimpleNamespace(driven=("a",), grounded=("b", "c")), dimensions=sizes)
    found = results.impedance_object(body, {"free": spectrum()}, None)
    assert found["electrodes"] == {"driven": ["a"], "grounded": ["b", "c"]}
    assert [each["origin"] for each in found["dimensions"]] == ["printed", "assumed"]
    assert found["measured"] is None
    free = found["spectra"]["free"]
    assert free["clamped_capacitance"] == {"value": approx(1.5e-9), "unit": "F"}
    assert free["frequency_error"]["value"] == approx(2.5e-3)
    assert free["modes"][0]["displacement_per_volt"]["value"] == approx(5e-9)
    assert free["modes"][0]["parallel_frequency"]["value"] == approx(21e3)
    measured: Any = SimpleNamespace(file_name="own.csv", sha256="abc")
    assert results.impedance_object(body, {}, measured)["measured"] == {"file": "own.csv", "sha256": "abc"}


@pytest.fixture
def stress() -> Any:
    return SimpleNamespace(
        stack_amplitude=5e6, highest_stack_stress=-20e6, rod_amplitude=30e6, highest_rod_stress=150e6, stack_mean=-25e6,
        rod_mean=120e6, rod_share=0.123,
    )  # fmt: skip


def test_stresses_of_stack_and_rod_stand_in_their_columns(stress: Any) -> None:
    head, table = results.stress_blocks({"free": {"axial 1": stress}}, 10e-6)
    assert head == "  free: axial stress at 10 um of the working end, tension positive"
    assert isinstance(table, Table)
    assert [list(row) for row in table.rows] == [["axial 1", "5 MPa", "-20 MPa", "30 MPa", "150 MPa", "12.3%"]]
    (found,) = results.stress_object({"axial 1": stress})
    assert found["highest_rod_stress"] == {"value": 150e6, "unit": "Pa"}
    assert found["rod_share"] == {"value": 0.123, "unit": ""}
