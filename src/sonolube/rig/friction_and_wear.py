"""Friction and wear ratios of a rig under a motion of its contact, by the rig's own models.

With the decay length of worn contacts in published friction tests, and the caveat against one by roughness alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, isfinite
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.contact import (
    ContactMotion,
    ExponentialHeights,
    contact_caveats,
    decay_length,
    load_balanced_motion,
    sinusoidal_motion,
)
from sonolube.models.friction.models import MeanGap
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio, model_friction
from sonolube.models.wear import DEFAULT_WEAR_MODEL, WEAR_MODELS, cube_wear_rate, vibrating_cube_wear_rate
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import PRESSED_LAYER, ResolvedRig, resolved_rig
from sonolube.text.units import format_si

ANY_FREQUENCY = 1.0
"""Frequency of a sine where nothing depends on it. [Hz]"""

_RISING_WEAR_MODEL = "dong_2015_load_balanced"


def friction_ratios(rig: Rig, motion: ContactMotion, *, sliding_speed: ArrayLike) -> CheckedRatio:
    """Friction with vibration over friction without, by the rig's friction model at some sliding speeds. []

    Parameters
    ----------
    rig : Rig
    motion : ContactMotion
        Motion of its contact.
    sliding_speed : array_like, any shape
        Macroscopic relative speed. [m/s]

    Returns
    -------
    CheckedRatio
        Of the shape of `sliding_speed`, NaN with a reason where a ratio is outside the range of the model.

    Raises
    ------
    InvalidInput
        If a speed is not positive.
    """
    places = rig.direction.over_contact(rig.direction.over_gap(motion))
    every = [
        model_friction(
            rig.friction_model,
            rig.contact,
            each,
            sliding_speed=sliding_speed,
            friction_coefficient=rig.friction_coefficient,
        )
        for _, each in places
    ]
    return every[0] if len(every) == 1 else _mean_ratio(every, [share for share, _ in places])


def _mean_ratio(every: Sequence[CheckedRatio], weights: Sequence[float]) -> CheckedRatio:
    """Weighted mean of several friction ratios; that of the first outside the model's range withholds it."""
    mean, raw = (
        np.asarray(np.average(np.stack([getattr(one, name) for one in every]), axis=0, weights=weights))
        for name in ("friction_ratio", "raw_friction_ratio")
    )
    reason = every[0].reason
    for one in every[1:]:
        reason = np.where(reason == "", one.reason, reason)
    return CheckedRatio(
        friction_ratio=np.where(reason == "", mean, np.nan), raw_friction_ratio=raw, reason=np.asarray(reason)
    )


def friction_at_speeds(rig: Rig, moving: ContactMotion, speeds: Floats) -> CheckedRatio:
    """Friction ratio at each of some sliding speeds, and the reason where there is none.

    NaN also at speeds that the model refuses, such as zero.
    """
    try:
        return friction_ratios(rig, moving, sliding_speed=speeds)
    except SonolubeError as refusal:
        if speeds.size == 1:
            none = np.full(1, np.nan)
            return CheckedRatio(friction_ratio=none, raw_friction_ratio=none, reason=np.array([str(refusal)]))
    every = [friction_at_speeds(rig, moving, speed) for speed in speeds[:, np.newaxis]]
    return CheckedRatio(
        friction_ratio=np.concatenate([one.friction_ratio for one in every]),
        raw_friction_ratio=np.concatenate([one.raw_friction_ratio for one in every]),
        reason=np.concatenate([one.reason for one in every]),
    )


def prescribed_sine(
    rig: Rig, *, vibration_amplitude: float, frequency: float | None = None, normal_load: float | None = None
) -> ContactMotion:
    """Sine of a rig in the direction of its vibration, the gap about the mean that its friction model is meant for."""
    model, direction = rig.friction_model, rig.direction
    direction.require_amplitude(vibration_amplitude)
    if rig.drive is None and frequency is None and model.rate_dependent:
        raise InvalidInput(f"{rig.title}: drive.frequency is missing; friction model {model.name} needs it")
    own = ANY_FREQUENCY if rig.drive is None else rig.drive.frequency
    motion = sinusoidal_motion(
        rig.contact,
        normal_load=rig.normal_load if normal_load is None else normal_load,
        vibration_amplitude=direction.normal_part() * vibration_amplitude,
        frequency=own if frequency is None else frequency,
    )
    if model.mean_gap is not MeanGap.AT_REST and np.any(motion.displacement):
        motion = load_balanced_motion(rig.contact, motion)
    if not direction.is_in_plane:
        return motion
    return direction.within_plane(motion, vibration_amplitude=vibration_amplitude)


