"""Friction, wear and power of a rig under its vibration, by the source of its amplitude."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.models.actuator import stack_caveats
from sonolube.models.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio, ratio_caveats
from sonolube.models.wear import WEAR_MODELS, cube_wear_rate
from sonolube.rig.amplitude_source import ResolvedVibration
from sonolube.rig.driven_rig import NO_DISSIPATED_POWER
from sonolube.rig.friction_and_wear import (
    direction_caveats,
    mean_friction,
    mean_wear,
    range_text,
    resting_caveats,
    rise_caveats,
    wear_model_of,
    wear_model_that_holds,
)
from sonolube.rig.operating_point import COMPUTED, FrictionPoint, VibrationOrigin, WearPoint
from sonolube.rig.power import PowerToSupply, power_to_supply
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, held_back_caveats, resolved_rig, source_caveats
from sonolube.rig.vibration import SteadyVibration, steady_vibration

_ROUNDED = 1e-6  # of a wear ratio


@dataclass(frozen=True, kw_only=True, slots=True)
class Simulation:
    """Steady vibration of a rig, with friction, wear and power.

    Parameters
    ----------
    status : str
        Status of the vibration; "outside_model_range" where the friction model has no meaning for it.
    reason : str
        Meaning of the status, and description of the motion.
    vibration : SteadyVibration
        Steady vibration of the tip: source, status, kind, amplitudes and sampled motion.
    friction : FrictionPoint
        Friction under it, and the power that the amplifier has to supply.
    wear : WearPoint
        Wear under it, by the wear model of the friction model's name where there is one.
    energy_balance : str
        How the two parts of the power to supply compare, and why; where the vibration is a sine, why
        there is no dissipated power.
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    status: str
    reason: str
    vibration: SteadyVibration
    friction: FrictionPoint
    wear: WearPoint
    energy_balance: str
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class VibratedFriction:
    """Friction ratios of a rig under its vibration, with where the amplitude comes from.

    Parameters
    ----------
    ratio : CheckedRatio
        Friction with vibration over friction without.
    origin : VibrationOrigin
        Amplitude and its source.
    vibration : SteadyVibration or None
        None where it leaves the range of the contact.
    caveats : tuple of str
        Reasons for caution about the numbers, one line each, ratios below 0 and above 1 among them.
    """

    ratio: CheckedRatio
    origin: VibrationOrigin
    vibration: SteadyVibration | None
    caveats: tuple[str, ...]


def simulate(rig: Rig | ResolvedRig) -> Simulation:
    """Steady vibration of a rig by the source of its amplitude, and friction and wear under it.

    Parameters
    ----------
    rig : Rig or ResolvedRig

    Returns
    -------
    Simulation

    Raises
    ------
    InvalidInput
        If the rig has no amplitude by the source it names, or neither harmonic balance nor marching finds a motion.
    OutsideRange
        If the load leaves no separation between the surfaces, the drive is too slow beside the structure's fastest
        mode, or a stated amplitude leaves the range of the height distribution.

    Notes
    -----
    A motion that does not repeat gives the mean over periods of the drive, segment by segment.
    """
    resolved = resolved_rig(rig).require_separation()
    vibration = steady_vibration(resolved)
    friction = friction_point(resolved)
    return Simulation(
        status=OUTSIDE_MODEL_RANGE if friction.reason else vibration.status,
        reason=friction.reason or vibration.reason,
        vibration=vibration,
        friction=friction,
        wear=_wear_point(resolved, vibration, wear_model_of(resolved.rig), friction.caveats, friction.reason),
        energy_balance=NO_DISSIPATED_POWER if friction.power is None else friction.power.energy_balance,
        caveats=friction.caveats,
    )


