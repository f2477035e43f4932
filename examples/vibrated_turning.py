"""Part of the time in which a turning tool cuts that vibrates along the cutting direction, as a figure.

Run: python examples/vibrated_turning.py [FOLDER]

A cutting force that depends neither on the speed nor on the vibration falls in the same proportion. Theory alone.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.figure import LINES, publication_style, write_figure
from sonolube.models.friction import tool_contact_fraction

speed = np.geomspace(0.02, 4, 400)
with publication_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.6, 2.9), layout="constrained")
    for line, amplitude in zip(LINES, (5e-6, 10e-6, 20e-6), strict=False):
        peak = peak_vibration_velocity(frequency=20e3, vibration_amplitude=amplitude)
        part = tool_contact_fraction(cutting_speed=speed, vibration_velocity=peak)
        left.semilogx(speed, part, linestyle=line, label=f"{1e6 * amplitude:.0f} um at 20 kHz")
        at = tool_contact_fraction(cutting_speed=[0.1, 0.5, 1.0], vibration_velocity=peak)
        shares = ", ".join(f"{100 * each:.0f} %" for each in at)
        print(f"{1e6 * amplitude:2.0f} um  critical {60 * peak:3.0f} m/min   at 0.1, 0.5, 1 m/s cuts for {shares}")
    left.set(xlabel="Cutting speed [m/s]", ylabel="Part of the time in contact [-]", ylim=(0, 1.05))
    left.legend()

    time = np.linspace(0, 100e-6, 2000)
    tool = 1e6 * (0.5 * time + 10e-6 * np.cos(2 * np.pi * 20e3 * time))
    front = np.maximum.accumulate(tool)
    right.plot(1e6 * time, tool, color="0.5", label="tool")
    right.plot(1e6 * time, np.where(tool < front, np.nan, tool), linewidth=2.5, label="cutting")
    right.set(xlabel="Time [µs]", ylabel="Position along the cut [µm]", title="0.5 m/s, 10 µm")
    right.legend()
folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
print(*write_figure(figure, folder=folder, name="vibrated_turning"), sep="\n")
