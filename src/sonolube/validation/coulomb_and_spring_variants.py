"""Variants of Coulomb friction under in-plane vibration and of spring-coupled contacts, from the literature.

No in-plane motion is printed for any test of the dissertation. A model that requires one takes a fraction of the normal
motion as a fitted parameter; across the sliding that is the variant `kinematic-fitted`.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path
from typing import Final

from sonolube.checks import Floats
from sonolube.errors import ModelRangeWarning, OutsideRange
from sonolube.models import friction
from sonolube.models.contact import RoughContact, normal_stiffness, separation
from sonolube.validation.model_variant import ConditionColumns, VibratedRig, read_variants
from sonolube.validation.published_tests import FrictionTest, InPlaneTest

_Vibrated = FrictionTest | ConditionColumns
_PER_SLIP_LENGTH: Final = friction.SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0)


@cache
def load_over_stiffness(contact: RoughContact, load: float) -> float:
    """Load over normal stiffness of a rough contact at rest: the approach of linear springs. [m]"""
    return float(_load_over_stiffness(contact, load))


def _load_over_stiffness(contact: RoughContact, load: float | Floats) -> Floats:
    """Load over normal stiffness of a rough contact at rest, for each load. [m]"""
    return load / normal_stiffness(contact, separation=separation(contact, normal_load=load))


def approach_at_rest(test: _Vibrated) -> float | Floats:
    """Approach of linear springs under the load of each condition. [m]"""
    if isinstance(test, ConditionColumns):
        return _load_over_stiffness(test.contact, test.normal_load)
    return load_over_stiffness(test.contact, test.normal_load)


def _coulomb_in_plane(test: InPlaneTest) -> Floats:
    """Friction ratio by Coulomb friction under the measured in-plane vibration. []"""
    return friction.oblique_vibration_ratio(
        sliding_speed=test.sliding_speed,
        vibration_velocity=test.vibration_velocity,
        vibration_direction=test.vibration_direction,
    )


def _coulomb_longitudinal(test: _Vibrated, in_plane_fraction: float) -> Floats:
    """Friction ratio by Coulomb friction under vibration along the sliding. []"""
    return friction.parallel_vibration_ratio(
        sliding_speed=test.sliding_speed, vibration_velocity=in_plane_fraction * _peak_velocity(test)
    )


def _coulomb_oblique(test: _Vibrated, in_plane_fraction: float, vibration_direction: float) -> Floats:
    """Friction ratio by Coulomb friction under vibration oblique to the sliding. []"""
    return friction.oblique_vibration_ratio(
        sliding_speed=test.sliding_speed,
        vibration_velocity=in_plane_fraction * _peak_velocity(test),
        vibration_direction=vibration_direction,
    )


def _spring_flat(test: _Vibrated, approach: float | None = None, mindlin_ratio: float | None = None) -> Floats:
    """Friction ratio by springs of constant stiffness, the profile of a flat punch. []"""
    at_rest = approach_at_rest(test) if approach is None else approach
    return _under_normal_oscillation(test, _PER_SLIP_LENGTH, at_rest, _slip_per_approach(test, mindlin_ratio))


def _spring_flat_on_roughness(test: _Vibrated, slip_length: float, approach_ratio: float) -> Floats:
    """Friction ratio by springs of constant stiffness, their approach in proportion to R_q. []"""
    at_rest = approach_ratio * test.contact.height_scale
    return _under_normal_oscillation(test, _PER_SLIP_LENGTH, at_rest, slip_length / at_rest)


def _spring_parabolic(test: FrictionTest) -> Floats:
    """Friction ratio by springs of a parabolic profile with the load and stiffness of the contact. []"""
    springs = replace(_PER_SLIP_LENGTH, profile="parabolic")
    hertz = 1.5 * load_over_stiffness(test.contact, test.normal_load)  # F_N = 2/3 k_z u
    return _under_normal_oscillation(test, springs, hertz, _slip_per_approach(test, None))


def _under_normal_oscillation(
    test: _Vibrated, springs: friction.SpringContact, at_rest: float | Floats, slip_per_approach: float | Floats
) -> Floats:
    """Friction ratio of springs about the load-balanced approach. []

    The ratio depends on lengths along the sliding over the slip length alone, so that springs of unit slip per
    approach slide more slowly.
    """
    a = test.vibration_amplitude
    return friction.normal_oscillation_ratio(
        springs,
        approach=friction.load_balanced_approach(springs, approach=at_rest, normal_amplitude=a),
        normal_amplitude=a,
        frequency=test.frequency,
        sliding_speed=test.sliding_speed / slip_per_approach,
    )


def _spring_approximate(test: FrictionTest) -> Floats:
    """Friction ratio by the published approximation for springs of constant stiffness. []"""
    springs, a = _springs(test, None), test.vibration_amplitude
    critical = friction.critical_speed(springs, frequency=test.frequency, normal_amplitude=a)
    with _range_warnings_as_errors():
        return friction.approximate_normal_ratio(
            springs,
            approach=load_over_stiffness(test.contact, test.normal_load),
            normal_amplitude=a,
            velocity_ratio=test.sliding_speed / critical,
        )


def _spring_in_plane(
    test: _Vibrated, mindlin_ratio: float, in_plane_fraction: float = 0.0, in_plane_phase: float = 0.0
) -> Floats:
    """Friction ratio by springs of constant stiffness under normal and in-plane motion. []"""
    if in_plane_fraction == 0:
        return _spring_flat(test, mindlin_ratio=mindlin_ratio)
    slip, a = _slip_per_approach(test, mindlin_ratio), test.vibration_amplitude
    with _range_warnings_as_errors():
        return friction.combined_oscillation_ratio(
            _PER_SLIP_LENGTH,
            approach=friction.load_balanced_approach(
                _PER_SLIP_LENGTH, approach=approach_at_rest(test), normal_amplitude=a
            ),
            frequency=test.frequency,
            sliding_speed=test.sliding_speed / slip,
            normal_amplitude=a,
            in_plane_amplitude=in_plane_fraction * a / slip,
            in_plane_phase=in_plane_phase,
            steps=128,
        )


def _spring_longitudinal(rig: VibratedRig) -> Floats:
    """Friction ratio by springs of constant stiffness under the measured motion along the sliding. []"""
    assert rig.in_plane_amplitude is not None
    assert rig.frequency is not None
    return friction.longitudinal_oscillation_ratio(
        _springs(rig, None),
        approach=load_over_stiffness(rig.contact, rig.normal_load),
        in_plane_amplitude=rig.in_plane_amplitude,
        frequency=rig.frequency,
        sliding_speed=rig.sliding_speed,
    )


def _elliptical(test: _Vibrated, in_plane_fraction: float, in_plane_phase: float) -> Floats:
    """Friction ratio by rigid Coulomb friction on an elliptical path. []"""
    return -friction.elliptical_traction_ratio(
        normal_load=test.normal_load,
        normal_stiffness=test.normal_load / approach_at_rest(test),
        normal_amplitude=test.vibration_amplitude,
        in_plane_amplitude=in_plane_fraction * test.vibration_amplitude,
        frequency=test.frequency,
        relative_velocity=test.sliding_speed,
        phase=-in_plane_phase,  # lag of the normal motion behind the in-plane motion
    )


@contextmanager
def _range_warnings_as_errors() -> Iterator[None]:
    """Raise OutsideRange where a model warns that it is used outside its range."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelRangeWarning)
        try:
            yield
        except ModelRangeWarning as caveat:
            raise OutsideRange(str(caveat)) from None


