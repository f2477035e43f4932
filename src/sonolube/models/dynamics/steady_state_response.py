"""Periodic steady-state response of a structure vibrating against its contact, by harmonic balance, for batches."""

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import (
    Complexes,
    Floats,
    require_finite,
    require_finite_complex,
    require_non_negative,
    require_positive,
)
from sonolube.errors import InvalidInput
from sonolube.execution.threads import map_chunks
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem, BatchSolution, concatenate
from sonolube.models.dynamics.harmonic_balance.equations import pole_residue_model
from sonolube.models.dynamics.harmonic_balance.solver import MAX_HARMONICS, solve
from sonolube.models.dynamics.motions import Status, SteadyStates
from sonolube.models.dynamics.structure import Structure
from sonolube.models.dynamics.warm_up import compile_in_parallel


def steady_state(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    voltage_amplitude: ArrayLike | None = None,
    voltage_harmonics: ArrayLike | None = None,
    voltage_offset: ArrayLike = 0.0,
    separation: ArrayLike | None = None,
    upper_branch: bool = False,
    minimum_harmonics: int = 1,
    relative_tolerance: float = 1e-6,
    stability: bool = True,
    workers: int = 1,
) -> SteadyStates:
    r"""Periodic steady-state vibration of a structure against its contact, by harmonic balance.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load on the contact. [N]
    frequency : array_like
        Frequency of the drive. [Hz]
    voltage_amplitude : array_like, optional
        Amplitude of a sinusoidal drive, a cosine at phase zero. [V]
    voltage_harmonics : array_like of complex, shape (..., K), optional
        Harmonics of any other periodic drive, in V: twice the `fourier_coefficients` of its waveform times the
        peak-to-peak voltage.
    voltage_offset : array_like
        Mean of the drive. [V]
    separation : array_like, optional
        Separation at equilibrium under the dead load, for `gap_closed`. [m]
    upper_branch : bool
        Whether to return the larger of coexisting vibrations, which a voltage lowered to its value reaches, rather
        than the smaller, which a raised one reaches.
    minimum_harmonics : int
        Least number of harmonics of the contact, from 1 to 64, all coupled; more than the points require makes
        neighbouring points comparable to the last digit.
    relative_tolerance : float
        Largest error of amplitude and mean force relative to the exact solution of the equations, from 1e-8 to 1e-3; a
        looser one takes fewer harmonics.
    stability : bool
        Whether to compute stability, which takes about as long as the vibration itself.
    workers : int
        Number of threads of the CPU.

    Returns
    -------
    SteadyStates
        Of the shape of the broadcast arguments.

    Raises
    ------
    InvalidInput
        If a frequency or load is not positive, a value not finite, the drive not given in exactly one way, there are no
        points, or `minimum_harmonics` or `relative_tolerance` is out of its range.

    See Also
    --------
    friction_averages, response_curve, march

    Notes
    -----
    Only the contact is nonlinear, so that the unknowns are the mean and the harmonics of its displacement alone:

    .. math::
        S_0\,(\bar x - \bar x_0) = \bar F_n - F_N, \qquad X_k = H(k\omega)\,V_k + G(k\omega)\,\Phi_k

    with the harmonics :math:`\Phi_k` of the contact force, which is sampled in time and Fourier transformed. Numbers of
    harmonics and samples adapt to each point [1]_. Batches are solved in chunks, which bounds the memory.

    Coexisting vibrations of the drive's period are searched for where the equation of a single harmonic has several
    solutions. Motions of other periods that coexist with a stable vibration are not: impacting at a few hundred hertz,
    a start from rest can end in one.

    References
    ----------
    .. [1] T. M. Cameron and J. H. Griffin, J. Appl. Mech. 56, 149 (1989), on alternating frequency-time transforms.
       doi:10.1115/1.3176036

    Examples
    --------
    >>> from sonolube.models.dynamics import ExponentialGap, steady_state
    >>> from sonolube.rig import read_rig
    >>> tribometer = read_rig("examples/rigs/tribometer.toml").structure
    >>> contact = ExponentialGap(decay_length=2e-6)
    >>> states = steady_state(tribometer, contact, normal_load=3.0, frequency=22e3, voltage_amplitude=[7.0, 14.0])
    >>> (1e6 * states.vibration_amplitude).round(2).tolist(), states.contact_loss_fraction.tolist()
    ([1.25, 2.5], [0.0, 0.0])
    """
    harmonics = drive_harmonics(voltage_amplitude, voltage_harmonics)
    if not 1 <= minimum_harmonics <= MAX_HARMONICS:
        raise InvalidInput(f"minimum_harmonics must lie between 1 and {MAX_HARMONICS}, got {minimum_harmonics!r}")
    if not 1e-8 <= relative_tolerance <= 1e-3:
        raise InvalidInput(f"relative_tolerance must lie between 1e-8 and 1e-3, got {relative_tolerance!r}")
    load, f = require_positive(normal_load=normal_load), require_positive(frequency=frequency)
    offset = require_finite(voltage_offset=voltage_offset)
    rest = np.asarray(np.inf) if separation is None else require_positive(separation=separation)
    shape = _batch_shape(load.shape, f.shape, harmonics.shape[:-1], offset.shape, rest.shape)

    def flat(values: Floats) -> Floats:
        return np.ascontiguousarray(np.broadcast_to(values, shape)).reshape(-1)

    drive = np.broadcast_to(harmonics, (*shape, harmonics.shape[-1]))
    model = pole_residue_model(structure)
    problem = BatchProblem(
        model=model,
        gap_law=gap_law,
        omega=2 * np.pi * flat(f),
        load=flat(load),
        voltage=np.ascontiguousarray(drive).reshape(-1, drive.shape[-1]),
        static_displacement=model.displacement_per_volt * flat(offset),
        minimum_harmonics=minimum_harmonics,
        upper_branch=upper_branch,
        stability=stability,
        tolerance=relative_tolerance,
    )
    solution = _solve(problem, workers)
    orders = np.arange(1, problem.voltage.shape[1] + 1)
    current = 1j * problem.omega[:, np.newaxis] * orders * solution.charge_harmonics
    columns: dict[str, Any] = {
        "normal_load": problem.load,
        "frequency": flat(f),
        "voltage_harmonics": problem.voltage,
        "voltage_offset": flat(offset),
        "status": _status(solution),
        "current_harmonics": current,
        "dissipated_power": 0.5 * np.sum((problem.voltage * current.conj()).real, axis=1),
        "gap_closed": solution.lowest_displacement <= -flat(rest),
    }
    columns |= {name: getattr(solution, name) for name in _SHARED_FIELDS}
    shaped = {name: values.reshape((*shape, *values.shape[1:])) for name, values in columns.items()}
    return SteadyStates(structure=structure, gap_law=gap_law, relative_tolerance=relative_tolerance, **shaped)


