"""Files of exported units: valid, the same each time, and compiled without a warning."""

import os
import subprocess
from collections.abc import Callable
from ctypes import CDLL
from dataclasses import replace
from importlib import import_module
from io import BytesIO
from math import pi
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from tests.design.fmu.conftest import RIGS
from tests.design.fmu.importer import Instance, fmpy, written
from tests.same import same

from sonolube.design.control import ControlDesign, FrictionLoop, simulate_closed_loop
from sonolube.design.fmu import MockUpUnit, PlantTables, c_compiler, controller_unit, plant_unit
from sonolube.rig import operating_points, read_rig

PlantOf = Callable[[PlantTables, str], MockUpUnit]
ControllerOf = Callable[[str], MockUpUnit]
VERSIONS = pytest.mark.parametrize("version", ["2", "3"])


def entries(unit: MockUpUnit) -> dict[str, bytes]:
    """Files of a unit by name."""
    with ZipFile(BytesIO(unit.content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@VERSIONS
def test_units_are_valid(
    collar: PlantTables,
    commanded: PlantTables,
    version: str,
    plant_of: PlantOf,
    controller_of: ControllerOf,
    tmp_path: Path,
) -> None:
    from fmpy.validation import validate_fmu

    for unit in (plant_of(collar, version), plant_of(commanded, version), controller_of(version)):
        path = str(written(unit, tmp_path))
        assert validate_fmu(path) == []
        assert "c-code" in fmpy.supported_platforms(path)
        assert unit.platform


@VERSIONS
def test_sources_compile_without_a_warning(
    collar: PlantTables,
    commanded: PlantTables,
    version: str,
    plant_of: PlantOf,
    controller_of: ControllerOf,
    tmp_path: Path,
) -> None:
    for unit in (plant_of(collar, version), plant_of(commanded, version), controller_of(version)):
        for name, content in entries(unit).items():
            if name.startswith("sources/"):
                (tmp_path / Path(name).name).write_bytes(content)
        compiler = c_compiler()
        assert compiler is not None
        strict = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-fPIC", "-shared")
        command = [compiler, *strict, f"fmi{version}.c", "-o", "unit.so", "-lm"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


@VERSIONS
def test_ranges_units_and_error_are_in_the_description(
    collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path
) -> None:
    description = fmpy.read_model_description(str(written(plant_of(collar, version), tmp_path)))
    by_name = {each.name: each for each in description.modelVariables}
    speed = by_name["sliding_speed"]
    assert (float(speed.min), float(speed.max), speed.unit) == (*collar.ranges.sliding_speed, "m/s")
    assert "slow envelope model" in description.description.lower()
    text = entries(plant_of(collar, version))["modelDescription.xml"].decode()
    assert repr(collar.relative_error) in text
    assert collar.relative_error < 1e-6
    volt = next(each for each in description.unitDefinitions if each.name == "V").baseUnit
    assert (volt.kg, volt.m, volt.s, volt.A) == (1, 2, -3, -1)


@VERSIONS
def test_a_unit_is_the_same_to_the_last_byte(collar: PlantTables, version: str, plant_of: PlantOf) -> None:
    def made(tables: PlantTables) -> MockUpUnit:
        return plant_unit(tables, version=version, identifier="rig_plant", tool="sonolube")  # type: ignore[arg-type]

    assert made(collar).content == made(collar).content
    bare, full = entries(made(collar)), entries(plant_of(collar, version))
    assert {name: full[name] for name in bare} == bare
    assert [name for name in full if name not in bare] == [name for name in full if name.startswith("binaries/")]
    other = entries(made(replace(collar, relative_error=1e-9)))
    assert other["modelDescription.xml"] != bare["modelDescription.xml"]
    assert other["sources/model_data.h"].splitlines()[0] != bare["sources/model_data.h"].splitlines()[0]


def test_without_a_compiler_the_unit_holds_sources_and_says_so(collar: PlantTables, tmp_path: Path) -> None:
    unit = plant_unit(collar, version="3", identifier="rig_plant", tool="sonolube", compiler=None)
    assert unit.platform == ""
    assert "no C compiler" in unit.missing
    assert not any(name.startswith("binaries/") for name in entries(unit))
    assert "sources/buildDescription.xml" in entries(unit)
    broken = plant_unit(collar, version="3", identifier="rig_plant", tool="sonolube", compiler=str(tmp_path / "none"))
    assert "failed" in broken.missing


@VERSIONS
def test_the_controller_commands_what_python_commands(
    study: ControlDesign, version: str, controller_of: ControllerOf, tmp_path: Path
) -> None:
    run, interval = study.run, study.controller.process.sample_interval
    assert run.phase is not None
    commands, frequencies = [], []
    with Instance(controller_of(version), tmp_path) as controller:
        controller.initialize({"friction_force_setpoint": float(run.setpoint[0])})
        for setpoint, measured, phase in zip(run.setpoint, run.measured_force, run.phase, strict=True):
            controller.set(
                {"friction_force_setpoint": float(setpoint), "friction_force": float(measured), "phase": float(phase)}
            )
            controller.step(interval)
            level, frequency = controller.get("voltage_peak_to_peak", "frequency")
            commands.append(level)
            frequencies.append(frequency)
        assert controller.messages == []
    assert commands == pytest.approx(run.level.tolist(), rel=1e-12)
    assert frequencies == pytest.approx(run.frequency.tolist(), rel=1e-12)


def test_the_controller_holds_between_its_samples(
    controller_of: ControllerOf, study: ControlDesign, tmp_path: Path
) -> None:
    interval = study.controller.process.sample_interval
    values = {"friction_force_setpoint": study.friction_force, "phase": -pi / 4}
    with Instance(controller_of("3"), tmp_path) as often, Instance(controller_of("3"), tmp_path) as once:
        for controller in (often, once):
            controller.initialize(values)
        often.steps(70, interval / 7)
        once.steps(10, interval)
        same(often.value("voltage_peak_to_peak"), once.value("voltage_peak_to_peak"))


def test_both_units_close_the_loop_as_python_does(
    collar: PlantTables, study: ControlDesign, plant_of: PlantOf, tmp_path: Path
) -> None:
    rig = read_rig(f"{RIGS}/collar.toml")
    controller, interval = study.controller, study.controller.process.sample_interval
    loop = FrictionLoop(
        plant=study.plant, mode=study.mode, controller=controller, tracker=None, level_maximum=study.level_maximum
    )
    by_python = simulate_closed_loop(loop, setpoint=study.run.setpoint)
    unit = controller_unit(
        controller, None, rig=rig, version="3", identifier="c", tool="sonolube", compiler=c_compiler()
    )
    waiting = [study.plant.highest_force] * controller.process.dead_time_samples
    forces = []
    with Instance(plant_of(collar, "3"), tmp_path) as plant, Instance(unit, tmp_path) as law:
        plant.initialize({})
        law.initialize({})
        for setpoint in study.run.setpoint:
            forces.append(plant.value("friction_force"))
            waiting.append(forces[-1])
            law.set({"friction_force_setpoint": float(setpoint), "friction_force": waiting.pop(0)})
            law.step(interval)
            plant.set({"voltage_peak_to_peak": law.value("voltage_peak_to_peak")})
            plant.step(interval)
    scale = study.plant.highest_force
    # Python's plant is piecewise linear between 41 voltages, the unit's is smooth
    assert np.abs(np.array(forces) - by_python.friction_force).max() < 1e-2 * scale
    assert forces[-1] == pytest.approx(float(study.run.setpoint[-1]), rel=1e-4)


def test_python_and_terminal_export_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sonolube as sl
    from sonolube.cli import main

    monkeypatch.setattr("sonolube.tasks.export.mock_up.c_compiler", lambda: None)
    with pytest.raises(SystemExit):
        main(["export", "fmu", f"{RIGS}/flextensional.toml", "--fmi", "2", "--out", str(tmp_path)])
    answer = sl.export.fmu(f"{RIGS}/flextensional.toml", fmi="2")
    for name, content in answer.files().items():
        assert (tmp_path / name).read_bytes() == content
    assert "flextensional-controller.fmu" in answer.files()
    assert any("no C compiler" in each for each in answer.caveats())


@VERSIONS
def test_the_library_has_every_function_of_the_interface(
    collar: PlantTables, version: str, plant_of: PlantOf, tmp_path: Path
) -> None:
    importer = {"2": "fmpy.fmi2:FMU2Slave", "3": "fmpy.fmi3:FMU3Slave"}[version].split(":")
    functions = [name for name in dir(getattr(import_module(importer[0]), importer[1])) if name.startswith("fmi")]
    assert len(functions) > 25
    name, content = next(each for each in entries(plant_of(collar, version)).items() if each[0].startswith("binaries"))
    path = tmp_path / Path(name).name
    path.write_bytes(content)
    library = CDLL(str(path))
    assert [each for each in functions if not hasattr(library, each)] == []


@VERSIONS
def test_an_importer_compiles_the_sources_by_its_own_build(
    collar: PlantTables, version: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cmake = pytest.importorskip("cmake", reason="cmake is not installed")
    from fmpy.build import build_platform_binary

    monkeypatch.setenv("PATH", cmake.CMAKE_BIN_DIR, prepend=os.pathsep)
    unit = plant_unit(collar, version=version, identifier="rig_plant", tool="sonolube")  # type: ignore[arg-type]
    unzipped = fmpy.extract(str(written(unit, tmp_path)), str(tmp_path / "unit"))
    strict = {"CMAKE_COMPILE_WARNING_AS_ERROR:BOOL": "ON"}
    build_platform_binary(unzipped, build_dir=str(tmp_path), all_warnings=True, cmake_options=strict)
    start = {"voltage_peak_to_peak": 28.0}
    rows = fmpy.simulate_fmu(unzipped, stop_time=0.2, output_interval=0.01, start_values=start)
    assert rows["friction_ratio"][-1] == pytest.approx(float(operating_points(collar.rig).friction_ratio), rel=1e-6)
