"""Recordings as a tribometer writes them, for the tutorial on measurements: friction, Hall probe, force gauge.

Run: python examples/recordings.py measured
"""

import sys
from pathlib import Path

import numpy as np

folder, rng = Path(sys.argv[1] if len(sys.argv) > 1 else "measured"), np.random.default_rng(1)
folder.mkdir(parents=True, exist_ok=True)


def write(name: str, heading: str, *columns: np.ndarray) -> None:
    """Write columns as CSV."""
    np.savetxt(folder / name, np.stack(columns, 1), delimiter=",", header=heading, comments="", fmt="%.9g")
    print(folder / name)


t = np.arange(0, 60, 0.01)
for name, level in {"off-1": 1.0, "off-2": 1.04, "off-3": 0.97, "on-1": 0.62, "on-2": 0.6, "on-3": 0.65}.items():
    force = level * (1 + 0.5 * np.exp(-t / 8)) + 0.05 * np.sin(2 * np.pi * t) + 0.03 * rng.standard_normal(t.size)
    write(f"friction-{name}.csv", "time (s),friction_force (N)", t, force)
volts = 5.0 * np.floor(t / 10)
force = 1 - 0.015 * volts + 0.03 * rng.standard_normal(t.size)
write("staircase.csv", "time (s),voltage_peak_to_peak (V),friction_force (N)", t, volts, force)
turn = 0.4 * t % 1
pulse = 20 * np.exp(-(((turn - 0.5) / 0.03) ** 2)) * ((t < 20) | (t > 22.5)) + 0.3 * rng.standard_normal(t.size)
write("hall.csv", "time (s),magnetic_flux_density (mT)", t, pulse)
x = 80 * np.interp(t, [0, 10, 17, 22, 30, 45, 60], [0, 1, 0.3, 0.8, 0, 1, 0])  # um
bent = np.frompyfunc(lambda held, now: min(max(held, now - 8), now + 8), 2, 1).accumulate(x, dtype=object)
write("gauge.csv", "time (s),displacement (um),applied_force (N)", t, x, 0.03 * x - 0.01 * bent.astype(float))
write("bending.csv", "time (s),displacement (um)", t[:1700], 0.9 * x[:1700])
warm = 22 + 18 * -np.expm1(-np.clip(t - 5, 0, None) / 12) + 0.1 * rng.standard_normal(t.size)
write("heated.csv", "time (s),temperature (degC)", t, warm)
