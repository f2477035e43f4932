"""The closures as they are set against experiment: what each leaves free, between which bounds, and its predictions."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from typing import Final

from sonolube.contact import (
    GapMotion,
    RoughContact,
    decay_length,
    harmonic_motion,
    load_balanced_motion,
    separation,
)
from sonolube.errors import OutsideRange
from sonolube.friction import (
    Holder,
    as_published,
    coupled,
    kinematic,
    load_balanced,
    mindlin_memory_length,
    separating_half_period,
    stick_slip,
    stick_slip_ratio,
)
from sonolube.reproduce.experiments import FrictionTest

IN_PLANE_SET: Final = "B"
"""The one set whose rig is allowed parasitic in-plane motion."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Parameter:
    """A parameter that a fit may choose.

    Parameters
    ----------
    name : str
        Its name, a word of the vocabulary where it is a quantity.
    unit : str
        Unit for the report.
    start : tuple of float
        Values from which the fit sets out, SI.
    low, high : float
        The physical bounds, SI.
    matters_in : str
        Letters of the sets that can tell it; empty for all.
    """

    name: str
    unit: str
    start: tuple[float, ...]
    low: float
    high: float
    matters_in: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class ClosureVariant:
    """One closure with what it leaves free.

    Parameters
    ----------
    name : str
        Its name in rows and figures.
    meaning : str
        What it says, in words.
    parameters : tuple of Parameter
        What a fit may choose; empty where nothing is fitted.
    ratio : callable
        Gives the friction ratio of a test for values of these parameters.
    """

    name: str
    meaning: str
    parameters: tuple[Parameter, ...]
    ratio: Callable[..., float]

    def predict(self, test: FrictionTest, *values: float) -> float | None:
        """Return the friction ratio of a test; None where the model does not reach, as where the gap would close. []"""
        try:
            return float(self.ratio(test, *values))
        except OutsideRange:
            return None


def _sine(test: FrictionTest, nominal_area_factor: float = 1.0) -> tuple[RoughContact, GapMotion]:
    return _cached_sine(
        replace(test.contact, nominal_area=nominal_area_factor * test.contact.nominal_area),
        test.normal_load,
        test.vibration_amplitude,
        test.frequency,
    )


@cache
def _cached_sine(
    contact: RoughContact, load: float, amplitude: float, frequency: float
) -> tuple[RoughContact, GapMotion]:
    motion = harmonic_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)
    return contact, motion


@cache
def _balanced(contact: RoughContact, motion: GapMotion) -> GapMotion:
    return load_balanced_motion(contact, motion)


