"""Inputs of a prediction and own runs, by values of the rig file and of the runs, by hand."""

from dataclasses import replace
from math import exp, log, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.prediction.inputs import Input, decay_length_of, own_runs, rig_inputs
from sonolube.prediction.posterior import learned
from sonolube.rig import Distribution, LogNormal, Rig, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


def within(factor: float, median: float = 1.0) -> Distribution:
    return Distribution(law=LogNormal(median=median, factor=factor), lowest=0.0, text=f"within {factor}")


def test_an_input_is_told_with_unit_spread_and_reason() -> None:
    one = Input(
        name="vibration_amplitude", label="amplitude", value=2.5e-6, spread=0.123, reason="by laser", remedy="none"
    )
    assert one.text == "amplitude 2.5 um within 12 % (by laser)"


def test_inputs_of_a_rig_without_distributions_have_usual_spreads() -> None:
    found = rig_inputs(tribometer())
    assert (found.frequency, found.sliding_speed, found.normal_load) == approx((22e3, 20.3e-3, 3.0))
    assert found.voltage_peak_to_peak == approx(28.0)
    assert not found.measured_length
    assert found.amplitude.value == approx(2.5e-6)
    assert found.amplitude.spread == approx(0.05)  # of a measured one
    assert found.friction.value == approx(0.341)
    assert found.friction.spread == approx(0.1)
    assert found.friction.reason == "given without a distribution"
    assert [each.name for each in found.uncertain] == ["decay_length", "vibration_amplitude", "friction_coefficient"]
    median, spread = learned().friction.decay_length()
    assert (found.decay.value, found.decay.spread) == approx((median, spread))
    assert "by published tests" in found.decay.reason
    assert "seven rigs" in decay_length_of(learned().friction, known_from="seven rigs").reason
    plane = rig_inputs(read_rig(RIGS / "vibrating_base.toml"), takes_plane=True)
    assert [each.name for each in plane.uncertain] == ["vibration_amplitude", "friction_coefficient"]


@mark.parametrize(("source", "key", "spread"), [
    ("measured", "vibration.vibration_amplitude", 0.05),
    ("computed", "stack.free_stroke_per_volt", 0.15),
    ("per-volt", "actuator.amplitude_per_volt", 0.1),
])  # fmt: skip
def test_the_amplitude_is_as_uncertain_as_its_source_or_as_the_entry_behind_it(
    source: str, key: str, spread: float
) -> None:
    rig = read_rig(RIGS / "tribometer.toml").replace("vibration.amplitude_source", source)
    assert rig_inputs(rig).amplitude.spread == approx(spread)
    known = rig_inputs(replace(rig, uncertainty={key: within(1.3)})).amplitude
    assert known.spread == approx(log(1.3), rel=1e-3)
    assert f"{key} within 1.3" in known.reason
    other = rig_inputs(replace(rig, uncertainty={"waveguide.axial_amplitude": within(1.3)})).amplitude
    assert other.spread == approx(spread)


def test_the_amplitude_of_a_waveguide_is_known_within_15_percent() -> None:
    assert rig_inputs(read_rig(RIGS / "poisson_steel_steel.toml")).amplitude.spread == approx(0.15)


def test_a_decay_length_of_the_rig_counts_with_its_distribution_or_within_30_percent() -> None:
    stated = tribometer("contact.decay_length=1.3um")
    found = rig_inputs(stated)
    assert found.measured_length
    assert found.decay.value == approx(1.3e-6)
    assert found.decay.spread == approx(0.3)
    assert found.decay.reason.startswith("stated; given without a distribution")
    for key in ("contact.decay_length", "contact.normal_stiffness"):
        known = rig_inputs(replace(stated, uncertainty={key: within(1.15)}))
        assert known.decay.spread == approx(log(1.15), rel=1e-3)
        assert known.decay.reason == "stated; within 1.15 in the rig file"
        assert known.at().decay_length_spread == approx(log(1.15), rel=1e-3)
    assert found.at().conditions.decay_length == approx([1.3e-6])
    taken = replace(stated, decay_length_origin="published_tests")
    assert not rig_inputs(taken).measured_length
    assert rig_inputs(taken).at().decay_length_spread is None
    assert rig_inputs(taken).at().conditions.decay_length == approx([1.5e-6])  # the reference of the population