def friction_point(rig: Rig | ResolvedRig, *, model: str | None = None) -> FrictionPoint:
    """Friction of a rig under its vibration, by the source of its amplitude.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    model : str, optional
        Name of a friction model instead of the rig's own; it takes over those of the rig's parameters that it has.

    Returns
    -------
    FrictionPoint

    Raises
    ------
    InvalidInput
        If the rig has no amplitude by the source it names, or no frequency or sliding speed and the model needs it.
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    UnknownName
        If there is no such model.

    Examples
    --------
    >>> from sonolube.rig import friction_point, read_rig
    >>> rig = read_rig("examples/rigs/tribometer.toml")
    >>> round(friction_point(rig).friction_ratio, 2), round(friction_point(rig, model="kinematic").friction_ratio, 2)
    (0.35, 0.16)
    """
    resolved = resolved_rig(rig).require_separation()
    if model is not None:
        resolved = resolved.with_friction_model(friction_model_named(resolved.rig, model))
    rig = resolved.rig
    found = vibrated_friction(resolved, sliding_speed=rig.sliding_speed)
    ratio = found.ratio
    intrinsic, valid = rig.friction_coefficient * rig.normal_load, float(ratio.friction_ratio)
    others = _models_that_hold(resolved) if ratio.reason else ""
    return FrictionPoint(
        friction_force=valid * intrinsic,
        friction_coefficient=valid * rig.friction_coefficient,
        intrinsic_friction_force=intrinsic,
        friction_ratio=valid,
        raw_friction_ratio=float(ratio.raw_friction_ratio),
        friction_reduction=1 - valid,
        status=OUTSIDE_MODEL_RANGE if ratio.reason else COMPUTED,
        reason="; ".join(text for text in (str(ratio.reason), others) if text) or None,
        friction_model=rig.friction_model.name,
        citation=rig.friction_model.citation,
        **found.origin,
        power=_power(resolved, found.vibration),
        caveats=found.caveats or resting_caveats(resolved),
    )


def wear_point(rig: Rig | ResolvedRig, *, model: str | None = None) -> WearPoint:
    """Wear of a rig with and without its vibration, by the source of its amplitude.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    model : str, optional
        Name of the wear model. Where absent that of the friction model's name, else the default one; and outside the
        range of that one the model that holds, which a caveat says.

    Returns
    -------
    WearPoint

    Raises
    ------
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    UnknownName
        If there is no such model.

    References
    ----------
    .. [1] D 3.26 to 3.29 as they were evaluated, for the default model.

    Examples
    --------
    >>> from sonolube.rig import read_rig, wear_point
    >>> point = wear_point(read_rig("examples/rigs/tribometer.toml"))
    >>> round(point.wear_reduction, 2)
    0.47
    """
    resolved = resolved_rig(rig).require_separation()
    name = wear_model_of(resolved.rig) if model is None else model
    WEAR_MODELS.named(name)
    try:
        vibration = steady_vibration(resolved)
    except OutsideRange as refusal:
        if resolved.vibration.driven is not None:
            raise
        return _withheld_wear(resolved, name, f"{OUTSIDE_MODEL_RANGE}: {refusal}")
    caveats = _caveats(resolved, vibration)
    return _wear_point(resolved, vibration, name, caveats, _outside_friction(resolved), is_chosen=model is not None)


def vibrated_friction(rig: Rig | ResolvedRig, *, sliding_speed: ArrayLike) -> VibratedFriction:
    """Friction ratios of a rig under its vibration at some sliding speeds."""
    resolved = resolved_rig(rig)
    used = resolved.vibration
    try:
        vibration = steady_vibration(resolved)
    except OutsideRange as refusal:
        if used.driven is not None:
            raise
        ratio, origin = _outside(refusal, sliding_speed), _stated_origin(used)
        return VibratedFriction(ratio=ratio, origin=origin, vibration=None, caveats=())
    ratio = mean_friction(resolved.rig, vibration.motions, sliding_speed=sliding_speed)
    return VibratedFriction(
        ratio=ratio,
        origin=_origin(vibration),
        vibration=vibration,
        caveats=(*_caveats(resolved, vibration), *ratio_caveats(friction_ratio=ratio.friction_ratio)),
    )


def _power(resolved: ResolvedRig, vibration: SteadyVibration | None) -> PowerToSupply | None:
    """Power that the amplifier of a rig has to supply at its operating point."""
    charge = resolved.charging_power()
    return power_to_supply(
        charging_power=None if charge is None else float(charge),
        dissipated_power=None if vibration is None else vibration.dissipated_power,
        apparent_power=None if vibration is None else vibration.apparent_power,
        peak_current=None if vibration is None else vibration.peak_current,
    )


