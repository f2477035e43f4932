"""One time step of a structure as a linear filter of the contact force, exact for its linear motion and its drive."""

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.first_order_modes import StatePairs
from sonolube.dynamics.waveform import Sine, Waveform, value
from sonolube.errors import InvalidInput

PAST = 5  # forces the filter remembers
_FITTED = 2  # harmonics of the drive whose force is integrated exactly
_NODES = 16  # of the quadrature over a step, beside those that a fast exponent asks for
_LONGEST_STEP = 1000.0  # over which the fastest exponent turns or decays, in radians: beyond, nodes are too many


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StepFilter:
    """The step at each of several frequencies, all with the same number of steps a period.

    The state after a step is y + sum_j recent_j f_j, where f_0 to f_4 are the force now and up to four steps ago, and y
    obeys y -> propagator y + oldest f_4 + drive.

    Parameters
    ----------
    propagator : ndarray, shape (frequencies, n, 2, 2)
    oldest : ndarray, shape (frequencies, n, 2)
    recent : ndarray, shape (frequencies, 5, n, 2)
    foreseen : ndarray, shape (frequencies, 2, 5)
        What the forces so far add to displacement and velocity of the contact one step ahead, beside the new y.
    ahead : ndarray, shape (frequencies, 2, 4, 5)
        What forces now and at the next four steps add to them at these steps, for a start without a past.
    backward : ndarray, shape (5, 5)
        The past that continues the forces now and at the next four steps.
    wave : ndarray, shape (frequencies, 3, steps, n, 2)
        Drive of each step per volt peak to peak, under a ramp of 1, s and s^2, s from 0 to 1 over the step.
    offset : ndarray, shape (frequencies, 3, n, 2)
        Drive per volt of offset, likewise.
    """

    propagator: Floats
    oldest: Floats
    recent: Floats
    foreseen: Floats
    ahead: Floats
    backward: Floats
    wave: Floats
    offset: Floats


class ForceShares(NamedTuple):
    """What each sample of the force weighs at the nodes of a step, times the weights of the quadrature."""

    corrected: Floats  # (nodes, 6): samples at the end of the step and up to five before
    foreseen: Floats  # (nodes, 5): at its start and up to four before
    ahead: Floats  # (4, nodes, 5): now and at the next four steps, in each of these


def force_shares(nodes: Floats, weights: Floats, steps: int) -> ForceShares:
    """Return what samples of the force weigh at the nodes of a step.

    Parameters
    ----------
    nodes, weights : ndarray, shape (nodes,)
        Of a quadrature from 0 to 1, the start and the end of the step.
    steps : int
        Steps a period.

    Returns
    -------
    ForceShares
    """
    theta = 2 * np.pi / steps

    def shares(sampled_at: Floats, first: int = 0) -> Floats:
        return _interpolation(first + nodes, sampled_at, theta) * weights[:, np.newaxis]

    back, ahead = 1.0 - np.arange(PAST + 1, dtype=np.float64), np.arange(PAST, dtype=np.float64)
    return ForceShares(shares(back), shares(back[1:]), np.stack([shares(ahead, first) for first in range(PAST - 1)]))


def past_of_a_start(steps: int) -> Floats:
    """Return the past, now and up to four steps ago, that continues the forces now and at the next four steps."""
    ahead = np.arange(PAST, dtype=np.float64)
    return _interpolation(-ahead, ahead, 2 * np.pi / steps)


def quadrature(pairs: StatePairs, *, steps: int, slowest: float) -> tuple[Floats, Floats]:
    """Return nodes and weights, from 0 to 1, that follow the free motion over a step.

    Parameters
    ----------
    pairs : StatePairs
    steps : int
        Steps a period.
    slowest : float
        Lowest frequency of the drive, in Hz.

    Returns
    -------
    nodes, weights : ndarray, shape (nodes,)

    Raises
    ------
    InvalidInput
        If the structure's fastest mode turns too often in a step.
    """
    angle = _fastest(pairs) / (steps * slowest)
    if angle > _LONGEST_STEP:
        raise InvalidInput(
            f"steps_per_period = {steps} is too few for a drive as slow as {slowest:.3g} Hz against this structure's"
            f" fastest mode; take {fewest_steps(pairs, frequency=slowest)} at least, or a higher frequency"
        )
    return _gauss(_NODES + int(np.ceil(0.6 * angle)))


