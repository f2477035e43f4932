"""Catalogue of actuators: sources of the data, coupling factors below one, and users' catalogue files."""

import math
from pathlib import Path

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.models.actuator import (
    FlextensionalActuator,
    catalogue_actuator,
    catalogue_names,
    catalogue_stack,
    equivalent_stack,
    read_catalogue,
)


@pytest.mark.parametrize("name", catalogue_names())
def test_every_actuator_has_a_source_and_a_coupling_factor_below_one(name: str) -> None:
    actuator = catalogue_actuator(name)
    assert actuator.source.startswith(("Dissertation", "Micromechatronics", "PiezoDrive", "Mechano", "Noliac"))
    if actuator.complete:
        stack = catalogue_stack(actuator, frequency=20e3, mechanical_quality_factor=80.0)
        assert 0.5 < stack.derived_coupling_factor < 0.9
    else:
        with raises(MissingProperty, match="prints no blocked_force"):
            catalogue_stack(actuator, frequency=20e3, mechanical_quality_factor=80.0)


@pytest.mark.parametrize("name", [name for name in catalogue_names() if name.startswith("sa0")])
def test_a_bar_of_the_printed_mass_and_stiffness_has_about_the_printed_resonance(name: str) -> None:
    # a uniform bar with free ends: f = sqrt(k/m)/2; force over range is softer than small signals
    actuator = catalogue_actuator(name)
    assert actuator.actuator_mass is not None
    implied = math.sqrt(actuator.stiffness / actuator.actuator_mass) / 2
    assert 0.45 < implied / actuator.resonance_frequency < 1.1


def test_the_loss_factor_at_the_frequency_is_the_inverse_of_the_quality_factor() -> None:
    stack = catalogue_stack(catalogue_actuator("sa050510"), frequency=20e3, mechanical_quality_factor=80.0)
    assert stack.stack_damping * 2 * math.pi * 20e3 / stack.stack_stiffness == approx(1 / 80)
    assert stack.stack_stiffness == approx(900 / 14e-6)
    assert stack.free_stroke_per_volt == approx(14e-6 / 180)


def test_a_users_catalogue_file_makes_a_flextensional_actuator_usable(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(
        '[sources]\nsheet = "a sheet"\n[amplified]\ntitle = "x"\nkind = "flextensional"\nsource = "sheet"\n'
        "stroke = 52e-6\nstroke_voltage = 150.0\nblocked_force = 190.0\nfree_capacitance = 1.53e-6\n"
        "resonance_frequency = 16e3\n"
    )
    found = read_catalogue(path)["amplified"]
    assert found.source == "a sheet"
    like = FlextensionalActuator(
        stroke=52e-6,
        stroke_voltage=150.0,
        blocked_force=190.0,
        resonance_frequency=16e3,
        free_capacitance=1.53e-6,
        actuator_mass=10e-3,
        mechanical_quality_factor=80.0,
    )
    assert found.moving_mass == approx(like.effective_mass)
    stack = catalogue_stack(found, frequency=16e3, mechanical_quality_factor=80.0)
    assert stack.stack_damping == approx(equivalent_stack(like).stack_damping)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 3", "x: must be a table"),
        ('[x]\ntitle = "x"\nkind = "stack"\nsource = "s"\nstroke = 1.0', "x.stroke_voltage: missing"),
        ("[x]\nstrok = 1.0", "did you mean stroke"),
        ("not toml", "own.toml"),
    ],
)
def test_an_invalid_catalogue_file_is_refused_with_the_entry(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(text)
    with raises(InvalidInput, match=message):
        read_catalogue(path)


def test_a_preload_above_the_limit_of_the_data_sheet_is_refused() -> None:
    with raises(InvalidInput, match="must not exceed 450 N, the limit of sa050510"):
        catalogue_stack(catalogue_actuator("sa050510"), frequency=2e4, mechanical_quality_factor=80, preload=500.0)
    with raises(UnknownName, match="did you mean sa050510"):
        catalogue_actuator("sa05051")
