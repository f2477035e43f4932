"""Wear of the tribometer's disc per kilometre, with and without vibration, at several loads.

Run: python examples/wear_with_and_without.py
"""

from pathlib import Path

import numpy as np

from sonolube.models.wear import cube_wear_rate, vibrating_cube_wear_rate
from sonolube.rig import read_rig, steady_vibration

rig = read_rig(Path(__file__).parent / "rigs" / "tribometer.toml")
loads = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
still = cube_wear_rate(rig.contact, normal_load=loads)
amplitude = steady_vibration(rig).vibration_amplitude
vibrating = vibrating_cube_wear_rate(rig.contact, normal_load=loads, vibration_amplitude=amplitude)

lines = [f"{rig.title}, {1e6 * amplitude:.2g} um", "load [N]   still [mm3/km]   vibrating [mm3/km]   reduction"]
for load, before, after in zip(loads, 1e12 * still, 1e12 * vibrating, strict=True):  # m2 to mm3/km
    lines.append(f"{load:8.1f}   {before:14.2f}   {after:18.2f}   {1 - after / before:9.1%}")
print("\n".join(lines))
