"""Evidence of predictions: friction models with one free parameter each, and published tests grouped into rigs.

The tests have vibration along the normal, and the uncertainty of their inputs; a rig's amplitude stands beside theirs
in decay lengths of the contact's force.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import hypot, log, pi
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers
from sonolube.models.contact import decay_length, separation
from sonolube.models.friction import tabulated_spring_ratio, tabulated_stick_slip_ratio
from sonolube.prediction.published_source import PublishedRig, shipped_sources
from sonolube.rig import ResolvedRig
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.validation.published_tests import FrictionTest, friction_tests


@dataclass(frozen=True, kw_only=True, slots=True)
class Conditions:
    """Conditions of one or many tests of a rig, its vibration along the normal; arrays broadcast.

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

    @property
    def velocity_ratio(self) -> Floats:
        """Sliding speed over peak velocity of the vibration. []"""
        return np.asarray(self.sliding_speed / (2 * pi * self.frequency * self.vibration_amplitude))

    def scaled(self, *, decay_length: Floats) -> "Conditions":
        """Conditions with decay lengths times factors, which broadcast."""
        return replace(self, decay_length=decay_length * self.decay_length)

    def taken(self, rows: Integers) -> "Conditions":
        """Conditions of some tests."""
        names = ("vibration_amplitude", "frequency", "sliding_speed", "decay_length")
        return replace(self, **{name: getattr(self, name)[rows] for name in names})

    def distance(self) -> Floats:
        """Distance from the published tests, with which the discrepancy of a friction model grows."""
        return distance_from_tests(self)


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
    effect : callable
        Share from 0 to 1 of the discrepancy that vibration can cause there, of the same arguments.
    bounds : callable
        Lowest and highest mean friction ratio that physics admits at conditions.
    """

    name: str
    citation: str
    parameter: str
    unit: str
    median: float
    spread: float
    ratio: Callable[[ArrayLike, Conditions], Floats]
    effect: Callable[[ArrayLike, Conditions], Floats]
    bounds: Callable[[Conditions], tuple[ArrayLike, ArrayLike]]


FULL_EFFECT: Final = 0.2
"""Reduction from which on a discrepancy is as large as it becomes. []"""


def normal_effect(log_length: ArrayLike, at: Conditions) -> Floats:
    r"""Share of the discrepancy that vibration along the normal can cause, from 0 to 1. []

    `log_length` is the logarithm of the memory or slip length D_c; it broadcasts against the conditions.

    .. math:: \frac{\min(a/l,\ 0.2)}{0.2}\, \frac{1}{1 + \xi^2}, \qquad \xi = \frac{v_r}{\omega a}\, \frac{l}{D_c}

    At rest friction falls by :math:`1 - e^{-a/l}/I_0(a/l) \le a/l`, and by the friction models not at all from
    :math:`\xi = 1` on: sliding that is faster than the vibration passes a memory length while the load hardly changes.
    """
    speed = at.velocity_ratio * at.decay_length / np.exp(log_length)
    at_rest = np.minimum(at.vibration_amplitude / at.decay_length / FULL_EFFECT, 1.0)
    return np.asarray(at_rest / (1 + speed**2))


def normal_bounds(_: Conditions) -> tuple[ArrayLike, ArrayLike]:
    """Under a dead load, which is the mean of the normal force, vibration along the normal does not raise friction."""
    return 0.0, 1.0


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
        effect=normal_effect,
        bounds=normal_bounds,
    ),
    Closure(
        name="spring_contact",
        citation="M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), flat profile with loss of contact",
        parameter="slip_length",
        unit="m",
        median=2e-6,
        spread=1.0,
        ratio=_spring,
        effect=normal_effect,
        bounds=normal_bounds,
    ),
)
"""Closures that are learned and weighed: in each, contact is loaded, slips and is lost."""


REFERENCE_DECAY_LENGTH: Final = 1.5e-6
"""Decay length l_0 of the force of a worn contact, about which that of the population is sought. [m]"""

UNSTATED_UNCERTAINTY: Final = 0.05
"""Of a friction ratio without printed scatter; the printed ones have 0.047. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class TestedRig:
    """Friction ratios measured on one pair of bodies.

    Parameters
    ----------
    name : str
        Letter of the set, or title of a rig.
    at : UncertainConditions
        Of n tests.
    friction_ratio : ndarray, shape (n,)
        Friction with vibration over friction without. []
    uncertainty : ndarray, shape (n,)
        Standard uncertainty of the ratios.
    """

    __test__ = False

    name: str
    at: UncertainConditions
    friction_ratio: Floats
    uncertainty: Floats


