"""Summits depend on the sampling

Radius and density of summits of one surface, sampled ever more coarsely: they are no properties of the surface
alone. The rms height falls by a quarter.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import MARKERS, publication_style
from sonolube.models.surfaces import SelfAffineSpectrum, gaussian_surface, sampling_dependence

spectrum = SelfAffineSpectrum(
    hurst_exponent=0.8, longest_wavelength=200e-6, rolloff_wavelength=100e-6, shortest_wavelength=2e-6
)
surface = gaussian_surface(
    rms_height=0.6e-6, spectrum=spectrum, shape=(512, 512), spacing_x=1e-6, spacing_y=1e-6, seed=1
)
found = sampling_dependence(surface, sampling_interval=1e-6 * np.array([1, 2, 4, 8, 16]))
curves = {"rms height": found.rms_height, "summit radius": found.summit_radius, "summit density": found.summit_density}
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for marker, (label, values) in zip(MARKERS, curves.items(), strict=False):
        axes.loglog(1e6 * np.array(found.sampling_interval), values / values[0], marker=marker, label=label)
    axes.set(xlabel="Sampling interval [µm]", ylabel="Over its value at 1 µm [-]")
    axes.legend()

if __name__ == "__main__":
    figure.savefig("sampling-interval.png", dpi=150)