def _as_published(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(as_published(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _separating(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(separating_half_period(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _load_balanced(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(load_balanced(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _kinematic(test: FrictionTest, amplitude_share: float = 1.0) -> float:
    return float(kinematic(*_sine(test), sliding_speed=test.sliding_speed, amplitude_share=amplitude_share))


def _stick_slip(test: FrictionTest, memory_length: float) -> float:
    at_rest = separation(test.contact, normal_load=test.normal_load)
    return float(
        stick_slip_ratio(
            decay_length=decay_length(test.contact, separation=at_rest),
            vibration_amplitude=test.vibration_amplitude,
            frequency=test.frequency,
            sliding_speed=test.sliding_speed,
            memory_length=memory_length,
        )
    )


def _mindlin(test: FrictionTest) -> float:
    length = mindlin_memory_length(
        test.contact, friction_coefficient=test.friction_coefficient, normal_load=test.normal_load
    )
    return _stick_slip(test, float(length))


def _stick_slip_in_plane(test: FrictionTest, memory_length: float, in_plane_fraction: float, phase: float) -> float:
    if test.set_name != IN_PLANE_SET:
        return _stick_slip(test, memory_length)
    contact, motion = _sine(test)
    return float(
        stick_slip(
            contact,
            _balanced(contact, motion),
            sliding_speed=test.sliding_speed,
            memory_length=memory_length,
            in_plane_fraction=in_plane_fraction,
            phase=phase,
        )
    )


def _coupled(test: FrictionTest, holder_compliance: float = 0.0) -> float:
    return _coupled_in_plane(test, holder_compliance, 0.0, 0.0)


def _coupled_in_plane(test: FrictionTest, holder_compliance: float, in_plane_fraction: float, phase: float) -> float:
    contact, motion = _sine(test)
    parasitic = test.set_name == IN_PLANE_SET
    return float(
        coupled(
            contact,
            _balanced(contact, motion),
            sliding_speed=test.sliding_speed,
            friction_coefficient=test.friction_coefficient,
            holder=Holder(holder_stiffness=1 / holder_compliance) if holder_compliance > 0 else Holder(),
            in_plane_fraction=in_plane_fraction if parasitic else 0.0,
            phase=phase,
        )
    )


# An and Y0 only move the gap at rest, and one factor stands for both
_AREA: Final = Parameter(name="nominal_area_factor", unit="", start=(0.5, 2.0), low=0.1, high=10.0)
_SHARE: Final = Parameter(name="amplitude_share", unit="", start=(0.3,), low=0.05, high=1.0)
_MEMORY: Final = Parameter(name="memory_length", unit="m", start=(1.5e-6,), low=0.1e-6, high=10e-6)
# a steel pin some centimetres long bends by no more than this at its tip
_COMPLIANCE: Final = Parameter(name="holder_compliance", unit="m/N", start=(1e-7, 5e-7), low=1e-9, high=2e-6)
_FRACTION: Final = Parameter(
    name="in_plane_fraction", unit="", start=(0.15, 0.4), low=0.0, high=1.0, matters_in=IN_PLANE_SET
)
_PHASE: Final = Parameter(
    name="phase", unit="rad", start=(0.0, pi / 2, pi, 3 * pi / 2), low=-pi, high=3 * pi, matters_in=IN_PLANE_SET
)

VARIANTS: Final = (
    ClosureVariant(
        name="as-published",
        meaning="D 3.46 to 3.48: k_t(t) cos(theta) over the whole period about an unmoved mean",
        parameters=(),
        ratio=_as_published,
    ),
    ClosureVariant(
        name="separating-half-period",
        meaning="D 3.15: k_t(t) over the separating half period",
        parameters=(),
        ratio=_separating,
    ),
    ClosureVariant(
        name="load-balanced",
        meaning="as published, about the mean that balances the load",
        parameters=(),
        ratio=_load_balanced,
    ),
    ClosureVariant(
        name="load-balanced-fitted",
        meaning="the same with a factor on the nominal area (or yield strength)",
        parameters=(_AREA,),
        ratio=_load_balanced,
    ),
    ClosureVariant(name="kinematic", meaning="cos(theta) alone", parameters=(), ratio=_kinematic),
    ClosureVariant(
        name="kinematic-fitted",
        meaning="cos(theta) alone with a share of the amplitude",
        parameters=(_SHARE,),
        ratio=_kinematic,
    ),
    ClosureVariant(
        name="stick-slip-mindlin", meaning="stick-slip, memory length after Mindlin", parameters=(), ratio=_mindlin
    ),
    ClosureVariant(
        name="stick-slip", meaning="stick-slip, memory length fitted", parameters=(_MEMORY,), ratio=_stick_slip
    ),
    ClosureVariant(
        name="stick-slip-in-plane",
        meaning="stick-slip, with in-plane motion on the rig of Table 4.2",
        parameters=(_MEMORY, _FRACTION, _PHASE),
        ratio=_stick_slip_in_plane,
    ),
    ClosureVariant(name="coupled", meaning="one bristle with Mindlin's stiffness", parameters=(), ratio=_coupled),
    ClosureVariant(
        name="coupled-compliant",
        meaning="one bristle, holder's compliance fitted",
        parameters=(_COMPLIANCE,),
        ratio=_coupled,
    ),
    ClosureVariant(
        name="coupled-in-plane",
        meaning="one bristle, compliance fitted, with in-plane motion on the rig of Table 4.2",
        parameters=(_COMPLIANCE, _FRACTION, _PHASE),
        ratio=_coupled_in_plane,
    ),
)
"""Every closure that is compared."""
