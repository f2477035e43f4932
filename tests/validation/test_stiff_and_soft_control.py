"""Stiff and soft active control of friction by vibrations and their energy efficiency, after the abstract.

One spring, displacements given. Along the normal, friction falls only where the contact sticks and slips, sideways also
where it slides on; sideways the motion always takes more energy than without, along the normal less, the same or more.
"""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, combined_oscillation_ratio, critical_speed, normal_oscillation_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
DEPTH, SLIP, FREQUENCY = 1e-6, 0.5e-6, 20e3


def normal(share: float, speed: float) -> tuple[float, float]:
    """Return friction and energy over those of the same approach without; speed over the critical."""
    ratio = float(
        normal_oscillation_ratio(
            FLAT,
            approach=DEPTH,
            normal_amplitude=share * DEPTH,
            frequency=FREQUENCY,
            sliding_speed=speed * critical_speed(FLAT, frequency=FREQUENCY, normal_amplitude=share * DEPTH),
        )
    )
    # the normal force gives back what it takes: the drive pays the mean friction alone
    phases = 2 * np.pi * (np.arange(10_000) + 0.5) / 10_000
    return ratio, ratio * float(np.maximum(1 - share * np.cos(phases), 0).mean())


def sideways(stroke: float, speed: float) -> tuple[float, float, bool]:
    """Return friction and energy of a unit spring over those without, and whether it ever sticks."""
    n = 10_000
    across = np.diff(stroke * np.cos(2 * np.pi * np.arange(n + 1) / n)).tolist()
    along, (p, q), friction, work, sticks = 2 * np.pi * speed * stroke / n, (1.0, 0.0), 0.0, 0.0, False
    for _ in range(10):
        friction = work = 0.0
        sticks = False
        for move in across:
            p, q = p + along, q + move
            length = float(np.hypot(p, q))
            sticks = sticks or length < 1
            p, q = p / max(length, 1.0), q / max(length, 1.0)
            friction += p / n
            work += p * along + q * move
    return friction, work / (along * n), sticks


@pytest.mark.parametrize("share", [0.3, 0.9, 1.5])
def test_along_the_normal_only_stick_slip_lowers_friction(share: float) -> None:
    assert normal(share, 0.9)[0] < 1
    assert normal(share, 1.1)[0] == 1


def test_along_the_normal_motion_takes_less_the_same_or_more_energy() -> None:
    assert normal(0.9, 0.3)[1] < 0.8
    assert normal(0.9, 1.1)[1] == approx(1)
    assert normal(1.5, 1.1)[1] > 1.05  # it jumps, and its mean force is greater than at rest


@pytest.mark.parametrize(("stroke", "speed"), [(0.5, 0.2), (1.5, 0.3), (5.0, 0.2), (5.0, 1.5)])
def test_sideways_it_always_takes_more(stroke: float, speed: float) -> None:
    friction, energy, _ = sideways(stroke, speed)
    assert friction < 1 < energy
    assert friction == approx(exact(stroke, speed), abs=3e-4)


def test_sideways_a_contact_that_slides_on_has_less_friction_too() -> None:
    friction, _, sticks = sideways(5.0, 1.5)
    assert not sticks
    assert friction < 0.95
    assert friction == approx(exact(5.0, 1.5), abs=3e-4)


def exact(stroke: float, speed: float) -> float:
    return float(
        combined_oscillation_ratio(
            FLAT,
            approach=DEPTH,
            transverse_amplitude=stroke * SLIP,
            frequency=FREQUENCY,
            sliding_speed=speed * 2 * np.pi * FREQUENCY * stroke * SLIP,
        )
    )
