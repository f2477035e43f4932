"""Published friction tests under vibration as records: conditions, measured friction ratio and its uncertainty."""

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import hypot
from pathlib import Path
from typing import Any, Final, Protocol

from sonolube.facts.published import PublishedValue, published_number, published_value, si_value
from sonolube.models.contact import RoughContact
from sonolube.validation.contacts import (
    printed_rms_height,
    roughness_spread,
    steel_on_steel_contact,
    uncoated_plate_contact,
    wear_contact,
)

NORMAL_VIBRATION_SETS: Final = {
    "A": "steel on aluminium, three speeds (Table 2.3)",
    "B": "example test of the power map, five voltages (Table 4.2)",
    "C": "steel on titanium (section 2.5.2)",
    "D": "titanium on titanium, two amplitudes (section 2.5.3)",
    "E": "ceramic on M50 (section 2.5.4)",
    "F": "M50 on M50 (section 2.5.5)",
    "G": "welder rig, round and flat tip (section 2.4)",
    "H": "flextensional actuator, slow and fast (section 2.2)",
}
"""Sets of tests of D with vibration along the normal. Section 2.5 repeats set A for steel on aluminium."""

IN_PLANE_VIBRATION_SETS: Final = {"L": "along the sliding, earlier studies (sections 1.3.1 and 2.2.5)"}
"""Sets of tests of other authors with vibration in the plane of contact, as quoted by D."""

FLEXTENSIONAL: Final = "H"
"""Letter of the set of the flextensional actuator, whose gain at resonance is not printed."""

FLEXTENSIONAL_GAINS: Final = (1.0, 20.0)
"""Limits of that gain: none, and one beyond the strength of the ceramic at the printed voltage. []"""

_STEEL_COEFFICIENT: Final = 0.26  # of steel on steel in D 3.1.4; for set H it is only drawn
_FLEXTENSIONAL_AREA: Final = 50e-6  # flats of the actuator, 10.5 mm by about 5 mm


class Conditions(Protocol):
    """Operating conditions of a test or a rig, as far as a model requires them."""

    def __hash__(self) -> int:
        """Hash by value, so that each prediction is computed once."""

    @property
    def label(self) -> str:
        """Set and number in the set."""

    @property
    def set_name(self) -> str:
        """Letter of the set."""


