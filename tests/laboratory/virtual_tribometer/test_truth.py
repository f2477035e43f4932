"""Truth of a virtual test: levels of friction by the rig's own models, temperatures by the law of first order."""

from dataclasses import replace
from math import exp, nan, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from tests.same import approx

from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, FrictionDraw
from sonolube.laboratory.virtual_tribometer.signals import Bursts, StickSlip
from sonolube.laboratory.virtual_tribometer.truth import FrictionLevel, Temperatures, TruthSetting, truth_dataset
from sonolube.models.thermal import EllipticSource, contact_rise
from sonolube.models.wear import cube_wear_rate
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.posterior import learned
from sonolube.prediction.within_plane import plane_posterior
from sonolube.rig import read_rig, simulate, thermal_solid

RIG_FILE = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
RIG = read_rig(RIG_FILE)
DRIVE = DriveSetting(voltage_peak_to_peak=25.9, frequency=22e3, voltage_offset=12.95)


@pytest.fixture(scope="module")
def draw() -> FrictionDraw:
    return FrictionDraw(RIG, seed=3)


def volts(peak_to_peak: float) -> DriveSetting:
    return replace(DRIVE, voltage_peak_to_peak=peak_to_peak, voltage_offset=peak_to_peak / 2)


def test_without_vibration_friction_is_the_coefficient_times_the_load_and_wear_that_of_the_cube(
    draw: FrictionDraw,
) -> None:
    for load in (5.0, 8.0):
        worn = float(cube_wear_rate(RIG.contact, normal_load=load))
        found = draw.at(None, 0.1, normal_load=load)
        assert found == FrictionLevel(approx(draw.friction_coefficient * load), 1.0, 0.0, approx(worn))
    assert draw.at(None, 0.1) == draw.at(None, 0.0, normal_load=5.0)  # the load of the rig by default
    at_rest = draw.at(DRIVE, 0.0)
    assert (at_rest.friction_force, at_rest.friction_ratio) == (approx(5 * draw.friction_coefficient), 1.0)
    assert np.isnan(at_rest.vibration_amplitude)
    assert at_rest.wear_rate > 0
    lifted = draw.at(DRIVE, 0.1, normal_load=0.0)
    assert (lifted.friction_force, lifted.friction_ratio, lifted.wear_rate) == (0.0, 1.0, 0.0)


def test_with_vibration_amplitude_and_wear_are_those_of_the_rig_at_that_setting_and_load(draw: FrictionDraw) -> None:
    assert RIG.drive is not None
    found = draw.at(volts(20.0), 0.05, normal_load=4.0)
    drive = replace(RIG.drive, voltage_peak_to_peak=20.0, voltage_offset=10.0, frequency=22e3, waveform="sine")
    at = simulate(replace(RIG, drive=drive, sliding_speed=0.05, normal_load=4.0))
    assert found.vibration_amplitude == approx(at.friction.vibration_amplitude)
    assert found.wear_rate == approx(float(at.wear.wear_rate))
    assert 0.01 <= found.friction_ratio < 1
    assert found.friction_force == approx(found.friction_ratio * draw.friction_coefficient * 4.0)


def test_along_the_sliding_friction_lies_above_that_of_rigid_contacts_and_wears_as_without_vibration() -> None:
    assert RIG.drive is not None
    rig = read_rig(RIG_FILE, changes=["vibration.direction=along", "friction.model=coulomb"])
    draw = FrictionDraw(rig, seed=3)
    ratios = []
    for volt in (2.6, 10.4, 25.9):
        found = draw.at(volts(volt), 0.02)
        peak = 2 * np.pi * 22e3 * found.vibration_amplitude
        assert 2 / np.pi * np.arcsin(min(0.02 / peak, 1.0)) - 1e-9 <= found.friction_ratio <= 1
        assert found.wear_rate == approx(float(cube_wear_rate(rig.contact, normal_load=5.0)))
        ratios.append(found.friction_ratio)
    assert ratios == sorted(ratios, reverse=True)
    assert ratios[-1] < ratios[0]


