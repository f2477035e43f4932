"""Scan of a surface

A self-affine surface with 1 % of its pixels missing, as a profilometer would write it, and what `sonolube
measure surface` draws of it.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import sonolube as sl
from sonolube.models.surfaces import SelfAffineSpectrum, gaussian_surface

spectrum = SelfAffineSpectrum(
    hurst_exponent=0.8, longest_wavelength=100e-6, rolloff_wavelength=20e-6, shortest_wavelength=2e-6
)
surface = gaussian_surface(
    rms_height=0.6e-6, spectrum=spectrum, shape=(200, 256), spacing_x=1e-6, spacing_y=1e-6, seed=1
)
surface.height[np.random.default_rng(1).random(surface.height.shape) < 0.01] = np.nan
with TemporaryDirectory() as folder:
    np.save(Path(folder) / "plate.npy", surface.height)
    figure = sl.plot(sl.measure.surface(Path(folder) / "plate.npy", spacing="1 um", length_unit="m"))

if __name__ == "__main__":
    figure.savefig("scan-of-a-surface.png", dpi=150)