def wear_model_of(rig: Rig) -> str:
    """Name of the wear model: that of the friction model's name where there is one, else the default."""
    name = rig.friction_model.name
    return name if name in WEAR_MODELS else DEFAULT_WEAR_MODEL


def mean_friction(rig: Rig, motions: tuple[ContactMotion, ...], *, sliding_speed: ArrayLike) -> CheckedRatio:
    """Mean friction ratio over several motions; that of the first outside the model's range withholds it.

    Of the shape of `sliding_speed`.
    """
    every = [friction_ratios(rig, motion, sliding_speed=sliding_speed) for motion in motions]
    return _mean_ratio(every, [1 / motion.frequency for motion in motions])


def mean_over_time(values: Sequence[Floats], motions: tuple[ContactMotion, ...]) -> Floats:
    """Mean over time of a quantity of several motions of unequal duration."""
    return np.asarray(np.average(np.stack(values), axis=0, weights=[1 / motion.frequency for motion in motions]))


def mean_wear(
    resolved: ResolvedRig,
    motions: tuple[ContactMotion, ...],
    *,
    wear_model: str,
    vibration_amplitude: float | None = None,
) -> tuple[float, str | None]:
    """Mean wear ratio over several motions about the mean gap of a wear model, and why it does not hold.

    None where the ratio is within the range of the model.
    """
    if resolved.rig.direction.is_in_plane:
        return float("nan"), (
            f"{OUTSIDE_MODEL_RANGE}: the vibration is {resolved.rig.direction.text}, and the wear models are of"
            " vibration along the normal; take its friction alone, or leave vibration.direction out"
        )
    ratio, smallest = _raw_wear_ratio(resolved, motions, wear_model, vibration_amplitude)
    if resolved.rig.friction_model.for_soft_bodies:
        return ratio, (
            f"{OUTSIDE_MODEL_RANGE}: wear by the cube is of hard rough bodies, and friction model"
            f" {resolved.rig.friction_model.name} of a soft or floating one, whose wear no model here has; measure it"
        )
    if smallest > 0:
        return ratio, None
    others = [
        (name, *_raw_wear_ratio(resolved, motions, name, vibration_amplitude))
        for name in WEAR_MODELS
        if name != wear_model
    ]
    holding = [(value, name) for name, value, gap in others if gap > 0]
    rest = resolved.separation
    amplitude = format_si(max(float(np.ptp(motion.displacement)) / 2 for motion in motions), "m")
    if wear_model != _RISING_WEAR_MODEL:
        why = (
            f"the amplitude {amplitude} exceeds the gap at rest {format_si(rest, 'm')}, about which no dead load can"
            " hold the surfaces"
        )
    else:
        why = f"the mean planes meet under the amplitude of {amplitude}, where the cube has no height"
    reason = f"{OUTSIDE_MODEL_RANGE}: {why}; wear model {wear_model} has no meaning"
    return ratio, f"{reason}; {range_text(holding, 'wear')}"


def wear_model_that_holds(
    resolved: ResolvedRig, motions: tuple[ContactMotion, ...], *, vibration_amplitude: float | None = None
) -> str | None:
    """Wear model within whose range some motions lie, the one about the risen mean gap first.

    None where no model holds.
    """
    if resolved.rig.direction.is_in_plane or resolved.rig.friction_model.for_soft_bodies:
        return None
    names = sorted(WEAR_MODELS, key=lambda name: name != _RISING_WEAR_MODEL)
    return next((name for name in names if _raw_wear_ratio(resolved, motions, name, vibration_amplitude)[1] > 0), None)


def rise_caveats(motions: tuple[ContactMotion, ...], *, wear_model: str) -> tuple[str, ...]:
    """Line on the rise of computed motions, which wear about the gap at rest leaves out."""
    rise = float(mean_over_time([np.asarray(motion.displacement.mean()) for motion in motions], motions))
    if wear_model == _RISING_WEAR_MODEL or not rise > 0:
        return ()
    return (
        f"wear by {wear_model} is about the gap at rest, as in the tables of D; the computed motion has its mean gap"
        f" {format_si(rise, 'm')} above it, where wear is less",
    )


def range_text(holding: list[tuple[float, str]], of: str) -> str:
    """Range of ratios by the models that hold, in words."""
    if not holding:
        return f"no {of} model holds for this vibration"
    (low, first), (high, last) = min(holding), max(holding)
    if first == last:
        return f"of the {of} models {first} holds: ratio {low:.3g}"
    return f"the {of} models that hold give ratios from {low:.3g} ({first}) to {high:.3g} ({last})"


