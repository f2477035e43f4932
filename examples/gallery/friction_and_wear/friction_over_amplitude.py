"""Friction over amplitude and speed

Friction with over friction without vibration by asperity stick-slip, for a sine of 20 kHz and a contact whose
stiffness changes by a factor e within 1 µm. Slow sliding gains most.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import friction

amplitude = np.linspace(0, 4e-6, 100)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, speed in zip(LINES, (0.01, 0.03, 0.1, 0.3), strict=False):
        ratio = friction.sine_stick_slip_ratio(
            decay_length=1e-6, vibration_amplitude=amplitude, frequency=20e3, sliding_speed=speed
        )
        axes.plot(1e6 * amplitude, ratio, linestyle=style, label=f"{1e3 * speed:g} mm/s")
    axes.set(xlabel="Vibration amplitude [µm]", ylabel="Friction ratio [-]", ylim=(0, 1.02))
    axes.legend(title="Sliding speed", ncols=2)

if __name__ == "__main__":
    figure.savefig("friction-over-amplitude.png", dpi=150)