def mechanism_text(rig: Rig | ResolvedRig) -> str:
    """What the friction model of a rig makes of its vibration besides the ratio, in one line; empty where nothing."""
    resolved = resolved_rig(rig)
    if not resolved.rig.friction_model.for_soft_bodies:
        return ""
    return resolved.rig.friction_model.mechanism(resolved.rig.contact, steady_vibration(resolved).motions[0])


def friction_model_named(rig: Rig, name: str) -> FrictionModel:
    """Friction model of a name, with those parameters of the rig's model that it has too."""
    model = FRICTION_MODELS.named(name)
    shared = {each.name for each in model.parameters()} & {each.name for each in rig.friction_model.parameters()}
    return model(**{key: getattr(rig.friction_model, key) for key in shared})


def operating_caveats(rig: Rig | ResolvedRig) -> tuple[str, ...]:
    """Caveats of a rig at its own operating point, for results over many points about it.

    Parameters
    ----------
    rig : Rig or ResolvedRig

    Returns
    -------
    tuple of str
        Of contact, amplitude, stack and gap; empty where the rig has no operating point.
    """
    resolved = resolved_rig(rig)
    try:
        return _caveats(resolved, steady_vibration(resolved))
    except SonolubeError:
        return ()


def _wear_point(
    resolved: ResolvedRig,
    vibration: SteadyVibration,
    model: str,
    caveats: tuple[str, ...],
    outside_friction: str | None,
    *,
    is_chosen: bool = False,
) -> WearPoint:
    """Wear under a vibration, withheld where friction is outside the range of its model for the reason given."""
    sine = vibration.vibration_amplitude if vibration.prescribed else None
    ratio, reason = mean_wear(resolved, vibration.motions, wear_model=model, vibration_amplitude=sine)
    if (
        reason
        and not is_chosen
        and (other := wear_model_that_holds(resolved, vibration.motions, vibration_amplitude=sine))
    ):
        outside = reason.removeprefix(f"{OUTSIDE_MODEL_RANGE}: ").partition(";")[0]
        caveats = (*caveats, f"{outside}, so that wear model {model} has no meaning; the wear is by {other}")
        model = other
        ratio, reason = mean_wear(resolved, vibration.motions, wear_model=model, vibration_amplitude=sine)
    reason = reason or outside_friction
    if not reason and resolved.rig.direction.second_direction is not None:
        caveats = (*caveats, "wear is by the motion along the normal; the path within the plane is left out")
    if not reason and not vibration.prescribed:
        caveats = (*caveats, *rise_caveats(vibration.motions, wear_model=model))
    if not reason:
        caveats = (*caveats, *_raised_wear(ratio))
    is_soft = resolved.rig.friction_model.for_soft_bodies  # of which the cube tells nothing, also without vibration
    rate = cube_wear_rate(resolved.rig.contact, normal_load=resolved.rig.normal_load)
    still = float("nan") if is_soft else float(rate)
    valid = float("nan") if reason else ratio
    return WearPoint(
        wear_rate=valid * still,
        intrinsic_wear_rate=still,
        wear_rate_ratio=valid,
        raw_wear_rate_ratio=ratio,
        wear_reduction=1 - valid,
        status=OUTSIDE_MODEL_RANGE if reason else COMPUTED,
        reason=reason,
        wear_model=model,
        **_origin(vibration),
        caveats=caveats,
    )


def _withheld_wear(resolved: ResolvedRig, model: str, reason: str) -> WearPoint:
    """Wear of a rig whose stated vibration has no motion in the range of its contact, with the reason alone."""
    none = float("nan")
    is_soft = resolved.rig.friction_model.for_soft_bodies
    still = none if is_soft else float(cube_wear_rate(resolved.rig.contact, normal_load=resolved.rig.normal_load))
    return WearPoint(
        wear_rate=none,
        intrinsic_wear_rate=still,
        wear_rate_ratio=none,
        raw_wear_rate_ratio=none,
        wear_reduction=none,
        status=OUTSIDE_MODEL_RANGE,
        reason=reason,
        wear_model=model,
        **_stated_origin(resolved.vibration),
        caveats=resting_caveats(resolved),
    )


