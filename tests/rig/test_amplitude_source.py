"""One amplitude for every command: measured first, then computed, then per volt, and the same friction everywhere."""

import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

from sonolube.design import MAPS, grid_plan, map_kinds, sweep
from sonolube.design.control import computed_characteristic
from sonolube.errors import InvalidInput
from sonolube.models.friction import BoundaryLubricant
from sonolube.rig import (
    VOLTAGE,
    Rig,
    available_sources,
    friction_point,
    lubrication_point,
    operating_points,
    point_batch,
    read_rig,
    rig_from,
    simulate,
    steady_vibration,
    temperature_point,
    thermal_solid,
)
from sonolube.rig.amplitude_source import VIBRATIONS
from sonolube.rig.record import MeasuredUnder
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.simulation import vibrated_friction

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = RIGS / "tribometer.toml"
USES = [(path.stem, source) for path in sorted(RIGS.glob("*.toml")) for source in available_sources(read_rig(path))]
VARIED = [
    (name, source)
    for name, source in USES
    if (drive := read_rig(RIGS / f"{name}.toml").drive) and drive.voltage_peak_to_peak
]
CLOSE = 1e-6


def chosen(name: str, source: str, *changes: str) -> Rig:
    return read_rig(RIGS / f"{name}.toml", changes=[f"vibration.amplitude_source={source}", *changes])


@cache
def ratio_of(name: str, source: str) -> float:
    return friction_point(chosen(name, source)).friction_ratio


def volts_of(rig: Rig) -> float:
    assert rig.drive is not None
    assert rig.drive.voltage_peak_to_peak is not None
    return rig.drive.voltage_peak_to_peak


def test_a_computed_amplitude_stands_where_the_measured_one_is_of_another_structure() -> None:
    heavier = (
        "structure.tip_mass=175 g",
        "drive.frequency=17.6 kHz",
    )  # with which the stack cannot give 2.5 um at 22 kHz
    with raises(InvalidInput, match="or choose the amplitude computed"):
        friction_point(chosen("tribometer", "measured", *heavier))
    alone = dict(chosen("tribometer", "computed", *heavier).content())
    alone |= {"vibration": {"amplitude_source": "computed"}, "assumptions": {}}
    expected = friction_point(rig_from(alone)).friction_ratio
    assert friction_point(chosen("tribometer", "computed", *heavier)).friction_ratio == approx(expected, rel=1e-12)


@pytest.mark.parametrize(("name", "source"), USES)
def test_friction_simulate_and_many_points_agree(name: str, source: str) -> None:
    rig, expected = chosen(name, source), ratio_of(name, source)
    assert 0 < expected < 1
    assert simulate(rig).friction.friction_ratio == approx(expected, rel=CLOSE)
    assert float(operating_points(rig).friction_ratio) == approx(expected, rel=CLOSE)
    assert point_batch(rig).numbers["friction_ratio"][0] == approx(expected, rel=CLOSE)
    vibrated = vibrated_friction(rig, sliding_speed=rig.sliding_speed)
    assert float(vibrated.ratio.friction_ratio) == approx(expected, rel=CLOSE)


@pytest.mark.parametrize(("name", "source"), USES)
def test_regime_and_thermal_take_the_friction_of_friction(name: str, source: str) -> None:
    rig, expected = chosen(name, source), ratio_of(name, source)
    steel = thermal_solid("stainless_steel_316")
    warm = temperature_point(rig, pin=steel, disc=steel, heat_capacity=1.5, thermal_conductance=0.05, duration=1.0)
    assert warm.friction_ratio == approx(expected, rel=CLOSE)
    assert warm.amplitude_source == source
    oil = BoundaryLubricant(film_coefficient=0.1, full_asperity_pressure=1e7)
    wet = lubrication_point(rig, lubricant=oil)
    assert wet.coefficients.ultrasonic / wet.coefficients.dry == approx(expected, rel=CLOSE)
    assert wet.amplitude_source == source


@pytest.mark.parametrize(("name", "source"), USES)
def test_a_sweep_at_the_rigs_own_point_has_its_friction(name: str, source: str) -> None:
    rig = chosen(name, source)
    plan = grid_plan(
        RIGS / f"{name}.toml",
        over={"sliding.sliding_speed": [rig.sliding_speed]},
        changes=[f"vibration.amplitude_source={source}"],
    )
    swept = sweep(plan)
    assert float(swept["friction_ratio"][0]) == approx(ratio_of(name, source), rel=CLOSE)
    assert swept.attrs["amplitude_source"] == source
    assert swept.attrs["caveats"] == "\n".join(friction_point(rig).caveats)


