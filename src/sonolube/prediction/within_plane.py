"""Vibration within the plane of contact: Coulomb's law with the discrepancy of vibration along the normal.

The friction ratio of test i on rig r is

    R_i = R_C(zeta_i e^x) + delta_r + e_i,    x ~ N(0, s_a^2),

with Coulomb's closed form R_C of the velocity ratio zeta = v_r/(omega a) and of the direction, and the error x of the
amplitude. The law has no parameter to learn. The discrepancy delta_r is that of `hierarchy`; its sigma is that learned
from vibration along the normal, weighed by the published points within the plane, each on a rig of its own. They are
few, so that its width stays near that of the normal. It grows with the distance from these points: in ln zeta below the
smallest tested one, by up to 1 with the sine of the angle to the sliding, along which all of them are, and by up to 1
from a line to a circle; both 1 are assumptions. Towards no vibration the distance is 0, since that limit is known. Of
an ellipse zeta is taken with the line of the same mean square, and the sine is that of its sides.

A part along the normal beside one within the plane is not predicted: no one law has both limits, since Coulomb's leaves
friction under vibration along the normal as it is and asperity stick-slip keeps 0.63 of the friction along the sliding
where 0.30 was measured, and by Coulomb's law the phase between both decides: in the example `vibrating_base.toml` a
fifth of the amplitude along the normal moves the ratio from 0.06 to anything between -0.13 and 0.25.
"""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import hypot, pi, sin
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.models.contact import ContactMotion
from sonolube.models.friction import oblique_vibration_ratio, parallel_vibration_ratio
from sonolube.models.friction.laws.coulomb import ring_directions
from sonolube.models.friction.models.coulomb import sampled_coulomb_ratio
from sonolube.prediction.evidence import (
    REFERENCE_DECAY_LENGTH,
    UNSTATED_UNCERTAINTY,
    Closure,
    Conditions,
    TestedRig,
    UncertainConditions,
)
from sonolube.prediction.hierarchy import OWN_DEVIATES, standard_normals
from sonolube.prediction.posterior import Posterior, RigDraws, learned, systematic_rows
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.validation.published_tests import InPlaneTest, in_plane_tests

NO_WEAR: Final = (
    "Wear is not predicted: neither a wear law nor a published wear test is of vibration within the plane; measure it."
)
"""Sentence in place of wear."""

NO_HEAT: Final = "within the plane friction heats along the whole path of the vibration; use sonolube thermal"
"""Why a prediction within the plane has no temperature rise."""

NO_LENGTH_ERROR: Final = 1e-9
"""Deviation of the logarithm of the decay length, on which Coulomb's law does not depend."""

_NODES: Final = 64  # of the integral over what one rig has of its own
_RING: Final = 12  # directions of a turning ring: an error of 4e-7
_ALONG: Final = 1e-9  # sine below which a direction is along the sliding
_UNTESTED_DIRECTION: Final = 1.0  # distance of a direction across the sliding: an assumption
_UNTESTED_ELLIPSE: Final = 1.0  # distance of a circle from a line: an assumption
_STILL: Final = ContactMotion(
    displacement=np.zeros(16384), normal_force=np.ones(16384), frequency=0.5 / pi, normal_load=1.0
)
"""Period without vibration, at 1 rad/s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlaneConditions(Conditions):
    """Conditions of tests under vibration within the plane; the decay length carries the amplitude's error alone.

    Parameters
    ----------
    direction : VibrationDirection
        In one direction of the plane, torsional, or an ellipse within the plane.
    """

    direction: VibrationDirection

    @property
    def velocity_ratio(self) -> Floats:
        """Sliding speed over peak velocity of the vibration, by the amplitude with its error. []"""
        peak = 2 * pi * self.frequency * self.vibration_amplitude
        return np.asarray(self.sliding_speed / peak * (self.decay_length / REFERENCE_DECAY_LENGTH))

    def distance(self) -> Floats:
        """Distance from the published points within the plane."""
        size, sine, roundness = _shape(self.direction)
        zeta = self.velocity_ratio / size
        below = np.maximum(np.log(tested_velocity_ratios()[0] / zeta), 0.0)
        untested = np.hypot(_UNTESTED_DIRECTION * sine, _UNTESTED_ELLIPSE * roundness)
        return np.asarray(np.hypot(below, untested * np.minimum(1 / zeta, 1.0)))


def within_plane(at: Conditions, direction: VibrationDirection) -> PlaneConditions:
    """Conditions with a direction within the plane."""
    return PlaneConditions(
        vibration_amplitude=at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        decay_length=at.decay_length,
        direction=direction,
    )


def is_predicted(direction: VibrationDirection) -> bool:
    """Whether a vibration is within the plane alone."""
    return direction.is_in_plane and "normal" not in direction.parts


def coulomb_ratio(direction: VibrationDirection, *, velocity_ratio: ArrayLike) -> Floats:
    """Friction ratio by Coulomb's law, at velocity ratios of any shape, across the sliding to 1e-4."""
    zeta = np.asarray(velocity_ratio, dtype=np.float64)
    if _is_along(direction):
        return parallel_vibration_ratio(sliding_speed=zeta, vibration_velocity=1.0)
    return np.interp(np.log(zeta), *_table(direction))


