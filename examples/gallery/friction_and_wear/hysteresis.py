"""Hysteresis before sliding

Dahl friction of a contact that is moved to and fro. Small strokes are almost elastic; strokes well beyond the
ratio of friction to stiffness (here 1 µm) enclose the work that is lost.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import friction

law = friction.DahlFriction(contact_stiffness=1e6, coulomb_friction_force=1.0)
time = np.linspace(0, 2, 4001)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, stroke in zip(LINES, (5e-6, 2e-6, 0.5e-6), strict=False):
        displacement = stroke * np.sin(2 * np.pi * time)
        velocity = 2 * np.pi * stroke * np.cos(2 * np.pi * time)
        force = friction.dahl_friction_history(law, time=time, relative_velocity=velocity)
        axes.plot(1e6 * displacement, force, linestyle=style, label=f"{1e6 * stroke:g} µm")
    axes.set(xlabel="Displacement [µm]", ylabel="Friction force [N]", ylim=(-1.1, 1.6))
    axes.legend(title="Amplitude", ncols=3, loc="upper center")

if __name__ == "__main__":
    figure.savefig("hysteresis.png", dpi=150)