_SHARED_FIELDS = {field.name for field in fields(SteadyStates)} & set(BatchSolution._fields)


def _solve(problem: BatchProblem, workers: int) -> BatchSolution:
    """Solution of a batch, in chunks."""
    with compile_in_parallel(kernel_law(problem.gap_law), stability=problem.stability, tolerance=problem.tolerance):
        return concatenate(map_chunks(lambda own: solve(problem.select(own)), problem.omega.size, workers))


def _batch_shape(*shapes: tuple[int, ...]) -> tuple[int, ...]:
    """Broadcast shape of the points, at least one."""
    given = f"load, frequency, voltage, offset and gap{{}} shapes{{}} {', '.join(map(str, shapes))}"
    try:
        shape = np.broadcast_shapes(*shapes)
    except ValueError:
        raise InvalidInput(given.format(" must have matching", ", got")) from None
    if 0 in shape:
        raise InvalidInput(f"there are no points to compute: {given.format(' have', '')}")
    return shape


def drive_harmonics(amplitude: ArrayLike | None, harmonics: ArrayLike | None) -> Complexes:
    """Harmonics of a drive given either by its amplitude or by its harmonics, shape (..., K), in V.

    `harmonics` has shape (..., K).
    """
    if (amplitude is None) == (harmonics is None):
        raise InvalidInput("give either voltage_amplitude or voltage_harmonics")
    if amplitude is not None:
        return require_non_negative(voltage_amplitude=amplitude)[..., np.newaxis].astype(np.complex128)
    assert harmonics is not None
    drive = require_finite_complex(voltage_harmonics=harmonics)
    if drive.ndim == 0 or not 1 <= drive.shape[-1] <= MAX_HARMONICS:
        raise InvalidInput(
            f"voltage_harmonics must have 1 to {MAX_HARMONICS} harmonics along the last axis, got shape {drive.shape}"
        )
    return drive


def _status(solution: BatchSolution) -> NDArray[np.int8]:
    """Status of each point."""
    status = np.full(solution.mean_displacement.shape, Status.PERIODIC, dtype=np.int8)
    status[np.isfinite(solution.coexisting_amplitude)] = Status.MULTISTABLE
    status[solution.unstable] = Status.UNSTABLE
    status[np.isnan(solution.mean_displacement)] = Status.NOT_CONVERGED
    return status