def _outside_friction(resolved: ResolvedRig) -> str | None:
    """Why the friction of a rig is outside the range of its model; None inside it, or where it lacks an input."""
    try:
        return friction_point(resolved).reason
    except InvalidInput:
        return None


def _raised_wear(ratio: float) -> tuple[str, ...]:
    """Line on a wear ratio above 1, which no published test has."""
    if ratio <= 1 + _ROUNDED:
        return ()
    return (
        f"wear ratio {ratio:.3g} is above 1: by this model the vibration raises wear, as it presses the surfaces closer"
        " than at rest for part of the period; published wear tests have 0.27 to 1.0",
    )


def _models_that_hold(resolved: ResolvedRig) -> str:
    """Range of the friction ratio by the other friction models that hold for a rig's vibration."""
    holding, rig = [], resolved.rig
    for name in FRICTION_MODELS:
        model, own = FRICTION_MODELS[name], rig.friction_model
        if (
            name == own.name
            or not rig.direction.parts <= model.directions
            or model.for_soft_bodies != own.for_soft_bodies
        ):
            continue
        other = resolved.with_friction_model(friction_model_named(rig, name))
        try:
            found = mean_friction(other.rig, steady_vibration(other).motions, sliding_speed=rig.sliding_speed)
        except SonolubeError:
            continue
        if not found.reason:
            holding.append((float(found.friction_ratio), name))
    return range_text(holding, "friction")


def _outside(refusal: OutsideRange, sliding_speed: ArrayLike) -> CheckedRatio:
    none = np.full(np.shape(sliding_speed), np.nan)
    reason = np.full(none.shape, f"{OUTSIDE_MODEL_RANGE}: {refusal}")
    return CheckedRatio(friction_ratio=none, raw_friction_ratio=none, reason=reason)


def _origin(vibration: SteadyVibration) -> VibrationOrigin:
    return VibrationOrigin(
        vibration_amplitude=vibration.vibration_amplitude,
        amplitude_source=vibration.amplitude_source,
        amplitude_origin=vibration.amplitude_origin,
    )


def _stated_origin(used: ResolvedVibration) -> VibrationOrigin:
    assert used.sine_amplitude is not None
    return VibrationOrigin(
        vibration_amplitude=used.sine_amplitude, amplitude_source=used.source, amplitude_origin=used.text
    )


def _caveats(resolved: ResolvedRig, vibration: SteadyVibration) -> tuple[str, ...]:
    """Caveats of direction, contact, amplitude, friction model, stack and gap."""
    return (
        *direction_caveats(resolved),
        *held_back_caveats(resolved, vibration_amplitude=vibration.vibration_amplitude),
        *resting_caveats(resolved, vibration_amplitude=vibration.vibration_amplitude),
        *source_caveats(resolved, vibration_amplitude=vibration.vibration_amplitude),
        *_tested_caveats(resolved.rig),
        *([] if vibration.prescribed else _stack_caveats(resolved, vibration)),
    )


def _tested_caveats(rig: Rig) -> tuple[str, ...]:
    """Line on how far the friction model of a rig was tested, where no comparison with published tests tells it."""
    model = rig.friction_model
    return (f"friction model {model.name}: {model.tested}",) if model.tested else ()


def _stack_caveats(resolved: ResolvedRig, vibration: SteadyVibration) -> tuple[str, ...]:
    rig, voltage = resolved.moved, complex(resolved.voltage.harmonics()[0])
    caveats = stack_caveats(
        rig.stack,
        voltage_offset=float(sum(resolved.voltage.range())) / 2,
        voltage_peak_to_peak=rig.voltage_peak_to_peak,
        elongation=vibration.elongation * abs(voltage) / voltage if voltage else 0.0,
        frequency=rig.drive.frequency,
    )
    if vibration.gap_closed:
        caveats = (
            *caveats,
            "the mean planes touch within the period, where asperities interact and the contact law fails;"
            " lower the voltage",
        )
    return caveats
