"""Range of validity of friction models: ratios beyond what a model can mean are withheld, with the reason."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.rough import RoughContact, separation
from sonolube.models.friction.models.model import FrictionModel

OUTSIDE_MODEL_RANGE = "outside_model_range"
"""Status of a result beyond the range of validity of its model."""

_ROUNDING = 2e-4  # of the friction ratio: that of tabulated ratios and of averages over a period
_DEAD_LOAD = 1e-5  # of the load: harmonic balance finds the mean force to 1e-6


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CheckedRatio:
    """Friction ratios of a model with the range of validity of the model applied.

    Parameters
    ----------
    friction_ratio : ndarray
        Friction with vibration over friction without; NaN outside the range of the model. []
    raw_friction_ratio : ndarray
        Value of the model's formula, also outside its range; NaN where the formula has none. []
    reason : ndarray of str
        Reason for which a ratio is outside the range, and advice; empty inside it.
    """

    friction_ratio: Floats
    raw_friction_ratio: Floats
    reason: NDArray[np.str_]

    def require_within_range(self) -> Floats:
        """Friction ratios; refuses any outside the range of the model. []

        Returns
        -------
        ndarray

        Raises
        ------
        OutsideRange
            If one is outside the range of the model.
        """
        for reason in self.reason[self.reason != ""].flat:
            raise OutsideRange(str(reason))
        return self.friction_ratio

    def require_braking(self) -> Floats:
        """Friction ratios where all brake the sliding, for heat and lubrication. []

        Returns
        -------
        ndarray

        Raises
        ------
        OutsideRange
            If one is outside the range of the model or below 0.
        """
        ratios = self.require_within_range()
        if np.any(ratios < 0):
            raise OutsideRange(
                f"friction ratio {float(np.min(ratios)):.3g}: the vibration drives the sliding, and friction that"
                " brakes it is needed here; lower the vibration or friction.in_plane_fraction"
            )
        return ratios


def checked_ratio(
    model: FrictionModel, raw: ArrayLike, *, mean_force_ratio: ArrayLike, gap_closed: ArrayLike
) -> CheckedRatio:
    """Friction ratios of a model with its range of validity applied.

    Parameters
    ----------
    model : FrictionModel
    raw : array_like, any shape
        Friction ratios by the formula of the model.
    mean_force_ratio : array_like, broadcast against `raw`
        Mean normal force of the motion over the load.
    gap_closed : array_like of bool, broadcast against `raw`
        Whether the mean planes meet within the period.

    Returns
    -------
    CheckedRatio

    See Also
    --------
    model_friction : From a motion of the gap.

    Notes
    -----
    The bounds of a model are exact, so that a value beyond one by no more than the rounding of tables and averages,
    2e-4, is the bound. A mean normal force within 1e-5 of the load is the load: under a dead load both are equal.
    """
    values, mean_force = np.asarray(raw, dtype=np.float64), np.asarray(mean_force_ratio, dtype=np.float64)
    low, high = model.ratio_bounds(mean_force_ratio=np.where(np.abs(mean_force - 1) <= _DEAD_LOAD, 1.0, mean_force))
    closed = np.logical_and(gap_closed, model.needs_open_gap)
    slack = _ROUNDING * np.maximum(1.0, np.abs(high))
    beyond = (values < low - slack) | (values > high + slack)
    too_high = (
        f"{OUTSIDE_MODEL_RANGE}: {model.name} gives a mean friction force beyond the Coulomb limit: {model.range_note}"
    )
    too_close = (
        f"{OUTSIDE_MODEL_RANGE}: the vibration closes the gap, and {model.name} has no meaning where the mean planes"
        " meet; lower the amplitude, or take a model about the load-balanced mean gap"
    )
    reason = np.where(np.broadcast_to(closed, values.shape), too_close, np.where(beyond, too_high, ""))
    return CheckedRatio(
        friction_ratio=np.where(reason == "", np.clip(values, low, high), np.nan),
        raw_friction_ratio=values,
        reason=np.asarray(reason),
    )


def ratio_caveats(*, friction_ratio: ArrayLike) -> tuple[str, ...]:
    """Meaning of friction ratios below 0 and above 1, one line each; empty where there is none.

    Parameters
    ----------
    friction_ratio : array_like, any shape
        Friction with vibration over friction without, by `checked_ratio`. []

    Returns
    -------
    tuple of str
    """
    known = np.asarray(friction_ratio, dtype=np.float64)
    lowest, highest = (float(of(known, initial=0.5, where=np.isfinite(known))) for of in (np.min, np.max))
    below = (
        f"friction ratio {lowest:.3g} is below 0: the mean friction force drives the sliding instead of braking it, "
        "as the vibration has a part along the sliding; it is the force of a motor, not friction reduced by more than "
        "all of it"
    )
    above = (
        f"friction ratio {highest:.6g} is above 1: the vibration raises friction, as the mean normal force of the "
        "motion exceeds the load"
    )
    return (*([below] if lowest < 0 else []), *([above] if highest > 1 else []))


def model_friction(
    model: FrictionModel,
    contact: RoughContact,
    motion: ContactMotion,
    *,
    sliding_speed: ArrayLike,
    friction_coefficient: ArrayLike | None = None,
) -> CheckedRatio:
    """Friction ratio of a model under a motion of the gap, its range of validity applied.

    Parameters
    ----------
    model : FrictionModel
    contact : RoughContact
    motion : ContactMotion
    sliding_speed : array_like, any shape
        Mean sliding speed. [m/s]
    friction_coefficient : float, optional
        Coefficient of friction without vibration; models whose limit depends on it need it. []

    Returns
    -------
    CheckedRatio
        Of the shape of `sliding_speed`.

    Raises
    ------
    InvalidInput
        If a speed is not positive, an argument that the model needs is missing, or it has no law for a direction in
        which the contact moves.

    See Also
    --------
    FrictionModel.ratio : The formula alone, which published tables were computed by.
    """
    speeds = require_positive(sliding_speed=sliding_speed)
    _require_direction(model, motion)
    smallest = float(separation(contact, normal_load=motion.normal_load)) + float(np.min(motion.displacement))
    raw, refusals = _raw_ratios(model, contact, motion, speeds.ravel(), friction_coefficient)
    found = checked_ratio(
        model, raw, mean_force_ratio=float(np.mean(motion.normal_force)) / motion.normal_load, gap_closed=smallest <= 0
    )
    reason = np.where(found.reason == "", refusals, found.reason)
    return CheckedRatio(
        friction_ratio=np.where(reason == "", found.friction_ratio, np.nan).reshape(speeds.shape),
        raw_friction_ratio=raw.reshape(speeds.shape),
        reason=reason.reshape(speeds.shape),
    )


def _require_direction(model: FrictionModel, motion: ContactMotion) -> None:
    """Refuse a motion within the plane that a model would leave out."""
    moved = [name for name in ("along", "across") if getattr(motion, name) is not None]
    missing = [name for name in moved if name not in model.directions]
    if missing:
        from sonolube.models.friction.models import FRICTION_MODELS

        able = " or ".join(name for name, each in FRICTION_MODELS.items() if {*moved} <= each.directions)
        raise InvalidInput(
            f"friction model {model.name} has no law for a motion {missing[-1]} the sliding; take friction.model {able}"
        )


def _raw_ratios(
    model: FrictionModel, contact: RoughContact, motion: ContactMotion, speeds: Floats, coefficient: ArrayLike | None
) -> tuple[Floats, NDArray[np.str_]]:
    """Ratio by the formula at each speed, NaN where it has none, and the reason why; else empty text."""
    try:
        ratio = model.ratio(contact, motion, sliding_speed=speeds, friction_coefficient=coefficient)
        return np.asarray(ratio, dtype=np.float64), np.full(speeds.shape, "")
    except OutsideRange as refusal:
        if speeds.size == 1:
            return np.full(1, np.nan), np.array([f"{OUTSIDE_MODEL_RANGE}: {refusal}"])
    parts = [_raw_ratios(model, contact, motion, speed, coefficient) for speed in speeds[:, np.newaxis]]
    ratios, reasons = zip(*parts, strict=True)
    return np.concatenate(ratios), np.concatenate(reasons)
