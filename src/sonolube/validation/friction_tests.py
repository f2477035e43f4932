"""Measured friction under vibration, each test with all that a closure needs to predict it."""

from dataclasses import dataclass, replace
from functools import cache
from math import hypot
from typing import Final, Protocol

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import RoughContact
from sonolube.published import PrintedNumber
from sonolube.published.values import Published, cell, stated
from sonolube.validation.contacts import steel_on_steel_contact, wear_contact
from sonolube.validation.inputs import exact, in_table, range_ends, said

SETS: Final = {
    "A": "steel on aluminium, three speeds (Table 2.3)",
    "B": "example test of the power map, five voltages (Table 4.2)",
    "C": "steel on titanium (section 2.5.2)",
    "D": "titanium on titanium, two amplitudes (section 2.5.3)",
    "E": "ceramic on M50 (section 2.5.4)",
    "F": "M50 on M50 (section 2.5.5)",
    "G": "welder rig, round and flat tip (section 2.4)",
    "H": "flextensional actuator, slow and fast (section 2.2)",
}
"""What each set of tests is. Section 2.5's steel on aluminium is set A again."""

_UNPRINTED_COEFFICIENT: Final = 0.26  # of steel on steel in D 3.1.4, where set H only has it drawn
_TITANIUM_COEFFICIENT: Final = 0.4  # forces of titanium on titanium are only drawn; near steel on titanium's 0.44
_FLEXTENSIONAL_AREA: Final = 50e-6  # the actuator's flats, 10.5 mm by about 5 mm


class Circumstances(Protocol):
    """What a model is asked about: as much of a test, or of a rig, as the model needs."""

    def __hash__(self) -> int:
        """Circumstances are compared by value, so that no prediction is computed twice."""

    @property
    def label(self) -> str:
        """Its set and its number in the set."""

    @property
    def set_name(self) -> str:
        """Letter of its set."""


class Measured(Circumstances, Protocol):
    """Circumstances under which friction was measured."""

    @property
    def friction_ratio(self) -> float:
        """Friction with vibration over friction without. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionTest:
    """One measured friction ratio and its circumstances.

    Parameters
    ----------
    label : str
        Its set and its number in the set, such as "A-1".
    contact : RoughContact
        The contact as the models see it; roughness is that of Table 3.2 in every set.
    sliding_speed : float
        Sliding speed while the surfaces vibrate. [m/s]
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
        Of the ratio, from the printed scatter; a pure number. None where none is printed.
    published : Published or None
        The printed reduction; None where it is words.
    """

    label: str
    contact: RoughContact
    sliding_speed: float
    vibration_amplitude: float
    frequency: float
    normal_load: float
    friction_coefficient: float
    friction_ratio: float
    uncertainty: float | None
    published: Published | None

    @property
    def set_name(self) -> str:
        """Letter of its set."""
        return self.label[0]


@cache
def friction_tests() -> tuple[FrictionTest, ...]:
    """Return every test, A-1 to H-2, in order."""
    return (
        *_tribometer(),
        *_power_map(),
        *_pairs(),
        *_welder(),
        *_flextensional(),
    )


def measured_ratios(tests: tuple[FrictionTest, ...]) -> Floats:
    """Return the measured friction ratios of tests. []"""
    return np.array([test.friction_ratio for test in tests])


def _tribometer() -> list[FrictionTest]:
    """Return set A. The speed's column of Table 2.3 has each speed twice, without and with vibration."""
    return [
        _on_tribometer(
            f"A-{row + 1}",
            in_table("2.3", "sliding_speed", 2 * row),
            before=in_table("2.3", "friction_force", 2 * row),
            after=in_table("2.3", "friction_force", 2 * row + 1),
            published=cell("2.5", "friction_reduction", row),
        )
        for row in range(3)
    ]


def _power_map() -> list[FrictionTest]:
    """Return set B; the first row of Table 4.2, and rows 9 to 14 of Table 4.1, run over the voltages from none."""
    load, still, area = said("4.1.2-normal-load"), in_table("4.2", "friction_force", 0), in_table("4.1", "nominal_area")
    forces = [in_table("4.2", "friction_force", level) for level in range(1, 6)]
    return [
        FrictionTest(
            label=f"B-{level}",
            contact=steel_on_steel_contact(nominal_area=area.value),
            sliding_speed=said("4.1.2-sliding-speed").value,
            vibration_amplitude=in_table("4.1", "vibration_amplitude", 9 + level).value,
            frequency=in_table("4.1", "frequency").value,
            normal_load=load.value,
            friction_coefficient=still.value / load.value,
            friction_ratio=force.value / still.value,
            uncertainty=_scatter(still, force),
            published=cell("4.2", "friction_reduction", level),
        )
        for level, force in enumerate(forces, start=1)
    ]