def _peak_velocity(test: _Vibrated) -> float | Floats:
    """Peak velocity of the normal vibration. [m/s]"""
    return 2 * pi * test.frequency * test.vibration_amplitude


def _slip_per_approach(test: _Vibrated, mindlin_ratio: float | None) -> float | Floats:
    """Slip length over the approach, with the ratio of stiffnesses of Mindlin if None."""
    return test.friction_coefficient / (test.contact.pair.mindlin_ratio if mindlin_ratio is None else mindlin_ratio)


def _springs(test: FrictionTest | VibratedRig, mindlin_ratio: float | None) -> friction.SpringContact:
    """Spring-coupled contact with a ratio of tangential to normal stiffness, that of Mindlin if None."""
    return friction.SpringContact(
        friction_coefficient=test.friction_coefficient,
        mindlin_ratio=test.contact.pair.mindlin_ratio if mindlin_ratio is None else mindlin_ratio,
    )


COULOMB_AND_SPRING_VARIANTS: Final = read_variants(
    Path(__file__).with_suffix(".toml"),
    coulomb_in_plane=_coulomb_in_plane,
    coulomb_longitudinal=_coulomb_longitudinal,
    coulomb_oblique=_coulomb_oblique,
    spring_flat=_spring_flat,
    spring_flat_on_roughness=_spring_flat_on_roughness,
    spring_parabolic=_spring_parabolic,
    spring_approximate=_spring_approximate,
    spring_in_plane=_spring_in_plane,
    spring_longitudinal=_spring_longitudinal,
    elliptical=_elliptical,
)
"""Variants of Coulomb friction and of spring-coupled contacts."""