def step_filter(
    pairs: StatePairs, contact_rows: Floats, *, frequency: Floats, steps: int, waveform: Waveform
) -> StepFilter:
    """Return the step at each frequency.

    Parameters
    ----------
    pairs : StatePairs
    contact_rows : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    frequency : ndarray, shape (frequencies,)
        Frequency of the drive. [Hz]
    steps : int
        Steps a period.
    waveform : Waveform

    Returns
    -------
    StepFilter

    Raises
    ------
    InvalidInput
        If the structure's fastest mode turns too often in a step.

    Notes
    -----
    Between its samples the force is the combination of a constant, the first two harmonics of the drive and, where six
    samples are at hand, a straight line that passes through them: with many steps a polynomial, with few exact for what
    a steady contact force mostly consists of. The displacement is foreseen from five past forces (an exponential Adams-
    Bashforth step); the new force found there corrects the state (Adams-Moulton). Order five in the step. [1]_

    References
    ----------
    .. [1] M. Hochbruck and A. Ostermann, Acta Numerica 19, 209 (2010). doi:10.1017/S0962492910000048
    """
    h = 1 / (frequency * steps)
    nodes, weights = quadrature(pairs, steps=steps, slowest=float(frequency.min()))
    shares = force_shares(nodes, weights, steps)
    moved = _moved(pairs.generator, pairs.contact, np.multiply.outer(h, 1 - nodes))  # exp(A h (1 - s)) c
    moved *= h[:, np.newaxis, np.newaxis, np.newaxis]

    def added(of_samples: Floats) -> Floats:
        """Return the state that each sample of the force adds over a step."""
        return np.asarray(np.einsum("fmqa,qj->fjma", moved, of_samples))

    propagator = np.stack([_moved(pairs.generator, unit, h[:, np.newaxis])[:, :, 0] for unit in _units(pairs)], axis=-1)
    corrected = added(shares.corrected)
    recent = corrected[:, :PAST].copy()
    for j in range(1, PAST):  # W(q) = (1 - E q) V(q) + q^5 U, q one step back
        recent[:, j] += _turn(propagator, recent[:, j - 1])
    oldest = corrected[:, PAST] + _turn(propagator, recent[:, PAST - 1])
    foreseen = _seen(contact_rows, added(shares.foreseen))
    foreseen += _seen(contact_rows, np.stack([_turn(propagator, recent[:, j]) for j in range(PAST)], axis=1))
    foreseen[..., PAST - 1] -= np.einsum("kma,fma->fk", contact_rows, oldest)
    later, reached = [], np.zeros_like(recent)
    for of_samples in shares.ahead:
        reached = np.stack([_turn(propagator, reached[:, j]) for j in range(PAST)], axis=1)
        reached += added(of_samples)
        later.append(_seen(contact_rows, reached))
    wave, offset = _drive_tables(pairs, h, steps, waveform, nodes, weights)
    return StepFilter(
        propagator=propagator,
        oldest=oldest,
        recent=recent,
        foreseen=foreseen,
        ahead=np.stack(later, axis=2),
        backward=past_of_a_start(steps),
        wave=wave,
        offset=offset,
    )


def fewest_steps(pairs: StatePairs, *, frequency: float) -> int:
    """Return the fewest steps a period, a multiple of 4, that hold few enough turns of the fastest mode.

    Parameters
    ----------
    pairs : StatePairs
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    int
    """
    return 4 * max(math.ceil(_fastest(pairs) / (4 * _LONGEST_STEP * frequency)), 2)


def _fastest(pairs: StatePairs) -> float:
    return float(np.abs(np.linalg.eigvals(pairs.generator)).max(initial=0.0))


def _units(pairs: StatePairs) -> list[Floats]:
    return [np.broadcast_to(row, pairs.contact.shape) for row in np.eye(2)]


def _turn(propagator: Floats, states: Floats) -> Floats:
    return np.asarray(np.einsum("fmab,fmb->fma", propagator, states))


def _seen(contact_rows: Floats, states: Floats) -> Floats:
    return np.asarray(np.einsum("kma,fjma->fkj", contact_rows, states))


