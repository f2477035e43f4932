"""Calibration of a displacement sensor as a force gauge: polynomial branches, and Preisach's model of hysteresis."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import nnls

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.measurement.gauge.preisach import PreisachPlane, mean_relay_widths, preisach_output, relay_fractions
from sonolube.measurement.time_series import require_equal_length

_REVERSAL = 0.02  # of the range, by which the displacement must return for a reversal
_RANGE_TOLERANCE = 1e-9  # of the range


def loading_mask(x: Floats) -> NDArray[np.bool_]:
    """Where a displacement is on a loading branch, with hysteresis against small reversals; shape (samples,)."""
    threshold = _REVERSAL * float(np.ptp(x))
    rising = np.empty(x.size, dtype=np.bool_)
    up, extreme, since = True, x[0], 0
    for at, value in enumerate(x.tolist()):
        if (value >= extreme) if up else (value <= extreme):
            extreme, since = value, at
        elif abs(value - extreme) > threshold:
            rising[since:at] = not up
            up, extreme, since = not up, value, at
        rising[at] = up
    return rising


def require_calibrated_range(*, displacement: ArrayLike, lowest: float, highest: float) -> Floats:
    """Displacements as a one-dimensional array; refuse any outside the calibrated range; shape (samples,)."""
    x = np.atleast_1d(require_finite(displacement=displacement))
    if x.ndim != 1:
        raise InvalidInput(f"displacement must be one-dimensional, got shape {x.shape}")
    tolerance = _RANGE_TOLERANCE * (highest - lowest)
    outside = (x < lowest - tolerance) | (x > highest + tolerance)
    if outside.any():
        raise OutsideRange(
            f"displacement must lie between {lowest:.6g} and {highest:.6g} m, where it was calibrated,"
            f" got {float(x[outside][0]):.6g} m"
        )
    return x


def require_readings(*, displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    """Displacement and force as one-dimensional arrays of equal length; shape (samples,)."""
    x, force = require_finite(displacement=displacement), require_finite(applied_force=applied_force)
    require_equal_length(displacement=x, applied_force=force)
    return x, force


def require_calibration_readings(*, displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    """Displacement and force of a calibration as one-dimensional arrays of equal length; shape (samples,)."""
    x, force = require_readings(displacement=displacement, applied_force=applied_force)
    if x.size < 2 or np.ptp(x) == 0:
        raise InvalidInput("displacement does not vary")
    return x, force


_MAX_ROWS = 20_000  # of a calibration; longer ones are decimated


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BranchCalibration:
    """Force over displacement as two polynomials, of the loading and the unloading branch.

    Parameters
    ----------
    loading, unloading : Polynomial
        Force in newtons over displacement in metres.
    loading_deviation, unloading_deviation : float
        Standard deviation of the calibration readings about them, in newtons.
    lowest, highest : float
        Calibrated range of displacement, in metres.
    """

    loading: Polynomial
    unloading: Polynomial
    loading_deviation: float
    unloading_deviation: float
    lowest: float
    highest: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PreisachCalibration:
    """Force over the history of displacement, by a nonlinear spring and Preisach's model of hysteresis.

    Parameters
    ----------
    plane : PreisachPlane
        Relays of the displacement, in metres.
    reversible : ndarray, shape (levels,)
        Force added by the spring over each level of displacement, in newtons; not negative.
    weights : ndarray, shape (cells,)
        Force subtracted by the relays of each cell when up, in newtons; not negative.
    resting_force : float
        Force with all relays down, in newtons.
    force_deviation : float
        Standard deviation of the calibration readings about the model, in newtons.
    """

    plane: PreisachPlane
    reversible: Floats
    weights: Floats
    resting_force: float
    force_deviation: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ForceEstimate:
    """Force from a calibrated displacement, with its uncertainty.

    Parameters
    ----------
    applied_force : ndarray, shape (samples,)
        Estimated force. [N]
    applied_force_uncertainty : ndarray, shape (samples,)
        Standard uncertainty, of the calibration and of the displacement times the stiffness. [N]
    """

    applied_force: Floats
    applied_force_uncertainty: Floats


def fit_branches(*, displacement: ArrayLike, applied_force: ArrayLike, degree: int = 3) -> BranchCalibration:
    """Calibration by one polynomial for the loading and one for the unloading branch, by least squares.

    Parameters
    ----------
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time. [m]
    applied_force : array_like, shape (samples,)
        Reading of the load cell that applies the force. [N]
    degree : int
        Of both polynomials, 1 to 7.

    Returns
    -------
    BranchCalibration

    Raises
    ------
    InvalidInput
        If the lengths differ, a value is not finite, the displacement does not vary, or a branch has too few samples.

    See Also
    --------
    fit_preisach : a calibration that depends on the history.
    force_from_branches : the force by this calibration.

    Notes
    -----
    All unloading is taken as one curve, wherever it began; where the curves fan out, as in D figure 2.32, the deviation
    shows by how much, and `fit_preisach` models them.
    """
    x, force = require_calibration_readings(displacement=displacement, applied_force=applied_force)
    if not 1 <= degree <= 7:
        raise InvalidInput(f"degree must lie between 1 and 7, got {degree}")
    rising = loading_mask(x)
    branches: dict[str, Any] = {}
    for name, branch in (("loading", rising), ("unloading", ~rising)):
        if np.unique(x[branch]).size <= degree + 1:
            raise InvalidInput(f"{name} has {int(branch.sum())} samples, too few for a polynomial of degree {degree}")
        polynomial = Polynomial.fit(x[branch], force[branch], degree)
        residual = force[branch] - polynomial(x[branch])
        deviation = float(np.sqrt(np.sum(residual**2) / (residual.size - degree - 1)))
        branches |= {name: polynomial, f"{name}_deviation": deviation}
    return BranchCalibration(**branches, lowest=float(x.min()), highest=float(x.max()))


def force_from_branches(
    calibration: BranchCalibration, *, displacement: ArrayLike, displacement_uncertainty: float = 0.0
) -> ForceEstimate:
    r"""Force from a displacement and its direction, by the polynomials of both branches.

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
        If a reading lies outside the calibrated range.

    Notes
    -----
    With the polynomial p of the branch and its residual deviation s,

    .. math:: F = p(x) , \qquad u_F^2 = s^2 + \left[ p'(x)\, u_x \right]^2 .
    """
    x = require_calibrated_range(displacement=displacement, lowest=calibration.lowest, highest=calibration.highest)
    u_x = float(require_non_negative(displacement_uncertainty=displacement_uncertainty))
    rising = loading_mask(x)
    slope = np.where(rising, calibration.loading.deriv()(x), calibration.unloading.deriv()(x))
    deviation = np.where(rising, calibration.loading_deviation, calibration.unloading_deviation)
    return ForceEstimate(
        applied_force=np.where(rising, calibration.loading(x), calibration.unloading(x)),
        applied_force_uncertainty=np.hypot(deviation, slope * u_x),
    )


def fit_preisach(*, displacement: ArrayLike, applied_force: ArrayLike, levels: int = 16) -> PreisachCalibration:
    r"""Calibration by Preisach's model, from loops that reverse at different displacements.

    Parameters
    ----------
    displacement : array_like, shape (samples,)
        Reading of the sensor, in the order of time, from its lowest value on; reversals at many different values
        determine the minor loops. [m]
    applied_force : array_like, shape (samples,)
        Reading of the load cell that applies the force. [N]
    levels : int
        Cells along each side of the Preisach plane, 2 to 64.

    Returns
    -------
    PreisachCalibration

    Raises
    ------
    InvalidInput
        If the lengths differ, a value is not finite, the displacement does not vary or there are fewer samples than
        twice the levels.

    See Also
    --------
    fit_branches : a calibration by two polynomials.
    force_from_preisach : the force by this calibration.

    Notes
    -----
    The force leads the displacement: a nonlinear spring, from which relays of the displacement subtract the part that
    has slipped,

    .. math:: F(t) = F_0 + \sum_l k_l\, r_l(x) - \sum_c w_c\, s_c[x] ,

    with the ramps :math:`r_l` over each level and the relay fractions :math:`s_c` of `relay_fractions`. Non-negative
    least squares for :math:`k_l` and :math:`w_c`, so that every loop dissipates energy. Minor loops between the same
    two displacements are congruent in this model; where those of the holder also depend on the force, the deviation
    shows it.

    References
    ----------
    .. [1] D 2.4.3, figure 2.32.
    .. [2] I. D. Mayergoyz, Mathematical Models of Hysteresis and Their Applications, Elsevier (2003), chapter 1.
    """
    x, force = require_calibration_readings(displacement=displacement, applied_force=applied_force)
    if x.size < 2 * levels:
        raise InvalidInput(f"{x.size} samples are too few for {levels} levels; give {2 * levels} or use fewer levels")
    plane = PreisachPlane(lowest=float(x.min()), highest=float(x.max()), levels=levels)
    stride = -(-x.size // _MAX_ROWS)
    ramps, fractions, target = _ramps(plane, x[::stride]), relay_fractions(plane, x)[::stride], force[::stride]
    # the resting force may have either sign: the difference of two that are not negative
    rest = np.ones((target.size, 1))
    scale = max(float(np.abs(target).max()), np.finfo(float).tiny)
    columns = np.concatenate([ramps, -fractions, rest, -rest], axis=1)
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
    """Force from the history of a displacement, by Preisach's model.

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
        If a reading lies outside the calibrated range.

    Notes
    -----
    The model of `fit_preisach`. The uncertainty of a reading is multiplied by the local slope of the force, the mean of
    those before and after the reading.
    """
    plane = calibration.plane
    x = require_calibrated_range(displacement=displacement, lowest=plane.lowest, highest=plane.highest)
    u_x = float(require_non_negative(displacement_uncertainty=displacement_uncertainty))
    slipped = preisach_output(plane, calibration.weights, x)
    force = calibration.resting_force + _ramps(plane, x) @ calibration.reversible - slipped
    mean_slope = float(np.sum(calibration.reversible) - np.sum(calibration.weights)) / (plane.highest - plane.lowest)
    slope = _local_slope(x, force, mean_slope) if x.size > 1 else np.array([mean_slope])
    uncertainty = np.hypot(calibration.force_deviation, slope * u_x)
    return ForceEstimate(applied_force=force, applied_force_uncertainty=uncertainty)


def dissipated_energy(*, displacement: ArrayLike, applied_force: ArrayLike) -> float:
    r"""Energy dissipated over a closed loop of force over displacement, its area, in joules.

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

    See Also
    --------
    major_loop_dissipation : the same of a calibration.

    Notes
    -----
    .. math:: E = \oint F\, dx ,

    by the trapezoidal rule.
    """
    x, force = require_readings(displacement=displacement, applied_force=applied_force)
    return float(np.sum((np.roll(x, -1) - x) * (np.roll(force, -1) + force)) / 2)


def major_loop_dissipation(calibration: PreisachCalibration) -> float:
    r"""Energy dissipated over the major loop of a Preisach calibration, in joules.

    Parameters
    ----------
    calibration : PreisachCalibration

    Returns
    -------
    float

    Notes
    -----
    .. math:: E = \sum_c w_c\, \overline{(\alpha - \beta)}_c

    with the weights of the cells and the mean widths of their relays.
    """
    return float(np.sum(mean_relay_widths(calibration.plane) * calibration.weights))


def _ramps(plane: PreisachPlane, x: Floats) -> Floats:
    """Fraction of each level that lies below the displacement, shape (samples, levels)."""
    place = (x - plane.lowest) / (plane.highest - plane.lowest) * plane.levels
    return np.asarray(np.clip(place[:, np.newaxis] - np.arange(plane.levels), 0.0, 1.0))


def _local_slope(x: Floats, force: Floats, mean_slope: float) -> Floats:
    """Slope of the force at each sample, the mean of those of both neighbouring intervals."""
    steps = np.diff(x)
    slopes = np.divide(np.diff(force), steps, out=np.full(steps.size, mean_slope), where=steps != 0)
    return np.concatenate([slopes[:1], (slopes[:-1] + slopes[1:]) / 2, slopes[-1:]])
