"""Friction outside the range of its model: one status, everywhere that a rig's friction is computed."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design import grid_plan, propagate, sweep, velocity_stress_map
from sonolube.errors import OutsideRange
from sonolube.models.friction import FRICTION_MODELS, BoundaryLubricant
from sonolube.rig import (
    STATUSES,
    Rig,
    friction_point,
    least_power_study,
    lubrication_point,
    operating_points,
    point_batch,
    read_rig,
    simulate,
    speed_study,
    temperature_point,
    thermal_solid,
    voltage_study,
    wear_point,
)
from sonolube.rig.responses import simulation_arrays
from sonolube.rig.simulation import _raised_wear
from sonolube.tasks.predict.new import new

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = read_rig(RIGS / "tribometer.toml")
OUTSIDE = "outside_model_range"
FRICTION = ("friction_ratio", "friction_reduction", "friction_coefficient", "friction_force")
STRONG: Any = {"voltage_peak_to_peak": 100.0, "voltage_offset": 50.0}
STRONG_CHANGES = ("drive.voltage_peak_to_peak=100V", "drive.voltage_offset=50V", "sliding.sliding_speed=0.3m/s")


def printed(*changes: str) -> Rig:
    """Return the tribometer with D 3.46 to 3.48 as printed, whose ratio rises above 1 under strong vibration."""
    return read_rig(RIGS / "tribometer.toml", changes=("friction.model=dong_2015_full_period", *changes))


def test_friction_above_mu_times_the_load_has_a_status_and_no_number() -> None:
    point = friction_point(printed("sliding.sliding_speed=1m/s"))
    assert point.status == OUTSIDE
    assert point.reason is not None
    assert "beyond the Coulomb limit" in point.reason
    assert all(np.isnan(getattr(point, name)) for name in FRICTION)
    assert point.raw_friction_ratio > 1
    assert point.intrinsic_friction_force == approx(0.341 * 3)


def test_where_friction_has_no_ratio_wear_has_none_for_the_same_reason() -> None:
    rig = printed("sliding.sliding_speed=1m/s")  # within the range of the wear model
    friction, wear = friction_point(rig), wear_point(rig, model="dong_2015_half_period")
    assert (wear.status, wear.reason) == (OUTSIDE, friction.reason)
    assert wear.wear_model != friction.friction_model
    assert all(np.isnan(getattr(wear, name)) for name in ("wear_rate", "wear_rate_ratio", "wear_reduction"))
    assert wear.raw_wear_rate_ratio > 0


def test_an_amplitude_beyond_the_heights_of_the_contact_gives_wear_the_status_of_friction() -> None:
    # exponential heights of 30 nm, over which the force rises by more than a float holds at 25 um closer
    known = new(pin="m50", disc="m50", load="5N", speed="0.2m/s", frequency="20kHz", amplitude="50um").rig
    rig = replace(known, contact=replace(known.contact, decay_length=30e-9))
    friction, wear = friction_point(rig), wear_point(rig)
    assert friction.status == wear.status == OUTSIDE
    assert "separation must lie between" in (wear.reason or "")
    assert wear.intrinsic_wear_rate > 0
    assert np.isnan(wear.wear_rate_ratio)


def test_a_wear_ratio_above_one_is_said_and_one_of_one_is_not() -> None:
    assert _raised_wear(1.0) == ()
    (line,) = _raised_wear(1.5)
    assert line.startswith("wear ratio 1.5 is above 1: by this model the vibration raises wear")
    assert "0.27 to 1.0" in line  # M50 on itself, and steel on titanium: D Tables 2.14


def test_friction_within_the_range_keeps_its_number() -> None:
    point = friction_point(TRIBOMETER)
    assert (point.status, point.reason) == ("computed", None)
    assert point.friction_ratio == point.raw_friction_ratio


def test_a_simulation_keeps_the_vibration_and_withholds_friction_and_wear_of_the_model() -> None:
    result = simulate(printed(*STRONG_CHANGES))
    assert (result.status, result.vibration.status) == (OUTSIDE, "periodic")
    assert result.reason.startswith(f"{OUTSIDE}: dong_2015_full_period")
    assert result.vibration.vibration_amplitude > 8e-6
    assert all(np.isnan(getattr(result.friction, name)) for name in FRICTION)
    assert np.isnan(result.wear.wear_rate)
    assert result.friction.raw_friction_ratio > 1
    assert simulation_arrays(printed(*STRONG_CHANGES), result).attrs["status"] == OUTSIDE


@pytest.mark.parametrize("model", [name for name in FRICTION_MODELS if not FRICTION_MODELS[name].for_soft_bodies])
def test_single_points_grids_and_batches_agree(model: str) -> None:
    rig = replace(TRIBOMETER, friction_model=FRICTION_MODELS[model]())
    rng = np.random.default_rng(3)
    volts, load, speed = rng.uniform(1, 90, 30), rng.uniform(1, 6, 30), rng.uniform(0.005, 0.4, 30)
    settings: Any = {
        "voltage_peak_to_peak": volts,
        "voltage_offset": volts / 2,
        "normal_load": load,
        "sliding_speed": speed,
    }
    grid, batch = operating_points(rig, **settings), point_batch(rig, **settings)
    assert grid.status.tolist() == [STATUSES[code] for code in batch.status]
    for name in FRICTION:
        assert getattr(grid, name) == approx(batch.numbers[name], abs=3e-4, nan_ok=True)
    assert np.all((grid.status == OUTSIDE) == np.isnan(grid.friction_ratio))
    assert np.all(grid.friction_ratio[grid.status != OUTSIDE] <= 1 + 3e-4)
    assert not np.isnan(grid.raw_friction_ratio).any()
    assert rig.drive is not None
    for i in (0, 11):
        one = replace(
            rig,
            normal_load=load[i],
            sliding_speed=speed[i],
            drive=replace(rig.drive, voltage_peak_to_peak=volts[i], voltage_offset=volts[i] / 2),
        )
        found = simulate(one)
        assert found.status == grid.status[i]
        assert found.friction.raw_friction_ratio == approx(grid.raw_friction_ratio[i], abs=3e-4)


def test_the_batch_gives_points_outside_one_reason_with_advice() -> None:
    batch = point_batch(printed(), sliding_speed=np.linspace(0.05, 3, 40), **STRONG)
    outside = batch.status == STATUSES.index(OUTSIDE)
    assert outside.any()
    assert {batch.reasons[code] for code in batch.reason[outside]} == {friction_reason()}
    assert len(set(batch.reasons)) == len(batch.reasons)


def friction_reason() -> str:
    found = operating_points(printed(), sliding_speed=3.0, **STRONG)
    return str(found.reason)


def test_sweeps_and_maps_mask_the_points_outside() -> None:
    plan = grid_plan(
        RIGS / "tribometer.toml",
        over={"sliding.sliding_speed": [0.01, 3.0]},
        changes=("friction.model=dong_2015_full_period", *STRONG_CHANGES[:2]),
    )
    swept = sweep(plan)
    names = swept["status"].attrs["flag_meanings"].split()
    assert [names[code] for code in swept["status"].values] == ["periodic", OUTSIDE]
    assert np.isnan(swept["friction_force"].values).tolist() == [False, True]
    assert swept["raw_friction_ratio"].values[1] > 1
    mapped = velocity_stress_map(printed(), sliding_speed=[0.01, 3.0], normal_load=[3.0], voltage_peak_to_peak=[100.0])
    assert mapped["status"].values.ravel().tolist() == ["periodic", OUTSIDE]
    assert np.isnan(mapped["friction_reduction"].values.ravel()).tolist() == [False, True]


def test_studies_over_one_quantity_mask_the_points_outside() -> None:
    for study in (
        voltage_study(printed(), voltage_peak_to_peak=[1.0, 200.0]),
        speed_study(printed(), sliding_speed=[0.005, 3.0], voltage_peak_to_peak=100.0),
    ):
        assert study["status"].values.ravel().tolist() == ["periodic", OUTSIDE]
        assert np.isnan(study["friction_ratio"].values.ravel()).tolist() == [False, True]


def test_a_voltage_is_not_found_for_a_friction_outside_the_range() -> None:
    found = least_power_study(printed("sliding.sliding_speed=1m/s"), frequency=[22e3], friction_ratio=0.5)
    assert found["status"].values.tolist() == [OUTSIDE]
    assert np.isnan(found["voltage_peak_to_peak"].values).all()


@pytest.mark.parametrize(
    ("rig", "speeds"),
    [
        ("tribometer", "5 mm/s to 200 mm/s"),  # with a computed vibration
        ("flextensional", "5 mm/s to 2 m/s"),  # with a stated one
    ],
)
def test_samples_outside_count_as_such(rig: str, speeds: str, tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    table = f'\n[uncertainty]\n"sliding.sliding_speed" = "uniform {speeds}"\n'
    text = re.sub(r"\[uncertainty\][^\[]*", "", (RIGS / f"{rig}.toml").read_text(encoding="utf-8"))
    path.write_text(text + table, encoding="utf-8")
    found = propagate(path, samples=32, changes=("friction.model=dong_2015_full_period",))
    outside = found["status"].values == found["status"].attrs["flag_meanings"].split().index(OUTSIDE)
    assert 0 < outside.sum() < 32
    assert np.isnan(found["friction_ratio"].values).tolist() == outside.tolist()
    reasons = found["reason_text"].values[found["reason"].values[outside]]
    assert all("beyond the Coulomb limit" in str(text) for text in reasons)


def test_heat_and_lubrication_refuse_a_friction_that_has_no_meaning() -> None:
    rig = printed("sliding.sliding_speed=1m/s")
    with raises(OutsideRange, match="beyond the Coulomb limit"):
        lubrication_point(rig, lubricant=BoundaryLubricant(film_coefficient=0.25, full_asperity_pressure=10e6))
    with raises(OutsideRange, match="beyond the Coulomb limit"):
        temperature_point(
            rig,
            pin=thermal_solid("stainless_steel_316"),
            disc=thermal_solid("aluminium_2024"),
            heat_capacity=1.0,
            thermal_conductance=0.1,
            duration=10.0,
        )
