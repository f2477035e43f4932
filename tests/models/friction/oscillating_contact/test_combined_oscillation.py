"""Oscillations in several directions against closed forms and springs integrated in time."""

from typing import Any

import numpy as np
from pytest import approx, mark

from sonolube.models.friction import (
    SpringContact,
    combined_oscillation_ratio,
    critical_speed,
    elliptical_traction_ratio,
    longitudinal_oscillation_ratio,
    normal_oscillation_ratio,
    transverse_vibration_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
FREQUENCY, DEPTH, SLIP = 20e3, 1e-6, 0.5e-6  # slip length mu k_z/k_x times the depth
OMEGA = 2 * np.pi * FREQUENCY
BOTH = mark.parametrize("contact", [FLAT, SPHERE])


@BOTH
@mark.parametrize(("depth", "amplitude", "v"), [(1.0, 0.5, 0.3), (0.3, 1.0, 0.3)])
def test_along_the_normal_alone_the_integrated_ratio_is_the_closed_form(
    contact: SpringContact, depth: float, amplitude: float, v: float
) -> None:
    motion: dict[str, Any] = {
        "approach": depth * DEPTH,
        "normal_amplitude": amplitude * DEPTH,
        "frequency": FREQUENCY,
        "sliding_speed": v * critical_speed(contact, frequency=FREQUENCY, normal_amplitude=amplitude * DEPTH),
    }
    assert combined_oscillation_ratio(contact, **motion) == approx(
        normal_oscillation_ratio(contact, **motion), abs=2e-4
    )


@BOTH
@mark.parametrize(("amplitude", "v"), [(0.3, 0.3), (2.0, 0.1)])
def test_along_the_sliding_alone_the_integrated_ratio_is_the_closed_form(
    contact: SpringContact, amplitude: float, v: float
) -> None:
    motion: dict[str, Any] = {
        "approach": DEPTH,
        "in_plane_amplitude": amplitude * DEPTH,
        "frequency": FREQUENCY,
        "sliding_speed": v * OMEGA * amplitude * DEPTH,
    }
    assert combined_oscillation_ratio(contact, **motion) == approx(
        longitudinal_oscillation_ratio(contact, **motion), abs=1e-4
    )


def across(amplitude: float, v: float, steps: int = 1024) -> float:
    return float(
        combined_oscillation_ratio(
            FLAT,
            approach=DEPTH,
            transverse_amplitude=amplitude,
            frequency=FREQUENCY,
            sliding_speed=v * OMEGA * amplitude,
            steps=steps,
        )
    )


@mark.parametrize(("amplitude", "v"), [(0.8, 0.3), (2.0, 0.3), (3.0, 1.2)])
def test_across_the_sliding_the_ratio_is_that_of_projections_onto_the_friction_circle(
    amplitude: float, v: float
) -> None:
    steps = 10000
    theta = 2 * np.pi * np.arange(steps) / steps
    increments = amplitude * np.diff(np.cos(np.append(theta, 2 * np.pi)))
    advance = v * amplitude * 2 * np.pi / steps
    p, q, total = 1.0, 0.0, 0.0
    for _ in range(3):
        total = 0.0
        for increment in increments:
            p, q = p + advance, q + increment
            excess = max(np.hypot(p, q), 1.0)
            p, q = p / excess, q / excess
            total += p
    assert across(amplitude * SLIP, v) == approx(total / steps, abs=3e-4)


@mark.parametrize(("stroke", "v", "steps"), [(3.0, 0.02, 16), (3.0, 0.1, 16), (1.2, 0.02, 8), (0.9, 0.6, 8)])
def test_a_spring_dragged_along_few_straight_slides_ends_each_where_many_projections_do(
    stroke: float, v: float, steps: int
) -> None:
    # the first part of a slide, in which the spring sticks, and the rest, in which it slips, are both resolved
    parts, y = 1000, stroke * np.cos(2 * np.pi * np.arange(steps + 1) / steps)
    p, q, vertices = 1.0, 0.0, np.zeros(steps + 1)
    for _ in range(40):
        start, vertices[0] = p, p
        for k in range(steps):
            advance, move = v * stroke * 2 * np.pi / steps / parts, float(y[k + 1] - y[k]) / parts
            for _ in range(parts):
                p, q = p + advance, q + move
                if (squared := p * p + q * q) > 1:
                    p, q = p / squared**0.5, q / squared**0.5
            vertices[k + 1] = p
        if abs(p - start) < 1e-6:
            break
    assert across(stroke * SLIP, v, steps=steps) == approx(np.trapezoid(vertices) / steps, abs=2e-3)


@mark.parametrize("stroke", [0.2, 0.6, 0.8])
def test_very_slow_sliding_across_an_oscillation_has_the_static_friction_ratio(stroke: float) -> None:
    # the spring slips only at the ends of its stroke: p^2 + stroke^2 = 1
    assert across(stroke * SLIP, 1e-3) == approx(np.sqrt(1 - stroke**2), abs=5e-3)


@mark.parametrize("v", [0.5, 2.0])
def test_a_long_stroke_across_gives_the_ratio_of_rigid_contacts(v: float) -> None:
    rigid = transverse_vibration_ratio(sliding_speed=v, vibration_velocity=1.0)
    assert across(500 * SLIP, v, steps=4096) == approx(float(rigid), abs=1e-4)


def test_the_error_falls_with_the_square_of_the_step() -> None:
    motion: dict[str, Any] = {
        "approach": DEPTH,
        "frequency": FREQUENCY,
        "sliding_speed": 0.02,
        "transverse_amplitude": 0.7e-6,
    }
    both = motion | {"normal_amplitude": 0.5e-6, "in_plane_amplitude": 0.3e-6, "in_plane_phase": 1.0}
    coarse, fine, finest = (float(combined_oscillation_ratio(FLAT, **both, steps=n)) for n in (128, 256, 2048))
    assert abs(fine - finest) < 0.4 * abs(coarse - finest) < 1e-2


@mark.parametrize("lag", [0.4, 1.6, 4.0])
def test_stiff_springs_under_elliptical_motion_have_the_traction_of_a_motor(lag: float) -> None:
    stiff = SpringContact(friction_coefficient=0.4, mindlin_ratio=4000.0)
    speed, amplitude, depth = 0.05, 1e-6, 0.4e-6
    theta = (np.arange(20000) + 0.5) * 2 * np.pi / 20000
    mean = np.mean(np.maximum(depth - amplitude * np.cos(theta), 0))
    springs = combined_oscillation_ratio(
        stiff,
        approach=depth,
        normal_amplitude=amplitude,
        in_plane_amplitude=amplitude,
        in_plane_phase=lag,
        frequency=FREQUENCY,
        sliding_speed=speed,
        steps=8192,
    )
    # the motion of the slider is that of the surface reversed; contact is closed half a period after the widest gap
    rigid = elliptical_traction_ratio(
        normal_load=mean,
        normal_stiffness=1.0,
        normal_amplitude=amplitude,
        in_plane_amplitude=amplitude,
        phase=-lag,
        frequency=FREQUENCY,
        relative_velocity=speed,
    )
    assert float(springs) == approx(-float(rigid), abs=0.02)


def one_dimensional(depth: float, along: float, lag: float, v: float) -> float:
    """Return the mean friction of a spring integrated in one dimension; lengths in slip lengths, speed per radian."""
    n = 20_000
    theta = 2 * np.pi * np.arange(n + 1) / n
    limits = np.maximum(depth - 0.9 * np.cos(theta), 0.0)
    moves = np.diff(v * theta + along * np.cos(theta - lag))
    force = total = 0.0
    for _ in range(3):
        total = 0.0
        for move, limit in zip(moves.tolist(), limits[1:].tolist(), strict=True):
            force = min(max(force + move, -limit), limit)
            total += force
    return total / float(limits[1:].sum())


@mark.parametrize("depth", [1.0, 0.6])
@mark.parametrize(("along", "lag", "v"), [(3.0, np.pi, 0.3), (3.0, np.pi / 2, 1.0), (1.5, 1.5 * np.pi, 0.02)])
def test_a_spring_opposed_to_the_slide_while_its_limit_falls_keeps_its_sign(
    depth: float, along: float, lag: float, v: float
) -> None:
    found = [
        combined_oscillation_ratio(
            FLAT,
            approach=depth * DEPTH,
            normal_amplitude=0.9 * DEPTH,
            in_plane_amplitude=along * SLIP,
            in_plane_phase=lag,
            frequency=FREQUENCY,
            sliding_speed=v * OMEGA * SLIP,
            steps=steps,
        )
        for steps in (1000, 1024, 2047)
    ]
    assert found == approx([one_dimensional(depth, along, lag, v)] * 3, abs=3e-4)
