"""What a rig file says of memory, holder and in-plane motion, and which closure listens."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0

from sonolube.errors import InvalidInput, UnknownName
from sonolube.friction import stick_slip_ratio
from sonolube.rig import Rig, friction_point, read_rig, simulate
from sonolube.wear.cube import cube_wear_rate

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=changes)


def test_a_shorter_memory_leaves_less_of_the_sine_to_gain() -> None:
    for length in (0.5e-6, 1.5e-6, 5e-6):
        rig = tribometer(f"friction.memory_length={length}m")
        expected = stick_slip_ratio(
            decay_length=2e-6,
            vibration_amplitude=rig.vibration_amplitude,
            frequency=22e3,
            sliding_speed=20.3e-3,
            memory_length=length,
        )
        assert friction_point(rig, closure="stick_slip").friction_ratio == approx(float(expected), rel=1e-4)


def test_a_soft_holder_lets_slow_sliding_keep_what_the_widest_gap_carries() -> None:
    # in series with a spring much softer than the contact the bristle never reaches its limit but at the widest gap
    soft = tribometer("friction.closure=coupled", "friction.holder_stiffness=1e4N/m", "sliding.sliding_speed=1um/s")
    beta = soft.vibration_amplitude / 2e-6
    assert friction_point(soft, closure="coupled").friction_ratio == approx(np.exp(-beta) / i0(beta), rel=1e-3)


def test_in_plane_motion_reaches_the_simulation_of_either_closure_that_takes_it() -> None:
    for closure in ("stick_slip", "coupled"):
        still = tribometer(f"friction.closure={closure}")
        moved = tribometer(
            f"friction.closure={closure}", "friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg"
        )
        assert moved.in_plane_phase == approx(np.pi / 2)
        assert abs(simulate(moved).friction_ratio - simulate(still).friction_ratio) > 0.02


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        (["friction.holder_stiffness=1e6N/m"], r"friction\.holder_stiffness: closure stick_slip does not take it"),
        (["friction.closure=coupled", "friction.memory_length=1um"], r"friction\.memory_length: closure coupled"),
        (["friction.closure=kinematic", "friction.in_plane_fraction=0.1"], "stick_slip and coupled do$"),
        (["friction.in_plane_phase=1rad"], r"needs friction\.in_plane_fraction"),
        (["friction.memory_length=0m"], r"memory_length must be positive, got 0\.0 m"),
        (["friction.in_plane_fraction=-0.1"], "in_plane_fraction must not be negative"),
        (["friction.memory_length=1"], "memory_length: 1 has no unit"),
    ],
)
def test_what_the_closure_does_not_take_is_refused_by_name(changes: list[str], complaint: str) -> None:
    with raises(InvalidInput, match=complaint):
        tribometer(*changes)


def test_wear_follows_the_closure_of_friction_where_it_has_one() -> None:
    balanced = simulate(tribometer("friction.closure=load_balanced"))
    assert balanced.wear_closure == "load_balanced"
    # with the area in proportion to the force only the cube's height matters: 1 + [l ln I0 - a I1/I0]/d
    assert 0.9 < balanced.wear_rate / float(cube_wear_rate(tribometer().contact, normal_load=3.0)) < 1
    assert simulate(tribometer()).wear_closure == "separating_half_period"


def test_without_a_name_friction_is_the_cubes() -> None:
    rig = tribometer()
    by_name = friction_point(rig, closure="separating_half_period")
    assert friction_point(rig).closure == "separating_half_period"
    assert friction_point(rig).friction_ratio == approx(by_name.friction_ratio, rel=1e-5)
    with raises(UnknownName, match="did you mean stick_slip"):
        friction_point(rig, closure="stickslip")
