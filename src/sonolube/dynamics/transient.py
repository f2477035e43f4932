"""Transients: start-up, hopping, bouncing and whatever else a structure does against its contact, marched in time."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.dynamics.backend import Backend
from sonolube.dynamics.first_order_modes import StatePairs, state_pairs
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.sharing import shared_march
from sonolube.dynamics.structure import Structure
from sonolube.dynamics.time_marching.batch import Marched, Points, Schedule, march_points
from sonolube.dynamics.time_marching.records import ContactMotion, Envelope, State, Trajectories, Trajectory
from sonolube.dynamics.time_marching.step_control import force_in_motion, resolution
from sonolube.dynamics.waveform import Sine, StartUpRamp, Waveform, drive_voltage, ramp_factor
from sonolube.errors import InvalidInput

_WINDOWS = 256  # entries of an envelope unless asked otherwise
AT_ONCE = StartUpRamp(duration=0.0)


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
    ramp: StartUpRamp = AT_ONCE,
    initial_state: State | None = None,
    periods_per_window: int | None = None,
    recorded_periods: int = 1,
    strobed_periods: int = 64,
    workers: int = 1,
    backend: Backend = "cpu",
) -> Trajectories:
    """March many points in time.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load. [N]
    frequency : array_like, broadcast against `normal_load`
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : array_like, broadcast against `normal_load`
        Drive voltage, peak to peak. [V]
    voltage_offset : array_like, broadcast against `normal_load`
        Its mean. [V]
    periods : int
        Periods of the drive to march.
    steps_per_period : int
        A multiple of 4, at least 8.
    waveform : Waveform or None
        Shape of the voltage; a sine if None.
    ramp : StartUpRamp
        How voltage and offset come up.
    initial_state : State or None
        Start, for each point or one for all; rest under the dead load if None.
    periods_per_window : int or None
        Periods to an entry of the envelope; as many as keep it at 256 entries if None.
    recorded_periods : int
        Periods at the end of which every step is returned.
    strobed_periods : int
        Periods at the end of which the last instant is returned.
    workers : int
        Threads of the processor to march with. Results do not depend on it.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU marches all points, a thread to each.

    Returns
    -------
    Trajectories
        With the shape of the broadcast arguments in front.

    Raises
    ------
    InvalidInput
        If a load or frequency is not positive, a voltage swing negative, a value not finite, a count out of range,
        shapes do not match, or the waveform jumps within a step.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not march this contact, structure or waveform.

    Notes
    -----
    Without contact the steps are exact, whatever their length, under any waveform and a linear ramp. The contact force
    is integrated to fifth order, by `step_filter`, where it is smooth: under the exponential law, before and after any
    jump of the voltage or end of a ramp, which restart the integration. Where Hertzian or linear contact is lost, or
    damping would pull, the force has a corner and the order falls to two; `advice` says so. An amplitude of fourteen
    micrometres over a decay length of two takes 12 steps a period for an error of 1e-4 of amplitude, mean force and
    friction, and 16 for 1e-5. Steps must also follow the contact at its stiffest; `status` is "coarse" where they do
    not.

    A GPU takes the same steps, but its sums round otherwise, by parts in 1e15 a step. Where disturbances do not grow
    its answers are within 1e-9 of the processor's, over the largest of their kind; in chaos rounding grows on either.
    """
    shape, points = _points(normal_load, frequency, voltage_peak_to_peak, voltage_offset)
    pairs = state_pairs(structure)
    schedule = Schedule(
        waveform=Sine() if waveform is None else waveform,
        ramp=ramp,
        steps=steps_per_period,
        periods=periods,
        window=-(-periods // _WINDOWS) if periods_per_window is None else periods_per_window,
        recorded=recorded_periods,
        strobed=strobed_periods,
    )
    start = _start(pairs, structure, initial_state, shape)
    contact_rows = _contact_rows(pairs, structure)
    marched = shared_march(pairs, contact_rows, gap_law, points, start, schedule, workers=workers, backend=backend)
    load = points.normal_load
    verdict = resolution(marched, contact_rows, gap_law, load, steps_per_period)
    return Trajectories(
        status=verdict.status.reshape(shape),
        advice=verdict.advice.reshape(shape),
        step_error=verdict.step_error.reshape(shape),
        envelope=_envelope(marched, points.frequency, schedule, shape),
        last_periods=_contact_motion(marched.recorded[:, :-1], contact_rows, gap_law, load, shape),
        strobed=_contact_motion(marched.strobed, contact_rows, gap_law, load, shape),
        final_state=_state(pairs, marched.final, shape),
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
    ramp: StartUpRamp = AT_ONCE,
    initial_state: State | None = None,
) -> Trajectory:
    """March one point and return every step.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load. [N]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : float
        Drive voltage, peak to peak. [V]
    voltage_offset : float
        Its mean. [V]
    periods : int
        Periods of the drive to march.
    steps_per_period : int
        A multiple of 4, at least 8.
    waveform : Waveform or None
        Shape of the voltage; a sine if None.
    ramp : StartUpRamp
        How voltage and offset come up.
    initial_state : State or None
        Start; rest under the dead load if None.

    Returns
    -------
    Trajectory

    Raises
    ------
    InvalidInput
        As `march` does.
    """
    shape, points = _points(normal_load, frequency, voltage_peak_to_peak, voltage_offset)
    if shape:
        raise InvalidInput(f"trajectory takes one point, got {points.frequency.size}; march takes many")
    shaped = Sine() if waveform is None else waveform
    pairs = state_pairs(structure)
    contact_rows = _contact_rows(pairs, structure)
    schedule = Schedule(
        waveform=shaped, ramp=ramp, steps=steps_per_period, periods=periods, window=periods, recorded=periods, strobed=1
    )
    start = _start(pairs, structure, initial_state, shape)
    marched = march_points(pairs, contact_rows, gap_law, points, start, schedule, workers=1)
    verdict = resolution(marched, contact_rows, gap_law, points.normal_load, steps_per_period)
    states = np.concatenate([start[np.newaxis, :, :1], marched.recorded[:, :-1]])
    time = np.arange(states.shape[0]) / (frequency * steps_per_period)
    at_rest = {"voltage_offset": voltage_offset, "voltage_peak_to_peak": voltage_peak_to_peak, "frequency": frequency}
    return Trajectory(
        time=time,
        voltage=ramp_factor(ramp, time=time) * drive_voltage(shaped, **at_rest, time=time),
        contact=_contact_motion(states, contact_rows, gap_law, points.normal_load, shape),
        states=_state(pairs, states[..., 0].T, (time.size,)),
        status=str(verdict.status[0]),
        advice=str(verdict.advice[0]),
    )


def _points(
    normal_load: ArrayLike, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike, voltage_offset: ArrayLike
) -> tuple[tuple[int, ...], Points]:
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
    return f.shape, Points(
        normal_load=load.ravel(), frequency=f.ravel(), voltage_peak_to_peak=swing.ravel(), voltage_offset=offset.ravel()
    )


def _contact_rows(pairs: StatePairs, structure: Structure) -> Floats:
    return np.stack(
        [np.einsum("j,jpb->pb", structure.contact_vector, each) for each in (pairs.to_displacement, pairs.to_velocity)]
    )


def _start(pairs: StatePairs, structure: Structure, state: State | None, shape: tuple[int, ...]) -> Floats:
    """Return the state of each point, shape (2 n, points)."""
    n, count = structure.coordinates, int(np.prod(shape))
    if state is None:
        return np.zeros((2 * n, count))
    try:
        x = np.broadcast_to(require_finite(coordinates=state.coordinates), (*shape, n)).reshape(count, n)
        v = np.broadcast_to(require_finite(rates=state.rates), (*shape, n)).reshape(count, n)
    except ValueError as refusal:
        if isinstance(refusal, InvalidInput):
            raise
        raise InvalidInput(
            f"initial_state must have {n} coordinates and rates for each of {count} points,"
            f" got shapes {np.shape(state.coordinates)} and {np.shape(state.rates)}"
        ) from None
    states = np.einsum("paj,lj->pal", pairs.from_displacement, x) + np.einsum("paj,lj->pal", pairs.from_velocity, v)
    return np.asarray(states.reshape(2 * n, count))


def _state(pairs: StatePairs, states: Floats, shape: tuple[int, ...]) -> State:
    n = pairs.generator.shape[0]
    x, v = (each.reshape(n, 2 * n) @ states for each in (pairs.to_displacement, pairs.to_velocity))
    return State(coordinates=x.T.reshape(*shape, n), rates=v.T.reshape(*shape, n))


def _contact_motion(
    states: Floats, contact_rows: Floats, gap_law: GapLaw, load: Floats, shape: tuple[int, ...]
) -> ContactMotion:
    x, v = (np.einsum("m,tml->lt", row.ravel(), states) for row in contact_rows)
    force = force_in_motion(gap_law, x, v, load[:, np.newaxis])
    return ContactMotion(
        displacement=x.reshape(*shape, -1), velocity=v.reshape(*shape, -1), normal_force=force.reshape(*shape, -1)
    )


def _envelope(marched: Marched, f: Floats, schedule: Schedule, shape: tuple[int, ...]) -> Envelope:
    ends = np.minimum(np.arange(1, marched.statistics.shape[0] + 1) * schedule.window, schedule.periods)
    samples = np.diff(ends, prepend=0)[:, np.newaxis] * schedule.steps
    highest, lowest, total, cosine, sine, force, strongest, weakest = np.moveaxis(marched.statistics, 1, 0)

    def of_points(values: Floats) -> Floats:
        return values.T.reshape(*shape, -1)

    return Envelope(
        time=of_points(ends[:, np.newaxis] / f),
        first_harmonic_amplitude=of_points(2 * np.hypot(cosine, sine) / samples),
        mean_displacement=of_points(total / samples),
        highest_displacement=of_points(highest),
        lowest_displacement=of_points(lowest),
        mean_normal_force=of_points(force / samples),
        highest_normal_force=of_points(strongest),
        lowest_normal_force=of_points(weakest),
    )
