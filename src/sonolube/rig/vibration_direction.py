"""Direction of a vibration against the sliding, with a second component where it has one, and the motion by both."""

from dataclasses import dataclass, replace
from math import cos, degrees, pi, sin
from types import MappingProxyType
from typing import Final, Literal, get_args

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.contact import ContactMotion
from sonolube.models.contact.contact_motion import delayed_oscillation
from sonolube.models.friction.laws.coulomb import ring_directions
from sonolube.text.units import format_si

DirectionWord = Literal["normal", "along", "across", "torsional", "perpendicular", "longitudinal", "transverse"]
"""Words for a direction of vibration."""

SecondWord = Literal["normal", "along", "across", "perpendicular", "longitudinal", "transverse"]
"""Words for the direction of the second component."""

SAME_DIRECTION: Final = MappingProxyType({"perpendicular": "normal", "longitudinal": "along", "transverse": "across"})
"""Words of the literature for directions, each with the one that stands for it."""

_TEXTS: Final = {
    "normal": "along the normal of the contact",
    "along": "along the sliding",
    "across": "across the sliding, within the plane",
    "torsional": "about the normal of the contact",
    "oblique": "within the plane",
}
_RING: Final = 12  # directions of a turning ring: an error of 4e-7
_SMALL_TURN: Final = 0.1  # rad, up to which the places of a ring keep their direction
_NOTHING: Final = 1e-14  # relative, of a component that is rounding


def _known(name: str, words: tuple[str, ...]) -> str:
    if name not in words:
        raise UnknownName.among(list(words), kind="direction of vibration", name=name)
    return SAME_DIRECTION.get(name, name)


