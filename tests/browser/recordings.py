"""Recordings for tests of pages: one with steps of its voltage, and one of a load cell whose columns nobody named."""

from pathlib import Path

import numpy as np

ZERO, INTRINSIC, REDUCTION = 0.05, 1.0, 0.3


def write_recordings(folder: Path) -> tuple[Path, Path]:
    """Paths of `stairs.csv`, with voltage and force, and of `cell.csv`, in ms and with the rest before the sliding."""
    rng, t = np.random.default_rng(1), np.arange(0, 60, 0.01)
    volts = 14.0 * np.floor(t / 20)
    force = INTRINSIC * (1 - REDUCTION * volts / 28) + 0.03 * rng.standard_normal(t.size)
    stairs, cell = folder / "stairs.csv", folder / "cell.csv"
    _write(stairs, "time (s),voltage_peak_to_peak (V),friction_force (N)", t, volts, force)
    _write(cell, "Zeit,Zelle", 1e3 * t, ZERO + force * (t > 4))
    return stairs, cell


def _write(path: Path, heading: str, *columns: np.ndarray) -> None:
    """Write columns as comma-separated values."""
    np.savetxt(path, np.stack(columns, 1), delimiter=",", header=heading, comments="", fmt="%.9g")
