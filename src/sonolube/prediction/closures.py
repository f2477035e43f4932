"""Closures: friction ratios of a vibrated contact with one free parameter each, as arrays."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import hypot, log
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers
from sonolube.models.friction import tabulated_spring_ratio, tabulated_stick_slip_ratio


@dataclass(frozen=True, kw_only=True, slots=True)
class Conditions:
    """Conditions of one or many tests of a rig under vibration along the normal; arrays broadcast.

    Parameters
    ----------
    vibration_amplitude : ndarray
        Zero to peak. [m]
    frequency : ndarray
        Of the vibration. [Hz]
    sliding_speed : ndarray
        Mean sliding speed. [m/s]
    decay_length : ndarray
        Length l over which the normal force falls by a factor of e: of the roughness. [m]
    """

    vibration_amplitude: Floats
    frequency: Floats
    sliding_speed: Floats
    decay_length: Floats

    def scaled(self, *, decay_length: Floats) -> "Conditions":
        """Conditions with decay lengths times factors, which broadcast."""
        return replace(self, decay_length=decay_length * self.decay_length)

    def taken(self, rows: Integers) -> "Conditions":
        """Conditions of some tests."""
        names = ("vibration_amplitude", "frequency", "sliding_speed", "decay_length")
        return Conditions(**{name: getattr(self, name)[rows] for name in names})


@dataclass(frozen=True, kw_only=True, slots=True)
class UncertainConditions:
    """Conditions of tests on one rig, with the spread of what was not measured.

    Parameters
    ----------
    conditions : Conditions
        As stated: arrays of shape (n,).
    decay_length_spread : float or None
        Standard deviation of the logarithm of the factor by which all decay lengths may be off, where they were
        measured; None where they are those of the population, whose scatter between rigs is learned.
    amplitude_spread : float
        Standard deviation of the logarithm of the factor by which all amplitudes may be off.
    amplitude_factor : float
        Median of that factor.
    """

    conditions: Conditions
    decay_length_spread: float | None
    amplitude_spread: float
    amplitude_factor: float = 1.0

    def log_length_factor(self, *, length_factor: Floats, length_spread: Floats, deviates: Floats) -> Floats:
        """Logarithm of the factor on decay length over amplitude, on which friction models depend."""
        offset = -log(self.amplitude_factor)
        if self.decay_length_spread is not None:
            return np.asarray(offset + hypot(self.decay_length_spread, self.amplitude_spread) * deviates)
        spread = np.hypot(np.exp(length_spread), self.amplitude_spread)
        return np.asarray(offset + length_factor + spread * deviates)


@dataclass(frozen=True, kw_only=True, slots=True)
class Closure:
    """Friction model with one positive free parameter and its prior distribution.

    Parameters
    ----------
    name : str
        In data and tables.
    citation : str
        Source of the model.
    parameter, unit : str
        Name and SI unit of the free parameter.
    median, spread : float
        Lognormal prior of the parameter: its median, and the standard deviation of its logarithm.
    ratio : callable
        Friction ratio of the logarithm of the parameter and of the conditions.
    """

    name: str
    citation: str
    parameter: str
    unit: str
    median: float
    spread: float
    ratio: Callable[[ArrayLike, Conditions], Floats]


def _stick_slip(log_length: ArrayLike, at: Conditions) -> Floats:
    """Friction ratio by stick-slip of asperities with exponential heights."""
    return tabulated_stick_slip_ratio(
        decay_length=at.decay_length,
        vibration_amplitude=at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        memory_length=np.exp(log_length),
    )


def _spring(log_length: ArrayLike, at: Conditions) -> Floats:
    """Friction ratio by a flat spring whose approach at rest is the decay length, with a free slip length."""
    return tabulated_spring_ratio(
        approach=at.decay_length,
        normal_amplitude=at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        slip_length=np.exp(log_length),
    )


CLOSURES: Final = (
    Closure(
        name="asperity_stick_slip",
        citation="stick-slip of asperities with exponential heights under a load-balanced sine",
        parameter="memory_length",
        unit="m",
        median=1.5e-6,
        spread=1.0,
        ratio=_stick_slip,
    ),
    Closure(
        name="spring_contact",
        citation="M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), flat profile with loss of contact",
        parameter="slip_length",
        unit="m",
        median=2e-6,
        spread=1.0,
        ratio=_spring,
    ),
)
"""Closures that are learned and weighed: in each, contact is loaded, slips and is lost."""