@dataclass(frozen=True, kw_only=True, slots=True)
class VibrationDirection:
    """Direction of the main component of a vibration, to which its amplitude belongs, and the second component.

    Parameters
    ----------
    direction : str
        "normal", "along", "across" or "torsional", or a word of `SAME_DIRECTION`; "oblique" where an angle is given.
    vibration_direction : float or None
        Angle between vibration and sliding, both within the plane, in place of a word. [rad]
    torsion_radius : float or None
        Radius of the ring that turns to and fro about the normal, at which the amplitude holds. [m]
    second_direction : str or None
        "normal", "along" or "across"; None without a second component.
    second_fraction : float
        Amplitude of the second component over that of the main one. []
    second_phase : float
        Lag of the second component behind the main one. [rad]

    Raises
    ------
    InvalidInput
        If a torsional vibration has no radius or a radius belongs to no torsional one, both components have one
        direction, or a value is negative or not finite.
    UnknownName
        If there is no such direction.
    """

    direction: str = "normal"
    vibration_direction: float | None = None
    torsion_radius: float | None = None
    second_direction: str | None = None
    second_fraction: float = 0.0
    second_phase: float = 0.0

    def __post_init__(self) -> None:
        main = SAME_DIRECTION.get(self.direction, self.direction)
        second = None if self.second_direction is None else _known(self.second_direction, get_args(SecondWord))
        require_non_negative(second_fraction=self.second_fraction)
        require_finite(second_phase=self.second_phase)
        if self.vibration_direction is not None:
            require_finite(vibration_direction=self.vibration_direction)
            main = "oblique"
        elif main == "oblique":
            raise InvalidInput("direction oblique needs vibration_direction, its angle to the sliding")
        else:
            main = _known(main, get_args(DirectionWord))
        if self.torsion_radius is not None:
            require_positive(torsion_radius=self.torsion_radius)
        if (main == "torsional") != (self.torsion_radius is not None):
            raise InvalidInput(
                'direction "torsional" needs torsion_radius, the radius at which the amplitude holds'
                if main == "torsional"
                else f'torsion_radius belongs to direction "torsional", not to "{main}"; leave it out'
            )
        if second is not None and second == main:
            raise InvalidInput(f'second_direction "{second}" is that of the vibration itself; name another one')
        if main == "torsional" and second not in (None, "normal"):
            raise InvalidInput(f'second_direction "{second}" beside direction "torsional": only "normal" can be')
        object.__setattr__(self, "direction", main)
        object.__setattr__(self, "second_direction", second if self.second_fraction > 0 else None)

    @property
    def word(self) -> str | float | None:
        """Its word, or its angle to the sliding, in rad; None of two components, for which neither stands."""
        if self.second_direction is not None:
            return None
        return self.direction if self.vibration_direction is None else self.vibration_direction

    @property
    def is_normal(self) -> bool:
        """Whether the vibration is along the normal alone."""
        return self.direction == "normal" and self.second_direction is None

    @property
    def is_in_plane(self) -> bool:
        """Whether the main component is within the plane."""
        return self.direction != "normal"

    @property
    def parts(self) -> frozenset[str]:
        """Directions of motion, of "normal", "along" and "across"."""
        main = {"torsional": {"along", "across"}, "oblique": {"along", "across"}}.get(self.direction, {self.direction})
        return frozenset(main | ({self.second_direction} if self.second_direction else set()))

    @property
    def angle(self) -> float | None:
        """Angle to the sliding of a vibration in one direction of the plane; None of others. [rad]"""
        if self.second_direction is not None:
            return None
        return {"along": 0.0, "across": pi / 2}.get(self.direction, self.vibration_direction)

    @property
    def text(self) -> str:
        """Direction in words."""
        text = _TEXTS[self.direction]
        if self.vibration_direction is not None:
            text = f"at {degrees(self.vibration_direction):.4g} deg to the sliding, within the plane"
        if self.torsion_radius is not None:
            text += f", the amplitude at a radius of {format_si(self.torsion_radius, 'm')}"
        if self.second_direction is None:
            return text
        return (
            f"{text}, with {self.second_fraction:.4g} of it {_TEXTS[self.second_direction]},"
            f" {degrees(self.second_phase):.4g} deg behind"
        )

    def require_amplitude(self, vibration_amplitude: float) -> None:
        """Refuse an amplitude that turns a ring by more than a small angle."""
        if self.torsion_radius is not None and vibration_amplitude > _SMALL_TURN * self.torsion_radius:
            raise InvalidInput(
                f"vibration_amplitude {format_si(vibration_amplitude, 'm')} turns a ring of"
                f" {format_si(self.torsion_radius, 'm')} in radius by more than {_SMALL_TURN:g} rad: the radius must be"
                " that at which the amplitude holds"
            )

    def normal_part(self) -> float:
        """Amplitude along the normal over that of the main component. []"""
        return float(abs(self.components()[0]))

    def within_plane(self, motion: ContactMotion, *, vibration_amplitude: float) -> ContactMotion:
        """Motion of the gap by the normal part, at its widest at the first phase, with the parts within the plane."""
        normal, *plane = self.components()
        turn = abs(normal) / normal if normal else 1.0
        phases = np.exp(2j * pi * np.arange(motion.displacement.size) / motion.displacement.size)
        along, across = (_oscillation(vibration_amplitude * turn * part * phases, part) for part in plane)
        return replace(motion, along=along, across=across)

    def over_gap(self, motion: ContactMotion) -> ContactMotion:
        """Any motion of the gap as the main component, with the second one, which follows it delayed."""
        if self.second_direction is None or self.is_in_plane:
            return motion
        if motion.along is not None or motion.across is not None:
            return motion
        second = self.second_fraction * delayed_oscillation(motion.displacement, phase=self.second_phase)
        return replace(motion, along=second) if self.second_direction == "along" else replace(motion, across=second)

    def over_contact(self, motion: ContactMotion) -> list[tuple[float, ContactMotion]]:
        """Motions at places of the contact with their shares: one, but of a ring, whose places move in turn."""
        if self.direction != "torsional" or motion.along is None:
            return [(1.0, motion)]
        angles, weights = ring_directions(_RING)
        return [
            (weight, replace(motion, along=motion.along * cos(angle), across=motion.along * sin(angle)))
            for angle, weight in zip(angles.tolist(), weights.tolist(), strict=True)
        ]

    def components(self) -> tuple[complex, complex, complex]:
        """Complex amplitudes along the normal, along and across the sliding over that of the main component."""
        angle = self.vibration_direction or 0.0
        found = {
            "normal": complex(self.direction == "normal"),
            "along": complex({"along": 1.0, "torsional": 1.0, "oblique": cos(angle)}.get(self.direction, 0.0)),
            "across": complex({"across": 1.0, "oblique": sin(angle)}.get(self.direction, 0.0)),
        }
        if self.second_direction is not None:
            found[self.second_direction] += self.second_fraction * np.exp(-1j * self.second_phase)
        return found["normal"], found["along"], found["across"]


def require_same_direction(words: frozenset[str], direction: VibrationDirection, *, title: str) -> None:
    """Refuse runs whose words, "normal" or "torsional", are of another direction than that of their rig."""
    other = sorted(words - {direction.direction})
    if other:
        raise InvalidInput(
            f"{title}: vibrates {direction.text}; leave out runs with the direction {' or '.join(other)}"
        )


NORMAL: Final = VibrationDirection()
"""Vibration along the normal of the contact."""


def _oscillation(rotating: Floats, part: complex) -> Floats | None:
    """Real part of a rotating amplitude; None for a component that is none."""
    return np.asarray(rotating.real) if abs(part) > _NOTHING else None
