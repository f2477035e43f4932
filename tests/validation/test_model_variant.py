"""Variants and their parameters: where they apply, what they need, conditions at once, and conditions of a rig."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import separation
from sonolube.models.friction import FRICTION_MODELS
from sonolube.rig import Rig, read_rig
from sonolube.validation.comparison import ComparedFit, RigPrediction, compared_models, predict_rig
from sonolube.validation.model_variant import (
    FreeParameter,
    ModelVariant,
    condition_columns,
    per_rig,
    read_variants,
    vibrated_rig,
)
from sonolube.validation.published_tests import friction_tests

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
SLOPE = FreeParameter(name="slope", default=0.5, initial_values=(0.3,), low=-5.0, high=5.0, reason="any")


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


def test_a_parameter_applies_to_its_sets_or_to_all() -> None:
    assert SLOPE.applies_to("B")
    assert SLOPE.applies_to("")
    own = replace(SLOPE, applicable_sets="AC")
    assert [own.applies_to(sets) for sets in ("A", "BC", "BD", "")] == [True, True, False, False]
    welder, map_ = per_rig((SLOPE,), "welder", "power map")
    assert (welder.applicable_sets, map_.applicable_sets) == ("G", "B")
    assert replace(SLOPE, unit="rad").is_angle
    assert not replace(SLOPE, unit="m").is_angle


def test_values_of_other_sets_do_not_reach_the_formula_of_a_test() -> None:
    own = replace(SLOPE, name="offset", applicable_sets="B")
    model = ModelVariant("made", "by hand", lambda test, slope, offset=0.0: slope + offset, parameters=(SLOPE, own))
    a, b = friction_tests("A")[0], friction_tests("B")[0]
    assert model.predict(a, 0.2, 0.05) == approx(0.2)
    assert model.predict(b, 0.2, 0.05) == approx(0.25)
    assert model.predict_all([a, b], 0.2, 0.05) == approx([0.2, 0.25])


def test_what_conditions_lack_is_named_in_the_order_of_the_model() -> None:
    model = ModelVariant(
        "made", "by hand", lambda test: 0.5, required_inputs=("in_plane_amplitude", "contact", "frequency")
    )
    rig = replace(vibrated_rig(tribometer()), frequency=None)
    assert model.inapplicability(rig) == "needs the amplitude along the sliding, the frequency: not known here"
    assert model.inapplicability(replace(rig, frequency=1e4, in_plane_amplitude=1e-6)) is None


@pytest.mark.parametrize(("count", "is_together"), [(7, False), (8, True)])
def test_eight_conditions_on_one_contact_are_computed_at_once(count: int, is_together: bool) -> None:
    calls: list[Any] = []

    def ratio(test: Any, slope: float) -> Any:
        calls.append(test)
        return slope * np.asarray(test.sliding_speed)

    model = ModelVariant("made", "by hand", ratio, parameters=(SLOPE,), takes_columns=True)
    first = friction_tests("A")[0]
    tests = [replace(first, sliding_speed=0.1 * (place + 1)) for place in range(count)]
    assert model.predict_all(tests, 2.0) == approx([0.2 * (place + 1) for place in range(count)])
    assert len(calls) == (1 if is_together else count)
    one_by_one = replace(model, takes_columns=False)
    calls.clear()
    assert one_by_one.predict_all(tests, 3.0) == approx([0.3 * (place + 1) for place in range(count)])
    assert len(calls) == count
    rig_specific = replace(model, parameters=(replace(SLOPE, applicable_sets="A"),))
    calls.clear()
    assert rig_specific.predict_all(tests, 4.0) == approx([0.4 * (place + 1) for place in range(count)])
    assert len(calls) == count


def test_columns_hold_each_input_of_conditions_and_nan_where_one_lacks_it() -> None:
    a, b = friction_tests("A")[:2]
    found = condition_columns([a, replace(b, contact=a.contact)])
    assert found is not None
    assert found.contact is a.contact
    assert found.sliding_speed == approx([20.3e-3, 40.6e-3])
    assert found.normal_load == approx([3.0, 3.0])
    assert found.vibration_amplitude == approx([2.5e-6, 2.5e-6])
    assert found.frequency == approx([22e3, 22e3])
    lacking = condition_columns([replace(vibrated_rig(tribometer()), frequency=None)])
    assert lacking is not None
    assert np.isnan(lacking.frequency[0])


def test_variants_of_a_file_have_its_entries_the_parameters_of_rigs_and_what_was_seen(tmp_path: Path) -> None:
    (tmp_path / "variants.toml").write_text(
        """[plain]
