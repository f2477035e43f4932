"""Files of modes: lists and tables in the normalisation of 1 kg, and what is refused in them."""

from pathlib import Path

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.rig.file.modes_file import kept_apart, read_modes

TOML = """\
command = "sonolube modes horn.toml"
frequency_error = 1e-3
assumptions = ["damping of steel"]
natural_frequency = [0, 20e3]
damping_ratio = [0.0, 0.01]
drive_participation = [0, 2.5]
contact_participation = [1.0, -3]
"""


def modes(folder: Path, text: str, name: str = "modes.csv", force_per_volt: float | None = None) -> dict[str, object]:
    (folder / name).write_text(text, encoding="utf-8")
    return read_modes(folder / name, force_per_volt=force_per_volt)


def test_a_file_that_a_command_wrote_gives_its_lists_without_their_origin(tmp_path: Path) -> None:
    assert modes(tmp_path, TOML + 'clamped_capacitance = "2 nF"\n', "modes.toml") == {
        "clamped_capacitance": "2 nF",
        "natural_frequency": [0.0, 20e3],
        "damping_ratio": [0.0, 0.01],
        "drive_participation": [0.0, 2.5],
        "contact_participation": [1.0, -3.0],
    }


def test_columns_are_told_from_other_entries() -> None:
    assert kept_apart({"natural_frequency": [1.0], "clamped_capacitance": 1e-9}) == {"clamped_capacitance": 1e-9}


def test_quality_factor_elongation_and_modal_mass_become_those_of_one_kilogram(tmp_path: Path) -> None:
    text = (
        "natural_frequency [kHz],quality_factor,port_participation,contact_participation,modal_mass [g]\n"
        "20,50,0.5,3,250\n25,200,-2,1,4000\n"
    )
    found = modes(tmp_path, text, force_per_volt=12.0)
    assert found["natural_frequency"] == approx([20e3, 25e3])
    assert found["damping_ratio"] == approx([0.01, 0.0025])
    # 12 N/V times the elongation, over the root of 0.25 kg and of 4 kg
    assert found["drive_participation"] == approx([12.0, -12.0])
    assert found["contact_participation"] == approx([6.0, 0.5])


HEAD = "natural_frequency [Hz],damping_ratio,drive_participation [N/V],contact_participation\n"
PORT = "natural_frequency [Hz],damping_ratio,port_participation,contact_participation\n"
QUALITY = "natural_frequency [Hz],quality_factor,drive_participation [N/V],contact_participation\n"
MASS = "natural_frequency [Hz],damping_ratio,drive_participation [N/V],contact_participation,modal_mass [kg]\n"


@pytest.mark.parametrize(
    ("text", "force", "complaint"),
    [
        (PORT + "1e3,0.01,1,1\n", None, "port_participation needs the blocked force per volt"),
        (HEAD + "1e3,0.01,1,1\n", 2.0, "has drive_participation, with the blocked force in it"),
        (QUALITY + "1e3,50,1,1\n2e3,0,1,1\n", None, "mode 2: quality_factor must be positive, got 0"),
        (MASS + "1e3,0.01,1,1,-2\n", None, "mode 1: modal_mass must be positive, got -2"),
        (HEAD + "-1,0.01,1,1\n", None, "natural_frequency must not be negative; 0 is a rigid motion"),
        (HEAD + "1e3,nan,1,1\n", None, "damping_ratio must be finite"),
        (
            "natural_frequency [Hz],damping_ratio,contact_participation\n1e3,0.01,1\n",
            None,
            "column drive_participation is",
        ),
        (
            HEAD.replace("damping_ratio", "damping_ratio,quality_factor") + "1e3,0.1,5,1,1\n",
            None,
            "has both damping_ratio and quality_factor",
        ),
    ],
)
def test_a_table_that_leaves_a_mode_unknown_is_refused(
    tmp_path: Path, text: str, force: float | None, complaint: str
) -> None:
    with raises(InvalidInput, match=complaint):
        modes(tmp_path, text, force_per_volt=force)


def test_lists_of_other_lengths_are_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match="damping_ratio has 1 entries, natural_frequency 2"):
        modes(tmp_path, TOML.replace("[0.0, 0.01]", "[0.01]"), "modes.toml")


def test_a_rigid_motion_is_a_mode(tmp_path: Path) -> None:
    assert modes(tmp_path, HEAD + "0,0.01,1,1\n")["natural_frequency"] == [0.0]