@cache
def published_rigs() -> tuple[TestedRig, ...]:
    """Shipped tests with vibration along the normal as rigs, of whose decay lengths nothing is known.

    No roughness enters: printed ones, worn or not, do not order the decay lengths that the tests ask for, and the 6 um
    of most records is a guess by comparison standards. Where an amplitude was not measured, its file has a median
    factor and a spread.
    """
    return tuple(
        tested_rig(rig, name=rig.section.set) for source in shipped_sources() for rig in source.rigs if rig.is_normal
    )


def tested_rig(rig: PublishedRig, *, name: str) -> TestedRig:
    """Published tests with vibration along the normal as a rig."""
    points = rig.points
    conditions = Conditions(
        vibration_amplitude=np.array([point.vibration_amplitude for point in points], dtype=np.float64),
        frequency=np.array([point.frequency for point in points], dtype=np.float64),
        sliding_speed=np.array([point.sliding_speed for point in points]),
        decay_length=np.full(len(points), REFERENCE_DECAY_LENGTH),
    )
    return TestedRig(
        name=name,
        at=UncertainConditions(
            conditions=conditions,
            decay_length_spread=None,
            amplitude_spread=rig.section.amplitude_spread or AMPLITUDE_ERROR,
            amplitude_factor=rig.section.amplitude_factor,
        ),
        friction_ratio=np.array([point.friction_ratio for point in points]),
        uncertainty=np.array([point.uncertainty or UNSTATED_UNCERTAINTY for point in points]),
    )


@cache
def _tested_logs() -> tuple[Floats, Floats]:
    """Lowest and highest logarithms of amplitude, speed and frequency of the published tests, each of shape (3,)."""
    logs = np.concatenate([_logs(rig.at.conditions) for rig in published_rigs()], axis=1)
    return logs.min(axis=1), logs.max(axis=1)


def distance_from_tests(at: Conditions) -> Floats:
    """Distance of conditions from the range of the published tests in logarithms of amplitude, speed and frequency.

    0 within the range, and towards no vibration, whose limit is known.
    """
    logs, (low, high) = _logs(at), _tested_logs()
    below, above = low[:, None] - logs, logs - high[:, None]
    below[0] = 0.0
    return np.asarray(np.linalg.norm(np.maximum(np.maximum(below, above), 0.0), axis=0))


def _logs(at: Conditions) -> Floats:
    """Logarithms of amplitude, speed and frequency, shape (3, n)."""
    return np.log(np.stack([at.vibration_amplitude, at.sliding_speed, at.frequency]))


@cache
def rigs_by_records() -> tuple[TestedRig, ...]:
    """Published rigs that have records, with the decay length R_q/lambda of these as reference.

    No user has it before a test.
    """
    recorded = {test.set_name for test in friction_tests()}
    found = []
    for rig in published_rigs():
        if rig.name not in recorded:
            continue
        lengths = np.array([_decay_length(test) for test in friction_tests() if test.set_name == rig.name])
        found.append(replace(rig, at=replace(rig.at, conditions=replace(rig.at.conditions, decay_length=lengths))))
    return tuple(found)


_MARGIN = 1.05  # of the largest tested one


@cache
def amplitude_ratios_of_tests() -> tuple[float, float]:
    """Smallest and the largest amplitude of the published tests over the decay length. []"""
    ratios = [test.vibration_amplitude / _decay_length(test) for test in friction_tests()]
    return float(np.min(ratios)), float(np.max(ratios))


def large_amplitude_caveats(resolved: ResolvedRig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Sentence where an amplitude is more decay lengths of a rig's contact than any published test had.

    Empty for amplitudes within the tests.
    """
    ratio = vibration_amplitude / resolved.decay_length
    low, high = amplitude_ratios_of_tests()
    if not ratio > _MARGIN * high:
        return ()
    return (
        f"the amplitude is {ratio:.3g} decay lengths of the contact's force, and the published tests have {low:.2g} to"
        f" {high:.2g}: beyond them the friction model is an extrapolation",
    )


def _decay_length(test: FrictionTest) -> float:
    """Decay length of the contact of a test under its load, in m."""
    at_rest = separation(test.contact, normal_load=test.normal_load)
    return float(decay_length(test.contact, separation=at_rest))
