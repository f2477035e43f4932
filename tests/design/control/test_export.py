"""Exported controller: compiled C against the simulation, and the lookup table as CSV."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.design.control import (
    Disturbance,
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    ThermalDrift,
    VibrationMode,
    controller_source,
    lookup_table,
    next_frequency,
    simulate_closed_loop,
    tuned_controller,
    tuned_tracker,
)

COMPILER = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)
MODE = VibrationMode(
    natural_frequency=22e3, damping_ratio=0.02, motional_conductance=0.4, parallel_capacitance=2e-7, frequency=21.95e3
)
VOLTS = np.linspace(0, 40, 9)
CHARACTERISTIC = FrictionCharacteristic(level=VOLTS, friction_force=1.02 / (1 + (VOLTS / 20) ** 2))
PROCESS = Process(time_constant=MODE.time_constant, dead_time=1e-3, sample_interval=2e-4)
TRACKER = tuned_tracker(MODE, sample_interval=2e-4)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")
@pytest.mark.parametrize("feed_forward", [True, False])
def test_the_compiled_controller_commands_the_voltages_of_the_simulation(feed_forward: bool, tmp_path: Path) -> None:
    controller = tuned_controller(CHARACTERISTIC, PROCESS, level_maximum=35.0, feed_forward=feed_forward)
    loop = FrictionLoop(plant=CHARACTERISTIC, mode=MODE, controller=controller, tracker=TRACKER, level_maximum=35.0)
    rng = np.random.default_rng(1)
    setpoint = np.repeat(rng.uniform(0.05, 1.1, 20), 60)  # some below what 35 V attain
    run = simulate_closed_loop(
        loop,
        setpoint=setpoint,
        drift=ThermalDrift(final_temperature_rise=40.0, warming_time=0.1),
        disturbance=Disturbance(friction_factor=1.15, friction_force_deviation=0.02),
    )
    source = tmp_path / "controller.c"
    source.write_text(controller_source(controller, TRACKER, title="a rig /* of */ tests"), encoding="utf-8")
    strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    assert COMPILER is not None
    subprocess.run([COMPILER, *strict, "-shared", "-fPIC", "-o", tmp_path / "controller.so", source], check=True)
    library = ctypes.CDLL(str(tmp_path / "controller.so"))
    library.sonolube_step.restype = library.sonolube_next_frequency.restype = ctypes.c_double
    library.sonolube_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double]
    library.sonolube_next_frequency.argtypes = [ctypes.c_double, ctypes.c_double]
    state = (ctypes.c_double * (2 + PROCESS.dead_time_samples))()
    library.sonolube_reset(state)
    volts = [library.sonolube_step(state, *pair) for pair in zip(run.setpoint, run.measured_force, strict=True)]
    assert np.array(volts) == approx(run.level, abs=1e-9)
    assert run.level.max() == 35.0
    for f, phase in ((21.9e3, -0.3), (22.1e3, 0.4), (1.0, 0.0), (1e6, 0.0)):
        expected = next_frequency(TRACKER, frequency=f, phase=phase)
        assert library.sonolube_next_frequency(f, phase) == approx(expected, abs=1e-9)


def test_the_lookup_table_restores_the_characteristic() -> None:
    controller = tuned_controller(CHARACTERISTIC, PROCESS, level_maximum=35.0)
    head, *rows = lookup_table(controller).splitlines()
    assert head == "friction_force [N],voltage_peak_to_peak [V]"
    read = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    assert read[:, 0] == approx(CHARACTERISTIC.friction_force)
    assert read[:, 1] == approx(CHARACTERISTIC.level)


def test_a_title_cannot_end_its_comment() -> None:
    controller = tuned_controller(CHARACTERISTIC, PROCESS, level_maximum=35.0)
    first = controller_source(controller, None, title="a */ int x; /* b\nc").splitlines()[0]
    assert first.count("*/") == 1
    assert first.endswith("*/")
