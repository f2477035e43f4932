"""Solver of a chunk of steady states: initial guess, Newton's method with adaptive truncation, voltage continuation."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Integers
from sonolube.models.dynamics.gap_laws.closed_form import force_decay_length
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem, BatchSolution
from sonolube.models.dynamics.harmonic_balance.equations import CHARGE_PER_VOLT, CONTACT_PER_VOLT, receptance
from sonolube.models.dynamics.harmonic_balance.extrema import response_measures
from sonolube.models.dynamics.harmonic_balance.floquet_exponent import (
    STABILITY_THRESHOLD,
    floquet_exponents,
    stability_undetermined,
)
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import (
    CONVERGED,
    DIVERGED,
    NEEDS_HARMONICS,
    NEEDS_SAMPLES,
    Iterates,
    Truncation,
    harmonic_workspace,
    newton_solve,
)
from sonolube.models.dynamics.harmonic_balance.initial_guess import InitialGuess, initial_guess
from sonolube.models.dynamics.kernels.simd import LANES, uniform_blocks

MAX_HARMONICS = 64
"""Largest number of harmonics of the contact. []"""
_MAX_SAMPLES, _MAX_COUPLED = 2048, 32
_REFINEMENTS, _ITERATIONS = 9, 12
_POINT = 500  # work of a point as plain Python beside its samples times harmonics, in units of these
_FEW: Final = {"most": 4600, "at_first": 2_000_000}  # work for which plain Python takes less than loading and compiling
_VOLTAGE_STEPS = 24  # of the continuation from a low voltage
_DISTINCT = 1e-4  # relative difference of amplitude above which two solutions are distinct


def solve(problem: BatchProblem) -> BatchSolution:
    """Steady states of a batch, one chunk of points solved together."""
    free = _receptances(problem, CONTACT_PER_VOLT) * problem.voltage
    guess = initial_guess(problem, free, upper_branch=problem.upper_branch)
    truncation = guess.truncation
    if problem.minimum_harmonics > 1:
        _raise_truncation(truncation, problem.minimum_harmonics)
    iterates, solved = _refine(problem, _iterates(problem, free, guess), truncation)
    if not solved.all():
        iterates = _continue_in_voltage(problem, free, iterates, truncation, solved)
    solution = _measured(problem, iterates, truncation, solved)
    several = np.flatnonzero(solved & (guess.largest_amplitude > guess.smallest_amplitude * (1 + _DISTINCT)))
    if several.size:
        _find_coexisting(problem.select(several), free[several], several, solution)
    return solution


def _receptances(problem: BatchProblem, response: int) -> Complexes:
    """Receptance at every harmonic of the drive of every point, shape (p, K)."""
    orders = np.arange(1, problem.voltage.shape[1] + 1)
    return receptance(problem.model, response, problem.omega[:, np.newaxis] * orders)


def _iterates(problem: BatchProblem, free: Complexes, guess: InitialGuess) -> Iterates:
    """Iterates that start from an initial guess."""
    capacity = max(int(guess.truncation.harmonics.max()), free.shape[1])
    harmonics = np.zeros((problem.omega.size, capacity), dtype=np.complex128)
    harmonics[:, 0] = guess.harmonic
    load, law = problem.load, problem.gap_law
    length, equilibrium = force_decay_length(law, load), law.equilibrium_coordinate(load)
    return Iterates(
        settings=np.stack([problem.omega, load, length, equilibrium, problem.static_displacement], axis=1),
        free_harmonics=free.view(np.float64),
        mean=guess.mean[:, np.newaxis],
        harmonics=harmonics.view(np.float64),
        force_harmonics=np.zeros_like(free).view(np.float64),
    )


def _raise_truncation(truncation: Truncation, harmonics: int) -> None:
    """Raise the numbers of harmonics, coupled harmonics and samples, in place."""
    np.maximum(truncation.harmonics, harmonics, out=truncation.harmonics)
    np.maximum(truncation.coupled, min(harmonics, _MAX_COUPLED), out=truncation.coupled)
    np.maximum(truncation.samples, 4 * truncation.harmonics, out=truncation.samples)


def _refine(problem: BatchProblem, iterates: Iterates, truncation: Truncation) -> tuple[Iterates, NDArray[np.bool_]]:
    """Solve all points, those without success again with more harmonics or samples; return which were solved."""
    outcome = np.full(problem.omega.size, DIVERGED)
    pending = np.arange(outcome.size)
    for attempt in range(_REFINEMENTS):
        iterates = _with_capacity(iterates, int(truncation.harmonics[pending].max(initial=0)))
        _newton(problem, iterates, truncation, pending, _ITERATIONS + 4 * attempt, outcome)
        pending = np.flatnonzero(outcome != CONVERGED)
        pending = pending[_refine_truncation(truncation, pending, outcome[pending])]
        if not pending.size:
            break
    return iterates, outcome == CONVERGED


def _newton(
    problem: BatchProblem, iterates: Iterates, truncation: Truncation, pending: Integers, steps: int, outcome: Integers
) -> None:
    """Solve the pending points by the compiled kernel; write their iterates and outcomes."""
    finest = [int(values[pending].max()) for values in truncation]
    sampled = pending.size * (_POINT + finest[0] * finest[2])
    chosen = uniform_blocks(pending, *truncation, lanes=newton_solve.lanes(sampled, LANES, **_FEW))
    newton_solve.for_points(sampled, **_FEW)(
        kernel_law(problem.gap_law),
        problem.model.contact_poles(),
        problem.model.static_stiffness,
        iterates,
        np.array(truncation),
        chosen,
        problem.tolerance,
        steps,
        outcome,
        harmonic_workspace(*finest),
    )


def _refine_truncation(truncation: Truncation, pending: Integers, outcome: Integers) -> NDArray[np.bool_]:
    """Raise what each pending point lacks, in place; return which of them stay within the limits."""
    harmonics, coupled, samples = (values[pending] for values in truncation)
    fully_coupled = (outcome == DIVERGED) & (coupled >= np.minimum(harmonics, _MAX_COUPLED))
    coupled = np.where(outcome == DIVERGED, np.minimum(4 * coupled, _MAX_COUPLED), coupled)
    harmonics = np.where((outcome == NEEDS_HARMONICS) | fully_coupled, 2 * harmonics, harmonics)
    samples = np.where((outcome == NEEDS_SAMPLES) | fully_coupled, 2 * samples, samples)
    possible = (harmonics <= MAX_HARMONICS) & (samples <= _MAX_SAMPLES)
    truncation.harmonics[pending[possible]] = harmonics[possible]
    truncation.coupled[pending[possible]] = np.minimum(coupled, harmonics)[possible]
    truncation.samples[pending[possible]] = np.maximum(samples, 4 * harmonics)[possible]
    return possible


def _with_capacity(iterates: Iterates, harmonics: int) -> Iterates:
    """Iterates with capacity for a number of harmonics."""
    missing = 2 * harmonics - iterates.harmonics.shape[1]
    if missing <= 0:
        return iterates
    return iterates._replace(harmonics=np.pad(iterates.harmonics, ((0, 0), (0, missing))))


def _continue_in_voltage(
    problem: BatchProblem, free: Complexes, iterates: Iterates, truncation: Truncation, solved: NDArray[np.bool_]
) -> Iterates:
    """Solve the remaining points by continuation from a low voltage in small steps; update what is solved."""
    remaining = np.flatnonzero(~solved)
    own_problem, own_free = problem.select(remaining), free[remaining]
    guess = initial_guess(own_problem, own_free / _VOLTAGE_STEPS, upper_branch=False)
    own, own_truncation = _iterates(own_problem, own_free / _VOLTAGE_STEPS, guess), guess.truncation
    good = np.zeros(remaining.size, dtype=bool)
    for step in range(1, _VOLTAGE_STEPS + 1):
        free_now = (own_free * (step / _VOLTAGE_STEPS)).view(np.float64)
        own = own._replace(free_harmonics=free_now, harmonics=own.harmonics * (step / max(step - 1, 1)))
        _raise_truncation(own_truncation, 16)
        own, good = _refine(own_problem, own, own_truncation)
    iterates = _with_capacity(iterates, own.harmonics.shape[1] // 2)
    iterates.harmonics[remaining] = 0.0
    iterates.harmonics[remaining, : own.harmonics.shape[1]] = own.harmonics
    iterates.mean[remaining], iterates.force_harmonics[remaining] = own.mean, own.force_harmonics
    for values, results in zip(truncation, own_truncation, strict=True):
        values[remaining] = results
    solved[remaining] = good
    return iterates


def _measured(
    problem: BatchProblem, iterates: Iterates, truncation: Truncation, solved: NDArray[np.bool_]
) -> BatchSolution:
    """Solution of a batch: measures of its motions, stability, and the charge on the stack."""
    model, omega, load = problem.model, problem.omega, problem.load
    if problem.stability:
        solved &= ~stability_undetermined(model, omega)
    mean, harmonics = iterates.mean[:, 0], iterates.harmonics.view(np.complex128)
    mean[~solved], harmonics[~solved] = 0.0, 0.0
    motion = (omega, load, mean, harmonics, truncation.harmonics)
    measures = response_measures(problem.gap_law, *motion)
    unstable = np.zeros(omega.size, dtype=bool)
    if problem.stability:
        exponents = floquet_exponents(model, problem.gap_law, *motion, truncation.samples)
        unstable = exponents > STABILITY_THRESHOLD
    charge = (model.clamped_capacitance + _receptances(problem, CHARGE_PER_VOLT)) * problem.voltage
    charge += _receptances(problem, CONTACT_PER_VOLT) * iterates.force_harmonics.view(np.complex128)
    width = int(truncation.harmonics[solved].max(initial=1))
    solution = BatchSolution(
        mean_displacement=mean,
        harmonics=np.ascontiguousarray(harmonics[:, :width]),
        mean_normal_force=load + model.static_stiffness * (mean - problem.static_displacement),
        charge_harmonics=charge,
        **measures._asdict(),
        unstable=unstable,
        coexisting_amplitude=np.full(omega.size, np.nan),
        harmonic_count=truncation.harmonics,
    )
    for name in _NAN_WHERE_UNSOLVED:
        getattr(solution, name)[~solved] = np.nan
    return solution


_NAN_WHERE_UNSOLVED = BatchSolution._fields[: BatchSolution._fields.index("unstable")]


def _find_coexisting(problem: BatchProblem, free: Complexes, points: NDArray[np.intp], solution: BatchSolution) -> None:
    """Write the amplitude of the other solution of points whose initial guess has several, if it is stable."""
    guess = initial_guess(problem, free, upper_branch=not problem.upper_branch)
    iterates, solved = _refine(problem, _iterates(problem, free, guess), guess.truncation)
    other = _measured(problem, iterates, guess.truncation, solved)
    own = solution.vibration_amplitude[points]
    distinct = np.abs(other.vibration_amplitude - own) > _DISTINCT * own
    coexisting = solved & ~other.unstable & distinct
    solution.coexisting_amplitude[points[coexisting]] = other.vibration_amplitude[coexisting]
