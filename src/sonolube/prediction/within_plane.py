"""Vibration within the plane of contact: springs on exponential heights, not below Coulomb's law of rigid contacts.

The friction ratio of test i on rig r is

    R_i = R(zeta_i e^x, a_i e^-x / s_r) + delta_r + e_i,    x ~ N(0, s_a^2),    ln s_r ~ N(mu, tau^2),

with the velocity ratio zeta = v_r/(omega a), the error x of the amplitude, and the mean slip length s_r of the rig's
contact. Along the sliding R is the exact ratio of springs on exponential heights; in other directions it lies between
two exact limits, Coulomb's R_C of rigid contacts and E of slow sliding,

    R = R_C + (1 - R_C) E(a/s) + cos^2 (theta) D,

with what sliding adds along the line, D = R_A - R_C,A - (1 - R_C,A) E_A, of the parts along the sliding. It is up to
0.15 below springs that are followed through the period (a test has the figures). The prior of the slip
length is Mindlin's mu C l with the decay length l learned along the normal; the published points are weighed with it.
The discrepancy delta_r is that of `hierarchy`, with its sigma, between R_C and 1: a contact that yields has more
friction than a rigid one, and no vibration within the plane raises the mean friction of either. It grows with the
distance from the published points: in ln zeta below the smallest tested one, by up to 1 with the sine of the angle to
the sliding, along which all of them are, and by up to 1 from a line to a circle; both 1 are assumptions. Of an ellipse
zeta is taken with the line of the same mean square, and the sine is that of its sides.

A part along the normal beside one within the plane is not predicted: no one law has both limits, since Coulomb's leaves
friction under vibration along the normal as it is and asperity stick-slip keeps 0.63 of the friction along the sliding
where 0.30 was measured, and by Coulomb's law the phase between both decides: in the example `vibrating_base.toml` a
fifth of the amplitude along the normal moves the ratio from 0.06 to anything between -0.13 and 0.25.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from math import asin, hypot, pi, sin, sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.models.contact import ContactMotion
from sonolube.models.friction import (
    exponential_longitudinal_ratio,
    exponential_static_ratio,
    oblique_vibration_ratio,
    parallel_vibration_ratio,
)
from sonolube.models.friction.laws.coulomb import ring_directions
from sonolube.models.friction.models.coulomb import sampled_coulomb_ratio
from sonolube.prediction.evidence import (
    FULL_EFFECT,
    REFERENCE_DECAY_LENGTH,
    UNSTATED_UNCERTAINTY,
    Closure,
    Conditions,
    TestedRig,
    UncertainConditions,
)
from sonolube.prediction.hierarchy import (
    HYPERPARAMETERS,
    OWN_DEVIATES,
    POPULATION_PRIOR,
    RigLikelihood,
    standard_normals,
)
from sonolube.prediction.posterior import Posterior, RigDraws, learned, systematic_rows
from sonolube.prediction.published_source import PublishedRig, shipped_sources
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.text.units import format_si

NO_WEAR: Final = (
    "Wear is not predicted: neither a wear law nor a published wear test is of vibration within the plane; measure it."
)
"""Sentence in place of wear."""

NO_HEAT: Final = "within the plane friction heats along the whole path of the vibration; use sonolube thermal"
"""Why a prediction within the plane has no temperature rise."""

NO_LENGTH_ERROR: Final = 1e-9
"""Deviation of the logarithm of the decay length, on which Coulomb's law does not depend."""

_NODES: Final = 32  # of the integral over what one rig has of its own
_DRAWS: Final = 2048  # of the hyperparameters
UNSTATED_FREQUENCY: Final = 3e3
"""Frequency of a published vibration of which the velocity alone is printed, an assumption. [Hz]"""

