"""Coulomb's law under vibration in any direction: closed forms, brute force, limits, symmetries, passivity."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx
from scipy.special import ellipe, ellipk
from tests.models.friction.models.test_models import CONTACT
from tests.tiers import examples

from sonolube.checks import Floats
from sonolube.models.contact import ContactMotion, normal_force, separation, sinusoidal_motion
from sonolube.models.friction import AsperityStickSlip, Coulomb, sliding_power_ratio

LOAD, FREQUENCY, AMPLITUDE = 3.0, 30e3, 1e-6
PEAK = 2 * np.pi * FREQUENCY * AMPLITUDE
PHASES = 2 * np.pi * np.arange(256) / 256
SPEEDS = np.array([0.01, 0.1, 0.15, 0.3]) * PEAK / 0.19


def motion(
    *, normal: float = 0.0, along: complex | None = None, across: complex | None = None, samples: int = 256
) -> ContactMotion:
    """Motion by complex amplitudes within the plane, in um, beside a normal one."""
    still = sinusoidal_motion(
        CONTACT, normal_load=LOAD, vibration_amplitude=normal * AMPLITUDE, frequency=FREQUENCY, samples=samples
    )
    turning = AMPLITUDE * np.exp(2j * np.pi * np.arange(samples) / samples)
    return replace(
        still,
        along=None if along is None else (along * turning).real,
        across=None if across is None else (across * turning).real,
    )


def ratio(moving: ContactMotion, speeds: Floats = SPEEDS) -> Floats:
    return Coulomb().ratio(CONTACT, moving, sliding_speed=speeds)


def brute_force(normal: float, along: complex, across: complex, speeds: Floats) -> Floats:
    """Mean of force and direction at a million phases."""
    theta = 2 * np.pi * (np.arange(2**20) + 0.5) / 2**20
    turning = 1j * PEAK * np.exp(1j * theta)
    u, w = (along * turning).real, (across * turning).real
    gap = separation(CONTACT, normal_load=LOAD) + normal * AMPLITUDE * np.cos(theta)
    load = normal_force(CONTACT, separation=gap) / LOAD
    return np.array([np.mean(load * (v + u) / np.hypot(v + u, w)) for v in speeds])


def test_along_it_is_the_arcsine_and_one_from_the_peak_velocity_on() -> None:
    expected = 2 / np.pi * np.arcsin(np.minimum(SPEEDS / PEAK, 1))
    assert ratio(motion(along=1)) == approx(expected, rel=1e-12)
    assert ratio(motion(along=1), np.array([1.0001, 3]) * PEAK) == approx([1, 1], abs=1e-12)


def test_across_it_is_the_complete_elliptic_integral() -> None:
    m = PEAK**2 / (PEAK**2 + SPEEDS**2)
    assert ratio(motion(across=1)) == approx(2 / np.pi * np.sqrt(1 - m) * ellipk(m), rel=1e-10)


@pytest.mark.parametrize(
    ("normal", "along", "across"),
    [
        (0.0, 1, 0.5j),
        (0.0, 0.7 * np.exp(-1j), 0.4),
        (1.0, np.exp(-1j), 0.0),
        (1.0, 0.3j, 0.8 * np.exp(2j)),
        (2.0, 0.0, 1.0),
    ],
)
def test_elliptical_motions_have_the_mean_of_a_million_phases(normal: float, along: complex, across: complex) -> None:
    found = ratio(motion(normal=normal, along=along, across=across))
    assert found == approx(brute_force(normal, along, across, SPEEDS), abs=1e-5)


def test_the_quadrature_agrees_with_the_closed_form_that_it_becomes() -> None:
    straight = motion(along=0.8, across=0.6)
    nearly = motion(along=0.8, across=0.6 * np.exp(1e-7j))
    assert ratio(nearly) == approx(ratio(straight), abs=1e-5)


@examples(40)
@given(angle=st.floats(0, np.pi / 2), size=st.floats(0.01, 3), lag=st.floats(-np.pi, np.pi), second=st.floats(0, 2))
def test_signs_and_mirror_images_change_nothing_and_friction_brakes(
    angle: float, size: float, lag: float, second: float
) -> None:
    along, across = size * np.cos(angle), size * np.sin(angle) + second * np.exp(-1j * lag)
    found = ratio(motion(along=along, across=across))
    assert ratio(motion(along=along, across=-across)) == approx(found, abs=2e-5)
    assert ratio(motion(along=-along, across=-across)) == approx(found, abs=2e-5)
    assert np.all((found > 0) & (found <= 1 + 1e-9))


@examples(25)
@given(angle=st.floats(0, np.pi), size=st.floats(0.0, 3), part=st.floats(0, 1.5), lag=st.floats(-np.pi, np.pi))
def test_the_mean_power_of_friction_is_never_negative(angle: float, size: float, part: float, lag: float) -> None:
    along, across, normal = size * np.cos(angle), size * np.sin(angle), part
    theta = 2 * np.pi * (np.arange(2**14) + 0.5) / 2**14
    turning = 1j * PEAK * np.exp(1j * (theta - lag))
    gap = separation(CONTACT, normal_load=LOAD) + normal * AMPLITUDE * np.cos(theta)
    load = normal_force(CONTACT, separation=gap) / LOAD
    v = SPEEDS[1]
    delay = np.exp(-1j * lag)
    drive = v * ratio(motion(normal=normal, along=along * delay, across=across * delay), SPEEDS[1:2])
    u, w = (along * turning).real, (across * turning).real
    vibration = np.mean(load * ((v + u) * u + w * w) / np.hypot(v + u, w))
    assert drive + vibration >= -1e-4 * v
    assert drive + vibration == approx(np.mean(load * np.hypot(v + u, w)), rel=2e-3)


def test_the_power_of_friction_along_and_across_has_its_closed_forms() -> None:
    for speed, zeta in ((0.05, 0.05 / PEAK), (3 * PEAK, 3.0)):
        along = sliding_power_ratio(motion(along=1), sliding_speed=speed)
        below = 2 / np.pi * (np.arcsin(min(zeta, 1)) + np.sqrt(max(1 / zeta**2 - 1, 0)))
        assert along == approx(below if zeta < 1 else 1, rel=1e-5)
        across = sliding_power_ratio(motion(across=1), sliding_speed=speed)
        assert across == approx(2 / np.pi * np.sqrt(1 + 1 / zeta**2) * ellipe(1 / (1 + zeta**2)), rel=1e-6)


def test_without_motion_within_the_plane_friction_follows_the_mean_force() -> None:
    assert ratio(motion()) == approx(np.ones(4), rel=1e-12)
    raised = motion(normal=1.0)
    assert ratio(raised) == approx(np.full(4, raised.normal_force.mean() / LOAD), rel=1e-12)


def test_stiff_asperities_approach_rigid_ones() -> None:
    stiff = AsperityStickSlip(memory_length=1e-10)
    for moving in (motion(along=1), motion(across=1), motion(along=0.6, across=0.8j)):
        assert stiff.ratio(CONTACT, moving, sliding_speed=SPEEDS) == approx(ratio(moving), abs=5e-3)
