"""Stress below a ball

A ball of 5 mm on steel under 5 N, along the axis. The shear stress is greatest half a contact radius below the
surface: that is where the material yields first.
"""

import matplotlib.pyplot as plt
import numpy as np

import sonolube.models.contact as contact
from sonolube.figure import LINES, publication_style

ball = contact.SphereOnFlat(tip_radius=2.5e-3, effective_modulus=115e9)
load, poisson_ratio = 5.0, 0.3
radius = contact.hertz_contact_radius(ball, normal_load=load)
depth = np.linspace(0, 3 * radius, 200)
axial, radial = contact.hertz_axial_stresses(ball, normal_load=load, depth=depth, poisson_ratio=poisson_ratio)
shear = contact.hertz_axial_shear_stress(ball, normal_load=load, depth=depth, poisson_ratio=poisson_ratio)

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, label, stress in zip(LINES, ("axial", "radial", "greatest shear"), (axial, radial, shear), strict=False):
        axes.plot(1e-6 * stress, 1e6 * depth, linestyle=style, label=label)
    deepest = depth[shear.argmax()]
    axes.plot(1e-6 * shear.max(), 1e6 * deepest, "k.", label=f"its maximum, {1e6 * deepest:.0f} µm deep")
    axes.set(xlabel="Stress [MPa]", ylabel="Depth [µm]")
    axes.invert_yaxis()
    axes.legend(loc="lower left")

if __name__ == "__main__":
    figure.savefig("stress-below-a-ball.png", dpi=150)
