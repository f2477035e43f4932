"""Descriptions of exported units in both versions, read as XML, against the variables that they are made from."""

from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pint
import pytest
from pytest import approx

from sonolube.design.fmu.variables import (
    _BASE_UNITS,
    Description,
    Variable,
    build_description,
    controller_variables,
    model_description,
    plant_variables,
)
from sonolube.rig import AMPLITUDE, VOLTAGE

KNOWN = Description(
    identifier="rig_plant",
    title='Rig "A" & B',
    text="a <plant>",
    notes={"error": "1e-6", "kind": "plant"},
    step=0.002,
    variables=(
        Variable(name="u", unit="V", description="in", is_input=True, start=1.5, lowest=0.0, highest=28.0),
        Variable(name="ratio", unit="", description="out"),
        Variable(name="rise", unit="K", description="warm", lowest=-5.0),
        Variable(name="f", unit="Hz", description="held", start=2e4, is_sampled=True, symbol="FREQ"),
    ),
)


def parsed(version: Any, described: Description = KNOWN) -> ET.Element:
    return ET.fromstring(model_description(described, version=version, token="{token}", tool="sonolube 1"))


@pytest.mark.parametrize("version", ["2", "3"])
def test_the_head_names_model_token_and_tool(version: str) -> None:
    root = parsed(version)
    assert root.attrib["fmiVersion"] == f"{version}.0"
    assert (root.attrib["modelName"], root.attrib["description"]) == ('Rig "A" & B', "a <plant>")
    assert root.attrib["guid" if version == "2" else "instantiationToken"] == "{token}"
    assert (root.attrib["generationTool"], root.attrib["variableNamingConvention"]) == ("sonolube 1", "flat")
    (abilities,) = root.findall("CoSimulation")
    state = "FMUstate" if version == "2" else "FMUState"
    assert abilities.attrib == {
        "modelIdentifier": "rig_plant",
        "canHandleVariableCommunicationStepSize": "true",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        f"canGetAndSet{state}": "true",
        f"canSerialize{state}": "true",
    }
    (experiment,) = root.findall("DefaultExperiment")
    assert {name: float(text) for name, text in experiment.attrib.items()} == approx(
        {"startTime": 0.0, "stopTime": 2.0, "stepSize": 0.002}
    )
    units = {each.attrib["name"]: {k: int(v) for k, v in each[0].attrib.items()} for each in root.iter("Unit")}
    assert units == {"V": {"kg": 1, "m": 2, "s": -3, "A": -1}, "K": {"K": 1}, "Hz": {"s": -1}, "s": {"s": 1}}


def test_variables_of_version_2_have_their_roles_ranges_and_starts() -> None:
    root = parsed("2")
    rows = [(each.attrib, each[0].attrib) for each in root.iter("ScalarVariable")]
    assert [(each["name"], each["valueReference"], each["description"]) for each, _ in rows] == [
        ("u", "1", "in"),
        ("ratio", "2", "out"),
        ("rise", "3", "warm"),
        ("f", "4", "held"),
    ]
    roles = [(each["causality"], each["variability"], each.get("initial")) for each, _ in rows]
    assert roles == [
        ("input", "continuous", None),
        ("output", "continuous", "calculated"),
        ("output", "continuous", "calculated"),
        ("output", "discrete", "exact"),
    ]
    assert [dict(real) for _, real in rows] == [
        {"unit": "V", "min": "0.0", "max": "28.0", "start": "1.5"},
        {},
        {"unit": "K", "relativeQuantity": "true", "min": "-5.0"},
        {"unit": "Hz", "start": "20000.0"},
    ]
    outputs = [each.attrib["index"] for each in root.findall("ModelStructure/Outputs/Unknown")]
    initial = [each.attrib["index"] for each in root.findall("ModelStructure/InitialUnknowns/Unknown")]
    assert (outputs, initial) == (["2", "3", "4"], ["2", "3"])
    facts = {each.attrib["name"]: each.attrib["value"] for each in root.iter("fact")}
    assert facts == {"error": "1e-6", "kind": "plant"}


def test_variables_of_version_3_have_time_beside_them() -> None:
    root = parsed("3")
    rows = [each.attrib for each in root.iter("Float64")]
    assert (rows[0]["name"], rows[0]["valueReference"], rows[0]["causality"]) == ("time", "0", "independent")
    assert [(each["name"], each["valueReference"]) for each in rows[1:]] == [
        ("u", "1"),
        ("ratio", "2"),
        ("rise", "3"),
        ("f", "4"),
    ]
    assert (rows[1]["min"], rows[1]["max"], rows[1]["start"], rows[1]["unit"]) == ("0.0", "28.0", "1.5", "V")
    assert "start" not in rows[2]
    assert [each.attrib["valueReference"] for each in root.iter("Output")] == ["2", "3", "4"]
    assert [each.attrib["valueReference"] for each in root.iter("InitialUnknown")] == ["2", "3"]
    notes = {each.attrib["type"]: each[0].attrib["value"] for each in root.iter("Annotation")}
    assert notes == {"sonolube.error": "1e-6", "sonolube.kind": "plant"}