@pytest.mark.parametrize("direction", ["normal", "along"])
def test_friction_is_drawn_from_own_evidence_in_its_direction(direction: str) -> None:
    # of lengths a thousand times the amplitude vibration does next to nothing
    normal, plane = learned().friction.hyperparameters.copy(), plane_posterior().hyperparameters.copy()
    normal[:, 1] += np.log(1e3)
    plane[:, 0] += np.log(1e4)
    evidence = EvidencePosterior(
        hyperparameters=normal, plane_hyperparameters=plane, fingerprint="1", shipped_fingerprint="2", sources=()
    )
    changes = [f"vibration.direction={direction}"] + (["friction.model=coulomb"] if direction == "along" else [])
    rig = read_rig(RIG_FILE, changes=changes)
    assert FrictionDraw(rig, seed=3, evidence=evidence).at(DRIVE, 0.02).friction_ratio > 0.9
    assert FrictionDraw(rig, seed=3).at(DRIVE, 0.02).friction_ratio < 0.8


def test_the_ratio_never_falls_below_a_hundredth() -> None:
    # fast vibration and slow sliding leave next to nothing of the friction
    ratios = [FrictionDraw(RIG, seed=seed).at(DRIVE, 2e-5).friction_ratio for seed in range(3)]
    assert min(ratios) >= 0.01


def test_levels_lie_on_the_line_between_two_voltages_within_two_percent_of_the_rigs_own() -> None:
    # 2 % of 25.9 V are 0.518 V
    draw, fresh = FrictionDraw(RIG, seed=3), FrictionDraw(RIG, seed=3)
    low, high = draw.at(volts(20.0), 0.0655), draw.at(volts(20.4), 0.0655)
    between = draw.at(volts(20.1), 0.0655)
    for name in FrictionLevel.__slots__:
        line = 0.75 * getattr(low, name) + 0.25 * getattr(high, name)
        assert getattr(between, name) == approx(line, rel=1e-12)
    far = draw.at(volts(21.0), 0.0655)
    assert draw.at(volts(20.7), 0.0655).vibration_amplitude == fresh.at(volts(20.7), 0.0655).vibration_amplitude
    assert draw.at(volts(30.0), 0.0655).vibration_amplitude > far.vibration_amplitude
    assert draw.at(volts(20.0), 0.0655) is low


def test_specimens_scatter_by_their_seed() -> None:
    coefficients = [FrictionDraw(RIG, seed=seed).friction_coefficient for seed in range(40)]
    assert len(set(coefficients)) == 40
    assert np.exp(np.mean(np.log(coefficients))) == approx(RIG.friction_coefficient, rel=0.15)


ASSUMED = HeatingAssumptions(
    pin_heat_capacity=2.0,
    pin_conductance=0.5,
    actuator_heat_capacity=12.0,
    actuator_conductance=0.4,
    loss_factor=0.1,
    ambient_temperature=300.0,
    pin_material="stainless_steel_304",
    disc_material="brass_c36000",
)
POWER = 2 * pi * 22e3 * 360e-9 * 25.9**2 / 8  # VA of a sine on the capacitance of the rig


def lagged(time: float, constant: float, lag: float) -> float:
    """Share that a sensor reads of a value that approaches its end, both of first order from zero."""
    return 1 - (constant * exp(-time / constant) - lag * exp(-time / lag)) / (constant - lag)


def flash(force: float, speed: float) -> tuple[float, float]:
    """Heat partition and mean flash rise by the model of the contact."""
    radius = sqrt(RIG.contact.nominal_area / pi)
    bodies = thermal_solid("stainless_steel_304"), thermal_solid("brass_c36000")
    source = EllipticSource(half_length=radius, half_width=radius)
    found = contact_rise(*bodies, source, heat_rate=force * speed, sliding_speed=speed)
    return float(found.heat_partition), float(found.mean_temperature_rise)


