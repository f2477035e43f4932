"""The closures as they are set against experiment: what each leaves free, and its predictions."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cache, lru_cache
from typing import Final

from sonolube.contact import (
    GapMotion,
    RoughContact,
    decay_length,
    load_balanced_motion,
    separation,
    sinusoidal_motion,
)
from sonolube.errors import OutsideRange
from sonolube.friction import (
    AsperityStickSlip,
    BristleWithHolder,
    Dong2015FullPeriod,
    Dong2015HalfPeriod,
    Dong2015LoadBalanced,
    Holder,
    Kinematic,
    mindlin_memory_length,
    sine_stick_slip_ratio,
)
from sonolube.validation.friction_tests import Circumstances, FrictionTest
from sonolube.validation.parameters import (
    AREA,
    COEFFICIENT,
    COMPLIANCE,
    FITTED_RIGS,
    IN_PLANE,
    MEMORY,
    SHARE,
    Parameter,
    of_rigs,
)


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
        Gives the friction ratio of a test for values of these parameters, by name.
    """

    name: str
    meaning: str
    parameters: tuple[Parameter, ...]
    ratio: Callable[..., float]

    def predict(self, test: Circumstances, *values: float) -> float | None:
        """Return the friction ratio of a test; None where the model does not reach, as where the gap would close. []"""
        answer = _remembered(self.ratio, test, self._told(test, values))
        return None if isinstance(answer, str) else answer

    def refusal(self, test: Circumstances, *values: float) -> str | None:
        """Return why the model does not reach a test; None where it does."""
        answer = _remembered(self.ratio, test, self._told(test, values))
        return answer if isinstance(answer, str) else None

    def _told(self, test: Circumstances, values: tuple[float, ...]) -> tuple[tuple[str, float], ...]:
        return tuple(
            (parameter.name, value)
            for parameter, value in zip(self.parameters, values, strict=True)
            if parameter.matters_to(test.set_name)
        )


@lru_cache(maxsize=2**16)
def _remembered(ratio: Callable[..., float], test: Circumstances, values: tuple[tuple[str, float], ...]) -> float | str:
    try:
        return float(ratio(test, **dict(values)))
    except OutsideRange as reason:
        return str(reason)


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
    motion = sinusoidal_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)
    return contact, motion


@cache
def _balanced(contact: RoughContact, motion: GapMotion) -> GapMotion:
    return load_balanced_motion(contact, motion)


