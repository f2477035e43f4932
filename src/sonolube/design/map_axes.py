"""Default axes of the maps of a rig, about its own operating point."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats
from sonolube.rig import Rig
from sonolube.rig.driven_rig import require_drive

MAP_AXES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "velocity-stress": ("sliding_speed", "normal_load", "voltage_peak_to_peak"),
        "velocity-power": ("sliding_speed", "voltage_peak_to_peak", "normal_load"),
        "frequency-voltage": ("frequency", "voltage_peak_to_peak"),
    }
)
"""Quantities that each kind of map is computed over: the first two along its axes, a third one by panels."""


def default_axes(rig: Rig, *, kind: str) -> dict[str, Floats]:
    """Values of every axis of a map about the operating point of a rig.

    Parameters
    ----------
    rig : Rig
        With a drive voltage.
    kind : str
        Key of `MAP_AXES`.

    Returns
    -------
    dict of str to ndarray
        By quantity: speeds from 10 to 200 mm/s, loads from 0.6 to 1.8 of the rig's, voltages up to the rig's,
        frequencies within a fifth of the rig's.
    """
    drive = require_drive(rig)
    assert drive.voltage_peak_to_peak is not None
    volts = drive.voltage_peak_to_peak or 1.0
    load_is_panel = kind != "velocity-stress"
    axes = {
        "sliding_speed": np.linspace(10e-3, 0.2, 77),
        "normal_load": rig.normal_load * np.linspace(0.6, 1.8, 7 if load_is_panel else 25),
        "voltage_peak_to_peak": volts * (np.linspace(0.02, 1, 50) if load_is_panel else np.linspace(0.2, 1, 5)),
        "frequency": drive.frequency * np.linspace(0.8, 1.2, 161),
    }
    return {name: axes[name] for name in MAP_AXES[kind]}
