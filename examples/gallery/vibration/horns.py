"""Gain of thin horns

Gain of half-wave horns at 20 kHz over the ratio of their end diameters. The stepped horn gains most for the
same ratio, and pays with stress at its step; theory of thin bars, without the radius of the step.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import publication_style
from sonolube.models import actuator

ratio = np.linspace(1.01, 3, 60)
bar = {"radius": 20e-3, "frequency": 20e3, "wave_speed": 5060.0}
quarter = 5060.0 / 20e3 / 4
conical = [actuator.thin_conical_horn(end_radius=20e-3 / each, **bar).displacement_gain for each in ratio]
exponential = [actuator.thin_exponential_horn(end_radius=20e-3 / each, **bar).displacement_gain for each in ratio]
stepped = [
    actuator.thin_stepped_horn(end_radius=20e-3 / each, end_length=quarter, **bar).displacement_gain for each in ratio
]
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    axes.plot(ratio, np.abs(stepped), label="stepped")
    axes.plot(ratio, np.abs(exponential), "--", label="exponential")
    axes.plot(ratio, np.abs(conical), "-.", label="conical")
    axes.set(xlabel="Diameter over end diameter [-]", ylabel="Displacement gain [-]")
    axes.legend()

if __name__ == "__main__":
    figure.savefig("horns.png", dpi=150)