@lru_cache(maxsize=16)
def _table(direction: VibrationDirection) -> tuple[Floats, Floats]:
    """Logarithms of velocity ratios, dense about 1, and the ratio at each."""
    beside = np.geomspace(1e-6, 0.1, 80)
    zeta = np.unique(
        np.concatenate([np.geomspace(1e-5, 0.9, 280), 1 - beside, 1 + beside, np.geomspace(1.1, 1e3, 160)])
    )
    if direction.second_direction is not None:
        reversal = abs(direction.components()[1])  # from which on the sliding is not reversed
        zeta = np.unique(np.concatenate([zeta, reversal * zeta[zeta > _ALONG]])) if reversal > _ALONG else zeta
        return np.log(zeta), sampled_coulomb_ratio(direction.within_plane(_STILL, vibration_amplitude=1.0), zeta)
    angles, weights = ring_directions(_RING) if direction.angle is None else (np.array([direction.angle]), np.ones(1))
    found = oblique_vibration_ratio(
        sliding_speed=zeta[:, None], vibration_velocity=1.0, vibration_direction=np.asarray(angles)
    )
    return np.log(zeta), np.asarray(found @ weights)


def _shape(direction: VibrationDirection) -> tuple[float, float, float]:
    """Size over the amplitude, size of the sine of the angle to the sliding, and roundness from a line to a circle.

    A ring, which is in every direction, has the sine 1.
    """
    if direction.second_direction is None:
        return 1.0, 1.0 if direction.angle is None else abs(sin(direction.angle)), 0.0
    _, along, across = direction.components()
    size = hypot(abs(along), abs(across))
    return size, abs(across) / size, 2 * abs((along * across.conjugate()).imag) / size**2


def _is_along(direction: VibrationDirection) -> bool:
    """Whether a vibration is along the sliding alone."""
    return direction.second_direction is None and _shape(direction)[1] < _ALONG


def _ratio(_: ArrayLike, at: Conditions) -> Floats:
    """Coulomb's law, which has no parameter."""
    assert isinstance(at, PlaneConditions)
    return coulomb_ratio(at.direction, velocity_ratio=at.velocity_ratio)


COULOMB: Final = Closure(
    name="coulomb",
    citation="W. Littmann, H. Storck and J. Wallaschek 2001; V. C. Kumar and I. M. Hutchings 2004",
    parameter="none",
    unit="",
    median=1.0,
    spread=0.0,
    ratio=_ratio,
)
"""Coulomb's law within the plane."""


@cache
def plane_rigs() -> tuple[TestedRig, ...]:
    """Published points within the plane, each on a rig of its own, with the uncertainty of those without scatter.

    Only the velocity of their vibration counts, so that it stands for the amplitude at 1 rad/s.
    """
    return tuple(_rig(test) for test in in_plane_tests())


