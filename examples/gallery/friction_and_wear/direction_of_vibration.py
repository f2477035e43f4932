"""Vibration along, across and oblique to the sliding

Coulomb friction under in-plane vibration. Along the sliding it falls only where the vibration is faster than
the sliding; across, it falls at every velocity, and less.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import friction

ratio = np.linspace(0, 4, 200)  # peak vibration velocity over sliding speed
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, angle in zip(LINES, (0, 30, 60, 90), strict=False):
        reduced = friction.oblique_vibration_ratio(
            sliding_speed=1.0, vibration_velocity=ratio, vibration_direction=np.radians(angle)
        )
        axes.plot(ratio, reduced, linestyle=style, label=f"{angle}°")
    axes.set(xlabel="Vibration velocity over sliding speed [-]", ylabel="Friction ratio [-]", ylim=(0, 1.02))
    axes.legend(title="Angle to the sliding")

if __name__ == "__main__":
    figure.savefig("direction-of-vibration.png", dpi=150)
