"""Many operating points of one rig at once: vibrations solved together, friction under each, a status to each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.actuator.stack import require_allowed_voltage
from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact import GapMotion, separation
from sonolube.dynamics import Status, SteadyStates, steady_state
from sonolube.dynamics.backend import Backend
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.rig.excitation import amplifier_power, voltage_harmonics, voltage_range
from sonolube.rig.friction_and_wear import friction_ratios
from sonolube.rig.linear_response import gap_law_of, require_drive, require_structure
from sonolube.rig.record import Rig
from sonolube.rig.steady_vibration import gap_motion

REFUSED = "refused"
"""Status of an operating point that a limit of the stack, the contact or the closure rules out."""

SETTINGS = ("voltage_peak_to_peak", "voltage_offset", "frequency", "normal_load")
"""What is set of a point beside its sliding speed, in the order of the rows that hold it."""

Advance = Callable[[int, int], None]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class OperatingPoints:
    """What a rig does at many operating points; every array has the shape of the broadcast settings.

    A point that was refused or did not converge has NaN for its numbers, and `reason` says why.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray
        Swing of the drive. [V]
    voltage_offset : ndarray
        Its mean. [V]
    frequency : ndarray
        Frequency of the drive. [Hz]
    normal_load : ndarray
        Force pressing the bodies together. [N]
    sliding_speed : ndarray
        Macroscopic relative speed. [m/s]
    status : ndarray of str
        "periodic", "unstable", "multistable" or "not_converged", as the steady state was found, or "refused".
    reason : ndarray of str
        What the status means, and what to try.
    vibration_amplitude : ndarray
        Vibration of the tip, zero to peak. [m]
    vibration_velocity : ndarray
        Highest speed of the tip along the surface normal. [m/s]
    mean_displacement : ndarray
        Rise of the tip from rest under the load. [m]
    contact_loss_fraction : ndarray
        Share of the period in which the contact carries less than a hundredth of the load. []
    friction_ratio : ndarray
        Friction with vibration over friction without, by the rig's closure. []
    friction_reduction : ndarray
        One minus that ratio. []
    friction_coefficient : ndarray
        Mean friction force over the normal load. []
    friction_force : ndarray
        Mean friction force with vibration. [N]
    actuator_power : ndarray
        Power a linear amplifier supplies, D 1.9. [W]
    dissipated_power : ndarray
        Mean electrical power that stays in stack, dampers and contact. [W]
    gap_closed : ndarray of bool
        Whether the mean planes meet within the period, where the contact model no longer holds.
    """

    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    frequency: Floats
    normal_load: Floats
    sliding_speed: Floats
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    vibration_amplitude: Floats
    vibration_velocity: Floats
    mean_displacement: Floats
    contact_loss_fraction: Floats
    friction_ratio: Floats
    friction_reduction: Floats
    friction_coefficient: Floats
    friction_force: Floats
    actuator_power: Floats
    dissipated_power: Floats
    gap_closed: NDArray[np.bool_]

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Which points have no friction."""
        return np.isnan(self.friction_ratio)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Settings:
    """Drives and loads of a batch, each array of one axis."""

    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    frequency: Floats
    normal_load: Floats

    @classmethod
    def of_columns(cls, columns: Floats) -> "Settings":
        """Return settings from their rows, in the order of the fields."""
        return cls(**dict(zip(SETTINGS, columns, strict=True)))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Outcome:
    """What becomes of the points that share one vibration."""

    status: list[str]
    reason: list[str]
    numbers: Floats  # five of the vibration, whether the gap closes, and the friction ratio


