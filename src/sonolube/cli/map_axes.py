"""The axes of a map, as asked for or as fits a rig."""

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.sweep_range import values_of
from sonolube.errors import InvalidInput
from sonolube.rig import Rig
from sonolube.rig.driven_rig import DrivenRig, driven_rig

_KEYS = {
    "sliding.sliding_speed": "sliding_speed",
    "contact.normal_load": "normal_load",
    "drive.voltage_peak_to_peak": "voltage_peak_to_peak",
    "drive.frequency": "frequency",
}
_TAKEN = {  # across, up, and a panel to each
    "velocity-stress": ("sliding_speed", "normal_load", "voltage_peak_to_peak"),
    "velocity-power": ("sliding_speed", "voltage_peak_to_peak", "normal_load"),
    "frequency-voltage": ("frequency", "voltage_peak_to_peak"),
}


def axes_of(rig: Rig, kind: str, over: list[str]) -> dict[str, Floats]:
    """Return the values of each axis of a kind of map.

    Raises
    ------
    InvalidInput
        If the rig cannot be mapped, a key is no axis of that map, or across or up there is but one value.
    """
    axes = _usual(driven_rig(rig), kind)
    for key, values in values_of(over).items():
        name = _KEYS.get(key)
        if name not in axes:
            known = ", ".join(long for long, short in _KEYS.items() if short in axes)
            raise InvalidInput(f"--over {key}: no axis of a {kind} map; its axes are {known}")
        if values.size < 2 and name in _TAKEN[kind][:2]:
            raise InvalidInput(f"--over {key}: a {kind} map runs over it, and needs at least 2 values")
        axes[name] = values.astype(np.float64)
    return axes


def _usual(rig: DrivenRig, kind: str) -> dict[str, Floats]:
    volts = rig.voltage_peak_to_peak or 1.0
    many = kind != "velocity-stress"
    loads = rig.normal_load * (np.linspace(0.6, 1.8, 7) if many else np.linspace(0.6, 1.8, 25))
    usual = {
        "sliding_speed": np.linspace(10e-3, 0.2, 77),
        "normal_load": loads,
        "voltage_peak_to_peak": volts * (np.linspace(0.02, 1, 50) if many else np.linspace(0.2, 1, 5)),
        "frequency": rig.drive.frequency * np.linspace(0.8, 1.2, 161),
    }
    return {name: usual[name] for name in _TAKEN[kind]}
