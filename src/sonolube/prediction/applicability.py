"""Limits of a prediction, its interval of the friction ratio alone, and the heating of a contact.

Rigs that a prediction refuses, and conditions of which the published tests tell less or nothing.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, MissingProperty, SonolubeError
from sonolube.models.thermal import EllipticSource, ThermalSolid, contact_rise
from sonolube.prediction.bodies import named_bodies, softer_hardness
from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, Conditions, published_rigs
from sonolube.prediction.evidence_posterior import EvidencePosterior, population_of
from sonolube.prediction.hierarchy import central_interval
from sonolube.prediction.inputs import RigInputs, rig_inputs, within_plane_refusal
from sonolube.prediction.predictive import DRAWS, ratio_draws
from sonolube.prediction.within_plane import (
    is_predicted,
    is_slower_than_tested,
    plane_caveats,
    plane_extrapolation,
    tested_velocity_ratios,
    within_plane,
)
from sonolube.rig import ResolvedRig, Rig, thermal_solid
from sonolube.rig.contact_temperature import spot_rise
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.text.units import format_si
from sonolube.validation.published_tests import friction_tests

NORMAL_VIBRATION: Final = "The vibration is along the normal of the contact."
"""Sentence of a prediction of vibration along the normal, as almost all published tests are."""

_SOFT_FAMILIES: Final = frozenset(
    {"polymer", "rubber", "elastomer", "felt", "skin", "foam", "textile", "leather", "webbing"}
)
_SOFT_MODULUS: Final = 10e9  # effective, in Pa: below that of any pair of metals, glasses or ceramics
_METALS: Final = frozenset(
    {
        *("aluminium", "brass", "bronze", "cast_iron", "copper", "magnesium", "nickel"),
        *("stainless_steel", "steel", "titanium", "zinc"),
    }
)
_MIN_DRY_FRICTION: Final = 0.15  # coefficient of metals on metals in air
_FAR_ROUGHER: Final = 5.0  # times the roughest published contact
_MARGIN: Final = 1.05  # beyond the ends of a range


@dataclass(frozen=True, kw_only=True, slots=True)
class Applicability:
    """Range of application of a prediction to a rig.

    Parameters
    ----------
    refusal : str or None
        One line with reason and remedy, where there is no prediction.
    caveats : tuple of str
        One line each.
    beyond_tests : tuple of str
        Those caveats that name what no published test is like.
    any_ratio : bool
        Whether friction may fall by anything from 0 to 100 %, for all that is known.
    """

    refusal: str | None
    caveats: tuple[str, ...]
    any_ratio: bool
    beyond_tests: tuple[str, ...] = ()


def applicability(rig: Rig, *, lubricant: bool = False, evidence: EvidencePosterior | None = None) -> Applicability:
    """Direction, bodies, lubricant and frequency of a rig against what predictions are learned from.

    Refused are a vibration along the normal and within the plane at once, and soft bodies: polymers, rubber, felt,
    skin, foam, an effective modulus below 10 GPa where not both materials are named, or a friction model of soft
    bodies, and a nominal pressure above the hardness of the softer body. A coefficient of friction below 0.15 of
    metals, or of hard bodies without names, counts as that of a lubricated contact.
    """
    lubricated = _lubrication(rig, lubricant=lubricant)
    beyond = (*lubricated, *_frequency(rig), *_roughness(rig))
    tested = _within_plane(rig.direction, evidence) if is_predicted(rig.direction) else ()
    return Applicability(
        refusal=_in_plane(rig) or _soft(rig) or _crushed(rig),
        caveats=(*tested, *beyond),
        any_ratio=bool(lubricated),
        beyond_tests=beyond,
    )


def _within_plane(direction: VibrationDirection, evidence: EvidencePosterior | None) -> tuple[str, ...]:
    """Caveats of a vibration within the plane by the posterior that predicts it."""
    own = "" if evidence is None else evidence.own_within_plane
    return plane_caveats(direction, population_of(direction, evidence), own=own)


def _in_plane(rig: Rig) -> str | None:
    """Refusal of a vibration along the normal and within the plane at once."""
    fraction = getattr(rig.friction_model, "in_plane_fraction", 0.0)
    if not rig.direction.is_normal:
        return None if is_predicted(rig.direction) else within_plane_refusal(rig)
    if not fraction:
        return None
    return (
        f"{rig.title}: a prediction is of vibration along the normal, but friction.in_plane_fraction is {fraction:g};"
        " remove it, or use fit and compare, whose models take motion in the plane of contact"
    )


def _soft(rig: Rig) -> str | None:
    """Refusal of soft bodies."""
    bodies = named_bodies(rig)
    soft = [body.title for body in bodies if body.family in _SOFT_FAMILIES]
    modulus = rig.contact.pair.effective_modulus
    if rig.friction_model.for_soft_bodies:
        why = f"friction model {rig.friction_model.name} is of a soft or floating contact"
    elif soft:
        why = f"{' and '.join(soft)} {'is' if len(soft) == 1 else 'are'} soft"
    elif len(bodies) < 2 and modulus < _SOFT_MODULUS:
        why = f"an effective modulus of {format_si(modulus, 'Pa')} is that of a soft body"
    else:
        return None
    return (
        f"{rig.title}: {why}, and all published tests behind a prediction are of hard bodies; use sonolube friction,"
        " whose models soft_layer and squeeze_film are theory alone"
    )


def _crushed(rig: Rig) -> str | None:
    """Refusal of a nominal pressure that the softer body cannot bear."""
    found = crushing_load(rig)
    return None if found is None else f"{rig.title}: {found}"


def crushing_load(rig: Rig) -> str | None:
    """Sentence on a nominal pressure above the hardness of the softer body; None where it bears the load."""
    pressure, hardness = rig.normal_load / rig.contact.nominal_area, softer_hardness(rig)
    if isinstance(hardness, str) or pressure <= hardness:
        return None
    return (
        f"a load of {format_si(rig.normal_load, 'N')} over {format_si(rig.contact.nominal_area, 'm2')} is"
        f" {format_si(pressure, 'Pa')}, above the hardness {format_si(hardness, 'Pa')} of the softer body,"
        " which cannot bear it; lower the load or enlarge contact.nominal_area"
    )


def _roughness(rig: Rig) -> tuple[str, ...]:
    """Caveat of a roughness far above that of the published tests."""
    height = rig.contact.roughness.rms_height
    highest = max(test.contact.roughness.rms_height for test in friction_tests())
    if height <= _FAR_ROUGHER * highest:
        return ()
    return (
        f"the rms height of {format_si(height, 'm')} is far above the {format_si(highest, 'm')} of the published tests,"
        " whose worn contacts tell little of it",
    )


def _lubrication(rig: Rig, *, lubricant: bool) -> tuple[str, ...]:
    """Caveat of a contact that is lubricated, or whose friction is that of a lubricated one."""
    coefficient, hard = rig.friction_coefficient, all(body.family in _METALS for body in named_bodies(rig))
    if lubricant:
        why = "the contact is lubricated"
    elif hard and coefficient < _MIN_DRY_FRICTION:
        why = (
            f"a coefficient of friction of {coefficient:.3g} without vibration is below {_MIN_DRY_FRICTION:g}, the"
            " least of dry metals, so that the contact counts as lubricated"
        )
    else:
        return ()
    return (f"{why}: a dry prediction does not hold, and friction may fall by anything from 0 to 100 %",)


def _frequency(rig: Rig) -> tuple[str, ...]:
    """Caveat of a frequency beyond those of the published tests."""
    if rig.drive is None or not rig.direction.is_normal:  # Coulomb's law knows velocities alone
        return ()
    low, high = _tested_frequencies()
    own = rig.drive.frequency
    if not _is_outside(own, low, high):
        return ()
    return (
        f"the frequency of {format_si(own, 'Hz')} is outside the {format_si(low, 'Hz')} to {format_si(high, 'Hz')} of"
        " the published tests: it enters by one scaling alone, the sliding speed over the peak speed of the vibration,"
        " v_r/(omega a)",
    )


def _tested_frequencies() -> tuple[float, float]:
    """Lowest and highest frequency of the published tests along the normal, in Hz."""
    tested = np.concatenate([each.at.conditions.frequency for each in published_rigs()])
    return float(tested.min()), float(tested.max())


def _is_outside(values: ArrayLike, low: float, high: float) -> NDArray[np.bool_]:
    """Whether values lie beyond the ends of a tested range by more than the margin."""
    found = np.asarray(values, dtype=np.float64)
    return ~((low / _MARGIN <= found) & (found <= high * _MARGIN))


def extrapolation_caveats(rig: Rig, inputs: RigInputs) -> tuple[str, ...]:
    """Sentence that names the conditions of a rig that lie outside the published tests.

    Empty where all conditions lie within.
    """
    if not rig.direction.is_normal:
        return plane_extrapolation(inputs.at().conditions)
    return tested_range_caveats(rig, vibration_amplitude=inputs.amplitude.value)


def tested_range_caveats(rig: Rig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Sentence that names the conditions of a rig at an amplitude that lie outside the published tests."""
    if not rig.direction.is_normal:
        return _plane_range_caveats(rig, vibration_amplitude)
    outside = untested_conditions(rig, vibration_amplitude=vibration_amplitude)
    if not outside:
        return ()
    return (f"outside the range of the published tests, so that the prediction extrapolates: {'; '.join(outside)}",)


