"""The exported plant, run by FMPy: its steady states are Python's, its transients those of the envelope."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.design.fmu.conftest import PIN, RIGS
from tests.design.fmu.importer import Instance, fmpy, written
from tests.same import same

from sonolube.design.control import impedance_phase, mode_admittance, mode_at_drive, next_envelope
from sonolube.design.fmu import MockUpUnit, PlantTables
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.rig import Rig, level_settings, operating_points, read_rig, temperature_point
from sonolube.rig.responses import start_up

PlantOf = Callable[[PlantTables, str], MockUpUnit]
VERSIONS = pytest.mark.parametrize("version", ["2", "3"])
LONG = 60  # time constants, after which e^-60 of a deviation is left


def values_at(tables: PlantTables, share: float) -> dict[str, float]:
    """Inputs at a share of their ranges, of the speed at the opposite one."""
    ranges = tables.ranges
    level = "voltage_peak_to_peak" if tables.has_current else "vibration_amplitude_setpoint"
    parts = {
        level: ranges.level,
        "frequency": ranges.frequency,
        "normal_load": ranges.normal_load,
        "sliding_speed": ranges.sliding_speed[::-1],
    }
    return {name: float(low + share * (high - low)) for name, (low, high) in parts.items()}


def in_python(tables: PlantTables, values: dict[str, float]) -> tuple[float, float]:
    """Friction force and amplitude of the rig by its operating point, at inputs of which the level is the first."""
    point = operating_points(
        tables.rig,
        **level_settings(tables.rig, next(iter(values.values()))),
        frequency=values.get("frequency"),
        normal_load=values.get("normal_load"),
        sliding_speed=values.get("sliding_speed"),
    )
    return float(point.friction_force), float(point.vibration_amplitude)


def settled(unit: MockUpUnit, tables: PlantTables, values: dict[str, float], folder: Path) -> Instance:
    """Instance whose vibration has settled."""
    instance = Instance(unit, folder)
    instance.initialize(values)
    instance.step(LONG / float(tables.resonance["decay_rate"](np.array(values["normal_load"]))))
    return instance


@VERSIONS
@pytest.mark.parametrize("which", ["collar", "commanded", pytest.param("driven", marks=pytest.mark.slow)])
@pytest.mark.parametrize("share", [0.13, 0.5, 0.87])
def test_steady_friction_and_amplitude_are_those_of_python_to_a_millionth(
    which: str, share: float, version: str, plant_of: PlantOf, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    tables: PlantTables = request.getfixturevalue(which)
    values = values_at(tables, share)
    force, amplitude = in_python(tables, values)
    with settled(plant_of(tables, version), tables, values, tmp_path) as plant:
        found, coefficient, height = plant.get("friction_force", "friction_coefficient", "vibration_amplitude")
    assert found == pytest.approx(force, rel=1e-6)
    assert coefficient == pytest.approx(force / values["normal_load"], rel=1e-6)
    assert height == pytest.approx(amplitude, rel=1e-6)


def test_current_and_phase_are_those_of_the_resonance(collar: PlantTables, plant_of: PlantOf, tmp_path: Path) -> None:
    values = {"voltage_peak_to_peak": 20.0}
    mode = mode_at_drive(collar.rig)
    with Instance(plant_of(collar, "3"), tmp_path) as plant:
        plant.initialize(values)
        plant.step(LONG * mode.time_constant)
        current, phase = plant.get("peak_current", "phase")
    assert current == pytest.approx(abs(mode_admittance(mode, frequency=mode.frequency)) * 20.0 / 2, rel=1e-6)
    assert phase == pytest.approx(impedance_phase(mode, frequency=mode.frequency), rel=1e-6)


@VERSIONS
def test_temperature_rises_as_in_python(collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path) -> None:
    heat = {"heat_capacity": PIN.heat_capacity, "thermal_conductance": PIN.thermal_conductance}
    given: dict[str, Any] = {"pin": PIN.pin, "disc": PIN.disc, **heat}
    early, late = (temperature_point(collar.rig, duration=time, **given) for time in (50.0, 2000.0))
    with Instance(plant_of(collar, version), tmp_path) as plant:
        plant.initialize({"voltage_peak_to_peak": 28.0})
        plant.steps(50, 1.0)
        # Python vibrates from the start, the unit after some milliseconds
        assert plant.value("temperature_rise") == pytest.approx(early.temperature_rise, rel=1e-4)
        plant.step(1950.0)
        assert plant.value("temperature_rise") == pytest.approx(late.temperature_rise, rel=1e-6)
        plant.set({"voltage_peak_to_peak": 0.0})
        plant.step(50.0)
        assert plant.value("temperature_rise") > late.temperature_rise  # friction without vibration is higher


def test_one_step_warms_as_many_short_ones(collar: PlantTables, plant_of: PlantOf, tmp_path: Path) -> None:
    names = ("temperature_rise", "friction_force", "phase")
    with Instance(plant_of(collar, "3"), tmp_path) as once, Instance(plant_of(collar, "3"), tmp_path) as often:
        for plant in (once, often):
            plant.initialize({"voltage_peak_to_peak": 28.0, "sliding_speed": 0.03})
        once.step(0.01)
        often.steps(100, 1e-4)
        assert once.get(*names) == pytest.approx(often.get(*names), rel=1e-6)


@VERSIONS
def test_a_step_of_the_voltage_follows_the_exact_envelope(
    collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path
) -> None:
    mode = mode_at_drive(collar.rig)
    rate, envelope = mode.rate(mode.frequency), 0j
    with Instance(plant_of(collar, version), tmp_path) as plant:
        plant.initialize({})
        for volts in (28.0, 28.0, 10.0, 0.0, 19.0):
            plant.set({"voltage_peak_to_peak": volts})
            plant.step(0.7 * mode.time_constant)
            envelope, _ = next_envelope(mode, envelope, level=volts, rate=rate, duration=0.7 * mode.time_constant)
            level = min(abs(envelope) * abs(rate) / mode.decay_rate, 28.0)
            force, amplitude = in_python(collar, {"level": level})
            assert plant.get("friction_force", "vibration_amplitude") == pytest.approx([force, amplitude], rel=1e-6)


BOUND = 0.07  # of the final amplitude, stated in docs/fmu.md
BOUND_RMS = 0.012


@pytest.mark.slow
def test_the_envelope_keeps_within_its_stated_bound_of_every_cycle_of_the_start(
    driven: PlantTables, driven_rig: Rig, plant_of: PlantOf, tmp_path: Path
) -> None:
    assert driven_rig.drive is not None
    f = driven_rig.drive.frequency
    marched = start_up(driven_rig, duration=4e-3).trajectory
    period = np.floor(marched.time * f + 1e-9).astype(int)
    cycles = [np.ptp(marched.contact.displacement[period == k]) / 2 for k in range(period.max())]
    envelope = []
    with Instance(plant_of(driven, "3"), tmp_path) as plant:
        plant.initialize({"voltage_peak_to_peak": driven.ranges.level[1]})
        plant.step(0.5 / f)
        for _ in cycles:
            envelope.append(plant.value("vibration_amplitude"))
            plant.step(1 / f)
    error = (np.array(envelope) - cycles) / cycles[-1]
    assert np.abs(error).max() < BOUND
    assert np.sqrt(np.mean(error**2)) < BOUND_RMS
    assert np.abs(error[-20:]).max() < 2e-3


@VERSIONS
def test_inputs_outside_of_their_range_are_warned_of_and_held_at_the_end(
    collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path
) -> None:
    with (
        Instance(plant_of(collar, version), tmp_path) as inside,
        Instance(plant_of(collar, version), tmp_path) as plant,
    ):
        inside.initialize({"voltage_peak_to_peak": 28.0, "sliding_speed": 0.1})
        plant.initialize({"voltage_peak_to_peak": 30.0, "sliding_speed": 0.2})
        assert inside.step(1e-3) == 0
        assert plant.step(1e-3) == 1
        assert plant.get("friction_force", "peak_current") != [0.0, 0.0]
        same(plant.value("friction_force"), inside.value("friction_force"))
        assert plant.value("voltage_peak_to_peak") == 30.0
        assert len(plant.messages) == 2
        assert "sliding_speed is 0.2 m/s at 0 s, outside of 0.025 to 0.1 m/s" in plant.messages[1]
        plant.set({"voltage_peak_to_peak": 28.0, "sliding_speed": 0.05})
        assert plant.step(1e-3) == 0
        assert not inside.messages


@VERSIONS
def test_what_has_no_meaning_is_refused(collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path) -> None:
    with Instance(plant_of(collar, version), tmp_path) as plant:
        with pytest.raises(fmpy.fmi1.FMICallException, match="status 3"):
            plant.step(1e-3)  # before initialization
        plant.time = 0.0
        plant.initialize({"voltage_peak_to_peak": 5.0})
        with pytest.raises(fmpy.fmi1.FMICallException, match="status 2"):
            plant.set({"voltage_peak_to_peak": float("nan")})
        with pytest.raises(fmpy.fmi1.FMICallException, match="status 3"):
            plant.set({"friction_force": 1.0})
        with pytest.raises(fmpy.fmi1.FMICallException, match="status 3"):
            plant.step(-1e-3)
        assert plant.value("voltage_peak_to_peak") == 5.0
        assert any("must be finite" in each for each in plant.messages)


@VERSIONS
def test_reset_and_restored_states_repeat_the_run_and_instances_do_not_meet(
    collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path
) -> None:
    names = ("friction_force", "vibration_amplitude", "temperature_rise", "phase")
    with Instance(plant_of(collar, version), tmp_path) as plant, Instance(plant_of(collar, version), tmp_path) as other:
        plant.initialize({"voltage_peak_to_peak": 28.0})
        other.initialize({"voltage_peak_to_peak": 3.0})
        plant.steps(3, 1e-3)
        kept, time = plant.snapshot(), plant.time
        other.step(1e-3)
        plant.steps(3, 1e-3)
        first = plant.get(*names)
        plant.restore(kept, time)
        plant.steps(3, 1e-3)
        same(plant.get(*names), first)
        other.restore(kept, time)
        other.steps(3, 1e-3)
        same(other.get(*names), first)
        plant.reset()
        plant.initialize({"voltage_peak_to_peak": 28.0})
        plant.steps(6, 1e-3)
        same(plant.get(*names), first)


def test_a_unit_is_simulated_by_the_importer_alone(collar: PlantTables, plant_of: PlantOf, tmp_path: Path) -> None:
    for version in ("2", "3"):
        path = str(written(plant_of(collar, version), tmp_path))
        start = {"voltage_peak_to_peak": 28.0}
        rows = fmpy.simulate_fmu(path, stop_time=0.2, output_interval=1e-3, start_values=start)
        force, _ = in_python(
            collar,
            {
                "level": 28.0,
                "frequency": 25e3,
                "normal_load": collar.rig.normal_load,
                "sliding_speed": collar.rig.sliding_speed,
            },
        )
        assert rows["friction_force"][-1] == pytest.approx(force, rel=1e-6)


def test_rigs_without_a_plant_are_refused_with_a_remedy() -> None:
    from sonolube.design.fmu import plant_ranges, plant_tables

    fixed = read_rig(f"{RIGS}/poisson_al_steel.toml")
    with pytest.raises(InvalidInput, match="does not follow the voltage; choose the amplitude computed"):
        plant_tables(fixed, plant_ranges(fixed))
    collar = read_rig(f"{RIGS}/collar.toml")
    with pytest.raises(InvalidInput, match="holds at 25 kHz only"):
        plant_ranges(collar, over={"drive.frequency": (24e3, 26e3)})
    with pytest.raises(InvalidInput, match="no input of the plant"):
        plant_ranges(collar, over={"contact.nominal_area": (1e-6, 2e-6)})
    heavy = plant_ranges(collar, over={"contact.normal_load": (1.0, 1e5)})
    with pytest.raises(OutsideRange, match="lower the load"):
        plant_tables(collar, heavy)