@mark.parametrize(("median", "spread", "reason"), [
    (0.341 * 1.0005, log(1.2), "within 1.2 in the rig file"),
    (0.341 * 1.002, 0.1, "given in place of within 1.2"),
    (0.341 * 0.998, 0.1, "given in place of within 1.2"),
])  # fmt: skip
def test_a_distribution_of_friction_counts_where_it_is_about_the_value_of_the_rig(
    median: float, spread: float, reason: str
) -> None:
    rig = replace(tribometer(), uncertainty={"friction.friction_coefficient": within(1.2, median)})
    found = rig_inputs(rig).friction
    assert found.spread == approx(spread, rel=1e-3)
    assert found.reason == reason


def test_an_input_takes_the_place_of_that_of_its_name_alone() -> None:
    found = rig_inputs(tribometer())
    for name in ("decay", "amplitude", "friction"):
        own = replace(getattr(found, name), value=7.0)
        changed = found.with_input(own)
        assert [getattr(changed, each).value == 7.0 for each in ("decay", "amplitude", "friction")] == [
            each == name for each in ("decay", "amplitude", "friction")
        ]


def test_conditions_are_those_of_the_rig_but_for_amplitudes_or_speeds_that_are_given() -> None:
    found = rig_inputs(tribometer())
    at = found.at(vibration_amplitude=[1e-6, 2e-6, 3e-6]).conditions
    assert at.vibration_amplitude == approx([1e-6, 2e-6, 3e-6])
    assert at.sliding_speed == approx([20.3e-3] * 3)
    assert at.frequency == approx([22e3] * 3)
    assert at.decay_length == approx([1.5e-6] * 3)
    both = found.at(vibration_amplitude=[1e-6, 2e-6], sliding_speed=[0.1, 0.2])
    assert both.conditions.sliding_speed == approx([0.1, 0.2])
    assert both.conditions.vibration_amplitude == approx([1e-6, 2e-6])
    assert both.amplitude_spread == approx(0.05)
    assert found.at().conditions.vibration_amplitude == approx([2.5e-6])


def test_a_rig_that_does_not_vibrate_or_is_of_a_soft_contact_is_refused() -> None:
    with raises(InvalidInput, match="the vibration amplitude is 0 m"):
        rig_inputs(replace(read_rig(RIGS / "vibrating_base.toml"), vibration_amplitude=0.0), takes_plane=True)
    with raises(InvalidInput, match="friction model squeeze_film is of a soft or floating contact; use friction"):
        rig_inputs(read_rig(RIGS / "cutter_head.toml").replace("friction.model", "squeeze_film"))
    with raises(InvalidInput, match="rests on tests of vibration along the normal"):
        rig_inputs(read_rig(RIGS / "vibrating_base.toml"))


def runs(**columns: Any) -> xr.Dataset:
    return xr.Dataset({name: ("run", np.asarray(values, float)) for name, values in columns.items()})


def of(data: xr.Dataset, *changes: str) -> Any:
    return own_runs(data, rig_inputs(tribometer(*changes)), title="own")


def test_own_runs_take_what_they_lack_from_the_rig() -> None:
    found = of(
        runs(
            friction_reduction=[0.6, 0.5, 0.4],
            vibration_amplitude=[1e-6, np.nan, np.nan],
            voltage_peak_to_peak=[28.0, 14.0, np.nan],
            sliding_speed=[0.1, np.nan, 0.3],
        )
    )
    at = found.tested.at.conditions
    assert found.tested.friction_ratio == approx([0.4, 0.5, 0.6])
    assert at.vibration_amplitude == approx([1e-6, 1.25e-6, 2.5e-6])  # 14 of 28 V: half of 2.5 um
    assert at.sliding_speed == approx([0.1, 20.3e-3, 0.3])
    assert found.tested.name == "own"
    assert found.friction is None
    assert found.wear_rate_ratio.size == 0


