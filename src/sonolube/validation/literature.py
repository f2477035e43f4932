"""The literature's models of friction under vibration as they are set against experiment: what each leaves free.

None of the dissertation's tests prints a motion within the plane. A model that needs one takes the fraction of the
normal motion that suits the tests best, "hidden"; across the sliding that is the closure `kinematic-fitted`.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from math import exp, pi, sqrt
from typing import Final

import numpy as np

from sonolube.contact import (
    GapMotion,
    RoughContact,
    load_balanced_motion,
    normal_stiffness,
    separation,
    sinusoidal_motion,
)
from sonolube.errors import ModelRangeWarning, OutsideRange
from sonolube.friction import (
    DahlFriction,
    Holder,
    LuGreFriction,
    SpringContact,
    approximate_normal_ratio,
    combined_oscillation_ratio,
    critical_speed,
    dahl_under_vibration,
    elliptical_traction_ratio,
    load_balanced_approach,
    longitudinal_oscillation_ratio,
    lugre_under_vibration,
    normal_oscillation_ratio,
    oblique_vibration_ratio,
    parallel_vibration_ratio,
    spring_driven_slider_force,
)
from sonolube.validation.closures import ClosureVariant
from sonolube.validation.earlier_tests import InPlaneTest
from sonolube.validation.friction_tests import FrictionTest
from sonolube.validation.parameters import IN_PLANE, Parameter, of_rigs
from sonolube.validation.vibrated_rig import VibratedRig

_FRACTION: Final = IN_PLANE[0]
_DIRECTION: Final = Parameter(
    name="vibration_direction",
    unit="rad",
    rest=0.0,
    start=(0.3, 1.2),
    low=0.0,
    high=pi / 2,
    reason="Any: between along and across everything is told.",
)
_APPROACH: Final = Parameter(
    name="approach",
    unit="m",
    rest=2e-6,
    start=(1e-6, 4e-6),
    low=0.1e-6,
    high=20e-6,
    reason="Load over normal stiffness: from a smooth Hertzian contact to ten times that of exponential heights.",
)
_MINDLIN: Final = Parameter(
    name="mindlin_ratio",
    unit="",
    rest=0.82,
    start=(0.1, 0.4, 0.82),
    low=0.02,
    high=1.0,
    reason="Mindlin's for like bodies is 0.67 to 1; a holder in series makes the contact softer along, as measured "
    "contacts of rough bodies are.",
)
_STRIBECK: Final = (
    Parameter(
        name="static_friction_ratio",
        unit="",
        rest=1.0,
        start=(1.2, 2.0),
        low=1.0,
        high=3.0,
        reason="Metals hold up to some three times what they slide at; below one the curve would not be Stribeck's.",
    ),
    Parameter(
        name="stribeck_velocity",
        unit="m/s",
        rest=0.1,
        start=(0.03, 0.3),
        low=1e-3,
        high=1.0,
        reason="From creep to the peak velocity of the strongest vibration.",
    ),
)
_IN_PLANE_OF_MAP: Final = of_rigs(IN_PLANE, "power map")
_SETTLING, _DAMPING = 8, 0.2  # of a drive: own periods before its force is taken, and share of critical damping


def _coulomb_in_plane(test: InPlaneTest) -> float:
    return float(
        oblique_vibration_ratio(
            sliding_speed=test.sliding_speed,
            vibration_velocity=test.vibration_velocity,
            vibration_direction=test.vibration_direction,
        )
    )


def _coulomb_along(test: FrictionTest, in_plane_fraction: float) -> float:
    return float(
        parallel_vibration_ratio(
            sliding_speed=test.sliding_speed, vibration_velocity=in_plane_fraction * _peak_velocity(test)
        )
    )


def _coulomb_oblique(test: FrictionTest, in_plane_fraction: float, vibration_direction: float) -> float:
    return float(
        oblique_vibration_ratio(
            sliding_speed=test.sliding_speed,
            vibration_velocity=in_plane_fraction * _peak_velocity(test),
            vibration_direction=vibration_direction,
        )
    )


def _spring_flat(test: FrictionTest, approach: float | None = None, mindlin_ratio: float | None = None) -> float:
    springs = _springs(test, mindlin_ratio)
    at_rest = _load_over_stiffness(test) if approach is None else approach
    return _under_normal_oscillation(test, springs, at_rest)


def _spring_parabolic(test: FrictionTest) -> float:
    springs = replace(_springs(test, None), profile="parabolic")
    return _under_normal_oscillation(test, springs, 1.5 * _load_over_stiffness(test))  # of Hertz, F_N = 2/3 k_z u


def _under_normal_oscillation(test: FrictionTest, springs: SpringContact, at_rest: float) -> float:
    a = test.vibration_amplitude
    return float(
        normal_oscillation_ratio(
            springs,
            approach=load_balanced_approach(springs, approach=at_rest, normal_amplitude=a),
            normal_amplitude=a,
            frequency=test.frequency,
            sliding_speed=test.sliding_speed,
        )
    )


def _spring_approximate(test: FrictionTest) -> float:
    springs, a = _springs(test, None), test.vibration_amplitude
    critical = critical_speed(springs, frequency=test.frequency, normal_amplitude=a)
    with _range_warnings_as_refusals():
        return float(
            approximate_normal_ratio(
                springs,
                approach=_load_over_stiffness(test),
                normal_amplitude=a,
                velocity_ratio=test.sliding_speed / critical,
            )
        )


def _spring_in_plane(
    test: FrictionTest, mindlin_ratio: float, in_plane_fraction: float = 0.0, phase: float = 0.0
) -> float:
    if in_plane_fraction == 0:
        return _spring_flat(test, mindlin_ratio=mindlin_ratio)
    springs, a = _springs(test, mindlin_ratio), test.vibration_amplitude
    with _range_warnings_as_refusals():
        return float(
            combined_oscillation_ratio(
                springs,
                approach=load_balanced_approach(springs, approach=_load_over_stiffness(test), normal_amplitude=a),
                frequency=test.frequency,
                sliding_speed=test.sliding_speed,
                normal_amplitude=a,
                in_plane_amplitude=in_plane_fraction * a,
                in_plane_phase=phase,
                steps=128,
            )
        )


def _spring_along(rig: VibratedRig) -> float:
    assert rig.in_plane_amplitude is not None
    assert rig.frequency is not None
    return float(
        longitudinal_oscillation_ratio(
            _springs(rig, None),
            approach=_load_over_stiffness(rig),
            in_plane_amplitude=rig.in_plane_amplitude,
            frequency=rig.frequency,
            sliding_speed=rig.sliding_speed,
        )
    )


def _elliptical(test: FrictionTest, in_plane_fraction: float, phase: float) -> float:
    return -float(
        elliptical_traction_ratio(
            normal_load=test.normal_load,
            normal_stiffness=test.normal_load / _load_over_stiffness(test),
            normal_amplitude=test.vibration_amplitude,
            in_plane_amplitude=in_plane_fraction * test.vibration_amplitude,
            frequency=test.frequency,
            relative_velocity=test.sliding_speed,
            phase=-phase,  # there the lag of the normal motion behind the other
        )
    )


def _dahl(test: FrictionTest, in_plane_fraction: float = 0.0, phase: float = 0.0) -> float:
    mean_force = dahl_under_vibration(
        test.contact,
        separation=_balanced_separation(test.contact, test.normal_load, test.vibration_amplitude, test.frequency),
        friction_coefficient=test.friction_coefficient,
        sliding_speed=test.sliding_speed,
        frequency=test.frequency,
        in_plane_amplitude=in_plane_fraction * test.vibration_amplitude,
        normal_amplitude=test.vibration_amplitude,
        phase=-phase,  # there the lag of the normal motion behind the other
        steps=256,
    )
    return float(mean_force) / (test.friction_coefficient * test.normal_load)


def _lugre(
    test: FrictionTest,
    mindlin_ratio: float,
    static_friction_ratio: float = 1.0,
    stribeck_velocity: float = 1.0,
    in_plane_fraction: float = 0.0,
    phase: float = 0.0,
) -> float:
    static_excess = (static_friction_ratio - 1) * exp(-((test.sliding_speed / stribeck_velocity) ** 2))
    sliding = test.friction_coefficient * test.normal_load / (1 + static_excess)
    law = LuGreFriction(
        coulomb_friction_force=sliding,
        static_friction_force=static_friction_ratio * sliding,
        stribeck_velocity=stribeck_velocity,
        bristle_stiffness=mindlin_ratio * test.normal_load / _load_over_stiffness(test),
        bristle_damping=0.0,  # a period's mean does not feel it
        viscous_coefficient=0.0,
    )
    motion = _balanced_sine(test.contact, test.normal_load, test.vibration_amplitude, test.frequency)
    speed = test.sliding_speed
    return float(
        lugre_under_vibration(
            law, motion, sliding_speed=speed, in_plane_fraction=in_plane_fraction, in_plane_phase=phase
        )
    )


def _dahl_driven(rig: VibratedRig) -> float:
    assert rig.in_plane_amplitude is not None
    assert rig.frequency is not None
    assert rig.holder_stiffness is not None
    assert rig.holder_mass is not None
    steady = rig.friction_coefficient * rig.normal_load
    stiffness = rig.contact.pair.mindlin_ratio * rig.normal_load / _load_over_stiffness(rig)
    own = sqrt(rig.holder_stiffness / rig.holder_mass)
    damping = 2 * _DAMPING * rig.holder_mass * own
    slide = spring_driven_slider_force(
        DahlFriction(coulomb_friction_force=steady, contact_stiffness=stiffness),
        Holder(holder_stiffness=rig.holder_stiffness, holder_damping=damping, holder_mass=rig.holder_mass),
        sliding_speed=rig.sliding_speed,
        frequency=rig.frequency,
        vibration_amplitude=rig.in_plane_amplitude,
        settling_time=_SETTLING * 2 * pi / own,
        duration=2 * pi / own,
    )
    return slide.mean_drive_force / steady


@contextmanager
def _range_warnings_as_refusals() -> Iterator[None]:
    """Refuse what a model warns of: beyond its range it is not compared."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelRangeWarning)
        try:
            yield
        except ModelRangeWarning as caveat:
            raise OutsideRange(str(caveat)) from None