def operating_points(
    rig: Rig,
    *,
    voltage_peak_to_peak: ArrayLike | None = None,
    voltage_offset: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    normal_load: ArrayLike | None = None,
    sliding_speed: ArrayLike | None = None,
    advance: Advance | None = None,
    backend: Backend = "cpu",
) -> OperatingPoints:
    """Return what a rig does at many operating points; what is not given is the rig's own.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    voltage_peak_to_peak : array_like, optional
        Swing of the drive. [V]
    voltage_offset : array_like, optional
        Its mean. [V]
    frequency : array_like, optional
        Frequency of the drive. [Hz]
    normal_load : array_like, optional
        Force pressing the bodies together; the structure stays as it is. [N]
    sliding_speed : array_like, optional
        Macroscopic relative speed. [m/s]
    advance : callable, optional
        Told how many vibrations are done, and of how many.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can.

    Returns
    -------
    OperatingPoints

    Raises
    ------
    InvalidInput
        If the rig has no structure, a setting has no meaning or shapes do not match.
        A point that cannot be had is no reason: it gets its status.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve the rig's contact or structure.

    Notes
    -----
    Steady vibrations are found in one batch, each drive and load once, whatever the number of sliding speeds.
    """
    require_structure(rig)
    assert rig.stack is not None
    columns, speeds = broadcast(rig, (voltage_peak_to_peak, voltage_offset, frequency, normal_load, sliding_speed))
    shape = speeds.shape
    distinct, which = np.unique(columns.reshape(4, -1), axis=1, return_inverse=True)
    settings, speeds = Settings.of_columns(distinct), speeds.ravel()
    rest = separation(rig.contact, normal_load=settings.normal_load)
    refusals = _refusals(rig, settings, rest)
    possible = np.array([not text for text in refusals], dtype=bool)
    states = None
    if possible.any():
        states = steady_states_of(rig, Settings.of_columns(distinct[:, possible]), rest[possible], backend)
    place = np.cumsum(possible) - 1

    status, reason = np.full((2, speeds.size), REFUSED, dtype=object)
    numbers = np.full((7, speeds.size), np.nan)
    for setting, members in enumerate(grouped(np.arange(speeds.size), which.ravel())):
        if states is not None and possible[setting]:
            found = _outcome(rig, states, int(place[setting]), speeds[members])
            status[members], reason[members], numbers[:, members] = found.status, found.reason, found.numbers
        else:
            reason[members] = refusals[setting]
        if advance is not None:
            advance(setting + 1, possible.size)
    columns = columns.reshape(4, *shape)
    amplitude, velocity, rise, lost, dissipated, closed, ratio = numbers.reshape(7, *shape)
    return OperatingPoints(
        **dict(zip(SETTINGS, columns, strict=True)),
        sliding_speed=speeds.reshape(shape),
        status=status.astype(np.str_).reshape(shape),
        reason=reason.astype(np.str_).reshape(shape),
        vibration_amplitude=amplitude,
        vibration_velocity=velocity,
        mean_displacement=rise,
        contact_loss_fraction=lost,
        **friction_and_power(rig, columns, friction_ratio=ratio),
        dissipated_power=dissipated,
        gap_closed=closed == 1,
    )


def friction_and_power(rig: Rig, columns: Floats, *, friction_ratio: Floats) -> dict[str, Floats]:
    """Return by name what follows from the friction ratio and the settings of points.

    Parameters
    ----------
    rig : Rig
    columns : ndarray
        Settings as `broadcast` returns them.
    friction_ratio : ndarray
        At each point. []

    Returns
    -------
    dict of str to ndarray
    """
    assert rig.stack is not None
    u, offset, f, load = columns
    return {
        "friction_ratio": friction_ratio,
        "friction_reduction": 1 - friction_ratio,
        "friction_coefficient": friction_ratio * rig.friction_coefficient,
        "friction_force": friction_ratio * rig.friction_coefficient * load,
        "actuator_power": amplifier_power(
            require_drive(rig),
            capacitance=rig.stack.free_capacitance,
            voltage_peak_to_peak=u,
            voltage_offset=offset,
            frequency=f,
        ),
    }


def steady_states(
    rig: Rig, *, voltage_peak_to_peak: ArrayLike | None = None, voltage_offset: ArrayLike | None = None
) -> SteadyStates:
    """Return the steady vibrations of a rig under some voltages, harmonics and all.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    voltage_peak_to_peak : array_like, optional
        Swing of the drive, of one axis. [V]
    voltage_offset : array_like, optional
        Its mean. [V]

    Returns
    -------
    SteadyStates

    Raises
    ------
    InvalidInput
        If the rig has no structure or a setting has no meaning.
    """
    columns, _ = broadcast(rig, (voltage_peak_to_peak, voltage_offset, None, None, None))
    settings = Settings.of_columns(columns.reshape(4, -1))
    return steady_states_of(rig, settings, separation(rig.contact, normal_load=settings.normal_load))


