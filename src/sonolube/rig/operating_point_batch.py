"""Operating points of one rig in very large batches: numbers as columns, statuses and reasons as codes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import SonolubeError
from sonolube.models.contact import GapMotionBatch, separation
from sonolube.models.dynamics import Status, SteadyStates
from sonolube.models.dynamics.kernels.simd import peak_velocities
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio, checked_ratio
from sonolube.rig import operating_conditions as conditions, operating_point_grid as grid
from sonolube.rig.friction_and_wear import friction_at_speeds
from sonolube.rig.operating_conditions import REFUSED, steady_states_of
from sonolube.rig.power import POWERS, electrical_load
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.rig.vibration import gap_motion

STATUSES = (*(status.name.lower() for status in Status), REFUSED, OUTSIDE_MODEL_RANGE)
"""Statuses of an operating point, by code."""

NUMBERS = (
    "friction_ratio",
    "friction_reduction",
    "friction_coefficient",
    "friction_force",
    "raw_friction_ratio",
    "vibration_amplitude",
    "vibration_velocity",
    "mean_displacement",
    "contact_loss_fraction",
    *POWERS,
)
"""Numbers of an operating point, the columns of a batch."""

_FEW = 15_000  # points for which plain Python takes less than compiling
_REFUSED = STATUSES.index(REFUSED)
_REASONS = {
    "periodic": "the vibration repeats with the drive",
    "unstable": "the vibration repeats with the drive, but small disturbances grow; simulate the point for the"
    " motion that appears instead",
    "multistable": "another vibration is stable too; simulate the point for the one that appears",
    "not_converged": "no vibration at the drive's own period was found; start from a lower voltage or add damping",
}
_NO_SEPARATION = "normal_load leaves no separation between the surfaces: lower the load"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PointBatch:
    """Operating points as columns, one row to a point.

    Parameters
    ----------
    numbers : dict of str to ndarray, shape (n,)
        Columns by the names of `NUMBERS`, in SI; NaN for a point that was refused or did not converge,
        those of friction also outside the range of the friction model.
    status : ndarray of int, shape (n,)
        Indices into `STATUSES`.
    reason : ndarray of int, shape (n,)
        Indices into `reasons`.
    reasons : tuple of str
        Meaning of a status, and advice.
    """

    numbers: dict[str, Floats]
    status: NDArray[np.int8]
    reason: NDArray[np.int16]
    reasons: tuple[str, ...]


def point_batch(
    rig: Rig | ResolvedRig,
    *,
    voltage_peak_to_peak: ArrayLike | None = None,
    voltage_offset: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    normal_load: ArrayLike | None = None,
    sliding_speed: ArrayLike | None = None,
    vibration_amplitude: ArrayLike | None = None,
    friction_tolerance: float = 1e-7,
) -> PointBatch:
    """Operating points of a rig in a very large batch; settings that are absent are the rig's own.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        Its vibration is by the source of its amplitude: of a structure, or a sine.
    voltage_peak_to_peak : array_like, optional
        Peak-to-peak voltage of the drive. [V]
    voltage_offset : array_like, optional
        Mean voltage of the drive. [V]
    frequency : array_like, optional
        Frequency of the drive. [Hz]
    normal_load : array_like, optional
        Force pressing the bodies together; the structure stays as it is. [N]
    sliding_speed : array_like, optional
        Macroscopic relative speed. [m/s]
    vibration_amplitude : array_like, optional
        Amplitude of the sine at any frequency, of a rig without a drive voltage. [m]
    friction_tolerance : float
        Largest error of a friction ratio by the batched form of a friction model; 8e-5 is five times as fast.

    Returns
    -------
    PointBatch
        Its rows are the broadcast settings, the last axis fastest.

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, a setting has no meaning or shapes do not match.

    Notes
    -----
    The points of `operating_points`, with general reasons. A friction model with a batched form gives the
    friction of the whole batch at once, asperity stick-slip on exponential heights to `friction_tolerance`; any other
    is evaluated for each vibration, and so is a sine of a stated amplitude.
    """
    resolved = resolved_rig(rig)
    rig = resolved.rig
    given = (voltage_peak_to_peak, voltage_offset, frequency, normal_load, sliding_speed)
    if resolved.vibration.driven is None:
        stated: dict[str, Any] = dict(zip(conditions.SETTINGS, given, strict=True))
        return _columns(grid.operating_points(resolved, **stated, vibration_amplitude=vibration_amplitude))
    columns, speeds = conditions.conditions_of(rig, given, vibration_amplitude=vibration_amplitude)
    columns, speeds = columns.reshape(4, -1), speeds.ravel()
    first, which = _distinct(columns)
    distinct = columns[:, first]
    rest = separation(rig.contact, normal_load=distinct[-1])
    refusal, reasons = _refusals(resolved, distinct, rest)
    status, reason = np.full(first.size, _REFUSED, dtype=np.int8), refusal.copy()
    numbers = np.full((len(grid.VIBRATION_NUMBERS), first.size), np.nan)
    friction = _no_friction(speeds.size)
    possible = np.flatnonzero(refusal == 0)
    if possible.size:
        states = steady_states_of(resolved, distinct[:, possible], rest[possible])
        status[possible] = states.status
        reason[possible] = states.status
        numbers[:, possible] = _measures(states)
        place = np.full(first.size, -1)
        place[possible] = np.where(states.status == Status.NOT_CONVERGED, -1, np.arange(possible.size))
        friction = _friction(rig, states, place[which], speeds, friction_tolerance)
    reasons = (*_REASONS.values(), *reasons)
    point_status, point_reason = status[which], _shifted(reason, refusal)[which]
    for text in np.unique(friction.reason[friction.reason != ""]):
        members = friction.reason == text
        point_status[members] = STATUSES.index(grid.friction_status(str(text)))
        point_reason[members] = len(reasons)
        reasons = (*reasons, str(text))
    found = grid.friction_of(
        resolved, columns, friction_ratio=friction.friction_ratio, raw_friction_ratio=friction.raw_friction_ratio
    )
    found |= dict(zip(grid.VIBRATION_NUMBERS, numbers[:, which], strict=True))
    found |= grid.supplied_power(resolved, columns, dissipated_power=found["dissipated_power"])
    return PointBatch(
        numbers={name: found[name] for name in NUMBERS}, status=point_status, reason=point_reason, reasons=reasons
    )


def _columns(points: grid.OperatingPoints) -> PointBatch:
    """Operating points as columns and codes."""
    reasons, reason = np.unique(points.reason.ravel(), return_inverse=True)
    codes = {name: code for code, name in enumerate(STATUSES)}
    return PointBatch(
        numbers={name: np.asarray(getattr(points, name), dtype=np.float64).ravel() for name in NUMBERS},
        status=np.array([codes[str(name)] for name in points.status.ravel()], dtype=np.int8),
        reason=reason.ravel().astype(np.int16),
        reasons=tuple(str(text) for text in reasons),
    )


def _distinct(columns: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Index of the first of each set of equal columns, and the set of every column."""
    mixed = np.zeros(columns.shape[1], dtype=np.uint64)
    for row in columns:
        bits = np.ascontiguousarray(row).view(np.uint64)
        mixed = (mixed ^ (bits ^ (bits >> np.uint64(29)))) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(32)
    _, first, which = np.unique(mixed, return_index=True, return_inverse=True)
    if not np.array_equal(columns[:, first[which]], columns):  # a hash collision
        _, first, which = np.unique(columns, axis=1, return_index=True, return_inverse=True)
    return first, which.ravel()