def _raw_wear_ratio(
    resolved: ResolvedRig, motions: tuple[ContactMotion, ...], model: str, vibration_amplitude: float | None
) -> tuple[float, float]:
    """Wear ratio by the formula of a model, and the smallest gap of the motion that it is for. [m]"""
    rig, load = resolved.rig, resolved.rig.normal_load
    smallest = resolved.separation + min(_lowest_displacement(rig, motion, model) for motion in motions)
    if vibration_amplitude is not None and model == DEFAULT_WEAR_MODEL:  # by quadrature of the sine itself
        vibrating = vibrating_cube_wear_rate(rig.contact, normal_load=load, vibration_amplitude=vibration_amplitude)
        return float(vibrating / cube_wear_rate(rig.contact, normal_load=load)), smallest
    ratio = WEAR_MODELS[model]
    return float(mean_over_time([np.asarray(ratio(rig.contact, motion)) for motion in motions], motions)), smallest


def _lowest_displacement(rig: Rig, motion: ContactMotion, model: str) -> float:
    """Lowest displacement of a motion about the mean gap of a wear model. [m]"""
    if model == _RISING_WEAR_MODEL:
        return float(load_balanced_motion(rig.contact, motion).displacement.min())
    return float(motion.displacement.min() - motion.displacement.mean())


CENTRAL_SHARE: Final = 0.95
"""Share of published contacts whose range of decay lengths the caveat gives. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class DecayLengthPopulation:
    """Lognormal distribution of the decay length over worn contacts.

    Parameters
    ----------
    median : float
        Decay length that half of the contacts exceed, in m.
    log_spread : float
        Standard deviation of its logarithm, a pure number.

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.
    """

    median: float
    log_spread: float

    def __post_init__(self) -> None:
        require_positive(median=self.median, log_spread=self.log_spread)

    @property
    def factor(self) -> float:
        """Geometric standard deviation: 68 % lie between the median over it and the median times it. []"""
        return exp(self.log_spread)

    def central_range(self, *, share: float = CENTRAL_SHARE) -> tuple[float, float]:
        """Central range that holds a share of the contacts, in m."""
        from statistics import NormalDist  # scipy.special takes a tenth of a second to load

        if not 0 < share < 1:
            raise InvalidInput(f"share must lie between 0 and 1, got {share:g}")
        width = exp(NormalDist().inv_cdf((1 + share) / 2) * self.log_spread)
        return self.median / width, self.median * width


PUBLISHED_DECAY_LENGTH: Final = DecayLengthPopulation(median=1.65e-6, log_spread=0.56)
"""Decay length of the worn contacts in the published friction tests.

