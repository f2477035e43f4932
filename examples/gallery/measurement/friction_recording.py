"""Recording of friction

A recording of one minute as a tribometer writes it (made here by a formula): running-in, the steady level with
its interval, and the wobble of the disc, as `sonolube measure friction` finds them.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import sonolube as sl

rng = np.random.default_rng(1)
time = np.arange(0, 60, 0.02)
force = 0.62 * (1 + 0.5 * np.exp(-time / 8)) + 0.05 * np.sin(2 * np.pi * time) + 0.03 * rng.standard_normal(time.size)
with TemporaryDirectory() as folder:
    path = Path(folder) / "friction.csv"
    np.savetxt(path, np.stack([time, force], 1), delimiter=",", header="time (s),friction_force (N)", comments="")
    figure = sl.measure.friction(path, sliding_speed=0.02, rotation_speed=1.0).plot()

if __name__ == "__main__":
    figure.savefig("friction-recording.png", dpi=150)
