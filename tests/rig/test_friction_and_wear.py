"""Parameters of friction models in rig files, and the friction and wear they give."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0
from tests.same import same

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.friction import dong_2015_half_period_ratio, sine_stick_slip_ratio
from sonolube.models.wear import cube_wear_rate
from sonolube.rig import Rig, friction_point, read_rig, simulate, steady_vibration

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=changes)


def undriven() -> Rig:
    """The tribometer's contact and vibration, of which nobody knows the frequency."""
    known = tribometer()
    return Rig(
        title="undriven",
        source="none",
        contact=known.contact,
        normal_load=known.normal_load,
        friction_coefficient=known.friction_coefficient,
        sliding_speed=known.sliding_speed,
        vibration_amplitude=known.vibration_amplitude,
    )


def test_a_shorter_memory_leaves_less_of_the_sine_to_gain() -> None:
    for length in (0.5e-6, 1.5e-6, 5e-6):
        rig = tribometer(f"friction.memory_length={length}m", "vibration.amplitude_source=per-volt")
        expected = sine_stick_slip_ratio(
            decay_length=2e-6,
            vibration_amplitude=steady_vibration(rig).vibration_amplitude,
            frequency=22e3,
            sliding_speed=20.3e-3,
            memory_length=length,
        )
        assert friction_point(rig).friction_ratio == approx(float(expected), rel=1e-9)


def test_a_soft_holder_lets_slow_sliding_keep_what_the_widest_gap_carries() -> None:
    # in series with a spring much softer than the contact the bristle never reaches its limit but at the widest gap
    soft = tribometer(
        "friction.model=bristle_with_holder", "friction.holder_stiffness=1e4N/m", "sliding.sliding_speed=1um/s"
    )
    beta = steady_vibration(soft).vibration_amplitude / 2e-6
    assert friction_point(soft).friction_ratio == approx(np.exp(-beta) / i0(beta), rel=1e-3)


def test_in_plane_motion_changes_the_friction_of_either_model_that_takes_it() -> None:
    for model in ("asperity_stick_slip", "bristle_with_holder"):
        still = tribometer(f"friction.model={model}")
        moved = tribometer(f"friction.model={model}", "friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg")
        assert getattr(moved.friction_model, "in_plane_phase") == approx(np.pi / 2)  # noqa: B009
        assert abs(simulate(moved).friction.friction_ratio - simulate(still).friction.friction_ratio) > 0.02


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        (
            ["friction.holder_stiffness=1e6N/m"],
            r"friction\.holder_stiffness: model asperity_stick_slip does not take it; bristle_with_holder does",
        ),
        (
            ["friction.model=bristle_with_holder", "friction.memory_length=1um"],
            r"friction\.memory_length: model bristle_with_holder",
        ),
        (
            ["friction.model=kinematic", "friction.in_plane_fraction=0.1"],
            "asperity_stick_slip and bristle_with_holder do$",
        ),
        (["friction.in_plane_phase=1rad"], r"needs friction\.in_plane_fraction"),
        (["friction.memory_length=0m"], r"memory_length must be positive, got 0\.0 m"),
        (["friction.in_plane_fraction=-0.1"], "in_plane_fraction must not be negative"),
        (["friction.memory_length=1"], "memory_length: 1 has no unit"),
    ],
)
def test_a_parameter_that_the_model_does_not_have_is_refused_by_name(changes: list[str], complaint: str) -> None:
    with raises(InvalidInput, match=complaint):
        tribometer(*changes)


def test_wear_follows_the_friction_model_where_it_has_one_of_its_name() -> None:
    balanced = simulate(tribometer("friction.model=dong_2015_load_balanced"))
    assert balanced.wear.wear_model == "dong_2015_load_balanced"
    # with the area in proportion to the force only the cube's height matters: 1 + [l ln I0 - a I1/I0]/d
    assert 0.9 < balanced.wear.wear_rate / float(cube_wear_rate(tribometer().contact, normal_load=3.0)) < 1
    assert simulate(tribometer()).wear.wear_model == "dong_2015_half_period"


def test_friction_is_by_the_rigs_own_model_unless_another_is_named() -> None:
    rig = tribometer("friction.model=kinematic", "vibration.amplitude_source=per-volt")
    assert friction_point(rig).friction_model == "kinematic"
    cube = dong_2015_half_period_ratio(
        rig.contact, normal_load=rig.normal_load, vibration_amplitude=steady_vibration(rig).vibration_amplitude
    )
    assert friction_point(rig, model="dong_2015_half_period").friction_ratio == approx(float(cube), rel=1e-4)
    with raises(UnknownName, match="did you mean asperity_stick_slip"):
        friction_point(rig, model="asperity_stickslip")


def test_a_named_model_keeps_the_in_plane_motion_of_the_rig() -> None:
    rig = tribometer("friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg")
    own = tribometer(
        "friction.model=bristle_with_holder", "friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg"
    )
    named = friction_point(rig, model="bristle_with_holder")
    same(named.friction_ratio, friction_point(own).friction_ratio)


def test_the_half_period_needs_no_frequency_and_other_models_say_that_they_do() -> None:
    rig = undriven()
    assert friction_point(rig, model="dong_2015_half_period").friction_ratio < 1
    with raises(InvalidInput, match=r"drive\.frequency is missing; friction model asperity_stick_slip needs it"):
        friction_point(rig)


def test_former_names_are_refused_with_the_present_ones() -> None:
    with raises(InvalidInput, match=r'friction\.closure: is now friction\.model; write model = "asperity_stick_slip"'):
        tribometer("friction.closure=stick_slip")
    with raises(InvalidInput, match=r'friction\.model: "coupled" is now "bristle_with_holder"'):
        tribometer("friction.model=coupled")
    with raises(InvalidInput, match=r'contact\.asperity_law: "corrected" is now "chang_etsion_bogy"'):
        tribometer("contact.asperity_law=corrected")
