"""Variants of the friction laws of Dahl and of LuGre under vibration, from the literature."""

from functools import cache
from math import pi, sqrt
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.models import friction
from sonolube.models.contact import RoughContact, separation
from sonolube.validation.coulomb_and_spring_variants import approach_at_rest, load_over_stiffness
from sonolube.validation.friction_model_variants import balanced_motion
from sonolube.validation.model_variant import ConditionColumns, VibratedRig, read_variants
from sonolube.validation.published_tests import FrictionTest

_SETTLING_PERIODS: Final = 8  # natural periods of a driven holder before its force is averaged
_DAMPING_RATIO: Final = 0.2  # of the driven holder


def _dahl(test: FrictionTest | ConditionColumns, in_plane_fraction: float = 0.0, in_plane_phase: float = 0.0) -> Floats:
    """Friction ratio by the law of Dahl with the stiffness of the cube, D 3.10 and 3.11. []"""
    mean_force = friction.dahl_under_vibration(
        test.contact,
        separation=_balanced_separations(test),
        friction_coefficient=test.friction_coefficient,
        sliding_speed=test.sliding_speed,
        frequency=test.frequency,
        in_plane_amplitude=in_plane_fraction * test.vibration_amplitude,
        normal_amplitude=test.vibration_amplitude,
        phase=-in_plane_phase,  # lag of the normal motion behind the in-plane motion
        steps=256,
    )
    return mean_force / (test.friction_coefficient * test.normal_load)


def _balanced_separations(test: FrictionTest | ConditionColumns) -> Floats:
    """Mean separation of each condition about which the load is balanced. [m]"""
    separations = [_balanced_separation(test.contact, *row) for row in _motion_rows(test)]
    return np.array(separations).reshape(np.shape(test.sliding_speed))


def _lugre(
    test: FrictionTest | ConditionColumns,
    mindlin_ratio: float,
    static_friction_ratio: float = 1.0,
    stribeck_velocity: float = 1.0,
    in_plane_fraction: float = 0.0,
    in_plane_phase: float = 0.0,
) -> Floats:
    """Friction ratio by the law of LuGre, the sliding friction of the test on its Stribeck curve. []"""
    static_excess = (static_friction_ratio - 1) * np.exp(-((test.sliding_speed / stribeck_velocity) ** 2))
    sliding = test.friction_coefficient * test.normal_load / (1 + static_excess)
    stiffness = mindlin_ratio * test.normal_load / approach_at_rest(test)
    laws = [
        friction.LuGreFriction(
            coulomb_friction_force=force,
            static_friction_force=static_friction_ratio * force,
            stribeck_velocity=stribeck_velocity,
            bristle_stiffness=bristle,
            bristle_damping=0.0,  # its mean over a period vanishes
            viscous_coefficient=0.0,
        )
        for force, bristle in zip(np.atleast_1d(sliding).tolist(), np.atleast_1d(stiffness).tolist(), strict=True)
    ]
    motions = [balanced_motion(test.contact, *row) for row in _motion_rows(test)]
    ratios = friction.lugre_ratios(
        laws,
        motions,
        sliding_speed=np.atleast_1d(test.sliding_speed),
        in_plane_fraction=in_plane_fraction,
        in_plane_phase=in_plane_phase,
    )
    return ratios.reshape(np.shape(test.sliding_speed))


def _motion_rows(test: FrictionTest | ConditionColumns) -> list[tuple[float, float, float]]:
    """Load, amplitude and frequency of each condition."""
    columns = (np.atleast_1d(each).tolist() for each in (test.normal_load, test.vibration_amplitude, test.frequency))
    return list(zip(*columns, strict=True))


def _dahl_driven(rig: VibratedRig) -> float:
    """Friction ratio of a mass on the law of Dahl behind an elastic drive vibrating along the sliding. []"""
    assert rig.in_plane_amplitude is not None
    assert rig.frequency is not None
    assert rig.holder_stiffness is not None
    assert rig.holder_mass is not None
    steady = rig.friction_coefficient * rig.normal_load
    stiffness = rig.contact.pair.mindlin_ratio * rig.normal_load / load_over_stiffness(rig.contact, rig.normal_load)
    natural = sqrt(rig.holder_stiffness / rig.holder_mass)
    damping = 2 * _DAMPING_RATIO * rig.holder_mass * natural
    slide = friction.spring_driven_slider_force(
        friction.DahlFriction(coulomb_friction_force=steady, contact_stiffness=stiffness),
        friction.Holder(holder_stiffness=rig.holder_stiffness, holder_damping=damping, holder_mass=rig.holder_mass),
        sliding_speed=rig.sliding_speed,
        frequency=rig.frequency,
        vibration_amplitude=rig.in_plane_amplitude,
        settling_time=_SETTLING_PERIODS * 2 * pi / natural,
        duration=2 * pi / natural,
    )
    return slide.mean_drive_force / steady


@cache
def _balanced_separation(contact: RoughContact, load: float, amplitude: float, frequency: float) -> float:
    """Mean separation at which the mean contact force of a harmonic gap motion is the load. [m]"""
    rise = float(np.mean(balanced_motion(contact, load, amplitude, frequency).displacement))
    return float(separation(contact, normal_load=load)) + rise


DAHL_AND_LUGRE_VARIANTS: Final = read_variants(
    Path(__file__).with_suffix(".toml"), dahl=_dahl, lugre=_lugre, dahl_driven=_dahl_driven
)
"""Variants of the laws of Dahl and of LuGre."""