def _refusals(resolved: ResolvedRig, distinct: Floats, rest: Floats) -> tuple[NDArray[np.int16], tuple[str, ...]]:
    """Number of the reason against each drive and load, from 1, 0 without one; and the reasons."""
    stack = resolved.moved.stack
    low, high = stack.lowest_voltage, stack.highest_voltage
    lowest, highest = resolved.voltage.range(voltage_peak_to_peak=distinct[0], voltage_offset=distinct[1])
    texts = (
        f"the drive goes too low: the lowest admissible voltage is {low} V",
        f"the drive goes too high: the highest admissible voltage is {high} V",
        _NO_SEPARATION,
    )
    refused = (lowest < (-np.inf if low is None else low), highest > (np.inf if high is None else high), rest <= 0)
    refusal = np.zeros(rest.size, dtype=np.int16)
    for code, points in enumerate(refused, start=1):
        refusal[points] = code
    return refusal, texts


def _shifted(reason: NDArray[np.int16], refusal: NDArray[np.int16]) -> NDArray[np.int16]:
    """Indices into all reasons, in which refusals follow statuses."""
    return np.where(refusal > 0, refusal + len(_REASONS) - 1, reason).astype(np.int16)


def _measures(states: SteadyStates) -> Floats:
    velocity = np.empty(states.frequency.size)
    of_points = peak_velocities.for_points(velocity.size, at_first=_FEW)
    of_points(2 * np.pi * states.frequency, states.harmonics, velocity)
    velocity[states.status == Status.NOT_CONVERGED] = np.nan
    apart = {"vibration_velocity": velocity, **electrical_load(states)}
    return np.stack([apart[name] if name in apart else getattr(states, name) for name in grid.VIBRATION_NUMBERS])