def _rig(test: InPlaneTest) -> TestedRig:
    """A published point as a rig."""
    conditions = PlaneConditions(
        vibration_amplitude=np.array([test.vibration_velocity]),
        frequency=np.array([0.5 / pi]),
        sliding_speed=np.array([test.sliding_speed]),
        decay_length=np.array([REFERENCE_DECAY_LENGTH]),
        direction=VibrationDirection(vibration_direction=test.vibration_direction),
    )
    return TestedRig(
        name=f"{test.label} of {test.study}",
        at=UncertainConditions(
            conditions=conditions, decay_length_spread=NO_LENGTH_ERROR, amplitude_spread=AMPLITUDE_ERROR
        ),
        friction_ratio=np.array([test.friction_ratio]),
        uncertainty=np.array([UNSTATED_UNCERTAINTY]),
    )


@cache
def tested_velocity_ratios() -> tuple[float, float]:
    """Smallest and largest velocity ratio of the published points within the plane. []"""
    ratios = [test.sliding_speed / test.vibration_velocity for test in in_plane_tests()]
    return min(ratios), max(ratios)


@cache
def plane_posterior(*, without: tuple[int, ...] = ()) -> Posterior:
    """Posterior within the plane: draws learned along the normal, resampled by the likelihood of the published points.

    Parameters
    ----------
    without : tuple of int
        Places of published points that are left out.
    """
    known = learned().friction.hyperparameters
    logs = np.zeros(len(known))
    for place, rig in enumerate(plane_rigs()):
        if place not in without:
            logs += _log_likelihood(rig, known)
    rows = systematic_rows(logs, len(known), np.random.default_rng(0))
    return Posterior(closure=COULOMB, hyperparameters=known[rows])


def _log_likelihood(rig: TestedRig, hyperparameters: Floats) -> Floats:
    """Logarithm of the likelihood of a rig by each row of hyperparameters, over what the rig has of its own."""
    rows = np.repeat(np.arange(len(hyperparameters)), _NODES)
    deviates = np.tile(standard_normals(_NODES, columns=OWN_DEVIATES, seed=1), (len(hyperparameters), 1))
    posterior = Posterior(closure=COULOMB, hyperparameters=hyperparameters)
    densities = RigDraws(posterior, rig.at, rows, deviates, own=rig).log_density().reshape(-1, _NODES)
    return np.asarray(np.logaddexp.reduce(densities, axis=1) - np.log(_NODES))


def tested_words(direction: VibrationDirection) -> str:
    """How far Coulomb's law was tested in a direction, as the beginning of a sentence."""
    if _is_along(direction):
        return f"Vibration {direction.text}, by Coulomb's law tested with {len(plane_rigs())} published points"
    return f"Vibration {direction.text}, by theory alone (Coulomb's law, compared with no experiment)"


def plane_caveats(direction: VibrationDirection) -> tuple[str, ...]:
    """How far a prediction within the plane was tested, where its width is from, and what the law leaves out."""
    points = " and ".join(
        f"{rig.name} ({float(rig.friction_ratio[0]):.2f} where the law has"
        f" {float(COULOMB.ratio(0.0, rig.at.conditions)[0]):.2f})"
        for rig in plane_rigs()
    )
    low, high = tested_velocity_ratios()
    count = len(plane_rigs())
    tested = f"{count} published points along the sliding, {points}, at v_r/(omega a) of {low:.2g} to {high:.2g}"
    first = f"vibration {direction.text}: Coulomb's law tested with {tested}, and with no others"
    width = "the width of its intervals is taken from vibration along the normal, since so few points hardly change it"
    if not _is_along(direction):
        first = (
            f"vibration {direction.text}: theory alone, Coulomb's law compared with no experiment; known are {tested}"
        )
        width += "; for an untested direction it is larger, by an assumption"
    compliance = "Coulomb's law has no compliance: a contact that yields by as much as the amplitude has more friction"
    return first, width, compliance


def plane_extrapolation(at: Conditions) -> tuple[str, ...]:
    """Sentence where the sliding is slower, against the vibration, than in any published point within the plane."""
    assert isinstance(at, PlaneConditions)
    zeta, low = float(at.velocity_ratio[0]) / _shape(at.direction)[0], tested_velocity_ratios()[0]
    if zeta >= low / 1.05:
        return ()
    return (
        f"outside the range of the published points, so that the prediction extrapolates: v_r/(omega a) {zeta:.2g},"
        f" tested down to {low:.2g}",
    )
