"""Variants of the friction models of this program: with default, fitted and rig-specific parameters."""

from dataclasses import asdict, replace
from functools import cache
from math import pi
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
from sonolube.validation.model_variant import (
    AMPLITUDE_FRACTION,
    DECAY_CONSTANT,
    FITTED_RIGS,
    FRICTION_COEFFICIENT_FACTOR,
    HOLDER_COMPLIANCE,
    IN_PLANE_MOTION,
    MEMORY_LENGTH,
    NOMINAL_AREA_FACTOR,
    NORMAL_VIBRATION,
    SINUSOIDAL_VIBRATION,
    ConditionColumns,
    ModelVariant,
    SeenSets,
    per_rig,
)
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
    """Friction ratio of a test by asperity stick-slip about the load-balanced mean gap. []"""
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
    """Friction ratio of a test by asperity stick-slip with the memory length of Mindlin. []"""
    length = friction.mindlin_memory_length(
        test.contact,
        friction_coefficient=friction_coefficient_factor * test.friction_coefficient,
        normal_load=test.normal_load,
    )
    return asperity_stick_slip(test, memory_length=float(length))


def _full_period(test: FrictionTest) -> float:
    """Friction ratio by the cube over the full period, D 3.46 to 3.48. []"""
    return float(friction.Dong2015FullPeriod().ratio(test.contact, _unbalanced(test), sliding_speed=test.sliding_speed))


def _half_period(test: FrictionTest) -> float:
    """Friction ratio by the cube over the separating half period, D 3.15. []"""
    return float(friction.Dong2015HalfPeriod().ratio(test.contact, _unbalanced(test), sliding_speed=test.sliding_speed))