def _no_friction(count: int) -> CheckedRatio:
    """As many points without a friction ratio, to be filled in."""
    ratio, raw = np.full((2, count), np.nan)
    return CheckedRatio(friction_ratio=ratio, raw_friction_ratio=raw, reason=np.full(count, "", dtype=object))


def _friction(
    rig: Rig, states: SteadyStates, place: NDArray[np.intp], speeds: Floats, tolerance: float
) -> CheckedRatio:
    """Friction ratio at each point, and the reason of points that vibrate but have none."""
    found = _no_friction(speeds.size)
    open_points = np.flatnonzero(place >= 0)
    moving = open_points[speeds[open_points] > 0]
    if moving.size and rig.direction.is_normal:
        _fill(found, moving, _batched_friction(rig, states, place[moving], speeds[moving], tolerance))
        open_points = open_points[np.isnan(found.raw_friction_ratio[open_points])]
    for members in conditions.points_by_vibration(open_points, place):
        try:
            moving_gap = gap_motion(states, int(place[members[0]]))
            _fill(found, members, friction_at_speeds(rig, moving_gap, speeds[members]))
        except SonolubeError as refusal:
            found.reason[members] = str(refusal)
    return found


def _fill(found: CheckedRatio, members: NDArray[np.intp], part: CheckedRatio) -> None:
    """Place the friction of some points."""
    for name in ("friction_ratio", "raw_friction_ratio", "reason"):
        getattr(found, name)[members] = getattr(part, name)


def _batched_friction(
    rig: Rig, states: SteadyStates, place: NDArray[np.intp], speeds: Floats, tolerance: float
) -> CheckedRatio:
    """Friction ratio at each of some moving points by the model's batched form; NaN where it has none."""
    known = states.status != Status.NOT_CONVERGED
    mean_force_ratio = states.mean_normal_force / states.normal_load
    motions = GapMotionBatch(
        mean_displacement=states.mean_displacement[known],
        harmonics=states.harmonics[known],
        frequency=states.frequency[known],
        mean_force_ratio=mean_force_ratio[known],
    )
    row = np.cumsum(known) - 1
    raw = rig.friction_model.batched_ratio(
        rig.contact,
        motions,
        sliding_speed=speeds,
        motion=row[place],
        friction_coefficient=rig.friction_coefficient,
        tolerance=tolerance,
    )
    return checked_ratio(
        rig.friction_model, raw, mean_force_ratio=mean_force_ratio[place], gap_closed=states.gap_closed[place]
    )