def test_actuator_pin_and_flash_approach_their_steady_rises_and_the_thermocouple_lags_behind() -> None:
    sizes = replace(UNDISTURBED, contact_share=0.25, thermocouple_time=3.0)
    found = Temperatures(RIG, ASSUMED, sizes)
    steady = found.set(0.0, setting=DRIVE, friction_force=0.8, sliding_speed=0.5)
    partition, flash_rise = flash(0.8, 0.5)
    assert steady == approx(flash_rise)
    actuator, pin = 0.1 * POWER / 0.4, partition * 0.4 / 0.5
    for time in (0.5, 7.0, 90.0):
        # time constants 12/0.4 = 30 s and 2/0.5 = 4 s; the flash comes at once
        expected = (actuator * (1 - exp(-time / 30)), pin * (1 - exp(-time / 4)))
        assert found.rises(time) == approx(expected, rel=1e-6)
        in_contact = pin * lagged(time, 4.0, 3.0) + flash_rise * (1 - exp(-time / 3.0))
        read = 300.0 + 0.75 * actuator * lagged(time, 30.0, 3.0) + 0.25 * in_contact
        assert found.reading(np.asarray(time)) == approx(read, abs=1e-5)


def test_what_was_warm_cools_when_drive_and_motor_are_switched_off() -> None:
    found = Temperatures(RIG, ASSUMED, replace(UNDISTURBED, thermocouple_time=0.01))
    found.set(0.0, setting=DRIVE, friction_force=0.8, sliding_speed=0.5)
    warm = found.rises(10.0)
    assert found.set(10.0, setting=None, friction_force=0.8, sliding_speed=0.0) == approx(0.0)
    cooled = found.rises(16.0)
    assert cooled == approx((warm[0] * exp(-6 / 30), warm[1] * exp(-6 / 4)))
    assert found.reading(np.asarray(16.0)) == approx(300.0 + cooled[0], abs=0.01)  # on the actuator by default


def test_a_thermocouple_as_slow_as_the_actuator_reads_the_limit_of_both_time_constants() -> None:
    found = Temperatures(RIG, ASSUMED, replace(UNDISTURBED, thermocouple_time=30.0))
    found.set(0.0, setting=DRIVE, friction_force=0.0, sliding_speed=0.0)
    rise = 0.1 * POWER / 0.4 * (1 - 3 * exp(-2.0))  # 1 - (1 + t/tau) exp(-t/tau) at 60 s
    assert found.reading(np.asarray(60.0)) == approx(300.0 + rise, rel=1e-5)


def test_without_materials_of_both_bodies_only_the_actuator_warms() -> None:
    for unknown in (replace(ASSUMED, pin_material="unobtainium"), replace(ASSUMED, disc_material="unobtainium")):
        found = Temperatures(RIG, unknown, replace(UNDISTURBED, contact_share=1.0))
        assert np.isnan(found.set(0.0, setting=DRIVE, friction_force=0.8, sliding_speed=0.5))
        assert found.rises(1e4) == approx((0.1 * POWER / 0.4, 0.0))
        assert found.reading(np.asarray(1e4)) == approx(300.0)
    bare = replace(RIG, pin_material=None, disc_material=None)
    of_rig = Temperatures(bare, replace(ASSUMED, disc_material=None), UNDISTURBED)
    assert np.isnan(of_rig.set(0.0, setting=None, friction_force=0.8, sliding_speed=0.5))


SLIPPING = StickSlip(excess_force=0.8, stiffness=2e3, mass=0.05, damping_ratio=0.01, sliding_speed=0.15)
LEVEL = FrictionLevel(1.1, 0.6, 2e-6, 3e-15)


def setting(time: float, drive: DriveSetting | None, stick_slip: StickSlip = SLIPPING) -> TruthSetting:
    return TruthSetting(time, 0.15, drive, LEVEL, 4.0, 5.0, stick_slip)