def untested_conditions(rig: Rig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Conditions of a rig at an amplitude outside the published tests along the normal, each with their range."""
    return tuple(
        f"{label} {format_si(value, unit)} ({format_si(low, unit)} to {format_si(high, unit)})"
        for label, value, unit, tested in _conditions(rig, vibration_amplitude)
        for low, high in [_ends(tested)]
        if _is_outside(value, low, high)
    )


def is_beyond_tests(
    rig: Rig, *, vibration_amplitude: ArrayLike, frequency: ArrayLike | None, sliding_speed: ArrayLike
) -> NDArray[np.bool_]:
    """Whether operating points of a rig lie beyond the published tests, by the ranges that judge a single one.

    Parameters
    ----------
    rig : Rig
    vibration_amplitude : array_like
        Zero to peak, of each point. [m]
    frequency : array_like or None
        Broadcast against `vibration_amplitude`; None where the rig has none. [Hz]
    sliding_speed : array_like
        Broadcast against `vibration_amplitude`. [m/s]

    Returns
    -------
    ndarray of bool, shape of the broadcast arguments
        True everywhere where the rig itself is unlike the tested ones.
    """
    f_given = np.nan if frequency is None else frequency
    a, f, v = (np.asarray(each, dtype=np.float64) for each in (vibration_amplitude, f_given, sliding_speed))
    a, f, v = np.broadcast_arrays(a, f, v)
    if _of_the_rig_alone(rig):
        return np.ones(a.shape, dtype=np.bool_)
    if not rig.direction.is_normal:
        known = (a > 0) & (v > 0) & np.isfinite(f)
        found = np.zeros(a.shape, dtype=np.bool_)
        if is_predicted(rig.direction) and np.any(known):
            found[known] = is_slower_than_tested(_plane_conditions(rig, a[known], f[known], v[known]))
        return found
    found = _is_outside(rig.contact.pair.effective_modulus, *_ends(_tested_moduli()))
    if frequency is not None:
        found = found | _is_outside(f, *_tested_frequencies())
    for values, name in ((a, "vibration_amplitude"), (v, "sliding_speed")):
        found = found | _is_outside(values, *_ends(_tested(name)))
    return np.broadcast_to(found, a.shape).copy()


def _of_the_rig_alone(rig: Rig) -> bool:
    """Whether a rig is unlike those of the published tests at any amplitude, frequency and speed."""
    return bool(_in_plane(rig) or _soft(rig) or _crushed(rig) or _lubrication(rig, lubricant=False) or _roughness(rig))


def tested_ranges_text(rig: Rig) -> str:
    """Ranges of the published tests that a rig is held to, in words."""
    if not rig.direction.is_normal:
        return f"v_r/(omega a) down to {tested_velocity_ratios()[0]:.2g}"
    ranges = (
        ("amplitude", "m", _ends(_tested("vibration_amplitude"))),
        ("sliding speed", "m/s", _ends(_tested("sliding_speed"))),
        ("frequency", "Hz", _tested_frequencies()),
    )
    return ", ".join(f"{name} {format_si(low, unit)} to {format_si(high, unit)}" for name, unit, (low, high) in ranges)


def _plane_range_caveats(rig: Rig, vibration_amplitude: float) -> tuple[str, ...]:
    """Sentence on conditions of a vibration within the plane outside the published points."""
    if rig.drive is None or not (rig.sliding_speed > 0 and is_predicted(rig.direction)):
        return ()
    own = (np.array([each]) for each in (vibration_amplitude, rig.drive.frequency, rig.sliding_speed))
    return plane_extrapolation(_plane_conditions(rig, *own))


def _plane_conditions(rig: Rig, amplitude: Floats, frequency: Floats, speed: Floats) -> Conditions:
    """Conditions of a rig that vibrates within the plane, each argument of shape (n,)."""
    conditions = Conditions(
        vibration_amplitude=amplitude,
        frequency=frequency,
        sliding_speed=speed,
        decay_length=np.full(amplitude.shape, REFERENCE_DECAY_LENGTH),
    )
    return within_plane(conditions, rig.direction)


def _conditions(rig: Rig, vibration_amplitude: float) -> list[tuple[str, float, str, Floats]]:
    """Label, value, unit and tested values of each condition."""
    return [
        ("vibration amplitude", vibration_amplitude, "m", _tested("vibration_amplitude")),
        ("sliding speed", rig.sliding_speed, "m/s", _tested("sliding_speed")),
        ("effective modulus", rig.contact.pair.effective_modulus, "Pa", _tested_moduli()),
    ]


def _tested(name: str) -> Floats:
    """Values of a condition in all published tests along the normal."""
    return np.concatenate([getattr(each.at.conditions, name) for each in published_rigs()])


def _tested_moduli() -> Floats:
    """Effective moduli of all published tests along the normal, in Pa."""
    return np.array([test.contact.pair.effective_modulus for test in friction_tests()])


def _ends(values: Floats) -> tuple[float, float]:
    """Lowest and highest of some values."""
    return float(np.min(values)), float(np.max(values))


def contact_heating(rig: Rig, pin: str | None, disc: str | None) -> float | str:
    """Mean temperature rise of the contact, taken as circular, for a watt of friction, in K/W; or why it is unknown."""
    solids = _thermal_solids(rig, pin, disc)
    if isinstance(solids, str):
        return solids
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = EllipticSource(half_length=radius, half_width=radius)
    rise = contact_rise(*solids, source, heat_rate=1.0, sliding_speed=rig.sliding_speed)
    return float(rise.mean_temperature_rise)


def spot_heating(rig: Rig, pin: str | None, disc: str | None) -> float | str:
    """Flash temperature rise of one real spot under the load for a watt of friction, in K/W; or why it is unknown."""
    solids, hardness = _thermal_solids(rig, pin, disc), softer_hardness(rig, pin, disc)
    if isinstance(solids, str) or isinstance(hardness, str):
        return solids if isinstance(solids, str) else hardness
    return float(spot_rise(*solids, rig, hardness=hardness, heat_rate=1.0))


def _thermal_solids(rig: Rig, pin: str | None, disc: str | None) -> tuple[ThermalSolid, ThermalSolid] | str:
    """Thermal properties of pin and disc, or why they are unknown."""
    named = pin is not None or disc is not None
    pin, disc = pin or rig.pin_material, disc or rig.disc_material
    if pin is None or disc is None:
        if named:
            raise InvalidInput("the temperature rise needs both materials; give pin and disc, or neither")
        return "name the materials of pin and disc"
    try:
        return thermal_solid(pin), thermal_solid(disc)
    except MissingProperty as missing:
        if named:
            raise
        return str(missing)


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionInterval:
    """Central 80 % interval of the friction ratio, with the error of the model, as `predict` gives it.

    Parameters
    ----------
    low, high : float or None
        Ends; None where there is no prediction.
    median : float or None
        Between them.
    reason : str
        Why there is none.
    caveats : tuple of str
        Own published tests that it was learned from too.
    """

    low: float | None = None
    high: float | None = None
    median: float | None = None
    reason: str = ""
    caveats: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Interval in words, or why there is none."""
        if self.low is None or self.high is None:
            return f"not predicted: {self.reason}"
        middle = "" if self.median is None else f"{self.median:.2g}, "
        return f"{middle}{self.low:.2g} to {self.high:.2g} (80 %, `sonolube predict`)"


def friction_interval(rig: Rig | ResolvedRig, *, evidence: EvidencePosterior | None = None) -> FrictionInterval:
    """Interval of the friction ratio of a rig at its operating point, without own runs; equal to that of `predict`."""
    resolved = resolved_rig(rig)
    direction = resolved.rig.direction
    try:
        limits = applicability(resolved.rig)
        if limits.refusal:
            return FrictionInterval(reason=limits.refusal)
        if limits.any_ratio:
            return FrictionInterval(reason=_lubrication(resolved.rig, lubricant=False)[0])
        at = rig_inputs(resolved, takes_plane=True).at()
    except SonolubeError as refusal:
        return FrictionInterval(reason=str(refusal))
    draws = ratio_draws(population_of(direction, evidence), at, count=DRAWS)[:, 0]
    low, high = central_interval(draws, 0.8)
    return FrictionInterval(
        low=float(low),
        high=float(high),
        median=float(np.median(draws)),
        caveats=() if evidence is None else evidence.caveats(direction),
    )
