"""A displacement sensor as a force gauge: calibration of a holder that bends with hysteresis."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import nnls

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.measurement.gauge.preisach import PreisachPlane, mean_relay_widths, preisach_output, relay_fractions

_TURN = 0.02  # share of the range by which the displacement must come back for a turn
_MOST_ROWS = 20_000  # of a calibration, beyond which neighbouring samples are passed over
_BEYOND = 1e-9  # share of the range


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BranchCalibration:
    """Force over displacement as two polynomials: one for loading, one for unloading.

    Parameters
    ----------
    loading, unloading : Polynomial
        Force in newtons over displacement in metres.
    loading_deviation, unloading_deviation : float
        Standard deviation of the calibration about them, in newtons.
    lowest, highest : float
        Range of displacement that was calibrated, in metres.
    """

    loading: Polynomial
    unloading: Polynomial
    loading_deviation: float
    unloading_deviation: float
    lowest: float
    highest: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PreisachCalibration:
    """Force over the history of displacement, after Preisach.

    Parameters
    ----------
    plane : PreisachPlane
        Relays of the displacement, in metres.
    reversible : ndarray, shape (levels,)
        Force that the displacement of each level adds, in newtons; none is negative.
    weights : ndarray, shape (cells,)
        Force that the relays of a cell take off when up, in newtons; none is negative.
    resting_force : float
        Force with all relays down, in newtons.
    force_deviation : float
        Standard deviation of the calibration about the model, in newtons.
    """

    plane: PreisachPlane
    reversible: Floats
    weights: Floats
    resting_force: float
    force_deviation: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ForceEstimate:
    """Force as a calibrated displacement tells it.

    Parameters
    ----------
    applied_force : ndarray, shape (samples,)
        Most likely value. [N]
    applied_force_uncertainty : ndarray, shape (samples,)
        Standard uncertainty: scatter of the calibration, and displacement times stiffness. [N]
    """

    applied_force: Floats
    applied_force_uncertainty: Floats


def fit_branches(*, displacement: ArrayLike, applied_force: ArrayLike, degree: int = 3) -> BranchCalibration:
    """Return the calibration by one polynomial for loading and one for unloading.

    Parameters
    ----------
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time. [m]
    applied_force : array_like, shape (samples,)
        Reading of the load cell that pulls. [N]
    degree : int
        Of both polynomials, 1 to 7.

    Returns
    -------
    BranchCalibration

    Raises
    ------
    InvalidInput
        If the lengths differ, a value is not finite, the displacement does not vary, or a branch has too few samples.

    Notes
    -----
    Takes all unloading for one curve, wherever it began; where the curves fan out, as in D figure 2.32, the deviation
    tells by how much, and `fit_preisach` follows them.
    """
    x, force = _calibration_signals(displacement, applied_force)
    if not 1 <= degree <= 7:
        raise InvalidInput(f"degree must lie between 1 and 7, got {degree}")
    rising = _loading(x)
    branches = {}
    for name, own in (("loading", rising), ("unloading", ~rising)):
        if np.unique(x[own]).size <= degree + 1:
            raise InvalidInput(f"{name} has {int(own.sum())} samples, too few for a polynomial of degree {degree}")
        polynomial = Polynomial.fit(x[own], force[own], degree)
        misses = force[own] - polynomial(x[own])
        branches[name] = polynomial, float(np.sqrt(np.sum(misses**2) / (misses.size - degree - 1)))
    return BranchCalibration(
        loading=branches["loading"][0],
        unloading=branches["unloading"][0],
        loading_deviation=branches["loading"][1],
        unloading_deviation=branches["unloading"][1],
        lowest=float(x.min()),
        highest=float(x.max()),
    )


def force_from_branches(
    calibration: BranchCalibration, *, displacement: ArrayLike, displacement_uncertainty: float = 0.0
) -> ForceEstimate:
    """Return the force from a displacement and its direction.

    Parameters
    ----------
    calibration : BranchCalibration
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time. [m]
    displacement_uncertainty : float
        Standard uncertainty of each reading. [m]

    Returns
    -------
    ForceEstimate

    Raises
    ------
    InvalidInput
        If a reading is not finite or the uncertainty negative.
    OutsideRange
        If a reading lies beyond the calibration.
    """
    x = _within(displacement, calibration.lowest, calibration.highest)
    spread = float(require_non_negative(displacement_uncertainty=displacement_uncertainty))
    rising = _loading(x)
    slope = np.where(rising, calibration.loading.deriv()(x), calibration.unloading.deriv()(x))
    scatter = np.where(rising, calibration.loading_deviation, calibration.unloading_deviation)
    return ForceEstimate(
        applied_force=np.where(rising, calibration.loading(x), calibration.unloading(x)),
        applied_force_uncertainty=np.hypot(scatter, slope * spread),
    )


def fit_preisach(*, displacement: ArrayLike, applied_force: ArrayLike, levels: int = 16) -> PreisachCalibration:
    """Return the calibration by Preisach's model, from loops that turn at different displacements.

    Parameters
    ----------
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time, from its lowest value on; the more turns at different values, the
        better the inner loops are known. [m]
    applied_force : array_like, shape (samples,)
        Reading of the load cell that pulls. [N]
    levels : int
        Cells along each side of the plane of relays, 2 to 64.

    Returns
    -------
    PreisachCalibration

    Raises
    ------
    InvalidInput
        If the lengths differ, a value is not finite, the displacement does not vary or there are fewer samples than
        twice the levels.

    Notes
    -----
    Force leads displacement: a spring, from which relays of the displacement take off what has slipped. Least squares
    in which neither adds up to less than nothing, so that every loop dissipates. Loops between the same two
    displacements are congruent in this model; where those of the holder depend on the force besides, the deviation
    says so.

    References
    ----------
    .. [1] D 2.4.3, figure 2.32.
    .. [2] I. D. Mayergoyz, Mathematical Models of Hysteresis and Their Applications, Elsevier (2003), chapter 1.
    """
    x, force = _calibration_signals(displacement, applied_force)
    if x.size < 2 * levels:
        raise InvalidInput(f"{x.size} samples are too few for {levels} levels; give {2 * levels} or take fewer levels")
    plane = PreisachPlane(lowest=float(x.min()), highest=float(x.max()), levels=levels)
    stride = -(-x.size // _MOST_ROWS)
    ramps, shares, target = _ramps(plane, x[::stride]), relay_fractions(plane, x)[::stride], force[::stride]
    # the resting force may have either sign: it is taken as the difference of two that are not negative
    rest = np.ones((target.size, 1))
    scale = max(float(np.abs(target).max()), np.finfo(float).tiny)
    columns = np.concatenate([ramps, -shares, rest, -rest], axis=1)
    solution = scale * nnls(columns, target / scale, maxiter=100 * columns.shape[1])[0]
    freedom = max(1, target.size - int(np.count_nonzero(solution)))
    return PreisachCalibration(
        plane=plane,
        reversible=solution[:levels],
        weights=solution[levels:-2],
        resting_force=float(solution[-2] - solution[-1]),
        force_deviation=float(np.sqrt(np.sum((target - columns @ solution) ** 2) / freedom)),
    )


def force_from_preisach(
    calibration: PreisachCalibration, *, displacement: ArrayLike, displacement_uncertainty: float = 0.0
) -> ForceEstimate:
    """Return the force from the history of a displacement.

    Parameters
    ----------
    calibration : PreisachCalibration
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time, from the unloaded state on. [m]
    displacement_uncertainty : float
        Standard uncertainty of each reading. [m]

    Returns
    -------
    ForceEstimate

    Raises
    ------
    InvalidInput
        If a reading is not finite or the uncertainty negative.
    OutsideRange
        If a reading lies beyond the calibration.

    Notes
    -----
    The uncertainty of a reading counts with the mean slope of the model over that reading, up and down.
    """
    plane = calibration.plane
    x = _within(displacement, plane.lowest, plane.highest)
    spread = float(require_non_negative(displacement_uncertainty=displacement_uncertainty))
    slipped = preisach_output(plane, calibration.weights, x)
    force = calibration.resting_force + _ramps(plane, x) @ calibration.reversible - slipped
    mean_slope = float(np.sum(calibration.reversible) - np.sum(calibration.weights)) / (plane.highest - plane.lowest)
    slope = _local_slope(x, force, mean_slope) if x.size > 1 else np.array([mean_slope])
    return ForceEstimate(
        applied_force=force, applied_force_uncertainty=np.hypot(calibration.force_deviation, slope * spread)
    )


def dissipated_energy(*, displacement: ArrayLike, applied_force: ArrayLike) -> float:
    """Return the energy that a closed loop of force over displacement dissipates, in joules.

    Parameters
    ----------
    displacement : array_like, shape (samples,)
        Along one loop; the last sample is joined to the first. [m]
    applied_force : array_like, shape (samples,)
        Force that moves it. [N]

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the lengths differ or a value is not finite.
    """
    x, force = _signals(displacement, applied_force)
    return float(np.sum((np.roll(x, -1) - x) * (np.roll(force, -1) + force)) / 2)


def major_loop_dissipation(calibration: PreisachCalibration) -> float:
    """Return the energy dissipated over the greatest loop calibrated, in joules: each relay's span times its force.

    Parameters
    ----------
    calibration : PreisachCalibration

    Returns
    -------
    float
    """
    return float(np.sum(mean_relay_widths(calibration.plane) * calibration.weights))


def _ramps(plane: PreisachPlane, x: Floats) -> Floats:
    """Return which share of each level lies below the displacement, shape (samples, levels)."""
    place = (x - plane.lowest) / (plane.highest - plane.lowest) * plane.levels
    return np.asarray(np.clip(place[:, np.newaxis] - np.arange(plane.levels), 0.0, 1.0))


def _local_slope(x: Floats, force: Floats, mean_slope: float) -> Floats:
    steps = np.diff(x)
    moved = steps != 0
    slopes = np.divide(np.diff(force), steps, out=np.full(steps.size, mean_slope), where=moved)
    return np.concatenate([slopes[:1], (slopes[:-1] + slopes[1:]) / 2, slopes[-1:]])


def _loading(x: Floats) -> NDArray[np.bool_]:
    """Return where the displacement rises, a turn counting once it has come back by a share of the range."""
    reach = _TURN * float(np.ptp(x))
    rising = np.empty(x.size, dtype=np.bool_)
    up, extreme, since = True, x[0], 0
    for at, value in enumerate(x.tolist()):
        if (value >= extreme) if up else (value <= extreme):
            extreme, since = value, at
        elif abs(value - extreme) > reach:
            rising[since:at] = not up
            up, extreme, since = not up, value, at
        rising[at] = up
    return rising


def _within(displacement: ArrayLike, lowest: float, highest: float) -> Floats:
    x = np.atleast_1d(require_finite(displacement=displacement))
    if x.ndim != 1:
        raise InvalidInput(f"displacement must be a row of readings, got shape {x.shape}")
    slack = _BEYOND * (highest - lowest)
    beyond = (x < lowest - slack) | (x > highest + slack)
    if beyond.any():
        raise OutsideRange(
            f"displacement must lie between {lowest:.6g} and {highest:.6g} m, where it was calibrated,"
            f" got {float(x[beyond][0]):.6g} m"
        )
    return x


def _calibration_signals(displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    x, force = _signals(displacement, applied_force)
    if x.size < 2 or np.ptp(x) == 0:
        raise InvalidInput("displacement does not vary")
    return x, force


def _signals(displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    x, force = require_finite(displacement=displacement), require_finite(applied_force=applied_force)
    if x.ndim != 1 or x.shape != force.shape or not x.size:
        raise InvalidInput(
            f"displacement and applied_force must be rows of one length, got {x.shape} and {force.shape}"
        )
    return x, force