@pytest.mark.parametrize("kind", map_kinds(VOLTAGE))
@pytest.mark.parametrize(("name", "source"), VARIED)
def test_a_map_at_the_rigs_own_point_has_its_friction(name: str, source: str, kind: str) -> None:
    rig = chosen(name, source)
    volts = volts_of(rig)
    assert rig.drive is not None
    own = {
        "sliding_speed": [rig.sliding_speed],
        "normal_load": [rig.normal_load],
        "voltage_peak_to_peak": [volts],
        "frequency": [rig.drive.frequency],
    }
    axes = {key: own[key] for key in own if (key == "frequency") == (kind == "frequency-voltage")}
    mapped = MAPS[kind](rig, **axes | {"voltage_peak_to_peak": [volts]})
    assert 1 - float(mapped["friction_reduction"].values.item()) == approx(ratio_of(name, source), rel=CLOSE)
    assert mapped.attrs["amplitude_source"] == source


@pytest.mark.parametrize(("name", "source"), VARIED)
def test_the_characteristic_of_control_ends_at_the_rigs_own_friction(name: str, source: str) -> None:
    rig = chosen(name, source)
    plant = computed_characteristic(rig, level_maximum=volts_of(rig), points=2)
    expected = ratio_of(name, source) * rig.friction_coefficient * rig.normal_load
    assert plant.lowest_force == approx(expected, rel=CLOSE)


def test_a_measured_amplitude_comes_first_then_a_computed_one_then_one_per_volt() -> None:
    rig = read_rig(TRIBOMETER)
    assert available_sources(rig) == ("measured", "computed", "per-volt")
    assert friction_point(rig).amplitude_source == "measured"
    assert friction_point(replace(rig, vibration_amplitude=None)).amplitude_source == "computed"
    assert friction_point(read_rig(RIGS / "collar.toml")).amplitude_source == "per-volt"


def test_the_computed_motion_of_a_measured_amplitude_has_that_amplitude_under_the_drive_of_the_measurement() -> None:
    assert steady_vibration(read_rig(TRIBOMETER)).vibration_amplitude == approx(2.5e-6, rel=1e-9)
    halved = chosen("tribometer", "measured", "vibration.vibration_amplitude=1.25um")
    assert steady_vibration(halved).vibration_amplitude == approx(1.25e-6, rel=1e-9)
    driven = resolved_rig(halved).vibration.driven
    assert driven is not None
    assert driven.calibration == approx(0.5, rel=5e-3)  # the tip is nearly linear in the drive


def test_a_measured_amplitude_is_proportional_to_the_voltage_where_nothing_is_computed() -> None:
    changes = ["vibration.vibration_amplitude=2um", "vibration.voltage_peak_to_peak=4V"]
    rig = read_rig(RIGS / "flextensional.toml", changes=[*changes, "drive.voltage_peak_to_peak=2V"])
    assert friction_point(rig).vibration_amplitude == approx(1e-6)
    assert operating_points(rig, voltage_peak_to_peak=[1.0, 4.0]).vibration_amplitude == approx([0.5e-6, 2e-6])


def test_a_stated_amplitude_holds_at_its_own_frequency_only() -> None:
    points = operating_points(read_rig(RIGS / "collar.toml"), frequency=[25e3, 30e3])
    assert points.status.tolist() == ["periodic", "refused"]
    assert "holds at 25 kHz only: choose the amplitude computed" in str(points.reason[1])


def test_a_measured_amplitude_holds_for_a_structure_at_any_drive_and_for_a_sine_at_its_own_frequency() -> None:
    elsewhere = chosen("tribometer", "measured", "drive.frequency=21kHz", "vibration.frequency=22kHz")
    assert available_sources(elsewhere)[0] == "measured"
    sine = ["vibration.vibration_amplitude=2um", "vibration.voltage_peak_to_peak=4V"]
    own = read_rig(RIGS / "flextensional.toml", changes=sine)
    assert available_sources(own) == ("measured", "per-volt")
    assert own.drive is not None
    for factor, sources in ((1 + 5e-7, ("measured", "per-volt")), (1 + 2e-6, ("per-volt",))):
        moved = replace(own, drive=replace(own.drive, frequency=factor * own.drive.frequency))
        stated = replace(moved, measured_under=MeasuredUnder(voltage_peak_to_peak=4.0, frequency=own.drive.frequency))
        assert available_sources(stated) == sources
    assert available_sources(replace(own, drive=None, amplitude_per_volt=None)) == ("measured",)


