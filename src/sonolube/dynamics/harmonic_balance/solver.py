"""Solving a chunk of points: first guess, balance, finer where needed, up the ramp where all else fails."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.dynamics.gap_law import GapLaw, length_of_change
from sonolube.dynamics.harmonic_balance.contact_kernel import equilibrium_displacement, law_of
from sonolube.dynamics.harmonic_balance.extrema import measure
from sonolube.dynamics.harmonic_balance.floquet_exponent import GROWTH, growth, too_slow
from sonolube.dynamics.harmonic_balance.harmonic_kernel import (
    CONVERGED,
    DIVERGED,
    FREE_MEAN,
    LOAD,
    NEEDS_HARMONICS,
    NEEDS_SAMPLES,
    OMEGA,
    TAIL,
    Points,
    Resolution,
    balance,
    workspace,
)
from sonolube.dynamics.harmonic_balance.initial_guess import FirstGuess, first_guess
from sonolube.dynamics.harmonic_balance.receptance import ContactPort, receptance

MOST_HARMONICS = 64
_MOST_SAMPLES, _MOST_COUPLED = 2048, 32
_ITERATIONS = 12
_RAMP = 24  # steps of voltage on the way up
_DISTINCT = 1e-4  # relative difference of amplitude that makes two solutions


class Vibrations(NamedTuple):
    """Steady states to find, one row or entry to a point."""

    given: Floats  # (p, 5): columns OMEGA to FREE_MEAN
    free: Complexes  # (p, K) m, harmonics without contact
    mean: Floats  # (p,) m
    harmonics: Complexes  # (p, room) m, the first guess and then the result
    force: Complexes  # (p, K) N, harmonics of the contact force, written

    def for_kernel(self) -> Points:
        """Return the same memory as the kernel sees it."""
        free, harmonics, force = (values.view(np.float64) for values in (self.free, self.harmonics, self.force))
        return Points(self.given, free, self.mean[:, np.newaxis], harmonics, force)


class Solutions(NamedTuple):
    """Steady states of a chunk, one row of each array to a point; NaN where there is none."""

    mean: Floats
    harmonics: Complexes
    mean_force: Floats
    charge: Complexes
    amplitude: Floats
    turns: Floats
    lowest_displacement: Floats
    force: Floats
    lost: Floats
    growing: NDArray[np.bool_]
    coexisting_amplitude: Floats
    count: Integers  # type: ignore[assignment]


def solve(
    port: ContactPort,
    gap_law: GapLaw,
    omega: Floats,
    load: Floats,
    voltage: Complexes,
    static_displacement: Floats,
    *,
    least: int,
    falling: bool,
    stability: bool,
    tolerance: float,
) -> Solutions:
    """Find and measure the steady states of a chunk of points.

    Parameters
    ----------
    port : ContactPort
    gap_law : GapLaw
    omega, load, static_displacement : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, and mean displacement without contact, in m.
    voltage : ndarray of complex, shape (p, K)
        Harmonics of the drive, in V.
    least : int
        Harmonics to take and couple at least.
    falling : bool
        Whether to take the larger of several vibrations.
    stability : bool
        Whether to judge stability.
    tolerance : float
        Largest relative error of amplitude and force.

    Returns
    -------
    Solutions
    """
    free = _of_orders(port, 1, omega, voltage.shape[1]) * voltage
    drive = (omega, load, static_displacement, free)
    guess = first_guess(port, gap_law, *drive, tolerance=TAIL * tolerance, highest=falling)
    resolution = guess.resolution
    if least > 1:
        _raise_to(least, resolution)
    points, solved = _refine(port, gap_law, _points(gap_law, *drive, guess), resolution, tolerance)
    if not solved.all():
        points = _up_the_ramp(port, gap_law, points, resolution, solved, tolerance)
    found = _measured(port, gap_law, points, voltage, resolution, solved, stability)
    double = np.flatnonzero(solved & (guess.highest > guess.lowest * (1 + _DISTINCT)))
    if double.size:
        _find_rivals(port, gap_law, points, voltage, double, falling, stability, tolerance, found)
    return found


def _of_orders(port: ContactPort, which: int, omega: Floats, orders: int) -> Complexes:
    return receptance(port, which, omega[:, np.newaxis] * np.arange(1, orders + 1))


def _points(
    gap_law: GapLaw, omega: Floats, load: Floats, static_displacement: Floats, free: Complexes, guess: FirstGuess
) -> Vibrations:
    room = max(int(guess.resolution.harmonics.max()), free.shape[1])
    harmonics = np.zeros((omega.size, room), dtype=np.complex128)
    harmonics[:, 0] = guess.harmonic
    given = np.stack(
        [omega, load, length_of_change(gap_law, load), equilibrium_displacement(gap_law, load), static_displacement],
        axis=1,
    )
    return Vibrations(given, free, guess.mean, harmonics, np.zeros_like(free))


def _raise_to(least: int, resolution: Resolution) -> None:
    np.maximum(resolution.harmonics, least, out=resolution.harmonics)
    np.maximum(resolution.coupled, min(least, _MOST_COUPLED), out=resolution.coupled)
    np.maximum(resolution.samples, 4 * resolution.harmonics, out=resolution.samples)


def _refine(
    port: ContactPort, gap_law: GapLaw, points: Vibrations, resolution: Resolution, tolerance: float
) -> tuple[Vibrations, NDArray[np.bool_]]:
    """Balance all points, those that did not succeed again with more harmonics or samples."""
    (compiled, law), poles = law_of(gap_law), port.poles()
    outcome = np.full(points.mean.size, DIVERGED)
    pending = np.arange(points.mean.size)
    for attempt in range(9):
        points = _with_room(points, int(resolution.harmonics[pending].max(initial=0)))
        # like beside like, since a block of lanes works as finely as its most demanding point
        demand = resolution.samples[pending] // 2 * MOST_HARMONICS + resolution.harmonics[pending] - MOST_HARMONICS - 1
        chosen = pending[np.argsort(demand.astype(np.uint16), kind="stable")]  # by counting, that is, at once
        work = workspace(*(int(values[chosen].max()) for values in resolution))
        finest, most = np.array(resolution), _ITERATIONS + 4 * attempt
        given = points.for_kernel()
        balance(*compiled, poles, port.static_stiffness, law, given, finest, chosen, tolerance, most, outcome, work)
        resolution.harmonics[:] = finest[0]
        pending = np.flatnonzero(outcome != CONVERGED)
        pending = pending[_finer(resolution, pending, outcome[pending])]
        if not pending.size:
            break
    return points, outcome == CONVERGED


def _finer(resolution: Resolution, pending: Integers, outcome: Integers) -> NDArray[np.bool_]:
    """Ask for more of what each point lacked; return which of them can still have it."""
    harmonics, coupled, samples = (values[pending] for values in resolution)
    alone = (outcome == DIVERGED) & (coupled >= np.minimum(harmonics, _MOST_COUPLED))
    coupled = np.where(outcome == DIVERGED, np.minimum(4 * coupled, _MOST_COUPLED), coupled)
    harmonics = np.where((outcome == NEEDS_HARMONICS) | alone, 2 * harmonics, harmonics)
    samples = np.where((outcome == NEEDS_SAMPLES) | alone, 2 * samples, samples)
    possible = (harmonics <= MOST_HARMONICS) & (samples <= _MOST_SAMPLES)
    resolution.harmonics[pending[possible]] = harmonics[possible]
    resolution.coupled[pending[possible]] = np.minimum(coupled, harmonics)[possible]
    resolution.samples[pending[possible]] = np.maximum(samples, 4 * harmonics)[possible]
    return possible


def _with_room(points: Vibrations, harmonics: int) -> Vibrations:
    missing = harmonics - points.harmonics.shape[1]
    if missing <= 0:
        return points
    return points._replace(harmonics=np.pad(points.harmonics, ((0, 0), (0, missing))))


def _up_the_ramp(
    port: ContactPort,
    gap_law: GapLaw,
    points: Vibrations,
    resolution: Resolution,
    solved: NDArray[np.bool_],
    tolerance: float,
) -> Vibrations:
    """Follow the remaining points from a low voltage in small steps."""
    lost = np.flatnonzero(~solved)
    omega, load, static_displacement = points.given[lost][:, [OMEGA, LOAD, FREE_MEAN]].T
    free = points.free[lost]
    drive = (omega, load, static_displacement, free / _RAMP)
    guess = first_guess(port, gap_law, *drive, tolerance=TAIL * tolerance, highest=False)
    part, own = _points(gap_law, *drive, guess), guess.resolution
    good = np.zeros(lost.size, dtype=bool)
    for step in range(1, _RAMP + 1):
        growth = step / max(step - 1, 1)
        part = part._replace(free=free * (step / _RAMP), harmonics=part.harmonics * growth)
        _raise_to(16, own)
        part, good = _refine(port, gap_law, part, own, tolerance)
    points = _with_room(points, part.harmonics.shape[1])
    points.harmonics[lost] = 0.0
    points.harmonics[lost, : part.harmonics.shape[1]] = part.harmonics
    points.mean[lost], points.force[lost] = part.mean, part.force
    for values, answers in zip(resolution, own, strict=True):
        values[lost] = answers
    solved[lost] = good
    return points


def _measured(
    port: ContactPort,
    gap_law: GapLaw,
    points: Vibrations,
    voltage: Complexes,
    resolution: Resolution,
    solved: NDArray[np.bool_],
    stability: bool,
) -> Solutions:
    omega, load, static_displacement = points.given[:, [OMEGA, LOAD, FREE_MEAN]].T
    if stability:
        solved &= ~too_slow(port, omega)
    points.mean[~solved], points.harmonics[~solved] = 0.0, 0.0
    motion = (omega, load, points.mean, points.harmonics, resolution.harmonics)
    measures = measure(gap_law, *motion)
    growing = np.zeros(omega.size, dtype=bool)
    if stability:
        growing = growth(port, gap_law, *motion, resolution.samples) > GROWTH
    orders = voltage.shape[1]
    charge = (port.clamped_capacitance + _of_orders(port, 2, omega, orders)) * voltage
    charge += _of_orders(port, 1, omega, orders) * points.force
    width = int(resolution.harmonics[solved].max(initial=1))
    found = Solutions(
        points.mean,
        np.ascontiguousarray(points.harmonics[:, :width]),
        load + port.static_stiffness * (points.mean - static_displacement),
        charge,
        measures.amplitude,
        measures.turns,
        measures.lowest_displacement,
        measures.force,
        measures.lost,
        growing,
        np.full(omega.size, np.nan),
        resolution.harmonics,
    )
    for values in found[:-3]:
        values[~solved] = np.nan
    return found


def _find_rivals(
    port: ContactPort,
    gap_law: GapLaw,
    points: Vibrations,
    voltage: Complexes,
    double: Integers,
    falling: bool,
    stability: bool,
    tolerance: float,
    found: Solutions,
) -> None:
    """Where one harmonic has two solutions, look for the other one and write its amplitude if it is there to stay."""
    omega, load, static_displacement = points.given[double][:, [OMEGA, LOAD, FREE_MEAN]].T
    drive = (omega, load, static_displacement, points.free[double])
    guess = first_guess(port, gap_law, *drive, tolerance=TAIL * tolerance, highest=not falling)
    other, solved = _refine(port, gap_law, _points(gap_law, *drive, guess), guess.resolution, tolerance)
    rivals = _measured(port, gap_law, other, voltage[double], guess.resolution, solved, stability)
    own = found.amplitude[double]
    real = solved & ~rivals.growing & (np.abs(rivals.amplitude - own) > _DISTINCT * own)
    found.coexisting_amplitude[double[real]] = rivals.amplitude[real]
