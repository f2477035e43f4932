"""Structures of rig files: chains and modes against the pin-on-disc chain and against linear theory."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from scipy.linalg import eigh

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import contact_receptance, drive_receptance, electrical_admittance
from sonolube.rig import load_study, read_rig, rig_content, rig_from, simulate
from sonolube.rig.driven_rig import DrivenRig, driven_rig

TRIBOMETER = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
CHAIN: dict[str, Any] = {
    "kind": "chain",
    "masses": {"tip": "0.1093 kg", "reaction": "2.41 kg", "arm": "602 g"},
    "springs": [{"between": ["reaction", "arm"], "spring_stiffness": "4.56e5 N/m"}],
    "dampers": [
        {"between": ["reaction", "arm"], "viscous_damping": "90 N s/m"},
        {"between": ["tip", "ground"], "viscous_damping": "702 N s/m"},
    ],
    "stack_between": ["tip", "reaction"],
    "contact": "tip",
    "loaded": "arm",
}
MODES = "natural_frequency [kHz],damping_ratio,drive_participation [N/V],contact_participation\n"


def with_structure(structure: dict[str, Any]) -> DrivenRig:
    return driven_rig(rig_from(tomllib.loads(TRIBOMETER.read_text(encoding="utf-8")) | {"structure": structure}))


def beside(tmp_path: Path, modes: str) -> Path:
    """A copy of the tribometer's file whose structure is a file of modes beside it."""
    text = TRIBOMETER.read_text(encoding="utf-8")
    before, _, rest = text.partition("[structure]")
    after = rest[rest.index("[assumptions]") :]
    table = '[structure]\nkind = "modes"\nfile = "modes.csv"\nclamped_capacitance = "209 nF"\n\n'
    (tmp_path / "modes.csv").write_text(modes, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(before + table + after, encoding="utf-8")
    return tmp_path / "rig.toml"


def test_a_chain_of_the_same_masses_springs_and_dampers_is_the_pin_on_disc_chain() -> None:
    own, chain = driven_rig(read_rig(TRIBOMETER)), with_structure(CHAIN)
    for name in ("mass_matrix", "damping_matrix", "stiffness_matrix", "drive_vector", "contact_vector"):
        assert getattr(chain.structure, name) == approx(getattr(own.structure, name), rel=1e-14)
    assert simulate(chain).friction.friction_force == approx(simulate(own).friction.friction_force, rel=1e-9)
    heavier = [load_study(rig, normal_load=[2.0, 4.0])["friction_ratio"].values for rig in (own, chain)]
    assert heavier[0] == approx(heavier[1], rel=1e-9)


def test_two_masses_on_a_spring_resonate_where_the_reduced_mass_says() -> None:
    free = CHAIN | {"masses": {"tip": "1 kg", "reaction": "3 kg"}, "springs": [], "dampers": []}
    structure = with_structure({key: value for key, value in free.items() if key != "loaded"}).structure
    # reaction mass with the stack's own 0.07 kg; stack of 2e9 N/m
    reduced = 1 * 3.07 / 4.07
    frequency = np.sqrt(2e9 / reduced) / (2 * np.pi)
    omega_squared = eigh(structure.stiffness_matrix, structure.mass_matrix, eigvals_only=True)
    assert np.sqrt(omega_squared[-1]) / (2 * np.pi) == approx(frequency, rel=1e-12)


def test_modes_from_a_file_have_the_receptances_of_the_chain_they_come_from(tmp_path: Path) -> None:
    undamped = CHAIN | {"dampers": []}
    content = tomllib.loads(TRIBOMETER.read_text(encoding="utf-8")) | {"structure": undamped}
    content["stack"] |= {"stack_damping": "0 N s/m"}
    chain = driven_rig(rig_from(content)).structure
    omega_squared, shapes = eigh(chain.stiffness_matrix, chain.mass_matrix)
    frequency = np.sqrt(np.maximum(omega_squared, 0.0)) / (2 * np.pi)
    frequency[0] = 0.0  # it floats
    rows = zip(1e-3 * frequency, np.zeros(3), chain.drive_vector @ shapes, chain.contact_vector @ shapes, strict=True)
    path = beside(tmp_path, MODES + "\n".join(",".join(f"{value:.17g}" for value in row) for row in rows))
    modal = driven_rig(
        read_rig(path, changes=[f"structure.clamped_capacitance={chain.clamped_capacitance!r}F"])
    ).structure
    at = np.geomspace(200.0, 60e3, 40)
    for response in (contact_receptance, drive_receptance, electrical_admittance):
        assert response(modal, frequency=at) == approx(response(chain, frequency=at), rel=1e-8)
    assert "natural_frequency" in rig_content(path)["structure"]


@pytest.mark.parametrize(
    ("modes", "complaint"),
    [
        ("damping_ratio\n0.1\n", "column natural_frequency is missing"),
        (MODES.replace("damping_ratio", "damping"), r"unknown column 'damping'; did you mean damping_ratio\?"),
        (MODES.replace(" [kHz]", "") + "20,0,1,1\n", r"column natural_frequency has no unit"),
        (MODES, "has no modes below its headings"),
        (MODES + "20,0,1\n", "mode 1 has 3 entries, its headings are 4"),
        (MODES + "20,0.1,x,1\n", "mode 1: drive_participation 'x' is no number"),
    ],
)
def test_a_file_of_modes_that_is_none_is_refused_in_one_line(tmp_path: Path, modes: str, complaint: str) -> None:
    with raises(InvalidInput, match=complaint) as refusal:
        read_rig(beside(tmp_path, modes))
    assert "structure.file" in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("changed", "complaint"),
    [
        ({"contact": "toe"}, r"structure: unknown body 'toe'"),
        ({"masses": {"tip": "1 m"}}, r"structure\.masses.*is a length"),
        ({"springs": [{"between": ["tip"], "spring_stiffness": "1 N/m"}]}, r"structure\.springs\.0\.between"),
        ({"spring": []}, r"structure\.spring: unknown key; did you mean springs\?"),
        ({"kind": "chains"}, r"structure"),
        ({"kind": "modes"}, r"structure"),
    ],
)
def test_a_wrong_chain_is_refused_by_its_key(changed: dict[str, Any], complaint: str) -> None:
    with raises(InvalidInput, match=complaint) as refusal:
        with_structure(CHAIN | changed)
    assert "\n" not in str(refusal.value)


def test_a_load_cannot_be_varied_where_nobody_says_where_it_hangs() -> None:
    rig = with_structure({key: value for key, value in CHAIN.items() if key != "loaded"})
    with raises(InvalidInput, match=r"structure\.loaded is missing; name the mass that the weights hang on"):
        load_study(rig, normal_load=[2.0])
