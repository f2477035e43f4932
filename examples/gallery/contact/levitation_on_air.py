"""Levitation on a squeeze film of air

A disc of 50 mm that vibrates at 20 kHz compresses the air below it. The mean gap at which that air carries the
load grows in proportion to the amplitude.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import contact

amplitude = np.linspace(0.2e-6, 5e-6, 60)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, load in zip(LINES, (5.0, 20.0, 100.0), strict=False):
        gap = contact.levitation_gap(normal_load=load, vibration_amplitude=amplitude, face_radius=25e-3, frequency=20e3)
        axes.plot(1e6 * amplitude, 1e6 * gap, linestyle=style, label=f"{load:g} N")
    axes.plot(1e6 * amplitude, 1e6 * amplitude, color="0.5", linewidth=0.8, label="gap = amplitude")
    axes.set(xlabel="Vibration amplitude [µm]", ylabel="Gap [µm]", ylim=(0, None))
    axes.legend()

if __name__ == "__main__":
    figure.savefig("levitation-on-air.png", dpi=150)
