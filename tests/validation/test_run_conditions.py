"""Own runs as conditions: repeats, settings of the rig, motions by direction, and what is refused, by hand."""

from dataclasses import replace
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.rig import Rig, read_rig
from sonolube.validation.run_conditions import RunConditions, RunsTable, known_amplitudes, run_conditions

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


def table(rig: Rig | None = None, **columns: Any) -> RunsTable:
    data = {name: ("run", np.asarray(values, float)) for name, values in columns.items()}
    return run_conditions(xr.Dataset(data, attrs={"title": "own, in %"}), rig)


def test_a_rig_gives_what_the_runs_do_not_state() -> None:
    found = table(tribometer(), friction_reduction=[0.5], voltage_peak_to_peak=[14.0])
    (one,) = found.conditions
    assert found.title == "own"
    assert found.runs == 1
    assert found.scatter is None
    assert one.normal_load == approx(3.0)
    assert one.friction_coefficient == approx(0.341)
    assert one.sliding_speed == approx(20.3e-3)
    assert one.frequency == approx(22e3)
    assert one.vibration_amplitude == approx(1.25e-6)  # half of 28 V: half of 2.5 um
    assert one.vibration_velocity is None
    assert one.vibration_direction is None
    assert one.contact is tribometer().contact or one.contact == tribometer().contact
    assert one.uncertainty is None
    assert one.label == one.settings == "1.25 um, 20.3 mm/s"
    still = table(replace(tribometer(), sliding_speed=0.0), friction_reduction=[0.5], vibration_amplitude=[1e-6])
    assert still.conditions[0].sliding_speed is None


def test_settings_within_a_hundredth_are_one_condition_of_the_first_run() -> None:
    found = table(
        friction_reduction=[0.5, 0.4, 0.6, 0.2, 0.1],
        vibration_amplitude=[1e-6, 1.009e-6, 1.011e-6, 1e-6, 1e-6],
        sliding_speed=[0.1, 0.1, 0.1, 0.1, 0.1015],
        normal_load=[3, 3, 3, 3.02, 3],
        friction_reduction_uncertainty=[0.03, 0.04, 0.05, 0.06, 0.02],
    )
    assert [one.repeats for one in found.conditions] == [3, 1, 1]
    first, second, third = found.conditions
    assert first.friction_ratio == approx((0.5 + 0.6 + 0.8) / 3)
    assert (second.friction_ratio, third.friction_ratio) == approx((0.4, 0.9))
    assert first.vibration_amplitude == approx(1e-6)
    assert (second.vibration_amplitude, third.sliding_speed) == approx((1.011e-6, 0.1015))
    # repeats of ratios 0.5, 0.6 and 0.8 about 0.6333: the scatter is of two degrees of freedom
    scatter = sqrt(((0.5 - 1.9 / 3) ** 2 + (0.6 - 1.9 / 3) ** 2 + (0.8 - 1.9 / 3) ** 2) / 2)
    assert found.scatter == approx(scatter)
    assert [one.uncertainty for one in found.conditions] == approx([scatter / sqrt(3), scatter, scatter])


def test_the_mean_of_repeats_is_no_better_known_than_its_digits() -> None:
    settings: dict[str, Any] = {
        "friction_reduction": [0.5, 0.5, 0.5, 0.3],
        "vibration_amplitude": [1e-6, 1e-6, 1e-6, 2e-6],
    }
    found = table(**settings, friction_reduction_resolution=[0.003, 0.003, 0.003, 0.004])
    assert [one.uncertainty for one in found.conditions] == approx([0.003, 0.004])
    assert table(**settings).conditions[0].uncertainty is None


def test_a_coefficient_without_vibration_is_that_of_its_condition() -> None:
    found = table(
        tribometer(), friction_reduction=[0.5], vibration_amplitude=[1e-6], intrinsic_friction_coefficient=[0.42]
    )
    assert found.conditions[0].friction_coefficient == approx(0.42)


def test_without_repeats_the_stated_uncertainty_of_each_run_is_that_of_its_condition() -> None:
    found = table(
        friction_reduction=[0.5, 0.4], vibration_amplitude=[1e-6, 2e-6], friction_reduction_uncertainty=[0.03, np.nan]
    )
    assert found.conditions[0].uncertainty == approx(0.03)
    assert found.conditions[1].uncertainty is None


def test_the_coefficient_is_that_of_the_forces_of_each_condition_or_the_mean_of_the_others() -> None:
    found = table(
        tribometer(),
        friction_reduction=[0.5, 0.4, 0.3],
        vibration_amplitude=[1e-6, 1e-6, 2e-6],
        normal_load=[3.0, 3.0, np.nan],
        intrinsic_friction_force=[0.9, 1.5, np.nan],
    )
    assert [one.friction_coefficient for one in found.conditions] == approx([0.4, 0.4])
    alone = table(friction_reduction=[0.5], vibration_amplitude=[1e-6])
    assert alone.conditions[0].friction_coefficient is None
    assert alone.conditions[0].normal_load is None
    assert alone.conditions[0].contact is None
    assert alone.conditions[0].holder_stiffness is None