def _load_balanced(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    """Friction ratio by the cube over the full period about the load-balanced mean gap. []"""
    contact = replace(test.contact, nominal_area=nominal_area_factor * test.contact.nominal_area)
    motion = _harmonic_motion(contact, test.normal_load, test.vibration_amplitude, test.frequency)
    return float(friction.Dong2015LoadBalanced().ratio(contact, motion, sliding_speed=test.sliding_speed))


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


def _unbalanced(test: FrictionTest) -> ContactMotion:
    """Harmonic gap motion of a test about the gap at rest."""
    return _harmonic_motion(test.contact, test.normal_load, test.vibration_amplitude, test.frequency)


def _balanced(test: FrictionTest) -> ContactMotion:
    """Harmonic gap motion of a test about the load-balanced mean gap."""
    return balanced_motion(test.contact, test.normal_load, test.vibration_amplitude, test.frequency)


_MEAN_GAP_CORRECTED: Final = "D 3.46 to 3.48, mean gap corrected"
_KINEMATIC_SOURCE: Final = "D 3.46; Kumar and Hutchings 2004, across"
_IN_PLANE_POWER_MAP: Final = per_rig(IN_PLANE_MOTION, "power map")
_FITTED_STICK_SLIP: Final = ModelVariant(
    "asperity-stick-slip-fitted",
    "asperity stick-slip, memory length fitted",
    _normal_stick_slip,
    (MEMORY_LENGTH,),
    takes_columns=True,
)

FRICTION_MODEL_VARIANTS: Final = (
    ModelVariant(
        "dong-2015-full-period",
        "D 3.46 to 3.48: k_t(t) cos(theta) over the whole period about an unchanged mean gap",
        _full_period,
        required_inputs=NORMAL_VIBRATION,
        source="D 3.46 to 3.48",
        friction_model=friction.Dong2015FullPeriod,
    ),
    ModelVariant(
        "dong-2015-half-period",
        "D 3.15: k_t(t) over the separating half period",
        _half_period,
        required_inputs=NORMAL_VIBRATION,
        source="D 3.15",
        friction_model=friction.Dong2015HalfPeriod,
    ),
    ModelVariant(
        "dong-2015-load-balanced",
        "D 3.46 to 3.48 about the mean gap that balances the load",
        _load_balanced,
        required_inputs=NORMAL_VIBRATION,
        source=_MEAN_GAP_CORRECTED,
        friction_model=friction.Dong2015LoadBalanced,
    ),
    ModelVariant(
        "dong-2015-load-balanced-per-rig",
        "the same with a factor on nominal area times yield strength for each rig",
        _load_balanced,
        per_rig((NOMINAL_AREA_FACTOR,), *FITTED_RIGS),
        required_inputs=NORMAL_VIBRATION,
        source=_MEAN_GAP_CORRECTED,
        friction_model=friction.Dong2015LoadBalanced,
    ),
    ModelVariant(
        "kinematic",
        "cos(theta) alone",
        _kinematic,
        required_inputs=SINUSOIDAL_VIBRATION,
        source=_KINEMATIC_SOURCE,
        takes_columns=True,
    ),
    ModelVariant(
        "kinematic-fitted",
        "cos(theta) alone with a fraction of the amplitude",
        _kinematic,
        (AMPLITUDE_FRACTION,),
        required_inputs=SINUSOIDAL_VIBRATION,
        source=_KINEMATIC_SOURCE,
        takes_columns=True,
    ),
    ModelVariant("asperity-stick-slip-mindlin", "asperity stick-slip, memory length after Mindlin", mindlin_stick_slip),
    ModelVariant(
        "asperity-stick-slip-mindlin-per-rig",
        "the same with a factor on the friction coefficient for each rig",
        mindlin_stick_slip,
        per_rig((FRICTION_COEFFICIENT_FACTOR,), *FITTED_RIGS),
    ),
    ModelVariant(
        "asperity-stick-slip",
        "asperity stick-slip with the default memory length of 1.5 um, which has seen all sets but B",
        _default_stick_slip,
        seen=SeenSets("ACDEFG", _FITTED_STICK_SLIP),
    ),
    _FITTED_STICK_SLIP,
    ModelVariant(
        "asperity-stick-slip-decay-constant",
        "asperity stick-slip, memory length and decay constant of the heights fitted",
        _stick_slip_with_decay_constant,
        (MEMORY_LENGTH, DECAY_CONSTANT),
        takes_columns=True,
    ),
    ModelVariant(
        "asperity-stick-slip-in-plane",
        "asperity stick-slip, with in-plane motion on the rig of Table 4.2",
        asperity_stick_slip,
        (MEMORY_LENGTH, *_IN_PLANE_POWER_MAP),
    ),
    ModelVariant(
        "asperity-stick-slip-in-plane-pins",
        "asperity stick-slip, with in-plane motion of either piezo-driven pin",
        asperity_stick_slip,
        (MEMORY_LENGTH, *per_rig(IN_PLANE_MOTION, "tribometer", "power map")),
    ),
    ModelVariant(
        "asperity-stick-slip-in-plane-per-rig",
        "asperity stick-slip, with in-plane motion on every rig",
        asperity_stick_slip,
        (MEMORY_LENGTH, *per_rig(IN_PLANE_MOTION, *FITTED_RIGS)),
    ),
    ModelVariant(
        "bristle-with-holder", "one bristle with the stiffness of Mindlin on a rigid holder", _bristle_with_holder
    ),
    ModelVariant(
        "bristle-with-holder-per-rig",
        "one bristle, with the compliance of each holder",
        _bristle_with_holder,
        per_rig((HOLDER_COMPLIANCE,), *FITTED_RIGS),
    ),
    ModelVariant(
        "bristle-with-holder-in-plane",
        "one bristle, with the compliance of each holder and in-plane motion on the rig of Table 4.2",
        _bristle_with_holder,
        (*per_rig((HOLDER_COMPLIANCE,), *FITTED_RIGS), *_IN_PLANE_POWER_MAP),
    ),
)
"""Variants of the friction models of `sonolube.models.friction.models`."""