description = "a ratio"
ratio = "level"
[fitted]
description = "with a length"
ratio = "level"
parameters = ["memory_length"]
rig_parameters = [{parameters = ["amplitude_fraction"], rigs = ["welder", "power map"]}]
required_inputs = ["contact"]
[seen]
description = "with a constant"
ratio = "level"
seen = {sets = "AC", refitted = "fitted"}
friction_model = "kinematic"
"""
    )
    given: list[Any] = []

    def level(*arguments: Any, **values: float) -> float:
        given.append((arguments, values))
        return 0.5

    plain, fitted, seen = read_variants(tmp_path / "variants.toml", level=level)
    assert plain.parameters == ()
    assert plain.seen is None
    assert plain.friction_model is None
    assert plain.required_inputs[0] == "contact"
    assert len(plain.required_inputs) == 6
    assert [(each.name, each.applicable_sets) for each in fitted.parameters] == [
        ("memory_length", ""), ("amplitude_fraction", "G"), ("amplitude_fraction", "B")
    ]  # fmt: skip
    assert fitted.required_inputs == ("contact",)
    assert seen.seen is not None
    assert (seen.seen.sets, seen.seen.refitted.name) == ("AC", "fitted")
    assert seen.seen_constants == 3
    assert plain.seen_constants == 0
    assert seen.friction_model is FRICTION_MODELS["kinematic"]
    test = friction_tests("G")[0]
    assert [each.predict(test, *values) for each, values in ((plain, ()), (seen, ()), (fitted, (1e-6, 0.3, 0.2)))] == [
        approx(0.5)
    ] * 3
    assert given == [
        ((test,), {}), ((FRICTION_MODELS["kinematic"], test), {}),
        ((test,), {"memory_length": 1e-6, "amplitude_fraction": 0.3}),
    ]  # fmt: skip


def test_a_rig_along_the_normal_has_its_settings_and_no_motion_within_the_plane() -> None:
    found = vibrated_rig(tribometer())
    assert found.vibration_amplitude == approx(2.5e-6)
    assert found.frequency == approx(22e3)
    assert (found.normal_load, found.friction_coefficient, found.sliding_speed) == approx((3.0, 0.341, 20.3e-3))
    assert (found.in_plane_amplitude, found.vibration_velocity, found.vibration_direction) == (None, None, None)
    assert found.holder_stiffness is None
    assert found.set_name == "-"
    held = tribometer("friction.model=bristle_with_holder", "friction.holder_stiffness=2e5 N/m")
    assert vibrated_rig(held).holder_stiffness == approx(2e5)


def test_a_rig_within_the_plane_has_its_angle_and_peak_velocity() -> None:
    along = vibrated_rig(read_rig(RIGS / "vibrating_base.toml"))
    assert along.vibration_amplitude is None
    assert along.in_plane_amplitude == approx(0.3523e-6)
    assert along.vibration_velocity == approx(2 * pi * 3e3 * 0.3523e-6)
    assert along.vibration_direction == approx(0.0)
    across = vibrated_rig(read_rig(RIGS / "vibrating_base.toml", changes=["vibration.direction=across"]))
    assert across.in_plane_amplitude is None
    assert across.vibration_direction == approx(pi / 2)
    both = vibrated_rig(
        read_rig(
            RIGS / "vibrating_base.toml",
            changes=["vibration.direction=normal", "vibration.second_direction=along", "vibration.second_fraction=0.4"],
        )
    )
    assert both.vibration_amplitude == approx(0.3523e-6)
    assert both.in_plane_amplitude == approx(0.4 * 0.3523e-6)
    assert both.vibration_direction == approx(0.0)
    ring = ["vibration.direction=torsional", "vibration.torsion_radius=2mm"]
    with raises(InvalidInput, match="are of vibration in one direction"):
        vibrated_rig(read_rig(RIGS / "vibrating_base.toml", changes=ring))
    with raises(InvalidInput, match="sliding_speed is 0"):
        vibrated_rig(replace(tribometer(), sliding_speed=0.0))


def fit_of(ratio: Any, **more: Any) -> ComparedFit:
    model = ModelVariant("made", "by hand", ratio, **({"required_inputs": ("contact",)} | more))
    return ComparedFit(model=model, sets="", assessment=None, parameters=(), predictions=())


def test_a_rig_is_predicted_by_what_applies_and_the_rest_says_why_it_does_not() -> None:
    def never(test: Any) -> float:
        raise OutsideRange("too slow")

    rig = vibrated_rig(tribometer())
    plain, none, lacking = predict_rig(
        (fit_of(never), fit_of(lambda test: 0.4), fit_of(lambda test: 0.5, required_inputs=("in_plane_amplitude",))),
        rig,
    )
    assert (plain.friction_ratio, plain.raw_friction_ratio, plain.uncertainty, plain.reason) == (0.4, 0.4, None, None)
    assert (none.friction_ratio, none.raw_friction_ratio, none.reason) == (None, None, "too slow")
    assert lacking.reason == "needs the amplitude along the sliding: not known here"
    objected = predict_rig((fit_of(lambda test: 1.2, friction_model=FRICTION_MODELS["kinematic"]),), rig)[0]
    assert isinstance(objected, RigPrediction)
    assert objected.friction_ratio is None
    assert objected.raw_friction_ratio == approx(1.2)
    assert "beyond the Coulomb limit" in (objected.reason or "")


def test_a_model_about_the_gap_at_rest_ends_where_the_amplitude_closes_that_gap() -> None:
    rig = vibrated_rig(tribometer())
    gap = float(separation(rig.contact, normal_load=rig.normal_load))
    cube, balanced = (
        ModelVariant("made", "by hand", lambda test: 0.5, friction_model=FRICTION_MODELS[name])
        for name in ("dong_2015_half_period", "asperity_stick_slip")
    )
    near, beyond = (replace(rig, vibration_amplitude=share * gap) for share in (0.99, 1.01))
    assert cube.range_objection(near, 0.5) is None
    assert "closes the gap" in (cube.range_objection(beyond, 0.5) or "")
    assert cube.range_objection(beyond, None) is None
    assert balanced.range_objection(beyond, 0.5) is None


def test_models_are_selected_in_the_order_of_the_list() -> None:
    found = compared_models(["kinematic-fitted", "kinematic"])
    assert [model.name for model in found] == ["kinematic", "kinematic-fitted"]
    assert len(compared_models()) > 20
