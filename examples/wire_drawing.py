"""Drawing stress of a steel wire through a die that vibrates along it, over the drawing speed, as a figure.

Run: python examples/wire_drawing.py [FOLDER]

Wire and die of G. E. Dieter, Mechanical Metallurgy, example 19.1; the vibration is chosen. Theory alone.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from sonolube.facts.materials import material
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.figure import LINES, publication_style, write_figure
from sonolube.models.friction import drawing_stress, superposed_mean_stress, vibrated_drawing_stress

flow_stress = 1300e6 * np.log(1 / 0.8) ** 0.3 / 1.3  # mean of 1300 MPa strain^0.3 over the pass
die = {"area_reduction": 0.2, "friction_coefficient": 0.09, "die_half_angle": np.radians(6)}
still = drawing_stress(yield_strength=flow_stress, **die)
speed = np.geomspace(0.03, 3, 300)
print(f"without vibration    {1e-6 * still:5.1f} MPa")

with publication_style():
    figure, axes = plt.subplots(figsize=(4.5, 3.2))
    for line, amplitude in zip(LINES, (5e-6, 10e-6, 15e-6), strict=False):
        peak = peak_vibration_velocity(frequency=20e3, vibration_amplitude=amplitude)
        speeds = {"drawing_speed": speed, "vibration_velocity": peak}
        stress = vibrated_drawing_stress(yield_strength=flow_stress, **speeds, **die)
        axes.semilogx(speed, 1e-6 * stress, linestyle=line, label=f"friction reversed, {1e6 * amplitude:.0f} um")
        slow = 1e-6 * np.interp(0.1, speed, stress)
        print(f"{1e6 * amplitude:2.0f} um  critical {peak:.2f} m/s   0.1 m/s {slow:5.1f} MPa")
    steel = material("steel_1045")
    modulus, density = steel.value("youngs_modulus"), steel.value("density")
    strain = peak_vibration_velocity(frequency=20e3, vibration_amplitude=10e-6) / np.sqrt(modulus / density)
    mean = superposed_mean_stress(yield_strength=still, youngs_modulus=modulus, strain_amplitude=strain)
    axes.axhline(1e-6 * mean, color="0.5", linestyle=":", label="superposition alone, 10 um")
    axes.set(xlabel="Drawing speed [m/s]", ylabel="Mean drawing stress [MPa]", ylim=(0, 260))
    axes.legend(loc="lower right")
print(f"10 um  a wave along the wire alone, by superposition {1e-6 * mean:5.1f} MPa")
folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
print(*write_figure(figure, folder=folder, name="wire_drawing"), sep="\n")
