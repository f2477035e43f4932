"""Springs before the slider under oscillations in several directions, and on a guide with mass."""

from typing import Any

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.friction import (
    Holder,
    SpringContact,
    combined_oscillation_ratio,
    critical_speed,
    elliptical_traction_ratio,
    guided_critical_speed,
    guided_oscillation_ratio,
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
def test_along_the_normal_alone_the_marched_spring_is_the_exact_one(
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
def test_along_the_sliding_alone_the_marched_spring_is_the_exact_one(
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
def test_across_the_sliding_the_spring_is_that_of_returns_to_the_circle(amplitude: float, v: float) -> None:
    steps = 10000
    theta = 2 * np.pi * np.arange(steps) / steps
    swings = amplitude * np.diff(np.cos(np.append(theta, 2 * np.pi)))
    advance = v * amplitude * 2 * np.pi / steps
    p, q, total = 1.0, 0.0, 0.0
    for _ in range(3):
        total = 0.0
        for swing in swings:
            p, q = p + advance, q + swing
            beyond = max(np.hypot(p, q), 1.0)
            p, q = p / beyond, q / beyond
            total += p
    assert across(amplitude * SLIP, v) == approx(total / steps, abs=3e-4)


@mark.parametrize("stroke", [0.2, 0.6, 0.8])
def test_very_slow_sliding_across_an_oscillation_leaves_the_root_of_one_less_the_square(stroke: float) -> None:
    # the spring touches its circle only at the ends of its swing: p^2 + stroke^2 = 1
    assert across(stroke * SLIP, 1e-3) == approx(np.sqrt(1 - stroke**2), abs=5e-3)


@mark.parametrize("v", [0.5, 2.0])
def test_a_long_stroke_across_is_that_of_rigid_contacts(v: float) -> None:
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
def test_stiff_springs_under_an_ellipse_are_those_of_a_motor(lag: float) -> None:
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
    # the slider's motion over the surface is the surface's reversed; contact closes half a turn after it stands apart
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


def in_line(depth: float, along: float, lag: float, v: float) -> float:
    """Return the mean friction of a spring marched on a line; lengths in slip lengths, speed over theirs a radian."""
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
def test_pushed_back_while_its_limit_falls_a_spring_keeps_its_side(
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
    assert found == approx([in_line(depth, along, lag, v)] * 3, abs=3e-4)


MASS, K_Z = 5e-3, 1e6


def guided(speed: float, *, stiffness: float, mass: float, damping: float = 0.0) -> float:
    return float(
        guided_oscillation_ratio(
            FLAT,
            Holder(holder_stiffness=stiffness, holder_mass=mass, holder_damping=damping),
            normal_stiffness=K_Z,
            approach=DEPTH,
            normal_amplitude=0.5 * DEPTH,
            frequency=FREQUENCY,
            sliding_speed=speed,
        )
    )


def test_a_heavy_slider_is_rigidly_guided() -> None:
    speed = 0.3 * float(critical_speed(FLAT, frequency=FREQUENCY, normal_amplitude=0.5 * DEPTH))
    rigid = normal_oscillation_ratio(
        FLAT, approach=DEPTH, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY, sliding_speed=speed
    )
    assert guided(speed, stiffness=1e4, mass=0.05, damping=10.0) == approx(float(rigid), abs=2e-3)


def test_a_guide_without_mass_is_a_spring_in_series() -> None:
    holder = Holder(holder_stiffness=0.8 * K_Z)  # as stiff as the contact, so that the critical speed doubles
    critical = guided_critical_speed(
        FLAT, holder, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY
    )
    assert float(critical) == approx(2 * OMEGA * SLIP * 0.5)
    assert guided(0.999 * float(critical), stiffness=0.8 * K_Z, mass=0.0) < 1
    assert guided(1.001 * float(critical), stiffness=0.8 * K_Z, mass=0.0) == 1


@mark.parametrize("tuning", [0.5, 0.9, 1.3])
def test_where_the_guided_slider_stops_gripping_is_where_the_marched_friction_meets_one(tuning: float) -> None:
    stiffness = tuning * MASS * OMEGA**2
    holder = Holder(holder_stiffness=stiffness, holder_mass=MASS, holder_damping=0.02 * MASS * OMEGA)
    critical = float(
        guided_critical_speed(FLAT, holder, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY)
    )
    damping = holder.holder_damping
    assert guided(1.02 * critical, stiffness=stiffness, mass=MASS, damping=damping) == approx(1, abs=1e-6)
    assert guided(0.7 * critical, stiffness=stiffness, mass=MASS, damping=damping) < 0.999


def test_at_the_resonance_of_the_guide_no_critical_speed_is_left() -> None:
    resonant = Holder(holder_stiffness=MASS * OMEGA**2, holder_mass=MASS)
    critical = guided_critical_speed(
        FLAT, resonant, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY
    )
    assert critical > 1e6


def test_a_rounded_contact_on_a_guide_is_refused() -> None:
    with raises(InvalidInput, match="profile must be 'flat'"):
        guided_oscillation_ratio(
            SPHERE,
            Holder(),
            normal_stiffness=K_Z,
            approach=DEPTH,
            normal_amplitude=DEPTH,
            frequency=FREQUENCY,
            sliding_speed=0.1,
        )