class MeasuredConditions(Conditions, Protocol):
    """Conditions under which friction was measured."""

    @property
    def friction_ratio(self) -> float:
        """Friction with vibration over friction without. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionTest:
    """Measured friction ratio under vibration along the normal, with its conditions.

    Parameters
    ----------
    label : str
        Set and number in the set, such as "A-1".
    contact : RoughContact
        Contact for the models. The roughness is printed for set B; elsewhere it is that of Table 3.2.
    roughness_spread : float
        Standard deviation of ln R_q that the provenance of the roughness justifies, see `roughness_inputs`. []
    sliding_speed : float
        Sliding speed during vibration. [m/s]
    vibration_amplitude : float
        Amplitude of the vibration along the surface normal. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Coefficient of friction without vibration. []
    friction_ratio : float
        Friction with vibration over friction without. []
    uncertainty : float or None
        Uncertainty of the ratio from the stated scatter of the forces; None where none is stated.
    published : PublishedValue or None
        Published friction reduction; None where it is in words.
    """

    label: str
    contact: RoughContact
    roughness_spread: float
    sliding_speed: float
    vibration_amplitude: float
    frequency: float
    normal_load: float
    friction_coefficient: float
    friction_ratio: float
    uncertainty: float | None
    published: PublishedValue | None

    @property
    def set_name(self) -> str:
        """Letter of the set."""
        return self.label[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class InPlaneTest:
    """Measured friction ratio under vibration in the plane of contact, with its conditions.

    Parameters
    ----------
    label : str
        Set and number in the set, such as "L-1".
    study : str
        Authors of the test.
    sliding_speed : float
        Sliding speed during vibration. [m/s]
    vibration_velocity : float
        Peak velocity of the vibration in the plane. [m/s]
    vibration_direction : float
        Angle between vibration and sliding. [rad]
    friction_ratio : float
        Friction with vibration over friction without. []
    """

    label: str
    study: str
    sliding_speed: float
    vibration_velocity: float
    vibration_direction: float
    friction_ratio: float

    @property
    def set_name(self) -> str:
        """Letter of the set."""
        return self.label[0]


Tests = tuple[MeasuredConditions, ...]
"""Tests of one kind or another, in a sequence that can be cached."""


def friction_tests(sets: str = "".join(NORMAL_VIBRATION_SETS)) -> tuple[FrictionTest, ...]:
    """Tests with vibration along the normal in order, A-1 to H-2."""
    return tuple(test for test in _normal_vibration_tests() if test.set_name in sets)


def with_printed_roughness(tests: Iterable[FrictionTest]) -> tuple[FrictionTest, ...]:
    """Tests with R_q as printed for the worn surface wherever it is printed: in sets B, C and G.

    The other tests are unchanged.

    Where the kind of a roughness is not named it is read as R_a. That of the counterface is not printed.
    """
    return tuple(_with_rms_height(test, printed_rms_height(test.label)) for test in tests)


@cache
def in_plane_tests() -> tuple[InPlaneTest, ...]:
    """Tests with vibration in the plane of contact.

    That of Littmann et al. is at the sliding speed at which the reduction vanishes; the speed of their largest
    reduction is not printed.
    """
    littmann = si_value("1.3.1-littmann-vibration-velocity")
    return (
        InPlaneTest(
            label="L-1",
            study="Littmann et al.",
            sliding_speed=si_value("2.2.5-littmann-ratio") * littmann,
            vibration_velocity=littmann,
            vibration_direction=0.0,
            friction_ratio=1.0,
        ),
        InPlaneTest(
            label="L-2",
            study="Gutowski and Leus",
            sliding_speed=si_value("1.3.1-gutowski-sliding-speed"),
            vibration_velocity=si_value("1.3.1-gutowski-vibration-velocity"),
            vibration_direction=0.0,
            friction_ratio=1 - si_value("1.3.1-gutowski-reduction"),
        ),
    )


@cache
def _normal_vibration_tests() -> tuple[FrictionTest, ...]:
    """All tests with vibration along the normal."""
    content = tomllib.loads(Path(__file__).with_name("published_tests.toml").read_text(encoding="utf-8"))
    tests = [_test(rig | test) for rig in content["rig"] for test in rig["tests"]]
    return (*sorted(tests, key=lambda test: test.label), *_flextensional())


def _test(ids: Mapping[str, Any]) -> FrictionTest:
    """Test from the ids of its published numbers."""
    load = si_value(ids["normal_load"])
    ratio, uncertainty = _measured_ratio(ids)
    return FrictionTest(
        label=ids["label"],
        contact=_contact(ids),
        roughness_spread=roughness_spread(ids["label"]),
        **{name: si_value(ids[name]) for name in ("sliding_speed", "vibration_amplitude", "frequency")},
        normal_load=load,
        friction_coefficient=si_value(ids["off"]) / load if "off" in ids else ids["friction_coefficient"],
        friction_ratio=ratio,
        uncertainty=uncertainty,
        published=published_value(ids["published"]),
    )


def _contact(ids: Mapping[str, Any]) -> RoughContact:
    """Contact of a test."""
    if ids["contact"] == "steel":
        return steel_on_steel_contact(nominal_area=si_value(ids["nominal_area"]))
    return uncoated_plate_contact() if ids["contact"] == "plate" else wear_contact()


def _measured_ratio(ids: Mapping[str, Any]) -> tuple[float, float | None]:
    """Friction ratio of a test, and its uncertainty from the scatter of forces, taken as independent. []"""
    if "on" not in ids:
        return 1 - si_value(ids["published"]), None
    off, on = published_number(ids["off"]), published_number(ids["on"])
    if "ranges" in ids:
        low, high = on.low / off.low, on.high / off.high
        return (low + high) / 2, abs(high - low) / 2
    ratio = on.value / off.value
    return ratio, ratio * hypot(*((force.high - force.low) / 2 / force.value for force in (off, on)))


def _flextensional() -> list[FrictionTest]:
    """Set H; the amplitude is half the quasi-static stroke at the drive voltage, without gain at resonance."""
    stroke = si_value("2.2.2-stroke") / si_value("2.2.2-voltage") * si_value("2.2.5-voltage-peak-to-peak")
    slow = FrictionTest(
        label="H-1",
        contact=steel_on_steel_contact(nominal_area=_FLEXTENSIONAL_AREA),
        roughness_spread=roughness_spread("H-1"),
        sliding_speed=si_value("2.2.4-sliding-speed-3.5"),
        vibration_amplitude=stroke / 2,
        frequency=si_value("2.2.2-resonance"),
        normal_load=si_value("2.2.4-normal-load"),
        friction_coefficient=_STEEL_COEFFICIENT,
        friction_ratio=1 - si_value("2.2.4-reduction"),
        uncertainty=None,
        published=published_value("2.2.4-reduction"),
    )
    fast = si_value("2.2.5-speed-of-no-reduction")
    return [slow, replace(slow, label="H-2", sliding_speed=fast, friction_ratio=1.0, published=None)]


def _with_rms_height(test: FrictionTest, rms_height: float | None) -> FrictionTest:
    """Test with another R_q; unchanged where there is none."""
    if rms_height is None:
        return test
    roughness = replace(test.contact.roughness, rms_height=rms_height)
    return replace(test, contact=replace(test.contact, roughness=roughness))