def test_two_hundred_runs_are_taken_and_one_more_is_refused() -> None:
    speeds = np.linspace(0.01, 0.2, 201)
    assert of(runs(friction_reduction=[0.5] * 200, sliding_speed=speeds[:200])).tested.friction_ratio.size == 200
    with raises(InvalidInput, match="201 runs; at most 200 update a prediction"):
        of(runs(friction_reduction=[0.5] * 201, sliding_speed=speeds))


@mark.parametrize(("name", "bad", "place"), [("vibration_amplitude", 0.0, 2), ("sliding_speed", -0.1, 3)])
def test_the_first_run_that_cannot_be_is_named(name: str, bad: float, place: int) -> None:
    values = [1e-6] * 3
    values[place - 1] = bad
    with raises(InvalidInput, match=f"own: {name} of run {place} must be positive"):
        of(runs(friction_reduction=[0.5, 0.4, 0.3], **{name: values}))


@mark.parametrize(("load", "is_said"), [(4.4, False), (4.6, True), (1.6, False), (1.4, True)])
def test_a_load_more_than_half_off_that_of_the_rig_is_said(load: float, is_said: bool) -> None:
    found = of(runs(friction_reduction=[0.5, 0.4], normal_load=[3.0, load], sliding_speed=[0.02, 0.03]))
    assert any("a load far from the rig's" in each for each in found.caveats) is is_said


def test_the_uncertainty_of_runs_is_stated_or_by_four_repeats_or_a_twentieth() -> None:
    stated = of(runs(friction_reduction=[0.5, 0.4], friction_reduction_uncertainty=[0.03, 0.04]))
    assert stated.tested.uncertainty == approx([0.03, 0.04])
    assert stated.caveats == ()
    # three repeats of one point have two spare; with the fourth, and one stated: that stays
    few = of(runs(friction_reduction=[0.5, 0.52, 0.54]))
    assert few.tested.uncertainty == approx([0.05] * 3)
    assert "hold too few repeats; 0.05 is taken for each ratio" in few.caveats[0]
    four = of(
        runs(
            friction_reduction=[0.5, 0.52, 0.54, 0.56, 0.4],
            friction_reduction_uncertainty=[np.nan, 0.02, np.nan, np.nan, np.nan],
            sliding_speed=[0.02, 0.02, 0.02, 0.02, 0.1],
        )
    )
    scatter = sqrt((0.03**2 + 0.01**2 + 0.01**2 + 0.03**2) / 3)
    assert four.tested.uncertainty == approx([scatter, 0.02, scatter, scatter, scatter])
    assert four.caveats == ()
    spread_out = of(runs(friction_reduction=[0.5, 0.52, 0.54, 0.56], sliding_speed=[0.02, 0.02, 0.03, 0.03]))
    assert spread_out.tested.uncertainty == approx([0.05] * 4)  # two pairs: three fewer repeats than four
    with raises(InvalidInput, match="must be positive in every run"):
        of(runs(friction_reduction=[0.5, 0.4], friction_reduction_uncertainty=[0.03, 0.0]))


def test_the_uncertainty_of_runs_is_at_least_that_of_their_digits() -> None:
    digits = [0.01, 0.03, 0.01, 0.03]
    stated = of(
        runs(
            friction_reduction=[0.5] * 4,
            friction_reduction_uncertainty=[0.02] * 4,
            friction_reduction_resolution=digits,
        )
    )
    assert stated.tested.uncertainty == approx([0.02, 0.03, 0.02, 0.03])
    equal = of(runs(friction_reduction=[0.5] * 4, friction_reduction_resolution=digits))
    assert equal.tested.uncertainty == approx(digits)
    assert any("less than the last digit that is written; 0.03 by the digits" in each for each in equal.caveats)
    unknown = of(runs(friction_reduction=[0.5] * 4))
    assert unknown.tested.uncertainty == approx([0.05] * 4)
    assert any("hold repeats that are equal in every digit; 0.05 is taken" in each for each in unknown.caveats)