def test_velocity_and_amplitude_follow_from_each_other_by_the_frequency() -> None:
    along = table(
        friction_reduction=[0.5, 0.4],
        vibration_velocity=[0.2, np.nan],
        vibration_amplitude=[np.nan, 3e-6],
        vibration_direction=[0.0, pi],
        frequency=[1e4, 2e4],
    ).conditions
    assert [one.vibration_velocity for one in along] == approx([0.2, 2 * pi * 2e4 * 3e-6])
    assert [one.in_plane_amplitude for one in along] == approx([0.2 / (2 * pi * 1e4), 3e-6])
    assert [one.vibration_amplitude for one in along] == [None, None]
    across = table(friction_reduction=[0.5], vibration_velocity=[0.2], vibration_direction=[1.2], frequency=[1e4])
    assert across.conditions[0].in_plane_amplitude is None
    assert across.conditions[0].vibration_velocity == approx(0.2)
    normal = table(friction_reduction=[0.5], vibration_velocity=[0.2], frequency=[1e4]).conditions[0]
    assert normal.vibration_amplitude == approx(0.2 / (2 * pi * 1e4))
    assert normal.in_plane_amplitude is None
    unknown = table(friction_reduction=[0.5], vibration_velocity=[0.2], vibration_direction=[0.0]).conditions[0]
    assert unknown.in_plane_amplitude is None
    assert unknown.label == "200 mm/s"


def test_the_direction_of_the_rig_is_that_of_runs_that_state_none() -> None:
    base = read_rig(RIGS / "vibrating_base.toml")
    (one,) = table(base, friction_reduction=[0.5]).conditions
    assert one.vibration_direction == approx(0.0)
    assert one.in_plane_amplitude == approx(0.3523e-6)
    assert one.vibration_velocity == approx(2 * pi * 3e3 * 0.3523e-6)


def test_a_holder_of_the_rig_enters_where_it_is_compliant() -> None:
    for model, stiffness in (("bristle_with_holder", 2e5), ("asperity_stick_slip", None)):
        changes = [f"friction.model={model}"] + ([f"friction.holder_stiffness={stiffness} N/m"] if stiffness else [])
        (one,) = table(tribometer(*changes), friction_reduction=[0.5]).conditions
        assert one.holder_stiffness == (None if stiffness is None else approx(2e5))
    (rigid,) = table(tribometer("friction.model=bristle_with_holder"), friction_reduction=[0.5]).conditions
    assert rigid.holder_stiffness is None


def test_conditions_at_another_strength_keep_the_ratio_of_their_motions() -> None:
    one = RunConditions(
        label="", set_name="a", friction_ratio=0.5, uncertainty=None, repeats=1,
        vibration_velocity=0.2, in_plane_amplitude=3e-6, sliding_speed=0.1,
    )  # fmt: skip
    assert one.strength == approx(0.2)
    twice = one.at(strength=0.4, sliding_speed=0.3)
    assert (twice.vibration_velocity, twice.in_plane_amplitude, twice.sliding_speed) == approx((0.4, 6e-6, 0.3))
    assert twice.vibration_amplitude is None
    normal = replace(one, vibration_amplitude=2e-6)
    assert normal.strength == approx(2e-6)
    assert normal.at(strength=1e-6).vibration_velocity == approx(0.1)
    assert one.at(sliding_speed=0.7).vibration_velocity == approx(0.2)
    assert one.at() == one
    still = replace(one, vibration_velocity=None)
    assert still.at(strength=1.0, sliding_speed=0.2) == replace(still, sliding_speed=0.2)
    assert replace(still, sliding_speed=None).settings == ""


def test_twelve_groups_of_conditions_are_left_out_in_turn_and_unlabelled_ones_are_numbered() -> None:
    found = table(friction_reduction=[0.5] * 14, normal_load=np.arange(1.0, 15.0)).conditions
    names = [one.set_name for one in found]
    assert len(set(names)) == 12
    assert names[12:] == names[:2]
    assert [one.label for one in found[:2]] == ["condition 1", "condition 2"]
    assert not set("".join(names)) & set("ABCDEFGHL")


def test_unknown_amplitudes_are_in_proportion_to_the_voltage_or_those_of_the_rig() -> None:
    found = known_amplitudes(
        np.array([1e-6, np.nan, np.nan]), np.array([10.0, 5.0, np.nan]), np.array([False, True, True]),
        own=4e-6, per_volt=0.2e-6,
    )  # fmt: skip
    assert found == approx([1e-6, 1e-6, 4e-6])
    with raises(InvalidInput, match=r"add one pair of them, such as --set vibration\.calibration="):
        known_amplitudes(np.array([np.nan]), np.array([5.0]), np.array([True]), own=4e-6, per_volt=None)
    assert known_amplitudes(
        np.array([np.nan]), np.array([np.nan]), np.array([True]), own=4e-6, per_volt=None
    ) == approx([4e-6])


@pytest.mark.parametrize("name", ["vibration_velocity", "frequency", "sliding_speed", "normal_load"])
def test_a_setting_that_is_not_positive_is_refused_with_its_run(name: str) -> None:
    with raises(InvalidInput, match=f"own: {name} of run 2 must be positive"):
        table(None, friction_reduction=[0.5, 0.4, 0.3], **{name: [1.0, 0.0, -1.0]})


def test_a_thousand_runs_are_fitted_and_one_more_is_refused() -> None:
    assert table(friction_reduction=[0.5] * 1000).runs == 1000
    with raises(InvalidInput, match="own: 1001 runs; at most 1000 are fitted"):
        table(friction_reduction=[0.5] * 1001)
