"""Units of example rigs, made once for all tests."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from sonolube.design.control import Amplifier, ControlDesign, ControlSettings, amplitude_mode, design_control
from sonolube.design.fmu import (
    MockUpUnit,
    PinHeat,
    PlantTables,
    c_compiler,
    controller_unit,
    plant_ranges,
    plant_tables,
    plant_unit,
)
from sonolube.rig import Rig, read_rig, thermal_solid

RIGS = "examples/rigs"
PIN = PinHeat(
    pin=thermal_solid("stainless_steel_316"),
    disc=thermal_solid("aluminium_2024"),
    heat_capacity=1.5,
    thermal_conductance=0.05,
)


@pytest.fixture(scope="session")
def collar() -> PlantTables:
    """Sine of an amplitude per volt, with a resonance and heat."""
    rig = read_rig(f"{RIGS}/collar.toml")
    return plant_tables(rig, plant_ranges(rig), heat=PIN)


@pytest.fixture(scope="session")
def driven_rig() -> Rig:
    """Rig whose structure gives its vibration."""
    return replace(read_rig(f"{RIGS}/tribometer.toml"), amplitude_source="computed")


@pytest.fixture(scope="session")
def driven(driven_rig: Rig) -> PlantTables:
    """Its tables about its operating point."""
    f, load, speed = driven_rig.drive.frequency, driven_rig.normal_load, driven_rig.sliding_speed  # type: ignore[union-attr]
    over = {
        "drive.frequency": (0.999 * f, 1.001 * f),
        "contact.normal_load": (0.9 * load, 1.1 * load),
        "sliding.sliding_speed": (0.7 * speed, 1.3 * speed),
    }
    return plant_tables(driven_rig, plant_ranges(driven_rig, over=over))


@pytest.fixture(scope="session")
def commanded() -> PlantTables:
    """Rig without a voltage, whose amplitude is commanded and whose friction model has no threshold."""
    rig = read_rig(f"{RIGS}/cutter_head.toml")
    return plant_tables(rig, plant_ranges(rig), mode=amplitude_mode(rig, quality_factor=50))


@pytest.fixture(scope="session")
def study() -> ControlDesign:
    """Controller of the collar, with a frequency tracker."""
    rig = read_rig(f"{RIGS}/collar.toml")
    return design_control(rig, ControlSettings(amplifier=Amplifier(voltage_maximum=28.0)))


@pytest.fixture(scope="session")
def plant_of() -> Callable[[PlantTables, str], MockUpUnit]:
    """Function that makes the plant of tables in a version, compiled once."""
    made: dict[tuple[int, str], MockUpUnit] = {}

    def plant(tables: PlantTables, version: str) -> MockUpUnit:
        key = id(tables), version
        if key not in made:
            made[key] = plant_unit(
                tables,
                version=version,  # type: ignore[arg-type]
                identifier="rig_plant",
                tool="sonolube",
                compiler=c_compiler(),
            )
        return made[key]

    return plant


@pytest.fixture(scope="session")
def controller_of(study: ControlDesign) -> Callable[[str], MockUpUnit]:
    """Function that makes the controller in a version."""
    rig = read_rig(f"{RIGS}/collar.toml")
    return lambda version: controller_unit(
        study.controller,
        study.tracker,
        rig=rig,
        version=version,  # type: ignore[arg-type]
        identifier="rig_controller",
        tool="sonolube",
        compiler=c_compiler(),
    )


@pytest.fixture(scope="session", autouse=True)
def _compiler() -> None:
    if c_compiler() is None:
        pytest.skip("no C compiler: install gcc or clang")
