"""Springs before the slider: gripping and slipping under oscillation along the normal or along the sliding."""

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx, mark, raises, warns

from sonolube.errors import InvalidInput, ModelRangeWarning, OutsideRange
from sonolube.friction import (
    SpringContact,
    approximate_normal_ratio,
    critical_speed,
    load_balanced_approach,
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


def stepped(
    contact: SpringContact, *, depth: float, normal: float, along: float, speed: float, steps: int = 2000
) -> float:
    """March springs side by side, mu k_z/k_x = 1/2, by first-order steps: friction over limit, to about 1e-3."""
    count = 1 if contact is FLAT else 800
    lowered = np.zeros(1) if contact is FLAT else ((np.arange(count) + 0.5) / count * np.sqrt(depth + normal)) ** 2
    theta = 2 * np.pi * np.arange(steps) / steps
    slides = speed / FREQUENCY / steps + along * (np.sin(theta) - np.sin(theta - 2 * np.pi / steps))
    force = 0.5 * np.maximum(depth - normal - lowered, 0)
    friction = limits = 0.0
    for _ in range(4):
        friction = limits = 0.0
        for angle, slide in zip(theta, slides, strict=True):
            limit = 0.5 * np.maximum(depth - normal * np.cos(angle) - lowered, 0)
            force = np.clip(force + slide, -limit, limit)
            friction, limits = friction + float(force.sum()), limits + float(limit.sum())
    return friction / limits


def under_load(contact: SpringContact, *, depth: float, amplitude: float, v: float) -> float:
    speed = v * float(critical_speed(contact, frequency=FREQUENCY, normal_amplitude=amplitude))
    return float(
        normal_oscillation_ratio(
            contact, approach=depth, normal_amplitude=amplitude, frequency=FREQUENCY, sliding_speed=speed
        )
    )


def under_stroke(contact: SpringContact, *, amplitude: float, v: float) -> float:
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
def test_gripping_and_slipping_under_a_vibrating_load_is_that_of_springs_stepped(
    contact: SpringContact, depth: float, v: float
) -> None:
    speed = v * 0.5 * OMEGA * DEPTH
    assert under_load(contact, depth=depth * DEPTH, amplitude=DEPTH, v=v) == approx(
        stepped(contact, depth=depth * DEPTH, normal=DEPTH, along=0.0, speed=speed), abs=1e-3
    )


@BOTH
@mark.parametrize(("stroke", "v"), [(0.2, 0.3), (0.5, 0.01), (0.9, 0.4), (2.0, 0.1), (8.0, 0.7)])
def test_gripping_and_slipping_under_a_vibrating_end_is_that_of_springs_stepped(
    contact: SpringContact, stroke: float, v: float
) -> None:
    amplitude = stroke * DEPTH
    assert under_stroke(contact, amplitude=amplitude, v=v) == approx(
        stepped(contact, depth=DEPTH, normal=0.0, along=amplitude, speed=v * OMEGA * amplitude), abs=1e-3
    )


@BOTH
@settings(deadline=None)
@given(depth=st.floats(-0.9, 3), v=st.floats(1.0, 50.0))
def test_from_the_critical_speed_on_nothing_is_reduced_contact_lost_or_not(
    contact: SpringContact, depth: float, v: float
) -> None:
    assert under_load(contact, depth=depth * DEPTH, amplitude=DEPTH, v=v * (1 + 1e-12)) == 1


def test_the_critical_speed_is_hand_computed() -> None:
    # 0.4 * 2 pi 20 kHz * 1 um / 0.8
    assert float(critical_speed(FLAT, frequency=20e3, normal_amplitude=1e-6)) == approx(0.0628319, rel=1e-5)


@BOTH
@mark.parametrize("amplitude", [0.2, 0.7, 1.0, 1.5])
def test_slow_sliding_leaves_what_the_widest_gap_holds(contact: SpringContact, amplitude: float) -> None:
    theta = (np.arange(20000) + 0.5) * 2 * np.pi / 20000
    power = 1.0 if contact is FLAT else 1.5
    forces = np.maximum(1 - amplitude * np.cos(theta), 0) ** power
    plateau = normal_static_ratio(contact, approach=DEPTH, normal_amplitude=amplitude * DEPTH)
    assert float(plateau) == approx(forces.min() / forces.mean(), abs=1e-6)
    assert under_load(contact, depth=DEPTH, amplitude=amplitude * DEPTH, v=1e-8) == approx(float(plateau), abs=1e-3)


@BOTH
@settings(deadline=None)
@given(depth=st.floats(-0.5, 3), v=st.floats(1e-4, 0.9), faster=st.floats(1.01, 1.1))
def test_friction_grows_with_speed(contact: SpringContact, depth: float, v: float, faster: float) -> None:
    slow, fast = (under_load(contact, depth=depth * DEPTH, amplitude=DEPTH, v=one) for one in (v, v * faster))
    assert -1e-9 <= slow <= fast + 1e-6 <= 1 + 2e-6


@mark.parametrize("v", [1e-3, 0.1, 0.6])
def test_a_spring_cannot_tell_whether_its_limit_oscillates_or_its_end(v: float) -> None:
    # k_x a = mu k_z a': the same force, but for a cosine, so long as it never slides back nor parts
    load = under_load(FLAT, depth=DEPTH, amplitude=0.6 * DEPTH, v=v)
    assert under_stroke(FLAT, amplitude=0.3 * DEPTH, v=v) == approx(load, abs=1e-9)


@BOTH
@mark.parametrize("v", [0.05, 0.5, 0.95, 1.5])
def test_a_long_stroke_gives_the_arcsine_of_rigid_contacts(contact: SpringContact, v: float) -> None:
    rigid = parallel_vibration_ratio(sliding_speed=v, vibration_velocity=1.0)
    assert under_stroke(contact, amplitude=1e5 * DEPTH, v=v) == approx(float(rigid), abs=2e-3)


def test_a_sphere_held_while_it_oscillates_follows_cattaneo_and_mindlin() -> None:
    # harmonic swing a about the point of full slip less a; unloading by Masing from F = 1 - (1 - s)^1.5, s in slips
    swing, slip = 0.3, 0.5 * DEPTH
    theta = (np.arange(20000) + 0.5) * np.pi / 20000
    back = swing * (1 - np.cos(theta))  # slid back from the front, of 2 a at most
    leaving = 1 - 2 * (1 - (1 - back / 2) ** 1.5)
    least = leaving[-1]
    returning = least + 2 * (1 - (1 - (2 * swing - back) / 2) ** 1.5)
    held = (leaving.mean() + returning.mean()) / 2
    assert under_stroke(SPHERE, amplitude=swing * slip, v=1e-9) == approx(held, abs=1e-4)


@BOTH
@mark.parametrize("amplitude", [0.0, 0.4, 1.0, 3.0])
def test_a_balanced_approach_carries_the_load_of_rest(contact: SpringContact, amplitude: float) -> None:
    mean = float(load_balanced_approach(contact, approach=DEPTH, normal_amplitude=amplitude * DEPTH)) / DEPTH
    theta = (np.arange(40000) + 0.5) * 2 * np.pi / 40000
    power = 1.0 if contact is FLAT else 1.5
    assert np.mean(np.maximum(mean - amplitude * np.cos(theta), 0) ** power) == approx(1, abs=1e-6)


@mark.parametrize(("contact", "below", "above"), [(FLAT, 0.0144, 1e-9), (SPHERE, 0.0061, 0.0223)])
def test_the_published_approximation_is_as_good_as_it_says(contact: SpringContact, below: float, above: float) -> None:
    amplitude, v = np.linspace(0.05, 1, 12) * DEPTH, np.linspace(0.002, 1, 200)[:, np.newaxis]
    exact = normal_oscillation_ratio(
        contact,
        approach=DEPTH,
        normal_amplitude=amplitude,
        frequency=FREQUENCY,
        sliding_speed=v * critical_speed(contact, frequency=FREQUENCY, normal_amplitude=amplitude),
    )
    error = approximate_normal_ratio(contact, approach=DEPTH, normal_amplitude=amplitude, velocity_ratio=v) - exact
    assert error.min() == approx(-below, abs=2e-4)
    assert error.max() == approx(above, abs=2e-4)


def test_the_approximation_warns_where_contact_is_lost() -> None:
    with warns(ModelRangeWarning, match="contact is lost"):
        approximate_normal_ratio(FLAT, approach=1e-6, normal_amplitude=2e-6, velocity_ratio=0.5)


def test_what_the_drive_spends_is_what_slipping_turns_to_heat() -> None:
    # the spring gives back by the period what it stores, and the oscillating load does no work along the plane
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
    ratio = under_load(FLAT, depth=DEPTH, amplitude=0.8 * DEPTH, v=v)
    assert ratio * slide * steps == approx(heat, rel=1e-3)


def test_without_oscillation_nothing_changes() -> None:
    still: dict[str, Any] = {"approach": DEPTH, "frequency": FREQUENCY, "sliding_speed": [1e-6, 1.0]}
    for contact in (FLAT, SPHERE):
        assert normal_oscillation_ratio(contact, normal_amplitude=0.0, **still) == approx([1, 1])
        assert longitudinal_oscillation_ratio(contact, in_plane_amplitude=0.0, **still) == approx([1, 1])


def test_bodies_that_never_touch_are_refused() -> None:
    with raises(OutsideRange, match="never touch"):
        normal_static_ratio(FLAT, approach=-2e-6, normal_amplitude=1e-6)


def test_an_unknown_profile_is_refused() -> None:
    with raises(InvalidInput, match="profile must be 'flat' or 'parabolic'"):
        SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="cone")  # type: ignore[arg-type]
