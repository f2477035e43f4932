"""Scans and spectra as instruments write them, for the tutorial on measurements: plate, transducer, vibrating tip.

Run: python examples/scans_and_spectra.py measured
"""

import sys
from pathlib import Path

import numpy as np

from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance
from sonolube.models.surfaces import SelfAffineSpectrum, gaussian_surface

folder, rng = Path(sys.argv[1] if len(sys.argv) > 1 else "measured"), np.random.default_rng(1)
folder.mkdir(parents=True, exist_ok=True)


def write(name: str, heading: str, *columns: np.ndarray) -> None:
    """Write columns as CSV."""
    np.savetxt(folder / name, np.stack(columns, 1), delimiter=",", header=heading, comments="", fmt="%.9g")
    print(folder / name)


spectrum = SelfAffineSpectrum(
    hurst_exponent=0.8, longest_wavelength=100e-6, rolloff_wavelength=20e-6, shortest_wavelength=2e-6
)
plate = gaussian_surface(
    rms_height=0.6e-6, spectrum=spectrum, shape=(200, 256), spacing_x=1e-6, spacing_y=1e-6, seed=1
).height
plate[rng.random(plate.shape) < 0.01] = np.nan
np.save(folder / "plate.npy", plate)
print(folder / "plate.npy")
branch = MotionalBranch(resistance=22.0, inductance=1.67e-3, capacitance=636e-12)
f = np.linspace(120e3, 220e3, 401)
z = 1 / circuit_admittance(ButterworthVanDyke(parallel_capacitance=1.6e-9, branches=(branch,)), frequency=f)
z *= np.exp(0.005 * rng.standard_normal(f.size))
write("transducer.csv", "frequency (Hz),|Z| (ohm),phase (deg)", f, np.abs(z), np.degrees(np.angle(z)))
t, w = np.arange(0, 2e-3, 1e-6), 2 * np.pi * 22e3
for u in (10, 20, 30):
    velocity = [1e3 * w * 0.06e-6 * u * np.cos(np.pi * k / 6) * np.cos(w * t + 1) for k in range(7)]
    noisy = [v + 3 * rng.standard_normal(t.size) for v in velocity]
    heading = ",".join(f"point {k + 1} (mm/s)" for k in range(7))
    write(f"tip-{u}V.csv", f"time (s),stack_voltage (V),{heading}", t, u / 2 * np.cos(w * t), *noisy)
modes = [np.cos(np.pi * order * np.arange(7) / 6) for order in (1, 2, 3)]
write("modes.csv", "# axial modes of a free bar, at the points", *modes)