Learned with the friction models from the friction of those tests, not from their roughness: amplitude enters the models
through its ratio to the decay length, and neither printed roughness nor load, hardness or size of the scar orders the
lengths that the tests ask for."""


def decay_length_caveat(rig: Rig | ResolvedRig, *, vibration_amplitude: float | None = None) -> str | None:
    """Caveat against a decay length by roughness that worn contacts of published tests do not have.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    vibration_amplitude : float, optional
        Zero to peak, at which the friction of both decay lengths is compared; the stated one where absent. [m]

    Returns
    -------
    str or None
        With the friction ratio of a sine of that amplitude by the rig's own friction model, for its own decay length
        and for the median of `PUBLISHED_DECAY_LENGTH`, where it has an amplitude; None where the rig states its decay
        length, its friction model is of soft bodies or within the plane, its heights are not exponential, or R_q/lambda
        lies within the central 95 % of that population.
    """
    resolved = resolved_rig(rig)
    model = resolved.rig.friction_model
    if model.for_soft_bodies or "normal" not in model.directions:  # hard worn contacts tell nothing of it
        return None
    contact, (low, high) = resolved.rig.contact, PUBLISHED_DECAY_LENGTH.central_range()
    heights = contact.heights
    if contact.decay_length is not None or not isinstance(heights, ExponentialHeights):
        return None
    own = float(decay_length(contact))
    if low <= own <= high:
        return None
    return (
        f"decay length by roughness R_q/{heights.decay:g} = {_micrometres(own)} um; worn contacts of published tests"
        f" have {_micrometres(low)} to {_micrometres(high)} um ({100 * CENTRAL_SHARE:.0f} %); "
        f"{_ratios_text(resolved, vibration_amplitude)}give contact.decay_length or contact.normal_stiffness"
    )


def resting_caveats(resolved: ResolvedRig, *, vibration_amplitude: float | None = None) -> tuple[str, ...]:
    """Caveats of the contact of a rig under its load, that of its decay length included."""
    caveat = decay_length_caveat(resolved, vibration_amplitude=vibration_amplitude)
    d = resolved.separation
    own = contact_caveats(resolved.rig.contact, separation=d) if d > 0 else (PRESSED_LAYER,)
    return (*input_caveats(resolved.rig), *own, *(() if caveat is None else (caveat,)))


_MAX_DRY_FRICTION: Final = 2.0  # coefficient of hard bodies in air; clean metals in a vacuum exceed it
_MAX_RELATIVE_ROUGHNESS: Final = 0.05  # rms height over the radius of the nominal area


def input_caveats(rig: Rig) -> tuple[str, ...]:
    """Caveats of entries of a rig that hard dry bodies in air do not have."""
    if rig.friction_model.for_soft_bodies:
        return ()
    friction, height = rig.friction_coefficient, rig.contact.roughness.rms_height
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    return (
        *(
            [
                f"a coefficient of friction of {friction:.3g} without vibration is above {_MAX_DRY_FRICTION:g}, which"
                " hard dry bodies do not reach in air: check force, load and zero of the force"
            ]
            if friction > _MAX_DRY_FRICTION
            else []
        ),
        *(
            [
                f"the rms height of {format_si(height, 'm')} is {height / radius:.2g} of the radius"
                f" {format_si(radius, 'm')} of the nominal area, too much for a mean over asperities: check"
                " contact.roughness"
            ]
            if height > _MAX_RELATIVE_ROUGHNESS * radius
            else []
        ),
    )


def direction_caveats(resolved: ResolvedRig) -> tuple[str, ...]:
    """How far the friction of a vibration within the plane was tested, and what a model leaves out of its direction."""
    rig, model = resolved.rig, resolved.rig.friction_model
    if rig.direction.is_normal:
        if "normal" in model.directions:
            return ()
        able = "asperity_stick_slip"
        return (
            f"friction model {model.name} is of vibration within the plane, and leaves friction under one along the"
            f" normal as it is; take friction.model {able}",
        )
    text = f"vibration {rig.direction.text}"
    if model.name == "coulomb" and rig.direction.angle == 0.0:
        return (
            f"{text}: friction by theory without a fitted number; of seven published points it differs from two by up"
            " to 0.04 of the friction ratio, and five, slow ones under 0.35 um, have 0.09 to 0.15 more",
        )
    if model.name == "asperity_stick_slip":
        return (
            f"{text}: friction by theory alone; with the memory length of vibration along the normal the model"
            " asperity_stick_slip leaves at least 0.63 of the friction along the sliding where Littmann et al. measured"
            " 0.30: take friction.model coulomb, or a memory length from own runs",
        )
    return (f"{text}: friction by theory alone, the model {model.name}; compared with no experiment",)


def _ratios_text(resolved: ResolvedRig, amplitude: float | None) -> str:
    """Friction ratios by the decay length of the roughness and by that of published tests, in words."""
    if amplitude is None:
        amplitude = _stated_amplitude(resolved)
    if amplitude is None:
        return ""
    rig = resolved.rig
    worn = replace(rig, contact=replace(rig.contact, decay_length=PUBLISHED_DECAY_LENGTH.median))
    first, second = (_ratio_under_sine(one, amplitude) for one in (rig, worn))
    if first is None and second is None:
        return ""
    texts = ["none by the model" if ratio is None else f"{ratio:.2f}" for ratio in (first, second)]
    return f"friction ratio {texts[0]} with the first, {texts[1]} with their median; "


def _stated_amplitude(resolved: ResolvedRig) -> float | None:
    """Amplitude that a rig states or measured, not one that has to be computed. [m]"""
    try:
        used = resolved.vibration
    except SonolubeError:
        return None
    if used.sine_amplitude is None and used.source == "measured":
        return resolved.rig.vibration_amplitude
    return used.sine_amplitude


def _ratio_under_sine(rig: Rig, amplitude: float) -> float | None:
    """Friction ratio of a rig under a sine; None outside the range of its friction model."""
    try:
        motion = prescribed_sine(rig, vibration_amplitude=amplitude)
        ratio = float(friction_ratios(rig, motion, sliding_speed=rig.sliding_speed).friction_ratio)
    except SonolubeError:
        return None
    return ratio if isfinite(ratio) else None


def _micrometres(length: float) -> str:
    return f"{1e6 * length:.2g}"
