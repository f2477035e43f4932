"""Variants of the friction models of this program: with default, fitted and rig-specific parameters."""

from dataclasses import asdict, replace
from functools import cache
from math import pi
from pathlib import Path
from typing import Final

from sonolube.checks import Floats
from sonolube.models import friction
from sonolube.models.contact import (
    ContactMotion,
    RoughContact,
    decay_length,
    load_balanced_motion,
    separation,
    sinusoidal_motion,
)
from sonolube.validation.model_variant import ConditionColumns, read_variants
from sonolube.validation.published_tests import FrictionTest


@cache
def balanced_motion(contact: RoughContact, load: float, amplitude: float, frequency: float) -> ContactMotion:
    """Harmonic gap motion about the mean gap at which the mean contact force is the load."""
    return load_balanced_motion(contact, _harmonic_motion(contact, load, amplitude, frequency))


def _normal_stick_slip(test: FrictionTest | ConditionColumns, memory_length: float) -> Floats:
    """Friction ratio by asperity stick-slip without in-plane motion. []"""
    at_rest = separation(test.contact, normal_load=test.normal_load)
    return friction.sine_stick_slip_ratio(
        decay_length=decay_length(test.contact, separation=at_rest),
        vibration_amplitude=test.vibration_amplitude,
        frequency=test.frequency,
        sliding_speed=test.sliding_speed,
        memory_length=memory_length,
    )


def asperity_stick_slip(
    test: FrictionTest, *, memory_length: float, in_plane_fraction: float = 0.0, in_plane_phase: float = 0.0
) -> Floats:
    """Friction ratio of a test by asperity stick-slip about the load-balanced mean gap.

    Parameters
    ----------
    test : FrictionTest
    memory_length : float
        Sliding distance over which an asperity forgets. [m]
    in_plane_fraction : float
        Amplitude of an in-plane motion over that along the normal. []
    in_plane_phase : float
        Phase of the in-plane motion. [rad]

    Returns
    -------
    ndarray
        Friction under vibration over that at rest.
    """
    if in_plane_fraction == 0:
        return _normal_stick_slip(test, memory_length)
    model = friction.AsperityStickSlip(
        memory_length=memory_length, in_plane_fraction=in_plane_fraction, in_plane_phase=in_plane_phase
    )
    return model.ratio(test.contact, _balanced(test), sliding_speed=test.sliding_speed)


def _default_stick_slip(test: FrictionTest) -> Floats:
    """Friction ratio of a test by asperity stick-slip with the package's own memory length. []"""
    return asperity_stick_slip(test, memory_length=friction.EMPIRICAL_MEMORY_LENGTH)


def _stick_slip_with_decay_constant(
    test: FrictionTest | ConditionColumns, memory_length: float, decay_constant: float
) -> Floats:
    """Friction ratio by asperity stick-slip with a decay length of R_q over a fitted constant. []"""
    return friction.sine_stick_slip_ratio(
        decay_length=test.contact.height_scale / decay_constant,
        vibration_amplitude=test.vibration_amplitude,
        frequency=test.frequency,
        sliding_speed=test.sliding_speed,
        memory_length=memory_length,
    )


def mindlin_stick_slip(test: FrictionTest, friction_coefficient_factor: float = 1.0) -> Floats:
    """Friction ratio of a test by asperity stick-slip with the memory length of Mindlin.

    Parameters
    ----------
    test : FrictionTest
    friction_coefficient_factor : float
        Factor of the measured coefficient of friction, of which the memory length is computed.

    Returns
    -------
    ndarray
        Friction under vibration over that at rest.
    """
    length = friction.mindlin_memory_length(
        test.contact,
        friction_coefficient=friction_coefficient_factor * test.friction_coefficient,
        normal_load=test.normal_load,
    )
    return asperity_stick_slip(test, memory_length=float(length))


def _cube(model: type[friction.FrictionModel], test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    """Friction ratio by a model of the cube, given the motion about the gap at rest. []"""
    contact = replace(test.contact, nominal_area=nominal_area_factor * test.contact.nominal_area)
    motion = _harmonic_motion(contact, test.normal_load, test.vibration_amplitude, test.frequency)
    return float(model().ratio(contact, motion, sliding_speed=test.sliding_speed))


def _kinematic(test: FrictionTest | ConditionColumns, amplitude_fraction: float = 1.0) -> Floats:
    """Friction ratio by the direction of the relative velocity, D 3.46 in closed form. []"""
    peak_velocity = amplitude_fraction * 2 * pi * test.frequency * test.vibration_amplitude
    return friction.transverse_vibration_ratio(sliding_speed=test.sliding_speed, vibration_velocity=peak_velocity)


def _bristle_with_holder(
    test: FrictionTest, holder_compliance: float = 0.0, in_plane_fraction: float = 0.0, in_plane_phase: float = 0.0
) -> Floats:
    """Friction ratio by a bristle of Mindlin's stiffness on a rigid or compliant holder. []"""
    holder = friction.Holder(holder_stiffness=1 / holder_compliance) if holder_compliance > 0 else friction.Holder()
    model = friction.BristleWithHolder(
        **asdict(holder), in_plane_fraction=in_plane_fraction, in_plane_phase=in_plane_phase
    )
    return model.ratio(
        test.contact, _balanced(test), sliding_speed=test.sliding_speed, friction_coefficient=test.friction_coefficient
    )


@cache
def _harmonic_motion(contact: RoughContact, load: float, amplitude: float, frequency: float) -> ContactMotion:
    """Harmonic gap motion about the gap at rest."""
    return sinusoidal_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)


def _balanced(test: FrictionTest) -> ContactMotion:
    """Harmonic gap motion of a test about the load-balanced mean gap."""
    return balanced_motion(test.contact, test.normal_load, test.vibration_amplitude, test.frequency)


FRICTION_MODEL_VARIANTS: Final = read_variants(
    Path(__file__).with_suffix(".toml"),
    cube=_cube,
    kinematic=_kinematic,
    mindlin_stick_slip=mindlin_stick_slip,
    default_stick_slip=_default_stick_slip,
    normal_stick_slip=_normal_stick_slip,
    stick_slip_with_decay_constant=_stick_slip_with_decay_constant,
    asperity_stick_slip=asperity_stick_slip,
    bristle_with_holder=_bristle_with_holder,
)
"""Variants of the friction models of `sonolube.models.friction.models`."""
