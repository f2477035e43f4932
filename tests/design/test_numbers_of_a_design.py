"""Numbers that no design has are refused by their names, wherever one of its records is made."""

from collections.abc import Callable
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from pytest import raises

from sonolube.design.control import FrictionCharacteristic, FrictionLoop, Process, VibrationMode, tuned_controller
from sonolube.design.control.closed_loop_simulation import Disturbance, ThermalDrift
from sonolube.design.control.control_design import ControlSettings
from sonolube.design.control.process import PIGains
from sonolube.design.control.resonance_tracking import Amplifier, swing_limit
from sonolube.design.test_plan.candidates import Factors
from sonolube.design.test_plan.comparison import COMPARISONS
from sonolube.design.test_plan.plan import Procedure
from sonolube.errors import InvalidInput

MODE: dict[str, Any] = {"natural_frequency": 22e3, "damping_ratio": 0.02, "frequency": 22e3}
PROCESS: dict[str, Any] = {"time_constant": 1e-3, "dead_time": 1e-3, "sample_interval": 2e-4}


def loop(level_maximum: float) -> FrictionLoop:
    line = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))
    controller = tuned_controller(line, Process(**PROCESS), level_maximum=50.0)
    return FrictionLoop(
        plant=line, mode=VibrationMode(**MODE), controller=controller, tracker=None, level_maximum=level_maximum
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Process(**PROCESS | {"time_constant": 0.0}), "time_constant must be positive"),
        (lambda: Process(**PROCESS | {"sample_interval": 0.0}), "sample_interval must be positive"),
        (lambda: Process(**PROCESS | {"dead_time": -1e-9}), "dead_time must not be negative"),
        (lambda: PIGains(proportional_gain=0.0, integral_time=1.0), "proportional_gain must be positive"),
        (lambda: PIGains(proportional_gain=1.0, integral_time=0.0), "integral_time must be positive"),
        (lambda: VibrationMode(**MODE | {"damping_ratio": 0.0}), "damping_ratio must be positive"),
        (lambda: VibrationMode(**MODE, motional_conductance=0.0, parallel_capacitance=1e-9), "motional_conductance"),
        (lambda: VibrationMode(**MODE, motional_conductance=0.1), "needs both motional_conductance and parallel"),
        (lambda: ThermalDrift(warming_time=0.0), "warming_time must be positive"),
        (lambda: ThermalDrift(final_temperature_rise=nan), "final_temperature_rise must be finite"),
        (lambda: Disturbance(friction_factor=0.0), "friction_factor must be positive"),
        (lambda: Disturbance(later_factor=0.0), "later_factor must be positive"),
        (lambda: Disturbance(start_time=-1e-9), "start_time must not be negative"),
        (lambda: Disturbance(friction_force_deviation=-1e-9), "friction_force_deviation must not be negative"),
        (lambda: loop(0.0), "level_maximum must be positive"),
        (lambda: ControlSettings(duration=0.0), "duration must be positive"),
        (lambda: ControlSettings(sample_interval=0.0), "sample_interval must be positive"),
        (lambda: Amplifier(voltage_maximum=0.0), "voltage_maximum must be positive"),
        (lambda: Amplifier(voltage_maximum=inf), "voltage_maximum must be"),
        (lambda: Amplifier(voltage_maximum=1.0, current_maximum=0.0), "current_maximum must be positive"),
        (lambda: Amplifier(voltage_maximum=1.0, slew_rate_maximum=-1.0), "slew_rate_maximum must be positive"),
        (lambda: swing_limit(Amplifier(voltage_maximum=1.0), admittance=1j, frequency=0.0), "frequency must be"),
        (lambda: factors(normal_load=0.0), "normal_load must be positive"),
        (lambda: factors(sliding_speed=0.0), "sliding_speed must be positive"),
        (lambda: factors(vibration_amplitude=0.0), "vibration_amplitude must be positive"),
        (lambda: Procedure(intrinsic_distance=-1.0, vibrated_distance=1.0), "intrinsic_distance must not be negative"),
        (lambda: Procedure(intrinsic_distance=1.0, vibrated_distance=-1.0), "vibrated_distance must not be negative"),
        (
            lambda: Procedure(intrinsic_distance=0.0, vibrated_distance=0.0, measuring_time=0.0),
            "measuring_time must be",
        ),
    ],
)
def test_a_number_without_a_meaning_is_refused_by_its_name(make: Callable[[], object], message: str) -> None:
    with raises(InvalidInput, match=message):
        make()


def factors(**change: float) -> Factors:
    known = {"normal_load": 3.0, "sliding_speed": 0.02, "vibration_amplitude": 1e-6} | change
    return Factors(**{name: np.array([value]) for name, value in known.items()})


@pytest.mark.parametrize("name", COMPARISONS)
def test_a_difference_to_be_found_and_its_chances_are_possible(name: str) -> None:
    usual = {"difference": 0.1, "deviation": 0.1, "power": 0.8, "significance": 0.05}
    for change in ({"difference": 0.0}, {"deviation": 0.0}, {"power": 1.0}, {"significance": 0.0}, {"power": 0.0}):
        with raises(InvalidInput, match=next(iter(change))):
            COMPARISONS[name].replicates(**usual | change)
