"""Published tests with vibration along the normal, grouped into rigs with the uncertainty of their inputs."""

from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.models.contact import decay_length, separation
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.validation.published_tests import FrictionTest, friction_tests

REFERENCE_DECAY_LENGTH: Final = 1.5e-6
"""Decay length l_0 of the force of a worn contact, about which that of the population is sought. [m]"""

_RESONANCE: Final = (2.0, 0.7)  # gain of set H over the quasi-static stroke, of which nothing is printed; its spread
_UNSTATED_UNCERTAINTY: Final = 0.05  # of a friction ratio without printed scatter; the printed ones have 0.047


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
    """Sets A to H of the published tests as rigs, of whose decay lengths nothing is known.

    No roughness enters: printed ones, worn or not, do not order the decay lengths that the tests ask for, and the 6 um
    of most records is a guess by comparison standards. On the flextensional actuator of set H the amplitude at
    resonance was not measured: it is the quasi-static stroke times 2, within a factor of 2 (one standard deviation).
    """
    return tuple(_rig(name, tuple(tests)) for name, tests in groupby(friction_tests(), lambda test: test.set_name))


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
    """Sets A to H with the decay length R_q/lambda of their records as reference, which no user has before a test."""
    lengths: dict[str, list[float]] = {}
    for test in friction_tests():
        at_rest = separation(test.contact, normal_load=test.normal_load)
        lengths.setdefault(test.set_name, []).append(float(decay_length(test.contact, separation=at_rest)))
    return tuple(
        replace(
            rig, at=replace(rig.at, conditions=replace(rig.at.conditions, decay_length=np.array(lengths[rig.name])))
        )
        for rig in published_rigs()
    )


def _rig(name: str, tests: tuple[FrictionTest, ...]) -> TestedRig:
    """One set of tests as a rig."""
    gain, amplitude_spread = _RESONANCE if name == "H" else (1.0, AMPLITUDE_ERROR)
    conditions = Conditions(
        vibration_amplitude=np.array([test.vibration_amplitude for test in tests]),
        frequency=np.array([test.frequency for test in tests]),
        sliding_speed=np.array([test.sliding_speed for test in tests]),
        decay_length=np.full(len(tests), REFERENCE_DECAY_LENGTH),
    )
    return TestedRig(
        name=name,
        at=UncertainConditions(
            conditions=conditions, decay_length_spread=None, amplitude_spread=amplitude_spread, amplitude_factor=gain
        ),
        friction_ratio=np.array([test.friction_ratio for test in tests]),
        uncertainty=np.array([test.uncertainty or _UNSTATED_UNCERTAINTY for test in tests]),
    )