def _peak_velocity(test: FrictionTest) -> float:
    return 2 * pi * test.frequency * test.vibration_amplitude


def _springs(test: FrictionTest | VibratedRig, mindlin_ratio: float | None) -> SpringContact:
    return SpringContact(
        friction_coefficient=test.friction_coefficient,
        mindlin_ratio=test.contact.pair.mindlin_ratio if mindlin_ratio is None else mindlin_ratio,
    )


def _load_over_stiffness(test: FrictionTest | VibratedRig) -> float:
    return _approach_at_rest(test.contact, test.normal_load)


@cache
def _approach_at_rest(contact: RoughContact, load: float) -> float:
    at_rest = separation(contact, normal_load=load)
    return load / float(normal_stiffness(contact, separation=at_rest))


@cache
def _balanced_separation(contact: RoughContact, load: float, amplitude: float, frequency: float) -> float:
    rise = float(np.mean(_balanced_sine(contact, load, amplitude, frequency).displacement))
    return float(separation(contact, normal_load=load)) + rise


@cache
def _balanced_sine(contact: RoughContact, load: float, amplitude: float, frequency: float) -> GapMotion:
    sine = sinusoidal_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)
    return load_balanced_motion(contact, sine)


LITERATURE_VARIANTS: Final = tuple(
    ClosureVariant(name=name, meaning=meaning, parameters=parameters, ratio=ratio)
    for name, meaning, parameters, ratio in (
        ("coulomb-in-plane", "Coulomb friction, the vibration within the plane as measured", (), _coulomb_in_plane),
        (
            "coulomb-along-hidden",
            "Coulomb friction, a hidden motion along the sliding alone",
            (_FRACTION,),
            _coulomb_along,
        ),
        (
            "coulomb-oblique-hidden",
            "Coulomb friction, a hidden motion within the plane alone",
            (_FRACTION, _DIRECTION),
            _coulomb_oblique,
        ),
        ("spring-flat", "springs of constant stiffness, load over stiffness of the rough contact", (), _spring_flat),
        ("spring-parabolic", "springs of a Hertzian contact of the same load and stiffness", (), _spring_parabolic),
        ("spring-approximate", "the published approximation of springs of constant stiffness", (), _spring_approximate),
        (
            "spring-flat-fitted",
            "springs of constant stiffness, approach and ratio of stiffnesses fitted",
            (_APPROACH, _MINDLIN),
            _spring_flat,
        ),
        (
            "spring-in-plane",
            "springs of constant stiffness, with in-plane motion on the rig of Table 4.2",
            (_MINDLIN, *_IN_PLANE_OF_MAP),
            _spring_in_plane,
        ),
        (
            "spring-along",
            "springs of constant stiffness, the measured motion along the sliding alone",
            (),
            _spring_along,
        ),
        ("elliptical", "rigid friction on an ellipse, a hidden motion along the sliding", IN_PLANE, _elliptical),
        ("dahl", "Dahl's law with the cube's stiffness about a balanced mean", (), _dahl),
        (
            "dahl-in-plane",
            "the same, with in-plane motion on the rig of Table 4.2",
            _IN_PLANE_OF_MAP,
            _dahl,
        ),
        (
            "lugre",
            "LuGre's law, its limit after the balanced load, stiffness of the bristles fitted",
            (_MINDLIN,),
            _lugre,
        ),
        (
            "lugre-in-plane",
            "the same, Stribeck's curve fitted, with in-plane motion on the rig of Table 4.2",
            (_MINDLIN, *_STRIBECK, *_IN_PLANE_OF_MAP),
            _lugre,
        ),
        (
            "dahl-driven",
            "a mass on Dahl's law behind a yielding drive damped by a fifth of critical, vibrated along",
            (),
            _dahl_driven,
        ),
    )
)
"""Every model of the literature that is compared."""
