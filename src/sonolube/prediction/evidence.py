"""Published tests with vibration along the normal, grouped into rigs with the uncertainty of their inputs."""

from dataclasses import dataclass
from functools import cache
from itertools import groupby
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import decay_length, separation
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.validation.published_tests import FrictionTest, friction_tests

_RESONANCE: Final = (
    2.0,
    0.7,
)  # gain of set H over the quasi-static stroke, of which nothing is printed, and its spread
_GUESSED_ROUGHNESS: Final = 0.1  # between rigs with one guessed roughness; the rest is in the scatter between rigs
_RA_OR_RQ: Final = 0.15  # of set B: whether the printed roughness is Ra or Rq is not said
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
    """Sets A to H of the published tests as rigs.

    Returns
    -------
    tuple of TestedRig

    Notes
    -----
    In sets A and C to H the roughness is one guess, that of D Table 3.2. Its common error goes into the parameters of
    the population, and what the rigs differ by into the scatter between rigs; neither is counted twice here. On the
    flextensional actuator of set H the amplitude at resonance was not measured: it is the quasi-static stroke times 2,
    within a factor of 2 (one standard deviation).
    """
    return tuple(_rig(name, tuple(tests)) for name, tests in groupby(friction_tests(), lambda test: test.set_name))


def _rig(name: str, tests: tuple[FrictionTest, ...]) -> TestedRig:
    """One set of tests as a rig."""
    gain, amplitude_spread = _RESONANCE if name == "H" else (1.0, AMPLITUDE_ERROR)
    lengths = [
        decay_length(test.contact, separation=separation(test.contact, normal_load=test.normal_load)) for test in tests
    ]
    conditions = Conditions(
        vibration_amplitude=np.array([test.vibration_amplitude for test in tests]),
        frequency=np.array([test.frequency for test in tests]),
        sliding_speed=np.array([test.sliding_speed for test in tests]),
        decay_length=np.array(lengths, dtype=float),
    )
    return TestedRig(
        name=name,
        at=UncertainConditions(
            conditions=conditions,
            decay_length_spread=_RA_OR_RQ if name == "B" else _GUESSED_ROUGHNESS,
            amplitude_spread=amplitude_spread,
            amplitude_factor=gain,
        ),
        friction_ratio=np.array([test.friction_ratio for test in tests]),
        uncertainty=np.array([test.uncertainty or _UNSTATED_UNCERTAINTY for test in tests]),
    )
