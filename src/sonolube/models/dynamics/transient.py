"""Transient response of a structure against its contact: start-up, impacting and any other motion, by time marching."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, damped_force
from sonolube.models.dynamics.linear import FirstOrderModes, first_order_modes
from sonolube.models.dynamics.motions import ContactSamples, Envelope, State, Trajectories, Trajectory
from sonolube.models.dynamics.structure import Structure
from sonolube.models.dynamics.time_marching.batch import (
    MarchingProblem,
    MarchingSchedule,
    MarchingSolution,
    assess_steps,
    march_on_threads,
)
from sonolube.models.dynamics.waveform import Sine, StartUpRamp, Waveform, drive_voltage, ramp_factor

_WINDOWS = 256  # default number of entries of an envelope
NO_RAMP = StartUpRamp(duration=0.0)
"""Ramp of a drive that is switched on with its full amplitude."""


def march(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    voltage_offset: ArrayLike = 0.0,
    periods: int,
    steps_per_period: int = 16,
    waveform: Waveform | None = None,
    ramp: StartUpRamp = NO_RAMP,
    initial_state: State | None = None,
    periods_per_window: int | None = None,
    recorded_periods: int = 1,
    strobed_periods: int = 64,
    workers: int = 1,
) -> Trajectories:
    """Trajectories of a batch of points, by time marching with an exponential integrator.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load. [N]
    frequency : array_like, broadcast against `normal_load`
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : array_like, broadcast against `normal_load`
        Peak-to-peak drive voltage. [V]
    voltage_offset : array_like, broadcast against `normal_load`
        Mean drive voltage. [V]
    periods : int
        Number of drive periods to march.
    steps_per_period : int
        A multiple of 4, at least 8.
    waveform : Waveform or None
        Waveform of the voltage; a sine if None.
    ramp : StartUpRamp
        Ramp of amplitude and offset of the voltage.
    initial_state : State or None
        Initial state, of each point or one for all; equilibrium under the dead load if None.
    periods_per_window : int or None
        Periods per entry of the envelope; such that it has at most 256 entries if None.
    recorded_periods : int
        Number of periods, at the end, of which every step is returned.
    strobed_periods : int
        Number of periods, at the end, of which the last instant is returned.
    workers : int
        Number of threads of the CPU. Results do not depend on it.

    Returns
    -------
    Trajectories
        Arrays start with the shape of the broadcast arguments.

    Raises
    ------
    InvalidInput
        If a load or frequency is not positive, a peak-to-peak voltage negative, a value not finite, a count out of
        range, shapes do not match, or the waveform jumps within a step.

    See Also
    --------
    trajectory, steady_state, classify_attractor

    Notes
    -----
    Without contact force the steps are exact, whatever their length, under any waveform and a linear ramp. The contact
    force is integrated to fifth order (`ExponentialIntegrator`) where it is smooth: under the exponential law, before
    and after a jump of the voltage or the end of a ramp, at which the integration restarts. Where contact of spheres or
    springs is lost, or damping would make the force tensile, the force has a corner and the order falls to two;
    `advice` names this. An amplitude of fourteen micrometres over a decay length of two takes 12 steps per period for
    an error of 1e-4 of amplitude, mean force and friction, and 16 for 1e-5. Steps must also resolve the contact at its
    stiffest; `status` is "coarse" where they do not.
    """
    problem, shape = _problem(
        structure,
        gap_law,
        (normal_load, frequency, voltage_peak_to_peak, voltage_offset),
        initial_state,
        MarchingSchedule(
            waveform=Sine() if waveform is None else waveform,
            ramp=ramp,
            steps=steps_per_period,
            periods=periods,
            window=-(-periods // _WINDOWS) if periods_per_window is None else periods_per_window,
            recorded=recorded_periods,
            strobed=strobed_periods,
        ),
    )
    solution = march_on_threads(problem, workers)
    status, advice, step_error = assess_steps(problem, solution)
    return Trajectories(
        status=status.reshape(shape),
        advice=advice.reshape(shape),
        step_error=step_error.reshape(shape),
        envelope=_envelope(problem, solution, shape),
        last_periods=_contact_motion(problem, solution.recorded[:, :-1], shape),
        strobed=_contact_motion(problem, solution.strobed, shape),
        final_state=_state(problem.modes, solution.final, shape),
    )


def trajectory(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: float,
    frequency: float,
    voltage_peak_to_peak: float,
    voltage_offset: float = 0.0,
    periods: int,
    steps_per_period: int = 16,
    waveform: Waveform | None = None,
    ramp: StartUpRamp = NO_RAMP,
    initial_state: State | None = None,
) -> Trajectory:
    """Trajectory of one point with every time step, by the integrator of `march`.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load. [N]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : float
        Peak-to-peak drive voltage. [V]
    voltage_offset : float
        Mean drive voltage. [V]
    periods : int
        Number of drive periods to march.
    steps_per_period : int
        A multiple of 4, at least 8.
    waveform : Waveform or None
        Waveform of the voltage; a sine if None.
    ramp : StartUpRamp
        Ramp of amplitude and offset of the voltage.
    initial_state : State or None
        Initial state; equilibrium under the dead load if None.

    Returns
    -------
    Trajectory

    Raises
    ------
    InvalidInput
        As `march`, or if there is more than one point.

    See Also
    --------
    march
    """
    shaped = Sine() if waveform is None else waveform
    schedule = MarchingSchedule(
        waveform=shaped, ramp=ramp, steps=steps_per_period, periods=periods, window=periods, recorded=periods, strobed=1
    )
    point = (normal_load, frequency, voltage_peak_to_peak, voltage_offset)
    problem, shape = _problem(structure, gap_law, point, initial_state, schedule)
    if shape:
        raise InvalidInput(f"trajectory takes one point, got {problem.frequency.size}; march takes many")
    solution = march_on_threads(problem, workers=1)
    status, advice, _ = assess_steps(problem, solution)
    states = np.concatenate([problem.start[np.newaxis, :, :1], solution.recorded[:, :-1]])
    time = np.arange(states.shape[0]) / (frequency * steps_per_period)
    drive = {"voltage_offset": voltage_offset, "voltage_peak_to_peak": voltage_peak_to_peak, "frequency": frequency}
    return Trajectory(
        time=time,
        voltage=ramp_factor(ramp, time=time) * drive_voltage(shaped, **drive, time=time),
        contact=_contact_motion(problem, states, shape),
        states=_state(problem.modes, states[..., 0].T, (time.size,)),
        status=str(status[0]),
        advice=str(advice[0]),
    )


def _problem(
    structure: Structure,
    gap_law: GapLaw,
    points: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    initial_state: State | None,
    schedule: MarchingSchedule,
) -> tuple[MarchingProblem, tuple[int, ...]]:
    """Marching problem of checked and broadcast loads, frequencies, voltages and offsets, and its shape."""
    normal_load, frequency, voltage_peak_to_peak, voltage_offset = points
    checked = (
        require_positive(normal_load=normal_load),
        require_positive(frequency=frequency),
        require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak),
        require_finite(voltage_offset=voltage_offset),
    )
    try:
        load, f, swing, offset = np.broadcast_arrays(*checked)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in checked)
        raise InvalidInput(f"load, frequency, voltage and offset must have matching shapes, got {shapes}") from None
    if not f.size:
        raise InvalidInput("there must be at least one point to march")
    modes, contact = first_order_modes(structure), structure.contact_vector
    outputs = [np.einsum("j,jpb->pb", contact, each) for each in (modes.to_displacement, modes.to_velocity)]
    problem = MarchingProblem(
        modes=modes,
        contact_output=np.stack(outputs),
        gap_law=gap_law,
        schedule=schedule,
        normal_load=load.ravel(),
        frequency=f.ravel(),
        voltage_peak_to_peak=swing.ravel(),
        voltage_offset=offset.ravel(),
        start=_start(modes, structure, initial_state, f.shape),
    )
    return problem, f.shape


def _start(modes: FirstOrderModes, structure: Structure, state: State | None, shape: tuple[int, ...]) -> Floats:
    """Initial states of all points, shape (2 n, points)."""
    n, count = structure.coordinates, int(np.prod(shape))
    if state is None:
        return np.zeros((2 * n, count))
    given = require_finite(coordinates=state.coordinates), require_finite(velocities=state.velocities)
    try:
        x, v = (np.broadcast_to(each, (*shape, n)).reshape(count, n) for each in given)
    except ValueError:
        raise InvalidInput(
            f"initial_state must have {n} coordinates and velocities for each of {count} points,"
            f" got shapes {np.shape(state.coordinates)} and {np.shape(state.velocities)}"
        ) from None
    states = np.einsum("paj,lj->pal", modes.from_displacement, x) + np.einsum("paj,lj->pal", modes.from_velocity, v)
    return np.asarray(states.reshape(2 * n, count))


def _state(modes: FirstOrderModes, states: Floats, shape: tuple[int, ...]) -> State:
    """Coordinates and velocities from pairs of states."""
    n = modes.state_matrix.shape[0]
    x, v = (each.reshape(n, 2 * n) @ states for each in (modes.to_displacement, modes.to_velocity))
    return State(coordinates=x.T.reshape(*shape, n), velocities=v.T.reshape(*shape, n))


def _contact_motion(problem: MarchingProblem, states: Floats, shape: tuple[int, ...]) -> ContactSamples:
    """Motion of the contact and its force from pairs of states, shape (times, 2 n, points)."""
    x, v = (np.einsum("m,tml->lt", row.ravel(), states) for row in problem.contact_output)
    with np.errstate(over="ignore", invalid="ignore"):  # of points that diverged
        force = damped_force(problem.gap_law, x, v, problem.normal_load[:, np.newaxis])
    x, v, force = (values.reshape(*shape, -1) for values in (x, v, force))
    return ContactSamples(displacement=x, velocity=v, normal_force=force)


def _envelope(problem: MarchingProblem, solution: MarchingSolution, shape: tuple[int, ...]) -> Envelope:
    """Envelope from the statistics of the windows."""
    schedule, statistics = problem.schedule, solution.statistics
    ends = np.minimum(np.arange(1, statistics.shape[0] + 1) * schedule.window, schedule.periods)
    samples = np.diff(ends, prepend=0)[:, np.newaxis] * schedule.steps
    highest, lowest, total, cosine, sine, force, strongest, weakest = np.moveaxis(statistics, 1, 0)

    def shaped(values: Floats) -> Floats:
        return values.T.reshape(*shape, -1)

    return Envelope(
        time=shaped(ends[:, np.newaxis] / problem.frequency),
        first_harmonic_amplitude=shaped(2 * np.hypot(cosine, sine) / samples),
        mean_displacement=shaped(total / samples),
        highest_displacement=shaped(highest),
        lowest_displacement=shaped(lowest),
        mean_normal_force=shaped(force / samples),
        highest_normal_force=shaped(strongest),
        lowest_normal_force=shaped(weakest),
    )
