"""Range of validity of friction models: no contact transmits more than mu F_N; a formula beyond that is withheld."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import ContactMotion, RoughContact, sinusoidal_motion
from sonolube.models.friction import FRICTION_MODELS, FrictionModel
from sonolube.models.friction.models.range_check import (
    OUTSIDE_MODEL_RANGE,
    checked_ratio,
    model_friction,
    ratio_caveats,
)
from sonolube.rig import read_rig

CONTACT = read_rig("examples/rigs/tribometer.toml").contact
CLOSE = read_rig("examples/rigs/welder_flat.toml").contact  # 8.2 um of gap under 70 N
HARD_MODELS = [name for name, model in FRICTION_MODELS.items() if not model.for_soft_bodies]


def moving(contact: RoughContact, *, load: float, amplitude: float) -> ContactMotion:
    return sinusoidal_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=22e3)


@pytest.mark.parametrize("name", FRICTION_MODELS)
def test_a_ratio_above_the_coulomb_limit_is_withheld_with_a_reason(name: str) -> None:
    found = checked_ratio(FRICTION_MODELS[name](), [0.3, 1.0, 1.01, 166.0], mean_force_ratio=1.0, gap_closed=False)
    assert found.friction_ratio[:2].tolist() == [0.3, 1.0]
    assert np.isnan(found.friction_ratio[2:]).all()
    assert found.raw_friction_ratio.tolist() == [0.3, 1.0, 1.01, 166.0]
    assert found.reason[0] == ""
    assert found.reason[3].startswith(f"{OUTSIDE_MODEL_RANGE}: {name} gives a mean friction force beyond")


@pytest.mark.parametrize("name", ["asperity_stick_slip", "bristle_with_holder"])
def test_models_that_drive_the_slider_keep_negative_ratios(name: str) -> None:
    found = checked_ratio(FRICTION_MODELS[name](), [-0.4, -1.5], mean_force_ratio=1.0, gap_closed=False)
    assert found.friction_ratio[0] == -0.4
    assert np.isnan(found.friction_ratio[1])


def test_elastic_friction_of_the_cube_has_no_negative_ratio() -> None:
    found = checked_ratio(FRICTION_MODELS["dong_2015_full_period"](), -0.4, mean_force_ratio=1.0, gap_closed=False)
    assert np.isnan(found.friction_ratio)


def test_a_mean_normal_force_above_the_load_permits_as_much_friction() -> None:
    # a stiff mount holds the mean gap at rest, where the mean force is 1.9 times the load
    found = checked_ratio(FRICTION_MODELS["asperity_stick_slip"](), [1.8, 2.0], mean_force_ratio=1.9, gap_closed=False)
    assert (found.reason == "").tolist() == [True, False]


@pytest.mark.parametrize("name", HARD_MODELS)
@pytest.mark.parametrize("amplitude", [0.2e-6, 1e-6, 4e-6])
def test_what_passes_is_below_mu_times_the_mean_normal_force(name: str, amplitude: float) -> None:
    motion = moving(CONTACT, load=3.0, amplitude=amplitude)
    found = model_friction(
        FRICTION_MODELS[name](), CONTACT, motion, sliding_speed=[1e-3, 0.05, 2.0], friction_coefficient=0.3
    )
    limit = np.mean(motion.normal_force) / 3.0
    within = found.reason == ""
    assert np.all(np.abs(found.friction_ratio[within]) <= limit * (1 + 3e-4))
    assert np.isnan(found.friction_ratio[~within]).all()


def test_the_formula_as_printed_stands_beside_the_withheld_ratio() -> None:
    model, motion = FRICTION_MODELS["dong_2015_full_period"](), moving(CONTACT, load=3.0, amplitude=4e-6)
    found = model_friction(model, CONTACT, motion, sliding_speed=1.0)
    formula = model.ratio(CONTACT, motion, sliding_speed=1.0)
    assert formula > 1
    assert found.raw_friction_ratio == approx(formula)
    with raises(OutsideRange, match="lower the amplitude or the sliding speed, or use asperity_stick_slip"):
        found.require_within_range()


def test_a_vibration_through_the_mean_planes_is_outside_every_model_that_needs_a_gap() -> None:
    motion = moving(CLOSE, load=70.0, amplitude=11.46e-6)
    for name in HARD_MODELS:
        found = model_friction(
            FRICTION_MODELS[name](), CLOSE, motion, sliding_speed=[0.05, 0.1], friction_coefficient=0.3
        )
        assert (found.reason == "").all() == (name in {"coulomb", "kinematic"}), name
        assert np.isnan(found.friction_ratio).all() == (name not in {"coulomb", "kinematic"}), name


def test_the_half_period_is_defined_where_its_formula_is_though_withheld() -> None:
    motion = moving(CLOSE, load=70.0, amplitude=11.46e-6)
    found = model_friction(FRICTION_MODELS["dong_2015_half_period"](), CLOSE, motion, sliding_speed=0.05)
    assert "closes the gap" in str(found.reason)
    assert found.raw_friction_ratio == approx(0.0417, abs=1e-4)


def test_arguments_without_meaning_are_refused_and_no_status() -> None:
    motion = moving(CONTACT, load=3.0, amplitude=1e-6)
    with raises(InvalidInput, match="sliding_speed must be positive"):
        model_friction(FRICTION_MODELS["kinematic"](), CONTACT, motion, sliding_speed=0.0)
    with raises(InvalidInput, match="requires a friction_coefficient"):
        model_friction(FRICTION_MODELS["bristle_with_holder"](), CONTACT, motion, sliding_speed=0.1)


def test_every_model_says_why_ratios_beyond_its_bounds_have_no_meaning() -> None:
    for name, model in FRICTION_MODELS.items():
        assert issubclass(model, FrictionModel)
        assert len(model.range_note) > 40, name


def test_a_value_beyond_an_exact_bound_by_rounding_is_the_bound() -> None:
    # under a dead load |F1/F0| <= 1 (Coulomb), and harmonic balance finds the load to 1e-6
    found = checked_ratio(
        FRICTION_MODELS["asperity_stick_slip"](), [1.00000023, 1.0001, 0.9, -1.00002], mean_force_ratio=1.0000003,
        gap_closed=False,
    )  # fmt: skip
    assert found.friction_ratio.tolist() == [1.0, 1.0, 0.9, -1.0]
    assert found.raw_friction_ratio[0] == 1.00000023


def test_a_mean_force_above_the_load_by_more_than_rounding_is_kept() -> None:
    found = checked_ratio(FRICTION_MODELS["asperity_stick_slip"](), 1.001, mean_force_ratio=1.002, gap_closed=False)
    assert found.friction_ratio == 1.001


def test_ratios_within_0_and_1_need_no_caveat() -> None:
    assert ratio_caveats(friction_ratio=[0.0, 0.4, 1.0, np.nan]) == ()
    assert ratio_caveats(friction_ratio=np.nan) == ()


def test_a_ratio_below_0_is_said_to_drive_and_one_above_1_to_raise_friction() -> None:
    below, above = ratio_caveats(friction_ratio=[-0.174, 0.5, 1.37])
    assert below.startswith("friction ratio -0.174 is below 0: the mean friction force drives the sliding")
    assert above.startswith("friction ratio 1.37 is above 1: the vibration raises friction")


@pytest.mark.parametrize("name", ["asperity_stick_slip", "bristle_with_holder"])
@pytest.mark.parametrize(("fraction", "lag"), [(0.2, 0.0), (0.5, 0.9)])
def test_a_motion_along_the_sliding_acts_as_the_same_fraction_of_the_normal_one(
    name: str, fraction: float, lag: float
) -> None:
    normal = moving(CONTACT, load=3.0, amplitude=1e-6)
    phase = 2 * np.pi * np.arange(normal.displacement.size) / normal.displacement.size
    along = replace(normal, along=fraction * 1e-6 * np.cos(phase - lag))
    arguments: dict[str, Any] = {"sliding_speed": [5e-3, 0.05], "friction_coefficient": 0.3}
    by_motion = model_friction(FRICTION_MODELS[name](), CONTACT, along, **arguments)
    parameters: dict[str, Any] = {"in_plane_fraction": fraction, "in_plane_phase": lag}
    own = FRICTION_MODELS[name](**parameters)
    by_fraction = model_friction(own, CONTACT, normal, **arguments)
    assert by_motion.raw_friction_ratio == approx(by_fraction.raw_friction_ratio, rel=1e-6)
    assert (by_motion.reason == by_fraction.reason).all()
    without = model_friction(FRICTION_MODELS[name](), CONTACT, normal, **arguments)
    assert by_motion.raw_friction_ratio != approx(without.raw_friction_ratio, rel=1e-2)


@pytest.mark.parametrize(
    ("name", "direction"), [("kinematic", "along"), ("dong_2015_full_period", "along"), ("kinematic", "across")]
)
def test_a_motion_that_a_model_has_no_law_for_is_refused(name: str, direction: str) -> None:
    normal = moving(CONTACT, load=3.0, amplitude=1e-6)
    within: dict[str, Any] = {direction: np.zeros_like(normal.displacement)}
    motion = replace(normal, **within)
    with raises(InvalidInput, match=f"friction model {name} has no law for a motion {direction} the sliding"):
        model_friction(FRICTION_MODELS[name](), CONTACT, motion, sliding_speed=0.05, friction_coefficient=0.3)