def _as_published(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(Dong2015FullPeriod().ratio(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _separating(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(Dong2015HalfPeriod().ratio(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _load_balanced(test: FrictionTest, nominal_area_factor: float = 1.0) -> float:
    return float(Dong2015LoadBalanced().ratio(*_sine(test, nominal_area_factor), sliding_speed=test.sliding_speed))


def _kinematic(test: FrictionTest, amplitude_fraction: float = 1.0) -> float:
    return float(Kinematic(amplitude_fraction=amplitude_fraction).ratio(*_sine(test), sliding_speed=test.sliding_speed))


def _stick_slip(test: FrictionTest, memory_length: float) -> float:
    at_rest = separation(test.contact, normal_load=test.normal_load)
    return float(
        sine_stick_slip_ratio(
            decay_length=decay_length(test.contact, separation=at_rest),
            vibration_amplitude=test.vibration_amplitude,
            frequency=test.frequency,
            sliding_speed=test.sliding_speed,
            memory_length=memory_length,
        )
    )


def stick_slip_in_plane(
    test: FrictionTest, *, memory_length: float, in_plane_fraction: float = 0.0, phase: float = 0.0
) -> float:
    """Return the ratio of a test by stick-slip about a balanced mean. []

    Parameters
    ----------
    test : FrictionTest
    memory_length : float
        Sliding distance over which an asperity forgets. [m]
    in_plane_fraction : float
        Motion along the sliding direction over that along the normal. []
    phase : float
        Lag of the in-plane motion behind the normal one. [rad]
    """
    if in_plane_fraction == 0:
        return _stick_slip(test, memory_length)
    contact, motion = _sine(test)
    return float(
        AsperityStickSlip(memory_length=memory_length, in_plane_fraction=in_plane_fraction, in_plane_phase=phase).ratio(
            contact, _balanced(contact, motion), sliding_speed=test.sliding_speed
        )
    )


def mindlin_stick_slip(test: FrictionTest, friction_coefficient_factor: float = 1.0) -> float:
    """Return the ratio of a test by stick-slip with Mindlin's memory length. []"""
    length = mindlin_memory_length(
        test.contact,
        friction_coefficient=friction_coefficient_factor * test.friction_coefficient,
        normal_load=test.normal_load,
    )
    return _stick_slip(test, float(length))


def _coupled(
    test: FrictionTest, holder_compliance: float = 0.0, in_plane_fraction: float = 0.0, phase: float = 0.0
) -> float:
    contact, motion = _sine(test)
    return float(
        BristleWithHolder(
            **asdict(Holder(holder_stiffness=1 / holder_compliance) if holder_compliance > 0 else Holder()),
            in_plane_fraction=in_plane_fraction,
            in_plane_phase=phase,
        ).ratio(
            contact,
            _balanced(contact, motion),
            sliding_speed=test.sliding_speed,
            friction_coefficient=test.friction_coefficient,
        )
    )


_IN_PLANE_OF_MAP: Final = of_rigs(IN_PLANE, "power map")
_IN_PLANE_OF_PINS: Final = of_rigs(IN_PLANE, "tribometer", "power map")

VARIANTS: Final = tuple(
    ClosureVariant(name=name, meaning=meaning, parameters=parameters, ratio=ratio)
    for name, meaning, parameters, ratio in (
        (
            "as-published",
            "D 3.46 to 3.48: k_t(t) cos(theta) over the whole period about an unmoved mean",
            (),
            _as_published,
        ),
        ("separating-half-period", "D 3.15: k_t(t) over the separating half period", (), _separating),
        ("load-balanced", "as published, about the mean that balances the load", (), _load_balanced),
        (
            "load-balanced-per-rig",
            "the same with each rig's own factor on the nominal area times yield strength",
            of_rigs((AREA,), *FITTED_RIGS),
            _load_balanced,
        ),
        ("kinematic", "cos(theta) alone", (), _kinematic),
        ("kinematic-fitted", "cos(theta) alone with a share of the amplitude", (SHARE,), _kinematic),
        ("stick-slip-mindlin", "stick-slip, memory length after Mindlin", (), mindlin_stick_slip),
        (
            "stick-slip-mindlin-per-rig",
            "the same with each rig's own factor on the friction coefficient",
            of_rigs((COEFFICIENT,), *FITTED_RIGS),
            mindlin_stick_slip,
        ),
        ("stick-slip", "stick-slip, memory length fitted", (MEMORY,), _stick_slip),
        (
            "stick-slip-in-plane",
            "stick-slip, with in-plane motion on the rig of Table 4.2",
            (MEMORY, *_IN_PLANE_OF_MAP),
            stick_slip_in_plane,
        ),
        (
            "stick-slip-in-plane-pins",
            "stick-slip, with in-plane motion of either piezo-driven pin",
            (MEMORY, *_IN_PLANE_OF_PINS),
            stick_slip_in_plane,
        ),
        (
            "stick-slip-in-plane-per-rig",
            "stick-slip, with in-plane motion on every rig",
            (MEMORY, *of_rigs(IN_PLANE, *FITTED_RIGS)),
            stick_slip_in_plane,
        ),
        ("coupled", "one bristle with Mindlin's stiffness", (), _coupled),
        ("coupled-per-rig", "one bristle, each holder's compliance", of_rigs((COMPLIANCE,), *FITTED_RIGS), _coupled),
        (
            "coupled-in-plane",
            "one bristle, each holder's compliance, with in-plane motion on the rig of Table 4.2",
            (*of_rigs((COMPLIANCE,), *FITTED_RIGS), *_IN_PLANE_OF_MAP),
            _coupled,
        ),
    )
)
"""Every closure that is compared."""
