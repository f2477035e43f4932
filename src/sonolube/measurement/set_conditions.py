"""Stretches of a recording in which everything that was set is constant, by its channels of set points."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.time_series import constant_stretches

if TYPE_CHECKING:
    import xarray as xr

_SETTINGS: Final = ("motor_on", "sliding_speed_set", "normal_load_set", "lubricant_set", "recording_part")


@dataclass(frozen=True, kw_only=True, slots=True)
class SetConditions:
    """Stretch of a recording at one speed, load and lubricant.

    Parameters
    ----------
    samples : slice
    slides : bool
        Whether the motor is on.
    sliding_speed : float
        NaN where it is not known. [m/s]
    normal_load : float
        NaN where it is not known. [N]
    lubricant : int
        Its number; 0 for none.
    levels : tuple of (slice, float, float)
        Samples of each drive setting, its voltage in V, peak to peak, and its frequency in Hz, both 0 for off.
    """

    samples: slice
    slides: bool
    sliding_speed: float
    normal_load: float
    lubricant: int
    levels: tuple[tuple[slice, float, float], ...]


def set_conditions(recording: "xr.Dataset") -> tuple[SetConditions, ...]:
    """Stretches of a recording at constant conditions, in the order of time.

    Empty where the recording has no set points of the motor.
    """
    if "motor_on" not in recording:
        return ()
    columns = [_column(recording, name) for name in _SETTINGS]
    drive = [_column(recording, name) for name in ("voltage_peak_to_peak_set", "frequency_set")]
    found = []
    for begin, end in constant_stretches(*columns):
        levels = tuple(
            (slice(begin + first, begin + last), float(drive[0][begin + first]), float(drive[1][begin + first]))
            for first, last in constant_stretches(*(column[begin:end] for column in drive))
        )
        motor, speed, load, lubricant, _ = (float(column[begin]) for column in columns)
        found.append(
            SetConditions(
                samples=slice(begin, end),
                slides=motor > 0,
                sliding_speed=speed,
                normal_load=load,
                lubricant=0 if np.isnan(lubricant) else round(lubricant),
                levels=levels,
            )
        )
    return tuple(found)


def _column(recording: "xr.Dataset", name: str) -> Floats:
    """Values of a channel; zeros for a drive that was not used, NaN for others that are missing."""
    if name in recording:
        values: Floats = recording[name].to_numpy()
        return values
    missing = 0.0 if name in ("voltage_peak_to_peak_set", "frequency_set") else np.nan
    return np.full(recording["time"].size, missing)
