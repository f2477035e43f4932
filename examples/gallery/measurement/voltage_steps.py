"""Friction by steps of voltage

The drive voltage rises every ten seconds; each step has its own level of friction with its interval. One
recording gives the whole curve of friction over voltage.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import sonolube as sl

rng = np.random.default_rng(1)
time = np.arange(0, 60, 0.02)
volts = 5.0 * np.floor(time / 10)
force = 1 - 0.015 * volts + 0.03 * rng.standard_normal(time.size)
with TemporaryDirectory() as folder:
    path = Path(folder) / "staircase.csv"
    header = "time (s),voltage_peak_to_peak (V),friction_force (N)"
    np.savetxt(path, np.stack([time, volts, force], 1), delimiter=",", header=header, comments="")
    measured = sl.measure.friction(path)
    figure = sl.plot(measured, title=list(measured.figures())[-1])

if __name__ == "__main__":
    figure.savefig("voltage-steps.png", dpi=150)