def test_a_rig_without_the_voltage_of_its_measurement_has_its_amplitude_at_every_voltage() -> None:
    rig = read_rig(RIGS / "flextensional.toml", changes=["vibration.vibration_amplitude=2um"])
    sine = VIBRATIONS["measured"](rig)
    assert sine.source == "measured"
    assert sine.sine_amplitude == approx(2e-6)
    assert volts_of(rig) > 0
    assert sine.per_volt == approx(2e-6 / volts_of(rig))  # its own voltage, where none is stated
    assert sine.amplitude_at(3.0) == approx(6e-6 / volts_of(rig))
    assert rig.drive is not None
    without = replace(rig, drive=replace(rig.drive, voltage_peak_to_peak=None))
    held = VIBRATIONS["measured"](without)
    assert held.per_volt is None
    assert held.amplitude_at(3.0) == approx(2e-6)


def test_a_source_that_the_rig_lacks_is_refused_with_those_that_it_has() -> None:
    with raises(InvalidInput, match=r"no amplitude computed: give the tables stack and structure.*; it has per-volt"):
        friction_point(chosen("flextensional", "computed"))
    with raises(InvalidInput, match=r"no amplitude measured: give vibration\.vibration_amplitude"):
        friction_point(chosen("flextensional", "measured"))


def test_amplitudes_that_differ_by_more_than_their_error_are_told_in_one_line() -> None:
    apart = friction_point(chosen("tribometer", "computed", "actuator.amplitude_per_volt=0.2um/V")).caveats
    (line,) = (caveat for caveat in apart if "amplitudes differ" in caveat)
    assert "computed 2.5 um, taken here, and per-volt 5.6 um" in line
    assert not any("amplitudes differ" in caveat for caveat in friction_point(read_rig(TRIBOMETER)).caveats)


def test_beyond_the_gap_at_rest_wear_is_by_the_model_that_holds_and_says_so() -> None:
    from sonolube.rig import wear_point

    rig = read_rig(RIGS / "welder_flat.toml")
    wear = wear_point(rig)
    assert wear.wear_model == "dong_2015_load_balanced"
    same(wear.wear_rate_ratio, wear_point(rig, model="dong_2015_load_balanced").wear_rate_ratio)
    assert wear.reason is None
    assert any(
        "exceeds the gap at rest" in caveat and "half_period has no meaning" in caveat for caveat in wear.caveats
    )


def test_a_wear_model_that_was_asked_for_has_no_number_beyond_the_gap_at_rest() -> None:
    from sonolube.rig import wear_point

    wear = wear_point(read_rig(RIGS / "welder_flat.toml"), model="dong_2015_half_period")
    assert np.isnan(wear.wear_rate_ratio)
    assert wear.status == "outside_model_range"
    assert "exceeds the gap at rest" in (wear.reason or "")
    assert "dong_2015_load_balanced holds: ratio 0.6" in (wear.reason or "")
    assert "smaller amplitude" not in " ".join(wear.caveats)


def test_the_balance_of_energy_says_which_power_is_which() -> None:
    result = simulate(read_rig(TRIBOMETER))
    assert result.friction.power is not None
    assert result.friction.power.power_to_supply == result.vibration.dissipated_power
    assert "6.21 W charges the actuator's capacitance alone" in (result.energy_balance or "")
    assert "must supply the larger" in (result.energy_balance or "")


def held_by_a_spring(held: str, *left_out: str) -> Rig:
    """Tribometer as a chain with a spring to the ground, by which the mean voltage moves its contact."""
    chain = {
        "kind": "chain",
        "masses": {"tip": "0.1093 kg", "reaction": "2.41 kg", "arm": "602 g"},
        "springs": [
            {"between": ["reaction", "arm"], "spring_stiffness": "4.56e5 N/m"},
            {"between": [held, "ground"], "spring_stiffness": "1e6 N/m"},
        ],
        "dampers": [{"between": ["tip", "ground"], "viscous_damping": "702 N s/m"}],
        "stack_between": ["tip", "reaction"],
        "contact": "tip",
        "loaded": "arm",
    }
    content = tomllib.loads(TRIBOMETER.read_text(encoding="utf-8")) | {"structure": chain}
    return rig_from({name: table for name, table in content.items() if name not in ("assumptions", *left_out)})


@pytest.mark.parametrize("held", ["tip", "reaction", "arm"])
def test_a_measured_amplitude_is_that_under_the_mean_voltage_too_where_it_moves_the_contact(held: str) -> None:
    assert steady_vibration(held_by_a_spring(held)).vibration_amplitude == approx(2.5e-6, rel=1e-6)


@pytest.mark.parametrize("held", ["tip", "reaction", "arm"])
def test_many_points_agree_where_springs_to_the_ground_carry_a_part_of_the_load(held: str) -> None:
    rig = held_by_a_spring(held, "vibration")
    assert abs(np.mean(steady_vibration(rig).motions[0].normal_force) / rig.normal_load - 1) > 0.01
    expected = friction_point(rig).friction_ratio
    assert point_batch(rig).numbers["friction_ratio"] == approx(expected, rel=CLOSE)
