"""Elliptical motion of a bar's surface

A bar in its first axial mode bulges where it is strained. Points between node and end move along the bar and
normal to it: on ellipses, where the bulge lags by a quarter of a period.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import COLOURS, publication_style
from sonolube.models import actuator

bar = actuator.BarWaveguide(length=0.127, thickness=0.0254, poisson_ratio=0.3, axial_amplitude=5e-6, frequency=20e3)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 2.8))
    for place in np.linspace(-0.06, 0.06, 9):
        path = actuator.surface_trajectory(bar, position=place, phase=np.pi / 2)
        axes.plot(1e3 * place + 1e6 * path.axial_displacement, 1e6 * path.normal_displacement, color=COLOURS[0])
    axes.set(xlabel="Place along the bar [mm], with 1 µm of motion drawn as 1 mm", ylabel="Normal displacement [µm]")

if __name__ == "__main__":
    figure.savefig("elliptical-motion.png", dpi=150)
