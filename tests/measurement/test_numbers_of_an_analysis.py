"""Settings of analyses that have no meaning are refused by their names, before any sample is looked at."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.stiffness_estimate import single_mode
from sonolube.measurement.friction.rotation import MotorCalibration, disc_rotation, hall_pulse_times
from sonolube.measurement.friction.stated_parts import StatedParts
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction.voltage_steps import voltage_envelope
from sonolube.measurement.friction.windows import steady_state_onset, window_statistics
from sonolube.measurement.statistics.repeated_tests import mean_estimate
from sonolube.measurement.temperature import fit_temperature_response
from sonolube.measurement.vibration import amplitude_per_volt
from sonolube.measurement.wear_track import wear_track_from_grooves

T = np.arange(200) / 100
F = 1.0 + 0.1 * np.sin(T)
MOTOR: dict[str, Any] = {"torque_constant": 0.05, "idle_current": 0.1, "groove_diameter": 0.04}
ONSET: dict[str, Any] = {"time": T, "friction_force": F, "sliding_speed": 0.02}


@pytest.mark.parametrize(
    ("analyse", "message"),
    [
        (lambda: hall_pulse_times(time=T, magnetic_flux_density=F, prominence=0.009), "prominence"),
        (lambda: hall_pulse_times(time=T, magnetic_flux_density=F, prominence=1.01), "prominence"),
        (lambda: disc_rotation(time=np.arange(9.0), groove_diameter=0.0), "groove_diameter must be positive"),
        (lambda: MotorCalibration(**MOTOR | {"torque_constant": 0.0}), "torque_constant must be positive"),
        (lambda: MotorCalibration(**MOTOR | {"groove_diameter": 0.0}), "groove_diameter must be positive"),
        (lambda: MotorCalibration(**MOTOR, idle_current_uncertainty=-0.1), "idle_current_uncertainty must not be"),
        (lambda: MotorCalibration(**MOTOR, torque_constant_uncertainty=-0.1), "torque_constant_uncertainty must not"),
        (lambda: StatedParts(part=(np.nan, 1.0)), "start_time must be finite"),
        (lambda: StatedParts(rests=((0.0, np.inf),)), "end_time must be finite"),
        (lambda: StatedParts(steps=(((0.0, 1.0), -5.0),)), "voltage_peak_to_peak must not be negative"),
        (lambda: estimate_stick_slip(time=T, friction_force=F, minimum_drop=0.0), "minimum_drop must be positive"),
        (lambda: voltage_envelope(time=T, stack_voltage=F, window_duration=0.0), "window_duration must be positive"),
        (lambda: window_statistics(time=T, signal=F, window_duration=0.0), "window_duration must be positive"),
        (lambda: steady_state_onset(**ONSET | {"sliding_speed": 0.0}), "sliding_speed must be positive"),
        (lambda: steady_state_onset(**ONSET, band=0.0), "band must be positive"),
        (lambda: steady_state_onset(**ONSET, least_band=0.0), "least_band must be positive"),
        (lambda: mean_estimate([1.0, 2.0], confidence_level=0.49), "confidence_level"),
        (lambda: mean_estimate([1.0, 2.0], confidence_level=0.99999), "confidence_level"),
        (lambda: fit_temperature_response(time=T, temperature=F, confidence_level=1.0), "confidence_level"),
        (
            lambda: amplitude_per_volt(
                voltage_peak_to_peak=[1, 2, 3], vibration_amplitude=[1, 2, 3], confidence_level=0.4
            ),
            "confidence_level",
        ),
        (lambda: single_mode(modal_mass=0.0, frequency=1.0), "modal_mass must be positive"),
        (lambda: single_mode(modal_mass=1.0, frequency=0.0), "frequency must be positive"),
        (lambda: wear_track_from_grooves([], groove_diameter=0.0, sliding_distance=1.0), "groove_diameter must be"),
        (lambda: wear_track_from_grooves([], groove_diameter=1.0, sliding_distance=0.0), "sliding_distance must be"),
    ],
)
def test_a_setting_without_a_meaning_is_refused_by_its_name(analyse: Callable[[], object], message: str) -> None:
    with raises(InvalidInput, match=message):
        analyse()