def test_sampled_outputs_alone_leave_no_unknown_at_the_start() -> None:
    described = Description(
        identifier="c", title="c", text="c", notes={}, step=1.0, variables=(KNOWN.variables[0], KNOWN.variables[3])
    )
    assert parsed("2", described).find("ModelStructure/InitialUnknowns") is None
    assert [each.attrib["index"] for each in parsed("2", described).findall("ModelStructure/Outputs/Unknown")] == ["2"]


def test_the_sources_are_built_as_c99_with_the_library_of_mathematics() -> None:
    root = ET.fromstring(build_description("rig_plant").encode())
    (build,) = root.findall("BuildConfiguration")
    assert build.attrib["modelIdentifier"] == "rig_plant"
    assert [each.attrib["name"] for each in build.iter("SourceFile")] == ["fmi3.c"]


def tables(quantity: Any, *, current: bool, heat: object) -> Any:
    ranges = SimpleNamespace(
        level=(0.0, 28.0), frequency=(21e3, 23e3), normal_load=(2.0, 4.0), sliding_speed=(0.01, 0.02)
    )
    rig = SimpleNamespace(drive=SimpleNamespace(frequency=22e3), sliding_speed=0.05, normal_load=1.0)
    return SimpleNamespace(ranges=ranges, rig=rig, quantity=quantity, has_current=current, heat=heat)


def test_inputs_of_a_plant_start_within_their_ranges() -> None:
    found = plant_variables(tables(VOLTAGE, current=True, heat=object()))
    level, frequency, speed, load = found[:4]
    assert (level.name, level.unit, level.start, level.lowest, level.highest) == (
        "voltage_peak_to_peak",
        "V",
        0.0,
        0.0,
        28.0,
    )
    assert (frequency.start, frequency.lowest, frequency.highest) == (22e3, 21e3, 23e3)
    assert (speed.name, speed.start) == ("sliding_speed", 0.02)  # 0.05 lies above
    assert (load.name, load.start) == ("normal_load", 2.0)  # 1 N lies below
    assert all(each.is_input and not each.is_sampled for each in found[:4])
    assert level.place == "LEVEL"
    assert load.place == "NORMAL_LOAD"
    assert [each.name for each in found[4:]] == [
        "friction_force",
        "friction_coefficient",
        "friction_ratio",
        "vibration_amplitude",
        "peak_current",
        "phase",
        "temperature_rise",
    ]
    assert not any(each.is_input for each in found[4:])
    bare = plant_variables(tables(AMPLITUDE, current=False, heat=None))
    assert bare[0].name == "vibration_amplitude_setpoint"
    assert bare[0].description == "Commanded amplitude"
    assert [each.name for each in bare[4:]][-1] == "vibration_amplitude"


def test_a_controller_measures_friction_and_with_a_tracker_the_phase() -> None:
    controller: Any = SimpleNamespace(intrinsic_friction_force=1.7, quantity=VOLTAGE)
    setpoint, measured, level = controller_variables(controller, None)
    assert (setpoint.start, setpoint.lowest, setpoint.highest, setpoint.place) == (1.7, 0.0, 1.7, "SETPOINT")
    assert (measured.start, measured.is_input) == (1.7, True)
    assert (level.is_input, level.is_sampled, level.lowest, level.highest) == (False, True, -np.inf, np.inf)
    tracker: Any = SimpleNamespace(frequency=21.9e3)
    *_, phase, frequency, _ = controller_variables(controller, tracker)
    assert (phase.start, phase.lowest, phase.highest) == approx((-np.pi / 2, -np.pi, np.pi))
    assert (frequency.start, frequency.is_sampled, frequency.is_input) == (21.9e3, True, False)


@pytest.mark.parametrize("unit", sorted(_BASE_UNITS))
def test_units_have_the_base_units_of_the_si(unit: str) -> None:
    found = pint.UnitRegistry().Quantity(1.0, unit).to_base_units()
    symbols = {"kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "radian": "rad", "kelvin": "K"}
    assert found.magnitude == approx(1.0)
    assert _BASE_UNITS[unit] == {symbols[name]: power for name, power in found.unit_items()}