_FREQUENCY_SPREAD: Final = 0.8  # of its logarithm, which is that of the amplitude
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
    vibration_velocity : ndarray or None
        Of the vibration, where it was measured and the amplitude was not. [m/s]
    """

    direction: VibrationDirection
    vibration_velocity: Floats | None = None

    @property
    def velocity_ratio(self) -> Floats:
        """Sliding speed over peak velocity of the vibration, by the amplitude with its error. []"""
        error = self.decay_length / REFERENCE_DECAY_LENGTH
        if self.vibration_velocity is not None:
            return np.asarray(self.sliding_speed / self.vibration_velocity * np.ones_like(error))
        peak = 2 * pi * self.frequency * self.vibration_amplitude
        return np.asarray(self.sliding_speed / peak * error)

    def amplitude_ratio(self, log_length: ArrayLike) -> Floats:
        """Amplitude with its error over the slip length. []"""
        error = self.decay_length / REFERENCE_DECAY_LENGTH
        return np.asarray(self.vibration_amplitude / error / np.exp(log_length))

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


def compliant_ratio(direction: VibrationDirection, *, velocity_ratio: Floats, amplitude_ratio: Floats) -> Floats:
    """Friction ratio of springs on exponential heights, at ratios that broadcast; see above."""
    rigid = coulomb_ratio(direction, velocity_ratio=velocity_ratio)
    found = rigid + (1 - rigid) * np.interp(np.log(amplitude_ratio), *_slow_table(direction))
    size, sine, _ = _shape(direction)
    along = size * sqrt(max(1 - sine**2, 0.0))
    if along > _ALONG:  # what sliding adds to it along the line is known
        zeta, stroke = velocity_ratio / along, amplitude_ratio * along
        stiff = parallel_vibration_ratio(sliding_speed=zeta, vibration_velocity=1.0)
        moving = exponential_longitudinal_ratio(velocity_ratio=zeta, amplitude_ratio=stroke)
        found = found + (1 - sine**2) * (moving - stiff - (1 - stiff) * np.exp(-stroke))
    return np.clip(found, rigid, 1.0)


@lru_cache(maxsize=16)
def _slow_table(direction: VibrationDirection) -> tuple[Floats, Floats]:
    """Logarithms of amplitudes over slip lengths, and the friction ratio of slow sliding at each."""
    size, sine, _ = _shape(direction)
    stroke = np.geomspace(1e-5, 1e3, 400)
    is_ring = direction.second_direction is None and direction.angle is None
    angles, weights = ring_directions(_RING) if is_ring else (np.array([asin(min(sine, 1.0))]), np.ones(1))
    found = exponential_static_ratio(vibration_direction=np.asarray(angles), amplitude_ratio=size * stroke[:, None])
    return np.log(stroke), np.asarray(found @ weights)


def _ratio(log_length: ArrayLike, at: Conditions) -> Floats:
    """Ratio of springs on exponential heights with a slip length."""
    plane = _plane(at)
    return compliant_ratio(
        plane.direction, velocity_ratio=plane.velocity_ratio, amplitude_ratio=plane.amplitude_ratio(log_length)
    )


def _effect(log_length: ArrayLike, at: Conditions) -> Floats:
    """Share of the discrepancy that vibration can cause: it vanishes with the amplitude over the slip length."""
    plane = _plane(at)
    return np.minimum(_shape(plane.direction)[0] * plane.amplitude_ratio(log_length) / FULL_EFFECT, 1.0)


def _bounds(at: Conditions) -> tuple[ArrayLike, ArrayLike]:
    """Ratio of a rigid contact, and 1."""
    plane = _plane(at)
    return coulomb_ratio(plane.direction, velocity_ratio=plane.velocity_ratio), 1.0


MINDLIN_SLIP_LENGTH: Final = 0.3 * 1.2 * REFERENCE_DECAY_LENGTH
"""Slip length mu C l of metals: a coefficient of 0.3, stiffness ratio of 1.2, decay length learned along the normal."""

RIGID_MODEL: Final = "coulomb"
"""Friction model of rig files whose caveats within the plane are those of a prediction."""

SPRINGS: Final = Closure(
    name="spring_heights",
    citation="springs on exponential heights, by the rule of G. Masing 1926, with the stiffness of R. D. Mindlin 1949",
    parameter="slip_length",
    unit="m",
    median=MINDLIN_SLIP_LENGTH,
    spread=1.0,
    ratio=_ratio,
    effect=_effect,
    bounds=_bounds,
)
"""Springs on exponential heights within the plane."""


@cache
def plane_rigs() -> tuple[TestedRig, ...]:
    """Published points within the plane by rig, with the uncertainty of those without scatter where none is printed."""
    return tuple(plane_rig(rig) for source in shipped_sources() for rig in source.rigs if not rig.is_normal)


def plane_rig(published: PublishedRig) -> TestedRig:
    """Published points within the plane on one rig; of a stated velocity the amplitude alone has an error."""
    points, section = published.points, published.section
    frequency = np.array([point.frequency or UNSTATED_FREQUENCY for point in points])
    velocity = np.array([point.vibration_velocity for point in points])
    is_velocity = all(point.states_velocity for point in points)
    is_assumed = any(point.frequency is None for point in points)
    conditions = PlaneConditions(
        vibration_amplitude=velocity / (2 * pi * frequency),
        frequency=frequency,
        sliding_speed=np.array([point.sliding_speed for point in points]),
        decay_length=np.full(len(points), REFERENCE_DECAY_LENGTH),
        direction=section.path,
        vibration_velocity=velocity if is_velocity else None,
    )
    name = points[0].label if len(points) == 1 else section.set
    return TestedRig(
        name=f"{name} of {published.source}",
        at=UncertainConditions(
            conditions=conditions,
            decay_length_spread=NO_LENGTH_ERROR,
            amplitude_spread=_FREQUENCY_SPREAD if is_assumed else section.amplitude_spread or AMPLITUDE_ERROR,
            amplitude_factor=section.amplitude_factor,
        ),
        friction_ratio=np.array([point.friction_ratio for point in points]),
        uncertainty=np.array([point.uncertainty or UNSTATED_UNCERTAINTY for point in points]),
    )


@cache
def tested_velocity_ratios() -> tuple[float, float]:
    """Smallest and largest velocity ratio of the published points within the plane. []"""
    found = np.concatenate([_plane(rig.at.conditions).velocity_ratio for rig in plane_rigs()])
    return float(found.min()), float(found.max())


def _plane(at: Conditions) -> PlaneConditions:
    """Conditions of a vibration within the plane, as such."""
    assert isinstance(at, PlaneConditions)
    return at


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PlanePopulation:
    """Draws from the prior within the plane with their likelihoods, by which rigs are left out at no cost.

    Parameters
    ----------
    rigs : tuple of TestedRig
        Within the plane.
    draws : ndarray, shape (h, 6)
        Prior of the slip length; the discrepancy as it was learned along the normal from the shipped tests.
    log_weights : ndarray, shape (h,)
        Of each draw by further tests along the normal; 0 without them.
    log_likelihoods : ndarray, shape (h, r)
        Of each draw and each rig within the plane.
    """

    rigs: tuple[TestedRig, ...]
    draws: Floats
    log_weights: Floats
    log_likelihoods: Floats

    def with_rigs(self, *, within_plane: Sequence[TestedRig], along_normal: Sequence[TestedRig]) -> "PlanePopulation":
        """Population with the likelihoods of further rigs, those along the normal by the friction model of these."""
        known = learned().friction
        logs = sum((RigLikelihood(known.closure, rig)(known.hyperparameters) for rig in along_normal), np.zeros(1))
        weights = self.log_weights + np.resize(logs, self.log_weights.size)  # as the draws repeat those learned from
        columns = [_log_likelihood(self.draws, rig) for rig in within_plane]
        return replace(
            self,
            rigs=(*self.rigs, *within_plane),
            log_weights=weights,
            log_likelihoods=np.column_stack([self.log_likelihoods, *columns]),
        )

    def posterior(self, *, without: tuple[int, ...] = ()) -> Posterior:
        """Posterior by all rigs but some."""
        rows = systematic_rows(self._logs(without), _DRAWS, np.random.default_rng(0))
        return Posterior(closure=SPRINGS, hyperparameters=self.draws[rows])

    @property
    def effective_draws(self) -> float:
        """Effective number of the weighed draws. []"""
        logs = self._logs(())
        return float(np.exp(2 * np.logaddexp.reduce(logs) - np.logaddexp.reduce(2 * logs)))

    def _logs(self, without: tuple[int, ...]) -> Floats:
        """Logarithm of the weight of each draw by all rigs but some."""
        return np.asarray(self.log_weights + np.delete(self.log_likelihoods, without, axis=1).sum(axis=1))


@cache
def plane_population() -> PlanePopulation:
    """Population of the published rigs within the plane."""
    drawn = _prior_draws()
    none = PlanePopulation(
        rigs=(), draws=drawn, log_weights=np.zeros(len(drawn)), log_likelihoods=np.zeros((len(drawn), 0))
    )
    return none.with_rigs(within_plane=plane_rigs(), along_normal=())


@cache
def plane_posterior(*, without: tuple[int, ...] = ()) -> Posterior:
    """Posterior within the plane: the prior of the slip length, and the discrepancy learned along the normal.

    Both are resampled by the likelihood of the published rigs.

    Parameters
    ----------
    without : tuple of int
        Places of published rigs that are left out.
    """
    return plane_population().posterior(without=without)


def _prior_draws() -> Floats:
    """Hyperparameters before the published points within the plane, shape (draws, 6)."""
    drawn = np.resize(learned().friction.hyperparameters, (_DRAWS, len(HYPERPARAMETERS)))
    means, deviations = POPULATION_PRIOR.of(SPRINGS)
    slip = standard_normals(_DRAWS, columns=2, seed=7)
    drawn[:, [0, 2]] = means[[0, 2]] + deviations[[0, 2]] * slip
    return drawn


def _log_likelihood(hyperparameters: Floats, rig: TestedRig) -> Floats:
    """Logarithm of the likelihood of a rig by each draw from the prior, over what the rig has of its own."""
    rows = np.repeat(np.arange(len(hyperparameters)), _NODES)
    deviates = np.tile(standard_normals(_NODES, columns=OWN_DEVIATES, seed=1), (len(hyperparameters), 1))
    posterior = Posterior(closure=SPRINGS, hyperparameters=hyperparameters)
    densities = RigDraws(posterior, rig.at, rows, deviates, own=rig).log_density().reshape(-1, _NODES)
    return np.asarray(np.logaddexp.reduce(densities, axis=1) - np.log(_NODES))


def tested_words(direction: VibrationDirection) -> str:
    """How far the law was tested in a direction, as the beginning of a sentence."""
    law = "springs on exponential heights"
    if _is_along(direction):
        return f"Vibration {direction.text}, by {law} tested with {tested_points()[0]} published points"
    return f"Vibration {direction.text}, by theory alone ({law}, compared with no experiment)"


def plane_caveats(direction: VibrationDirection, posterior: Posterior, *, own: str = "") -> tuple[str, ...]:
    """How far a prediction within the plane was tested, what is known of the slip length, and what the law misses.

    `own` names own tests within the plane from which the posterior was learned too; empty without them.
    """
    low, high = tested_velocity_ratios()
    points, sources = tested_points()
    tested = (
        f"{points} published points of {sources} sources along the sliding, {', '.join(_compared(posterior))}, at"
        f" v_r/(omega a) of {low:.2g} to {high:.2g}"
    )
    law = "springs on exponential heights, which have more friction than Coulomb's law of rigid contacts,"
    first = f"vibration {direction.text}: {law} tested with {tested}, and with no others"
    if not _is_along(direction):
        first = f"vibration {direction.text}: theory alone, {law} compared with no experiment; known are {tested}"
    middle, spread = slip_length(posterior)
    known = f", of these points and of {own}" if own else " and of these points"
    slip = (
        f"the slip length of the contact, {format_si(middle, 'm')} within a factor of {np.exp(spread):.1f}, is that of"
        f" Mindlin's stiffness{known}; one run of your own tells it better than {'all' if own else 'either'}"
    )
    if not _is_along(direction):
        slip += "; for an untested direction the interval is wider, by an assumption"
    falling = [rig.name for rig in plane_rigs() if _falls_with_speed(rig)]
    rate = f"of {' and '.join(falling)} the friction ratio falls with the sliding speed, against every law without rate"
    return (first, slip, rate) if falling else (first, slip)


def tested_points() -> tuple[int, int]:
    """Number of published points within the plane, and of their sources."""
    return sum(rig.friction_ratio.size for rig in plane_rigs()), len(plane_rigs())


def slip_length(posterior: Posterior) -> tuple[float, float]:
    """Median of the slip length of a further rig, in m, and the deviation of its logarithm."""
    mu, tau = posterior.hyperparameters[:, [0, 2]].T
    return float(np.exp(np.median(mu))), float(np.sqrt(np.var(mu) + np.mean(np.exp(2 * tau))))


def _compared(posterior: Posterior) -> list[str]:
    """Each published rig with its measured ratios and those of the law at the median slip length."""
    log_length = np.log(slip_length(posterior)[0])
    return [
        f"{rig.name} ({_range(rig.friction_ratio)} where the law has {_range(ratio)})"
        for rig in plane_rigs()
        for ratio in [SPRINGS.ratio(log_length, rig.at.conditions)]
    ]


def _range(values: Floats) -> str:
    """Lowest and highest of some ratios, or the only one."""
    low, high = float(np.min(values)), float(np.max(values))
    return f"{low:.2f}" if f"{low:.2f}" == f"{high:.2f}" else f"{low:.2f} to {high:.2f}"


def _falls_with_speed(rig: TestedRig) -> bool:
    """Whether the ratios of three and more tests fall with the sliding speed, each to the next."""
    order = np.argsort(rig.at.conditions.sliding_speed)
    return rig.friction_ratio.size > 2 and bool(np.all(np.diff(rig.friction_ratio[order]) < 0))


def plane_extrapolation(at: Conditions) -> tuple[str, ...]:
    """Sentence where the sliding is slower, against the vibration, than in any published point within the plane."""
    if not is_slower_than_tested(at)[0]:
        return ()
    plane = _plane(at)
    zeta, low = float(plane.velocity_ratio[0]) / _shape(plane.direction)[0], tested_velocity_ratios()[0]
    return (
        f"outside the range of the published points, so that the prediction extrapolates: v_r/(omega a) {zeta:.2g},"
        f" tested down to {low:.2g}",
    )


def is_slower_than_tested(at: Conditions) -> NDArray[np.bool_]:
    """Whether the sliding is slower, against the vibration, than in any published point, at each of m conditions."""
    plane = _plane(at)
    zeta = np.atleast_1d(plane.velocity_ratio) / _shape(plane.direction)[0]
    return np.asarray(zeta < tested_velocity_ratios()[0] / 1.05)
