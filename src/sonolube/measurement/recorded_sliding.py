"""Voltage, speed and rest of a recording, by the channels that it has."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.friction.sliding import Mask, at_rest
from sonolube.measurement.friction.voltage_steps import voltage_envelope

if TYPE_CHECKING:
    import xarray as xr

_MEASURED: Final = ("relative_velocity", "sliding_speed", "rotation_speed")
_SET: Final = ("sliding_speed_set", "motor_on")

_MOVES: Final = 0.05  # of the highest speed
_CHANGES: Final = 0.1  # of the highest speed


def recorded_voltage(recording: "xr.Dataset") -> Floats | None:
    """Peak-to-peak voltage of a recording, from the alternating voltage where it is not recorded; None without both.

    [V]
    """
    if "voltage_peak_to_peak" in recording:
        return _values(recording, "voltage_peak_to_peak")
    if "stack_voltage" not in recording:
        return None
    return voltage_envelope(time=_values(recording, "time"), stack_voltage=_values(recording, "stack_voltage"))


def speed_channel(recording: "xr.Dataset") -> str | None:
    """Name of the channel of the speed: one that was measured, else one that was set; None without any."""
    names = (name for name in (*_MEASURED, *_SET) if name in recording)
    return next((name for name in names if np.isfinite(_values(recording, name)).any()), None)


def recorded_speed(recording: "xr.Dataset") -> Floats | None:
    """Speed of a recording: one that was measured, else the one that was set, 0 where the motor was off.

    In m/s; 1/s of a rotational speed, 1 of a motor that is on. None where no channel tells it.
    """
    name = speed_channel(recording)
    if name is None:
        return None
    speed = _values(recording, name)
    if name in _SET and "motor_on" in recording:
        return np.asarray(np.where(_values(recording, "motor_on") > 0, speed, 0.0))
    return speed


def speed_of_one_direction(recording: "xr.Dataset") -> Floats | None:
    """Speed of a recording by which its steps are separated; None for one that reciprocates, or where it is unknown.

    As `recorded_speed`.
    """
    speed = recorded_speed(recording)
    if speed is None:
        return None
    low, high = np.nanpercentile(speed, [5, 95])
    return None if low * high < 0 else speed


def speed_changes(recording: "xr.Dataset") -> bool:
    """Whether a recording has several sliding speeds, by over a tenth; false where the speed is not known."""
    speed = recorded_speed(recording)
    if speed is None:
        return False
    size = np.abs(speed[np.isfinite(speed)])
    low, high = np.percentile(size[size > _MOVES * size.max()], [5, 95]) if size.any() else (0.0, 0.0)
    return bool(high - low > _CHANGES * high)


def recorded_rest(recording: "xr.Dataset") -> Mask:
    """Whether the surfaces rest at each sample of a recording with `friction_force`, as `at_rest`; shape (samples,)."""
    return at_rest(
        time=_values(recording, "time"),
        friction_force=_values(recording, "friction_force"),
        voltage_peak_to_peak=recorded_voltage(recording),
        sliding_speed=recorded_speed(recording),
    )


def _values(recording: "xr.Dataset", name: str) -> Floats:
    """Values of a channel."""
    values: Floats = recording[name].to_numpy()
    return values
