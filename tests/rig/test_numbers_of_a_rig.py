"""Numbers that no rig has are refused by their names, wherever a record of a rig is made."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig import LogNormal, Normal, Rig, load_study, read_rig
from sonolube.rig.friction_and_wear import prescribed_sine
from sonolube.rig.new_rig.pin_and_vibration import FlatPin, RoundPin
from sonolube.rig.record import MeasuredUnder
from sonolube.rig.vibration_direction import VibrationDirection

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


@cache
def rig(name: str = "tribometer") -> Rig:
    return read_rig(RIGS / f"{name}.toml")


@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("normal_load", "must be positive"),
        ("friction_coefficient", "must be positive"),
        ("capacitance", "must be positive"),
        ("sliding_speed", "must not be negative"),
        ("vibration_amplitude", "must not be negative"),
        ("amplitude_per_volt", "must not be negative"),
        ("waveguide_amplitude", "must not be negative"),
    ],
)
def test_a_rig_has_no_number_below_zero_and_zero_only_where_it_means_rest(name: str, least: str) -> None:
    change: dict[str, Any] = {name: -1e-9}
    with raises(InvalidInput, match=f"^{name} {least}"):
        replace(rig(), **change)
    change = {name: 0.0}
    if least == "must be positive":
        with raises(InvalidInput, match=f"^{name} {least}"):
            replace(rig(), **change)
    else:
        assert getattr(replace(rig(), **change), name) == 0.0


def test_words_of_a_rig_are_of_those_that_are_known_and_its_title_is_one() -> None:
    wrong: Any = "mesured"
    with raises(UnknownName, match="source of the amplitude"):
        replace(rig(), amplitude_source=wrong)
    with raises(UnknownName, match="origin of the decay length"):
        replace(rig(), decay_length_origin=wrong)
    with raises(InvalidInput, match="title must not be empty"):
        replace(rig(), title="  ")


@pytest.mark.parametrize("name", ["voltage_peak_to_peak", "frequency", "normal_load"])
def test_conditions_of_a_measured_amplitude_are_positive(name: str) -> None:
    for value in (0.0, -1.0):
        given: dict[str, Any] = {name: value}
        with raises(InvalidInput, match=f"^{name} must be positive"):
            MeasuredUnder(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [({"second_fraction": -0.1, "second_direction": "along"}, "second_fraction must not be negative"),
     ({"second_phase": np.inf, "second_direction": "along"}, "second_phase must be finite"),
     ({"vibration_direction": np.nan}, "vibration_direction must be finite"),
     ({"direction": "torsional", "torsion_radius": 0.0}, "torsion_radius must be positive"),
     ({"direction": "torsional"}, "needs torsion_radius"),
     ({"direction": "along", "torsion_radius": 1e-3}, "torsion_radius belongs to direction"),
     ({"direction": "oblique"}, "direction oblique needs vibration_direction"),
     ({"direction": "along", "second_direction": "along"}, "is that of the vibration itself")],
)  # fmt: skip
def test_a_direction_without_a_meaning_is_refused_by_the_name_of_its_part(given: dict[str, Any], message: str) -> None:
    with raises(InvalidInput, match=message):
        VibrationDirection(**given)


def test_spreads_and_pins_are_positive() -> None:
    with raises(InvalidInput, match="deviation must be positive"):
        Normal(middle=1.0, deviation=0.0)
    with raises(InvalidInput, match="median must be positive"):
        LogNormal(median=0.0, factor=2.0)
    for factor in (1.0, np.inf):
        with raises(InvalidInput, match="factor must be above 1"):
            LogNormal(median=1.0, factor=factor)
    with raises(InvalidInput, match="diameter must be positive"):
        FlatPin(diameter=0.0)
    with raises(InvalidInput, match="tip_radius must be positive"):
        RoundPin(tip_radius=0.0)


def test_an_amplitude_or_load_without_a_meaning_is_refused_where_points_are_computed() -> None:
    with raises(InvalidInput, match="vibration_amplitude"):
        prescribed_sine(rig("bronze_bush"), vibration_amplitude=-1e-6)
    with raises(InvalidInput, match="normal_load must be positive"):
        load_study(rig("bronze_bush"), normal_load=[0.0])
