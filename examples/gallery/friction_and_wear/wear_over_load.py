"""Wear with and without vibration

Wear rate of the reference disc over the load by the cube model of D, beside the two rates of D Table 3.4.
Vibration halves the wear of this pair; of other pairs it may raise it.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.figure import publication_style
from sonolube.models import wear
from sonolube.rig import steady_vibration

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
load = np.linspace(0.5, 6, 40)
still = wear.cube_wear_rate(rig.contact, normal_load=load)
amplitude = steady_vibration(rig).vibration_amplitude
vibrating = wear.vibrating_cube_wear_rate(rig.contact, normal_load=load, vibration_amplitude=amplitude)

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    axes.plot(load, 1e12 * still, label="still")
    axes.plot(load, 1e12 * vibrating, linestyle="--", label=f"vibrating, {1e6 * amplitude:.1f} µm")
    axes.plot([3, 3], [25.66, 13.55], "kD", label="D Table 3.4 (computed there)")
    axes.set(xlabel="Normal load [N]", ylabel="Wear rate [mm³/km]", ylim=(0, None))
    axes.legend()

if __name__ == "__main__":
    figure.savefig("wear-over-load.png", dpi=150)
