"""Dahl's and the LuGre law as models of friction: closed forms, limits, and the laws under harmonic motions."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.contact import RoughContact, normal_force, separation
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.friction import FRICTION_MODELS, dahl_under_vibration, parallel_vibration_ratio
from sonolube.models.friction.models.lugre import LuGre
from sonolube.rig import read_rig

F, LOAD, MU = 22e3, 3.0, 0.34
SPEEDS = np.array([0.02, 0.087, 0.4])
PHASE = 2 * np.pi * np.arange(512) / 512


@pytest.fixture(scope="module")
def contact() -> RoughContact:
    return read_rig("examples/rigs/tribometer.toml").contact


def motion(contact: RoughContact, *, normal: float = 0.0, along: float = 0.0, across: float = 0.0) -> ContactMotion:
    """Harmonic motion about the separation at rest, its parts in phase."""
    d, wave = float(separation(contact, normal_load=LOAD)), np.sin(PHASE)
    return ContactMotion(
        displacement=normal * wave,
        normal_force=np.broadcast_to(normal_force(contact, separation=d + normal * wave), wave.shape),
        frequency=F,
        normal_load=LOAD,
        along=along * wave if along else None,
        across=across * wave if across else None,
    )


@pytest.mark.parametrize(("normal", "along"), [(0.5e-6, 0.0), (0.0, 1e-6), (0.5e-6, 1e-6)])
def test_dahl_is_the_law_with_the_cube_under_a_harmonic_motion(
    contact: RoughContact, normal: float, along: float
) -> None:
    found = FRICTION_MODELS["dahl"]().ratio(
        contact, motion(contact, normal=normal, along=along), sliding_speed=SPEEDS, friction_coefficient=MU
    )
    force = dahl_under_vibration(
        contact,
        separation=separation(contact, normal_load=LOAD),
        friction_coefficient=MU,
        sliding_speed=SPEEDS,
        frequency=F,
        in_plane_amplitude=along,
        normal_amplitude=normal,
        phase=0.0,
    )
    assert found == approx(force / (MU * LOAD), rel=1e-3)


def test_the_cube_is_so_stiff_that_vibration_along_the_sliding_has_the_ratio_of_coulomb(contact: RoughContact) -> None:
    moved = motion(contact, along=1e-6)
    found = FRICTION_MODELS["dahl"]().ratio(contact, moved, sliding_speed=SPEEDS, friction_coefficient=MU)
    rigid = parallel_vibration_ratio(sliding_speed=SPEEDS, vibration_velocity=2 * np.pi * F * 1e-6)
    assert found == approx(rigid, abs=0.01)


def test_slow_bristles_have_the_harmonic_mean_of_the_load(contact: RoughContact) -> None:
    moved = motion(contact, normal=0.5e-6)
    found = LuGre().ratio(contact, moved, sliding_speed=1e-6, friction_coefficient=MU)
    assert found == approx(1 / np.mean(LOAD / moved.normal_force), rel=1e-3)


def test_fast_vibration_along_the_sliding_leaves_the_stribeck_curve_behind(contact: RoughContact) -> None:
    # at 1 mm/s without vibration friction is 1 + 0.5/e of Coulomb's; under the vibration it is on the lower branch
    moved = motion(contact, along=2e-6)
    with_curve, without = (
        float(LuGre(static_friction_ratio=rise).ratio(contact, moved, sliding_speed=1e-3, friction_coefficient=MU))
        for rise in (1.5, 1.0)
    )
    assert with_curve == approx(without / (1 + 0.5 / np.e), rel=0.05)


@pytest.mark.parametrize("name", ["dahl", "lugre"])
def test_no_vibration_changes_nothing_and_a_coefficient_is_needed(name: str, contact: RoughContact) -> None:
    model = FRICTION_MODELS[name]()
    still = motion(contact)
    assert model.ratio(contact, still, sliding_speed=SPEEDS, friction_coefficient=MU) == approx(1.0)
    with raises(InvalidInput, match=f"{name} requires a friction_coefficient"):
        model.ratio(contact, still, sliding_speed=SPEEDS)