def test_coefficients_without_vibration_and_the_uncertainty_of_the_load_give_the_dry_friction() -> None:
    coefficient = of(runs(friction_reduction=[0.5], intrinsic_friction_coefficient=[0.42])).friction
    assert (coefficient.value, coefficient.spread) == approx((0.42, 0.05))
    assert coefficient.reason == "coefficients of the runs without vibration"
    # a load of 4 N within 0.4 N is 10 % of the coefficient, which more runs do not lessen; alone 2 %
    force = of(
        runs(
            friction_reduction=[0.5, 0.5],
            intrinsic_friction_force=[1.2, 1.2],
            normal_load=[4.0, 4.0],
            normal_load_uncertainty=[0.4, 0.4],
            sliding_speed=[0.01, 0.02],
        )
    ).friction
    assert (force.value, force.spread) == approx((0.3, sqrt(0.02**2 + 0.1**2)))


@mark.parametrize(("stated", "is_said"), [(0.021, False), (0.019, True)])
def test_a_median_uncertainty_below_a_fiftieth_is_that_within_one_test(stated: float, is_said: bool) -> None:
    found = of(
        runs(
            friction_reduction=[0.5, 0.4, 0.3],
            friction_reduction_uncertainty=[stated, stated, 0.5],
            sliding_speed=[0.01, 0.02, 0.03],
        )
    )
    assert any("as of one test" in each for each in found.caveats) is is_said


def test_forces_without_vibration_give_the_coefficient_with_its_standard_error() -> None:
    # ln of 0.3, 0.4 and 0.36: geometric mean; deviation over sqrt(3)
    found = of(
        runs(
            friction_reduction=[0.5, 0.4, 0.3, 0.2],
            intrinsic_friction_force=[0.9, 1.6, 1.08, np.nan],
            normal_load=[3.0, 4.0, np.nan, 3.0],
            sliding_speed=[0.01, 0.02, 0.03, 0.04],
        )
    ).friction
    logs = np.log([0.3, 0.4, 0.36])
    assert found.name == "friction_coefficient"
    assert found.value == approx((0.3 * 0.4 * 0.36) ** (1 / 3))
    assert found.spread == approx(np.std(logs, ddof=1) / sqrt(3))
    one = of(runs(friction_reduction=[0.5], intrinsic_friction_force=[1.2])).friction
    assert one.value == approx(0.4)
    assert one.spread == approx(0.05)  # of a single ratio
    alike = of(
        runs(friction_reduction=[0.5, 0.4], intrinsic_friction_force=[1.2, 1.2], sliding_speed=[0.01, 0.02])
    ).friction
    assert alike.spread == approx(0.02)  # nothing is known better by a few runs
    assert exp(log(alike.value)) == approx(0.4)


def test_wear_of_runs_is_taken_where_it_is_stated_as_ratio_or_as_reduction() -> None:
    found = of(
        runs(
            friction_reduction=[0.5, 0.4, 0.3, 0.2],
            wear_rate_ratio=[np.nan, 0.7, np.nan, np.nan],
            wear_reduction=[0.4, 0.9, np.nan, -0.25],
            sliding_speed=[0.01, 0.02, 0.03, 0.04],
        )
    )
    assert found.wear_rate_ratio == approx([0.6, 0.7, 1.25])
    assert found.wear_runs.tolist() == [0, 1, 3]
    with raises(InvalidInput, match="wear with vibration over wear without must be positive in every run"):
        of(runs(friction_reduction=[0.5, 0.4], wear_reduction=[0.5, 1.0]))


@mark.parametrize(("degrees", "is_taken"), [(1.0, True), (1.3, False), (181.0, True), (90.0, False)])
def test_runs_within_the_plane_have_the_direction_of_the_rig_within_a_fiftieth(degrees: float, is_taken: bool) -> None:
    # sin 1 deg = 0.0175, sin 1.3 deg = 0.0227
    inputs = rig_inputs(read_rig(RIGS / "vibrating_base.toml"), takes_plane=True)
    data = runs(friction_reduction=[0.5, 0.5], vibration_direction=[np.nan, np.deg2rad(degrees)])
    if is_taken:
        assert own_runs(data, inputs, title="own").tested.friction_ratio.size == 2
    else:
        with raises(InvalidInput, match="leave out runs in other directions"):
            own_runs(data, inputs, title="own")
