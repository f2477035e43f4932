"""Measures and kinematic formulas of the dissertation as functions of positional numbers, for interval propagation."""

from collections.abc import Callable
from functools import wraps
from math import pi
from typing import Final

from numpy.typing import ArrayLike

from sonolube.facts import metrics
from sonolube.models.wear import vibration_contact_count

Formula = Callable[..., float]


def _positional(function: Callable[..., ArrayLike], *names: str) -> Formula:
    """Function of keyword arguments as a function of positional numbers in the order of the names."""

    @wraps(function)
    def formula(*values: float) -> float:
        return float(function(**dict(zip(names, values, strict=True))))  # type: ignore[arg-type]

    return formula


friction_reduction: Final = _positional(
    metrics.friction_reduction, "intrinsic_friction_force", "reduced_friction_force"
)
"""Friction reduction of two forces or coefficients, D 2.1. []"""

wear_reduction: Final = _positional(metrics.wear_reduction, "intrinsic_wear_rate", "reduced_wear_rate")
"""Wear reduction of two wear rates, D 2.3. []"""

wear_rate: Final = _positional(metrics.wear_rate, "wear_volume", "sliding_distance")
"""Wear rate of a worn volume and a sliding distance, D 2.2. [m2]"""

sliding_speed: Final = _positional(metrics.linear_speed, "rotation_speed", "groove_diameter")
"""Sliding speed of a rotation speed and a groove diameter. [m/s]"""

sliding_distance: Final = _positional(metrics.sliding_distance, "revolutions", "groove_diameter")
"""Sliding distance of revolutions and a groove diameter. [m]"""

dot_spacing: Final = _positional(metrics.dot_spacing, "sliding_speed", "frequency")
"""Spacing of the marks of a vibration of a sliding speed and a frequency. [m]"""

indentation_spacing: Final = _positional(metrics.indentation_spacing, "sliding_speed", "period")
"""Spacing of the indentations of stick-slip of a sliding speed and a period, D 2.4. [m]"""

peak_vibration_velocity: Final = _positional(metrics.peak_vibration_velocity, "frequency", "vibration_amplitude")
"""Peak velocity of a frequency and an amplitude. [m/s]"""

superimposed_speed: Final = _positional(metrics.superimposed_speed, "sliding_speed", "vibration_velocity")
"""Superimposed speed of a sliding speed and a peak vibration velocity. [m/s]"""

contact_count: Final = _positional(vibration_contact_count, "frequency", "duration")
"""Number of contacts of a frequency and a duration. []"""


def groove_diameter(distance: float, turns: float) -> float:
    """Diameter of a groove from sliding distance and revolutions. [m]"""
    return distance / (pi * turns)
