"""Scans with a known groove, and spectra of a known circuit, as files for the page Data."""

from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.example_files import example_file
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance
from sonolube.models.dynamics import electrical_admittance
from sonolube.rig import read_rig, structure_by_stack

SPACING = 5e-6
GROOVE_DEPTH, GROOVE_WIDTH = 4e-6, 300e-6
"""Depth and width of a groove whose cross-section is a parabola. [m]"""
CIRCUIT = ButterworthVanDyke(
    parallel_capacitance=1.6e-9, branches=(MotionalBranch(resistance=22.0, inductance=1.67e-3, capacitance=636e-12),)
)


def groove_heights() -> Floats:
    """Heights of a tilted, rough plane with a straight groove along y in the middle of x, some missing. [m]"""
    rng = np.random.default_rng(5)
    x, y = SPACING * np.arange(240), SPACING * np.arange(160)
    across = (x - x.mean()) / (GROOVE_WIDTH / 2)
    groove = -GROOVE_DEPTH * np.maximum(0.0, 1 - across**2)
    heights: Floats = groove + 2e-3 * x + 1e-3 * y[:, None] + 50e-9 * rng.standard_normal((160, 240))
    heights[rng.random(heights.shape) < 0.01] = np.nan
    return heights


def write_groove(folder: Path) -> Path:
    """Scan with a groove, whose file lacks the distance of its pixels."""
    path = folder / "groove.npy"
    np.save(path, groove_heights())
    return path


def write_spectrum(folder: Path) -> Path:
    """Spectrum of the circuit with noise of half a percent."""
    f = np.linspace(120e3, 220e3, 401)
    return _write(folder / "transducer.csv", f, circuit_admittance(CIRCUIT, frequency=f))


def write_stack_spectrum(folder: Path) -> Path:
    """Spectrum of the structure of the tribometer with its stack, with noise of half a percent."""
    f = np.linspace(5e3, 60e3, 401)
    stack, in_structure = structure_by_stack(read_rig(example_file("tribometer").source))
    return _write(folder / "holder.csv", f, electrical_admittance(in_structure(stack), frequency=f))


def _write(path: Path, f: np.ndarray, admittance: np.ndarray) -> Path:
    """Columns of frequency, magnitude and phase of the impedance."""
    rng = np.random.default_rng(6)
    z = 1 / admittance * np.exp(0.005 * rng.standard_normal(f.size))
    columns = np.stack([f, np.abs(z), np.degrees(np.angle(z))], 1)
    np.savetxt(path, columns, delimiter=",", header="frequency (Hz),|Z| (ohm),phase (deg)", comments="", fmt="%.9g")
    return path