def _pairs() -> list[FrictionTest]:
    """Return sets C to F. Of M50 on M50 D prints one force twice: erratum E11; of titanium reductions alone."""
    titanium, tool_steel = in_table("2.11", "sliding_speed"), in_table("2.13", "sliding_speed")
    on_itself = [
        FrictionTest(
            label=f"D-{number}",
            contact=wear_contact(),
            sliding_speed=in_table("2.12", "sliding_speed").value,
            vibration_amplitude=in_table("2.12", f"{size}_amplitude").value,
            frequency=in_table("2.12", "frequency").value,
            normal_load=in_table("2.12", "normal_load").value,
            friction_coefficient=_TITANIUM_COEFFICIENT,
            friction_ratio=1 - said(name).value,
            uncertainty=None,
            published=stated(name),
        )
        for number, (size, name) in enumerate(
            (("larger", "2.5.3-friction-reduction-2.5um"), ("smaller", "2.5.3-friction-reduction-1um")), start=1
        )
    ]
    m50 = _on_tribometer(
        "F-1",
        tool_steel,
        before=said("2.5.5-friction-m50-off"),
        after=said("2.5.5-friction-m50-on"),
        published=stated("2.5.5-friction-reduction"),
        ratio=1 - said("2.5.5-friction-reduction").value,
    )
    return [
        _on_tribometer(
            "C-1",
            titanium,
            before=said("2.5.2-friction-titanium-off"),
            after=said("2.5.2-friction-titanium-on"),
            published=stated("2.5.2-friction-reduction"),
        ),
        *on_itself,
        _on_tribometer(
            "E-1",
            tool_steel,
            before=said("2.5.4-friction-ceramic-off"),
            after=said("2.5.4-friction-ceramic-on"),
            published=stated("2.5.4-friction-reduction"),
        ),
        m50,
    ]


def _welder() -> list[FrictionTest]:
    """Return set G: lower force over lower and upper over upper; the disc runs faster while it vibrates."""
    tests = []
    for tip in (0, 1):
        before, after = (in_table("2.9", f"{state}_friction_force", tip) for state in ("intrinsic", "reduced"))
        low, high = (
            reduced.value / intrinsic.value
            for intrinsic, reduced in zip(range_ends(before), range_ends(after), strict=True)
        )
        vibrating = 2 * tip + 1  # row of Table 2.8
        load = in_table("2.8", "normal_load", vibrating).value
        tests.append(
            FrictionTest(
                label=f"G-{tip + 1}",
                contact=steel_on_steel_contact(nominal_area=in_table("2.8", "nominal_area", vibrating).value),
                sliding_speed=in_table("2.8", "sliding_speed", vibrating).value,
                vibration_amplitude=in_table("2.8", "vibration_amplitude", vibrating).value,
                frequency=in_table("2.8", "frequency", vibrating).value,
                normal_load=load,
                friction_coefficient=before.value / load,
                friction_ratio=(low + high) / 2,
                uncertainty=abs(high - low) / 2,
                published=cell("2.9", "friction_reduction", tip),
            )
        )
    return tests


def _flextensional() -> list[FrictionTest]:
    """Return set H; the stroke is half the printed one per volt, taken without gain at resonance."""
    stroke = said("2.2.2-stroke").value / said("2.2.2-voltage").value * said("2.2.5-voltage-peak-to-peak").value
    slow = FrictionTest(
        label="H-1",
        contact=steel_on_steel_contact(nominal_area=_FLEXTENSIONAL_AREA),
        sliding_speed=said("2.2.4-sliding-speed-3.5").value,
        vibration_amplitude=stroke / 2,
        frequency=said("2.2.2-resonance").value,
        normal_load=said("2.2.4-normal-load").value,
        friction_coefficient=_UNPRINTED_COEFFICIENT,
        friction_ratio=1 - said("2.2.4-reduction").value,
        uncertainty=None,
        published=stated("2.2.4-reduction"),
    )
    fast = said("2.2.5-speed-of-no-reduction").value
    return [slow, replace(slow, label="H-2", sliding_speed=fast, friction_ratio=1.0, published=None)]


def _on_tribometer(
    label: str,
    speed: PrintedNumber,
    *,
    before: PrintedNumber,
    after: PrintedNumber,
    published: Published,
    ratio: float | None = None,
) -> FrictionTest:
    load = exact(in_table("2.2", "normal_load")).value
    return FrictionTest(
        label=label,
        contact=wear_contact(),
        sliding_speed=speed.value,
        vibration_amplitude=said("2.3.1-amplitude").value,
        frequency=said("2.3.1-frequency").value,
        normal_load=load,
        friction_coefficient=before.value / load,
        friction_ratio=after.value / before.value if ratio is None else ratio,
        uncertainty=_scatter(before, after) if ratio is None else None,
        published=published,
    )


def _scatter(before: PrintedNumber, after: PrintedNumber) -> float:
    """Return the printed scatter of two forces as that of their ratio. []"""
    parts = [(number.high - number.low) / 2 / number.value for number in (before, after)]
    return after.value / before.value * hypot(*parts)