def _moved(generator: Floats, start: Floats, time: Floats) -> Floats:
    """Return exp(A t) applied to one start a pair, shape (frequencies, n, times, 2)."""
    middle = np.trace(generator, axis1=1, axis2=2) / 2
    leaning = generator - middle[:, np.newaxis, np.newaxis] * np.eye(2)
    half_gap: Complexes = np.sqrt(-np.linalg.det(leaning).astype(np.complex128))  # exponents are middle +- half_gap
    t = time[:, np.newaxis, :]
    mu, delta = middle[:, np.newaxis], half_gap[:, np.newaxis]
    one, other, both = np.exp((mu + delta) * t), np.exp((mu - delta) * t), np.exp(mu * t)
    cosine = (one + other).real / 2
    small = np.abs(delta * t) < 1e-2
    series = both * t * (1 + (delta * t) ** 2 / 6 * (1 + (delta * t) ** 2 / 20 * (1 + (delta * t) ** 2 / 42)))
    sine = np.where(small, series, (one - other) / np.where(small, 1.0, 2 * delta)).real
    pushed = np.einsum("mab,mb->ma", leaning, start)
    return np.asarray(
        cosine[..., np.newaxis] * start[:, np.newaxis, :] + sine[..., np.newaxis] * pushed[:, np.newaxis, :]
    )


def _interpolation(time: Floats, sampled_at: Floats, theta: float) -> Floats:
    """Return the share of each sample at each time, in steps; theta is the phase of a step."""
    frequencies = [0.0j, *(sign * 1j * k * theta for k in range(1, _FITTED + 1) for sign in (1, -1))]
    exponents = frequencies + [0.0j] * (sampled_at.size - len(frequencies))
    generator = np.diag(np.ones(sampled_at.size - 1), 1)
    generator[-1] = -np.poly(np.array(exponents)).real[:0:-1]  # y'(n) = -sum of the others: every exp(exponent t)
    space = expm(np.multiply.outer(np.concatenate([time, sampled_at]), generator))[:, 0, :]
    return np.asarray(np.linalg.solve(space[time.size :].T, space[: time.size].T).T)


def _drive_tables(
    pairs: StatePairs, h: Floats, steps: int, waveform: Waveform, nodes: Floats, weights: Floats
) -> tuple[Floats, Floats]:
    """Return the drive of each step per volt peak to peak and per volt of offset."""
    powers, scale = np.arange(3)[:, np.newaxis], h[:, np.newaxis, np.newaxis, np.newaxis]
    steady = scale * _moved(pairs.generator, pairs.drive, np.multiply.outer(h, 1 - nodes))
    offset = np.einsum("fmqa,kq->fkma", steady, weights * nodes**powers)
    at, share = _split_at_corners(waveform, steps, nodes, weights)
    moved = scale * _moved(pairs.generator, pairs.drive, np.multiply.outer(h, 1 - at.ravel()))
    moved = moved.reshape(*moved.shape[:2], *at.shape, 2)
    heights = value(waveform, phase=2 * np.pi / steps * (np.arange(steps)[:, np.newaxis] + at))
    weighted = share * heights * at ** powers[..., np.newaxis]
    if at.shape[0] == 1:  # the same nodes in every step
        return np.einsum("fmqa,knq->fknma", moved[:, :, 0], weighted), offset
    return np.einsum("fmnqa,knq->fknma", moved, weighted), offset


def corners_within_steps(waveform: Waveform, steps: int) -> Floats:
    """Return where a waveform has corners within steps, in steps from the start of the period."""
    corners = np.empty(0) if isinstance(waveform, Sine) else waveform.starts_at * steps / (2 * np.pi)
    return np.asarray(corners[np.abs(corners - np.round(corners)) > 1e-9])


def _split_at_corners(waveform: Waveform, steps: int, nodes: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Return quadrature nodes and weights of each step, one row for all where no corner falls within a step."""
    inside = corners_within_steps(waveform, steps)
    if not inside.size:
        return nodes[np.newaxis], weights[np.newaxis]
    most = int(np.bincount(inside.astype(np.int64)).max())
    edges = np.ones((steps, most + 2))  # pieces left over have no length
    edges[:, 0] = 0.0
    for step in range(steps):
        own = np.sort(inside[inside.astype(np.int64) == step]) - step
        edges[step, 1 : 1 + own.size] = own
    length = np.diff(edges, axis=1)[..., np.newaxis]
    at = edges[:, :-1, np.newaxis] + length * nodes
    return at.reshape(steps, -1), (length * weights).reshape(steps, -1)


@cache
def _gauss(count: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (1 + nodes) / 2, weights / 2
