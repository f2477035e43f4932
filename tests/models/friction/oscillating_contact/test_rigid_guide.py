"""Oscillation along the normal or the sliding against springs integrated in time, and limits."""

from typing import Any

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, mark
from scipy.integrate import quad

from sonolube.models.friction import (
    SpringContact,
    critical_speed,
    longitudinal_oscillation_ratio,
    normal_oscillation_ratio,
    normal_static_ratio,
    parallel_vibration_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
FREQUENCY, DEPTH = 20e3, 1e-6
OMEGA = 2 * np.pi * FREQUENCY
BOTH = mark.parametrize("contact", [FLAT, SPHERE])


def integrated(
    contact: SpringContact, *, depth: float, normal: float, along: float, speed: float, steps: int = 2000
) -> float:
    """Return friction over limit of springs with mu k_z/k_x = 1/2 by first-order time integration, to about 1e-3."""
    count = 1 if contact is FLAT else 800
    offset = np.zeros(1) if contact is FLAT else ((np.arange(count) + 0.5) / count * np.sqrt(depth + normal)) ** 2
    theta = 2 * np.pi * np.arange(steps) / steps
    slides = speed / FREQUENCY / steps + along * (np.sin(theta) - np.sin(theta - 2 * np.pi / steps))
    force = 0.5 * np.maximum(depth - normal - offset, 0)
    friction = limits = 0.0
    for _ in range(4):
        friction = limits = 0.0
        for angle, slide in zip(theta, slides, strict=True):
            limit = 0.5 * np.maximum(depth - normal * np.cos(angle) - offset, 0)
            force = np.clip(force + slide, -limit, limit)
            friction, limits = friction + float(force.sum()), limits + float(limit.sum())
    return friction / limits


def normal_ratio(contact: SpringContact, *, depth: float, amplitude: float, v: float) -> float:
    speed = v * float(critical_speed(contact, frequency=FREQUENCY, normal_amplitude=amplitude))
    return float(
        normal_oscillation_ratio(
            contact, approach=depth, normal_amplitude=amplitude, frequency=FREQUENCY, sliding_speed=speed
        )
    )


def longitudinal_ratio(contact: SpringContact, *, amplitude: float, v: float) -> float:
    return float(
        longitudinal_oscillation_ratio(
            contact,
            approach=DEPTH,
            in_plane_amplitude=amplitude,
            frequency=FREQUENCY,
            sliding_speed=v * OMEGA * amplitude,
        )
    )


@BOTH
@mark.parametrize(("depth", "v"), [(2.0, 0.1), (1.0, 0.4), (0.8, 0.3), (0.3, 0.05), (-0.4, 0.3)])
def test_normal_oscillation_has_the_ratio_of_springs_integrated_in_time(
    contact: SpringContact, depth: float, v: float
) -> None:
    speed = v * 0.5 * OMEGA * DEPTH
    assert normal_ratio(contact, depth=depth * DEPTH, amplitude=DEPTH, v=v) == approx(
        integrated(contact, depth=depth * DEPTH, normal=DEPTH, along=0.0, speed=speed), abs=1e-3
    )


@mark.parametrize(("depth", "v"), [(-0.95, 0.01), (-0.8, 0.1), (-0.3, 0.8), (0.2, 0.05), (0.4, 0.95), (1.5, 0.3)])
def test_the_deficit_of_a_sphere_is_that_of_its_springs_integrated_over_their_depths(depth: float, v: float) -> None:
    # springs at q from the centre have the mean depth d - q^2 in amplitudes, and flat profiles that of a spring
    def limit(q: float) -> float:
        c = depth - q * q
        return c if c >= 1 else (c * (np.pi - np.arccos(c)) + np.sqrt(1 - c * c)) / np.pi

    def deficit(q: float) -> float:
        return limit(q) * (1 - normal_ratio(FLAT, depth=(depth - q * q) * DEPTH, amplitude=DEPTH, v=v))

    outer, ends = np.sqrt(depth + 1) * (1 - 1e-12), depth + np.sqrt(1 - v * v) * np.array([-1.0, 1.0])
    kinks = np.sqrt(ends[(ends > 0) & (ends < depth + 1)])  # springs that stick always, and never
    whole, missing = (quad(f, 0, outer, points=kinks, epsabs=1e-10, limit=200)[0] for f in (limit, deficit))
    assert normal_ratio(SPHERE, depth=depth * DEPTH, amplitude=DEPTH, v=v) == approx(1 - missing / whole, abs=2e-6)


@BOTH
@mark.parametrize(("stroke", "v"), [(0.2, 0.3), (0.5, 0.01), (0.9, 0.4), (2.0, 0.1), (8.0, 0.7)])
def test_longitudinal_oscillation_has_the_ratio_of_springs_integrated_in_time(
    contact: SpringContact, stroke: float, v: float
) -> None:
    amplitude = stroke * DEPTH
    assert longitudinal_ratio(contact, amplitude=amplitude, v=v) == approx(
        integrated(contact, depth=DEPTH, normal=0.0, along=amplitude, speed=v * OMEGA * amplitude), abs=1e-3
    )


@BOTH
@settings(deadline=None)
@given(depth=st.floats(-0.9, 3), v=st.floats(1.0, 50.0))
def test_from_the_critical_speed_on_friction_is_not_reduced_with_and_without_contact_loss(
    contact: SpringContact, depth: float, v: float
) -> None:
    assert normal_ratio(contact, depth=depth * DEPTH, amplitude=DEPTH, v=v * (1 + 1e-12)) == 1


@BOTH
@mark.parametrize("amplitude", [0.2, 0.7, 1.0, 1.5])
def test_slow_sliding_has_the_static_friction_ratio(contact: SpringContact, amplitude: float) -> None:
    theta = (np.arange(20000) + 0.5) * 2 * np.pi / 20000
    power = 1.0 if contact is FLAT else 1.5
    forces = np.maximum(1 - amplitude * np.cos(theta), 0) ** power
    static = normal_static_ratio(contact, approach=DEPTH, normal_amplitude=amplitude * DEPTH)
    assert float(static) == approx(forces.min() / forces.mean(), abs=1e-6)
    assert normal_ratio(contact, depth=DEPTH, amplitude=amplitude * DEPTH, v=1e-8) == approx(float(static), abs=1e-3)


@BOTH
@settings(deadline=None)
@given(depth=st.floats(-0.5, 3), v=st.floats(1e-4, 0.9), faster=st.floats(1.01, 1.1))
def test_friction_grows_with_speed(contact: SpringContact, depth: float, v: float, faster: float) -> None:
    slow, fast = (normal_ratio(contact, depth=depth * DEPTH, amplitude=DEPTH, v=one) for one in (v, v * faster))
    assert -1e-9 <= slow <= fast + 1e-6 <= 1 + 2e-6


@mark.parametrize("v", [1e-3, 0.1, 0.6])
def test_an_oscillating_limit_and_an_oscillating_end_have_the_same_effect(v: float) -> None:
    # k_x a = mu k_z a': the same force up to a cosine, without reverse slip or loss of contact
    load = normal_ratio(FLAT, depth=DEPTH, amplitude=0.6 * DEPTH, v=v)
    assert longitudinal_ratio(FLAT, amplitude=0.3 * DEPTH, v=v) == approx(load, abs=1e-9)


@BOTH
@mark.parametrize("v", [0.05, 0.5, 0.95, 1.5])
def test_a_long_stroke_gives_the_arcsine_of_rigid_contacts(contact: SpringContact, v: float) -> None:
    rigid = parallel_vibration_ratio(sliding_speed=v, vibration_velocity=1.0)
    assert longitudinal_ratio(contact, amplitude=1e5 * DEPTH, v=v) == approx(float(rigid), abs=2e-3)


def test_a_sphere_held_while_it_oscillates_follows_cattaneo_and_mindlin() -> None:
    # oscillation of amplitude a below full slip; unloading by Masing's rule from F = 1 - (1 - s)^1.5, s in slip lengths
    amplitude, slip = 0.3, 0.5 * DEPTH
    theta = (np.arange(20000) + 0.5) * np.pi / 20000
    back = amplitude * (1 - np.cos(theta))  # return from the front, at most 2 a
    unloading = 1 - 2 * (1 - (1 - back / 2) ** 1.5)
    lowest = unloading[-1]
    reloading = lowest + 2 * (1 - (1 - (2 * amplitude - back) / 2) ** 1.5)
    mean = (unloading.mean() + reloading.mean()) / 2
    assert longitudinal_ratio(SPHERE, amplitude=amplitude * slip, v=1e-9) == approx(mean, abs=1e-4)


def test_the_work_of_the_drive_equals_the_heat_of_slip() -> None:
    # over a period the spring stores no energy, and the oscillating load does no work along the plane
    v, steps = 0.3, 20000
    limits = 1 - 0.8 * np.cos(2 * np.pi * np.arange(steps) / steps)
    slide = v * 0.8 * 2 * np.pi / steps
    force = heat = 0.0
    for _ in range(2):
        heat = 0.0
        for limit in limits:
            slip = max(force + slide - limit, 0.0)
            force += slide - slip
            heat += limit * slip
    ratio = normal_ratio(FLAT, depth=DEPTH, amplitude=0.8 * DEPTH, v=v)
    assert ratio * slide * steps == approx(heat, rel=1e-3)


def test_without_oscillation_nothing_changes() -> None:
    constant: dict[str, Any] = {"approach": DEPTH, "frequency": FREQUENCY, "sliding_speed": [1e-6, 1.0]}
    for contact in (FLAT, SPHERE):
        assert normal_oscillation_ratio(contact, normal_amplitude=0.0, **constant) == approx([1, 1])
        assert longitudinal_oscillation_ratio(contact, in_plane_amplitude=0.0, **constant) == approx([1, 1])