def test_a_setting_sticks_without_drive_and_for_the_share_of_its_bursts() -> None:
    bursts = Bursts(np.random.default_rng(3), 2.0)
    first = float(np.random.default_rng(3).exponential(2.0))  # end of the first burst
    assert setting(0.0, None).sticks
    assert setting(0.0, None).sticking_share(bursts, first / 2) == approx(1.0)
    assert setting(0.0, None).sticking_share(bursts, first + 1e-3) == approx(first / (first + 1e-3))
    assert not setting(0.0, DRIVE).sticks
    assert setting(0.0, DRIVE).sticking_share(bursts, first + 1.0) == 0.0
    slow, fast = replace(SLIPPING, sliding_speed=0.05), replace(SLIPPING, sliding_speed=0.3)
    assert setting(0.0, None, slow).sticking_share(bursts, first + 1.0) == 1.0  # without bursts
    assert setting(0.0, None, fast).sticking_share(bursts, first + 1.0) == 0.0  # steady


def test_the_dataset_has_a_row_a_setting_and_zeros_for_a_drive_that_is_off() -> None:
    slow = replace(SLIPPING, sliding_speed=0.05)
    off, on = setting(1.0, None, slow), replace(setting(4.0, DRIVE), flash_temperature_rise=nan)
    single = {"wear_volume": (7e-12, "m3")}
    sizes = replace(UNDISTURBED, wobble_1=0.07)
    bursts = Bursts(np.random.default_rng(3), 0.0)
    found = truth_dataset([off, on], end_time=9.0, bursts=bursts, sizes=sizes, single=single, title="of it")
    told = {name: found[name].to_numpy().tolist() for name in found.data_vars if found[name].dims == ("setting",)}
    assert told == {
        "start_time": [1.0, 4.0],
        "sliding_speed": [0.15, 0.15],
        "voltage_peak_to_peak": [0.0, 25.9],
        "voltage_offset": [0.0, 12.95],
        "frequency": [0.0, 22e3],
        "vibration_amplitude": [2e-6, 2e-6],
        "friction_force": [1.1, 1.1],
        "friction_ratio": [0.6, 0.6],
        "wear_rate": [3e-15, 3e-15],
        "flash_temperature_rise": approx([4.0, nan], nan_ok=True),
        "normal_load": [5.0, 5.0],
        "stick_slip_frequency": approx([1 / slow.period, 0.0]),
        "stick_slip_fall": approx([slow.fall, 0.0]),
        "stick_slip_fraction": [1.0, 0.0],
    }
    units = {name: found[name].attrs["units"] for name in ("start_time", "wear_rate", "stick_slip_fall", "wobble_1")}
    assert units == {"start_time": "s", "wear_rate": "m2", "stick_slip_fall": "N", "wobble_1": "1"}
    assert (float(found["wear_volume"]), float(found["wobble_1"]), found.attrs["title"]) == (7e-12, 0.07, "of it")


def test_the_share_of_bursts_of_a_setting_is_that_until_the_next_one_begins() -> None:
    ends = np.cumsum([np.random.default_rng(3).exponential(2.0)])
    first = float(ends[0])
    rows = [setting(0.0, None), setting(first / 2, None), setting(first, DRIVE)]
    bursts = Bursts(np.random.default_rng(3), 2.0)
    found = truth_dataset(rows, end_time=first + 5, bursts=bursts, sizes=UNDISTURBED, single={}, title="")
    assert found["stick_slip_fraction"].to_numpy() == approx([1.0, 1.0, 0.0])
    last = truth_dataset(
        [setting(0.0, None)], end_time=first + 1e-3, bursts=bursts, sizes=UNDISTURBED, single={}, title=""
    )
    assert last["stick_slip_fraction"].to_numpy() == approx([first / (first + 1e-3)])