def broadcast(rig: Rig, given: Sequence[ArrayLike | None]) -> tuple[Floats, Floats]:
    """Return drives and loads as the rows of Settings, and speeds, all of one shape; refuse what has no meaning.

    What is given are swing, mean and frequency of the drive, load and sliding speed; for nothing, the rig's own.
    """
    voltage, offset, f, load, speed = given
    drive = require_drive(rig)
    assert drive.voltage_peak_to_peak is not None
    settings = (
        require_non_negative(voltage_peak_to_peak=drive.voltage_peak_to_peak if voltage is None else voltage),
        require_finite(voltage_offset=drive.voltage_offset if offset is None else offset),
        require_positive(frequency=drive.frequency if f is None else f),
        require_positive(normal_load=rig.normal_load if load is None else load),
        require_non_negative(sliding_speed=rig.sliding_speed if speed is None else speed),
    )
    try:
        every = np.broadcast_arrays(*settings)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in settings)
        raise InvalidInput(
            f"voltage, offset, frequency, load and speed must have matching shapes, got {shapes}"
        ) from None
    return np.stack(every[:-1]), every[-1].copy()


def _refusals(rig: Rig, settings: Settings, rest: Floats) -> list[str]:
    """Return why a drive or load cannot be had, empty where it can."""
    assert rig.stack is not None
    refusals = []
    extremes = voltage_range(
        require_drive(rig), voltage_peak_to_peak=settings.voltage_peak_to_peak, voltage_offset=settings.voltage_offset
    )
    for voltages, load, gap in zip(np.transpose(extremes), settings.normal_load, rest, strict=True):
        refusal = ""
        try:
            require_allowed_voltage(rig.stack, stack_voltage=voltages)
        except SonolubeError as beyond:
            refusal = str(beyond)
        if gap <= 0:
            refusal = f"normal_load {load:g} N leaves no separation between the surfaces: lower the load"
        refusals.append(refusal)
    return refusals


def steady_states_of(rig: Rig, settings: Settings, rest: Floats, backend: Backend = "cpu") -> SteadyStates:
    """Return the steady vibrations of a rig under drives and loads, of which the separations at rest are known."""
    return steady_state(
        require_structure(rig),
        gap_law_of(rig),
        normal_load=settings.normal_load,
        frequency=settings.frequency,
        voltage_harmonics=voltage_harmonics(require_drive(rig), voltage_peak_to_peak=settings.voltage_peak_to_peak),
        voltage_offset=settings.voltage_offset,
        separation=rest,
        backend=backend,
    )


def grouped(points: NDArray[np.intp], vibration: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the points that share each vibration, in the order of the vibrations.

    Parameters
    ----------
    points : ndarray of int, shape (k,)
    vibration : ndarray of int, shape (n,)
        That of every point.

    Returns
    -------
    list of ndarray of int
    """
    if not points.size:
        return []
    order = points[np.argsort(vibration[points], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(vibration[order])) + 1)


def _outcome(rig: Rig, states: SteadyStates, point: int, speeds: Floats) -> _Outcome:
    known, reason = Status(int(states.status[point])), states.reason(point)
    status, numbers = known.name.lower(), np.full((7, speeds.size), np.nan)
    if known is Status.NOT_CONVERGED:
        return _Outcome(status=[status] * speeds.size, reason=[reason] * speeds.size, numbers=numbers)
    moving = gap_motion(states, point)
    numbers[:-1].T[:] = (
        states.vibration_amplitude[point],
        np.abs(moving.velocity).max(),
        states.mean_displacement[point],
        states.contact_loss_fraction[point],
        states.dissipated_power[point],
        states.gap_closed[point],
    )
    numbers[-1], refusals = friction_of(rig, moving, speeds)
    return _Outcome(
        status=[REFUSED if refusal else status for refusal in refusals],
        reason=[refusal or reason for refusal in refusals],
        numbers=numbers,
    )


def friction_of(rig: Rig, moving: GapMotion, speeds: Floats) -> tuple[Floats, list[str]]:
    """Return the friction ratio at each speed, and why a speed has none."""
    try:
        return friction_ratios(rig, moving, sliding_speed=speeds), [""] * speeds.size
    except SonolubeError as refusal:
        if speeds.size == 1:
            return np.full(1, np.nan), [str(refusal)]
    ratios, refusals = zip(*(friction_of(rig, moving, speed) for speed in speeds[:, np.newaxis]), strict=True)
    return np.concatenate(ratios), [text for texts in refusals for text in texts]
