"""Friction analyses of recordings: refusals by channel."""

import numpy as np
import xarray as xr
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction_analysis import analyse_windows

RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def test_a_missing_channel_is_refused_with_the_closest_name() -> None:
    with raises(InvalidInput, match="no channel 'friction_force'; did you mean friction_forces"):
        analyse_windows(recording(seconds(10), friction_forces=np.ones(4000)))
