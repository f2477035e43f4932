"""Virtual measurement of a contact's stiffness: spectra of a chain of masses with a spring at its tip, noise and drift.

Shares no code with the analysis: the response is solved frequency by frequency from masses, dampers and springs, and
the equivalent spring of a large vibration is the first harmonic of the force by quadrature.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

Samples = np.ndarray

LOAD = 3.0  # N


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Masses in kg from the tip upwards, springs in N/m and dampers in N s/m between neighbours, damper at the tip."""

    masses: tuple[float, ...]
    springs: tuple[float, ...]
    dampers: tuple[float, ...]
    tip_damper: float

    def matrices(self) -> tuple[Samples, Samples, Samples]:
        """Mass, damping and stiffness matrices."""
        n = len(self.masses)
        damping, stiffness = np.zeros((n, n)), np.zeros((n, n))
        damping[0, 0] = self.tip_damper
        for place, (k, c) in enumerate(zip(self.springs, self.dampers, strict=True)):
            pair = np.zeros(n)
            pair[place], pair[place + 1] = 1, -1
            stiffness += k * np.outer(pair, pair)
            damping += c * np.outer(pair, pair)
        return np.diag(self.masses), damping, stiffness


TRIBOMETER = Chain(masses=(0.1093, 2.48, 0.602), springs=(2e9, 4.56e5), dampers=(30.0, 90.0), tip_damper=702.0)
"""Tip, reaction mass and arm of the reference rig: a resonance at 154 Hz of quality factor 4."""

SONOTRODE = Chain(masses=(0.11, 2.4), springs=(2e9,), dampers=(40.0,), tip_damper=0.0)
"""Tip and reaction mass: a resonance at 22 kHz of quality factor 360."""


def velocity(chain: Chain, f: Samples, *, spring: float, softening: float = 0.0) -> Samples:
    """Velocity of the tip per force on it, with a spring in N/m there and all springs of the chain made softer."""
    mass, damping, stiffness = chain.matrices()
    stiffness = stiffness * (1 - softening)
    stiffness[0, 0] += spring
    found = []
    for omega in 2 * np.pi * f:
        force = np.zeros(len(mass))
        force[0] = 1
        found.append(1j * omega * np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * mass, force)[0])
    return np.array(found)


def noisy(rng: Generator, values: Samples, deviation: float) -> Samples:
    """Values with complex noise of a standard deviation relative to the largest."""
    noise = rng.standard_normal(values.size) + 1j * rng.standard_normal(values.size)
    return np.asarray(values + deviation * np.abs(values).max() * noise / np.sqrt(2))


def equivalent_spring(stiffness: float, *, amplitude: float, decay_length: float) -> float:
    """First harmonic of the force of an exponential contact of constant mean force over the amplitude, in N/m."""
    theta = (np.arange(20000) + 0.5) * 2 * np.pi / 20000
    force = np.exp(-amplitude / decay_length * np.cos(theta))
    force *= stiffness * decay_length / force.mean()
    return float(-2 * np.mean(force * np.cos(theta)) / amplitude)
