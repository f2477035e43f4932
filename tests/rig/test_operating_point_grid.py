"""Many operating points at once: what linear theory and single points say of them, and a status for each."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from scipy.special import ellipk

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import drive_receptance
from sonolube.models.friction import FRICTION_MODELS
from sonolube.rig import Rig, operating_points, point_batch, read_rig, simulate, structure_in_contact
from sonolube.rig.operating_point_batch import NUMBERS, STATUSES, _distinct, _shifted
from sonolube.rig.power import POWERS

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = read_rig(RIGS / "tribometer.toml")


def with_model(name: str) -> Rig:
    return replace(TRIBOMETER, friction_model=FRICTION_MODELS[name]())


def test_small_vibrations_are_those_of_linear_theory_at_every_frequency() -> None:
    frequency = np.geomspace(2e3, 90e3, 25)
    amplitude = operating_points(TRIBOMETER, voltage_peak_to_peak=0.01, frequency=frequency).vibration_amplitude
    assert amplitude == approx(np.abs(drive_receptance(structure_in_contact(TRIBOMETER), frequency=frequency)) * 0.005)


def test_the_amplitude_is_proportional_to_small_voltages() -> None:
    volts = np.array([0.01, 0.02, 0.05])
    amplitude = operating_points(TRIBOMETER, voltage_peak_to_peak=volts).vibration_amplitude
    assert amplitude / volts == approx(np.full(3, amplitude[0] / volts[0]), rel=1e-6)


def test_the_kinematic_model_is_the_elliptic_integral_of_a_sine() -> None:
    # mean of v_r/sqrt(v_r^2 + (w a cos)^2) is 2/pi K(m)/sqrt(1 + q^2), q = w a/v_r, m = q^2/(1 + q^2); of 2 V the
    # vibration is a sine to 1e-4
    speeds = np.array([1e-3, 5e-3, 20e-3, 100e-3])
    points = operating_points(with_model("kinematic"), voltage_peak_to_peak=2.0, sliding_speed=speeds)
    q = 2 * np.pi * 22e3 * points.vibration_amplitude / speeds
    expected = 2 / np.pi * ellipk(q**2 / (1 + q**2)) / np.sqrt(1 + q**2)
    assert points.friction_ratio == approx(expected, rel=1e-3)


@pytest.mark.parametrize("model", ["kinematic", "asperity_stick_slip"])
def test_fast_sliding_feels_no_vibration(model: str) -> None:
    assert operating_points(with_model(model), sliding_speed=100.0).friction_ratio == approx(1, abs=1e-4)


def test_the_peak_velocity_is_that_of_the_sine() -> None:
    point = operating_points(TRIBOMETER)
    assert point.vibration_velocity == approx(2 * np.pi * 22e3 * point.vibration_amplitude, rel=2e-3)


def test_the_amplifiers_power_is_that_of_table_4_1() -> None:
    volts = np.array([5.1, 10.3, 15.5, 20.7, 25.9])
    points = operating_points(TRIBOMETER, voltage_peak_to_peak=volts, voltage_offset=volts / 2)
    assert points.charging_power == approx([0.21, 0.84, 1.9, 3.39, 5.31], abs=0.005)


def test_what_stays_in_the_rig_is_what_its_dampers_take() -> None:
    # the stack's force in phase with its velocity ends in the dampers; at resonance the tip's takes c w^2 a^2/2 = 42 W
    point = operating_points(TRIBOMETER)
    taken = 702 * (2 * np.pi * 22e3 * point.vibration_amplitude) ** 2 / 2
    assert taken < point.dissipated_power < 1.1 * taken


@pytest.mark.parametrize("model", ["asperity_stick_slip", "kinematic", "bristle_with_holder"])
def test_a_batch_is_its_single_points(model: str) -> None:
    rig = with_model(model)
    volts, speeds = np.array([[10.0], [60.0]]), np.array([5e-3, 87e-3])
    batch = operating_points(rig, voltage_peak_to_peak=volts, sliding_speed=speeds)
    assert rig.drive is not None
    for row, column in np.ndindex(2, 2):
        one = replace(
            rig,
            drive=replace(rig.drive, voltage_peak_to_peak=float(volts[row, 0])),
            sliding_speed=float(speeds[column]),
        )
        alone = simulate(one)
        for name in ("friction_ratio", "friction_force", "vibration_amplitude"):
            assert getattr(batch, name)[row, column] == approx(getattr(alone.friction, name), rel=1e-5), name
        for name in POWERS:
            assert getattr(batch, name)[row, column] == approx(getattr(alone.friction.power, name), rel=1e-5), name
        assert batch.dissipated_power[row, column] == approx(alone.vibration.dissipated_power, rel=1e-5)
        assert batch.status[row, column] == alone.vibration.status


def test_loads_and_frequencies_keep_their_order() -> None:
    frequency, load = np.array([23e3, 21e3, 22e3]), np.array([[3.0], [1.0]])
    batch = operating_points(TRIBOMETER, frequency=frequency, normal_load=load)
    assert batch.vibration_amplitude.argmax(axis=1).tolist() == [2, 2]
    assert batch.friction_force == approx(batch.friction_ratio * TRIBOMETER.friction_coefficient * load)


def test_one_impossible_point_does_not_spoil_the_others() -> None:
    assert TRIBOMETER.stack is not None
    weak = replace(TRIBOMETER, stack=replace(TRIBOMETER.stack, highest_voltage=100.0))
    points = operating_points(weak, voltage_peak_to_peak=[28.0, 400.0], normal_load=[[3.0], [1e9]])
    assert points.status.tolist() == [["periodic", "refused"], ["refused", "refused"]]
    assert points.failed.tolist() == [[False, True], [True, True]]
    assert points.reason[0, 1] == "the drive goes up to 214 V; the highest admissible voltage is 100 V"
    assert "leaves no separation" in points.reason[1, 0]


def test_where_no_point_is_possible_each_says_why() -> None:
    points = operating_points(TRIBOMETER, normal_load=[1e8, 1e9])
    assert points.status.tolist() == ["refused", "refused"]


def test_standstill_among_speeds_says_why_it_has_no_friction() -> None:
    points = operating_points(TRIBOMETER, sliding_speed=[0.0, 20.3e-3])
    assert points.status.tolist() == ["refused", "periodic"]
    assert "sliding_speed must be positive" in points.reason[0]
    assert points.friction_ratio[1] == approx(simulate(TRIBOMETER).friction.friction_ratio)


def test_progress_counts_each_vibration_once() -> None:
    told: list[tuple[int, int]] = []
    operating_points(
        TRIBOMETER,
        voltage_peak_to_peak=[[10.0], [20.0]],
        sliding_speed=[0.01, 0.02, 0.03],
        advance=lambda done, total: told.append((done, total)),
    )
    assert told == [(1, 2), (2, 2)]


def test_what_has_no_meaning_is_refused_by_name() -> None:
    with pytest.raises(InvalidInput, match=r"normal_load must be positive, got -1\.0 N"):
        operating_points(TRIBOMETER, normal_load=-1.0)
    with pytest.raises(InvalidInput, match="matching shapes"):
        operating_points(TRIBOMETER, frequency=[1e3, 2e3], normal_load=[1.0, 2.0, 3.0])
    with pytest.raises(InvalidInput, match=r"drive\.voltage_peak_to_peak is missing; give it to vary the voltage"):
        operating_points(read_rig(RIGS / "cutter_head.toml"), voltage_peak_to_peak=10.0)


def test_a_batch_lists_the_points_by_its_last_axis_with_the_speeds_and_forces_of_their_sines() -> None:
    # of 0.02 V the vibration is a sine to 1e-4, and friction is that without vibration where the sliding is fast
    volts, loads = np.array([0.01, 0.02]), np.array([[3.0], [4.0], [5.0]])
    batch = point_batch(TRIBOMETER, voltage_peak_to_peak=volts, normal_load=loads, sliding_speed=100.0)
    assert set(batch.numbers) == set(NUMBERS)
    amplitude = batch.numbers["vibration_amplitude"].reshape(3, 2)
    assert amplitude[:, 1] == approx(2 * amplitude[:, 0], rel=1e-4)
    assert batch.numbers["vibration_velocity"] == approx(2 * np.pi * 22e3 * amplitude.ravel(), rel=1e-3)
    assert batch.numbers["friction_ratio"] == approx(np.ones(6), abs=1e-6)
    assert batch.numbers["friction_reduction"] == approx(np.zeros(6), abs=1e-6)
    assert batch.numbers["friction_force"] == approx(0.341 * np.repeat([3.0, 4.0, 5.0], 2), rel=1e-3)
    assert batch.numbers["friction_coefficient"] == approx(np.full(6, 0.341), rel=1e-3)
    assert [STATUSES[code] for code in batch.status] == ["periodic"] * 6
    assert {batch.reasons[code] for code in batch.reason} == {"the vibration repeats with the drive"}


def test_points_of_a_batch_that_stack_or_contact_rule_out_say_which_limit_they_are_beyond() -> None:
    assert TRIBOMETER.stack is not None
    rig = replace(TRIBOMETER, stack=replace(TRIBOMETER.stack, lowest_voltage=-20.0, highest_voltage=100.0))
    volts, offset = np.array([28.0, 28.0, 28.0, 40.0, 40.0, 28.0]), np.array([14.0, -7.0, -5.9, 80.0, 80.1, 14.0])
    load = np.array([3.0, 3.0, 3.0, 3.0, 3.0, 1e5])
    batch = point_batch(rig, voltage_peak_to_peak=volts, voltage_offset=offset, normal_load=load)
    reasons = [batch.reasons[code] for code in batch.reason]
    assert [STATUSES[code] for code in batch.status] == [
        "periodic", "refused", "periodic", "periodic", "refused", "refused"
    ]  # fmt: skip
    assert reasons[1] == "the drive goes too low: the lowest admissible voltage is -20.0 V"
    assert reasons[4] == "the drive goes too high: the highest admissible voltage is 100.0 V"
    assert reasons[5] == "normal_load leaves no separation between the surfaces: lower the load"
    known = np.array([True, False, True, True, False, False])
    for name in ("friction_ratio", "vibration_amplitude", "vibration_velocity", "friction_force"):
        assert np.isfinite(batch.numbers[name]).tolist() == known.tolist()
    alone = operating_points(rig, voltage_peak_to_peak=28.0, voltage_offset=-5.9)
    assert batch.numbers["vibration_amplitude"][2] == approx(float(alone.vibration_amplitude))


def test_points_at_rest_have_a_vibration_and_a_reason_for_no_friction() -> None:
    batch = point_batch(TRIBOMETER, sliding_speed=[0.0, 0.05])
    assert np.isnan(batch.numbers["friction_ratio"]).tolist() == [True, False]
    assert batch.numbers["vibration_amplitude"] == approx([2.5e-6, 2.5e-6], rel=0.01)
    assert "sliding_speed" in batch.reasons[batch.reason[0]]
    assert batch.reasons[batch.reason[1]] == "the vibration repeats with the drive"


def test_a_batch_of_a_stated_sine_has_its_amplitude_at_its_own_frequency_alone() -> None:
    bush = read_rig(RIGS / "bronze_bush.toml")  # 2 um at 20 kHz
    batch = point_batch(bush, frequency=[20e3, 25e3, 20e3], sliding_speed=[0.05, 0.05, 0.1])
    assert batch.numbers["vibration_amplitude"] == approx([2e-6, np.nan, 2e-6], nan_ok=True)
    assert batch.numbers["vibration_velocity"][0] == approx(2 * np.pi * 20e3 * 2e-6)
    assert [STATUSES[code] for code in batch.status] == ["periodic", "refused", "periodic"]
    assert "holds at 20 kHz only" in batch.reasons[batch.reason[1]]
    assert batch.reason[0] == batch.reason[2]
    ratio = batch.numbers["friction_ratio"]
    assert ratio[0] < ratio[2] < 1  # the faster the sliding, the less it gains


def test_refusals_follow_the_statuses_and_each_distinct_condition_is_kept_once() -> None:
    found = _shifted(np.array([0, 3, 0, 0], dtype=np.int16), np.array([0, 0, 1, 3], dtype=np.int16))
    assert found.tolist() == [0, 3, 4, 6]  # behind four statuses
    columns = np.array([[1.0, 2.0, 1.0, 1.0, 2.0], [5.0, 5.0, 5.0, 6.0, 5.0], [0.0] * 5, [3.0, 3.0, 3.0, 3.0, 4.0]])
    first, which = _distinct(columns)
    assert sorted(first.tolist()) == [0, 1, 3, 4]
    assert first[which].tolist() == [0, 1, 0, 3, 4]  # of each, the column that it equals


@pytest.mark.parametrize(
    ("voltage", "frequency", "load", "status", "told"),
    [
        (65.8644, 22436.58, 61.209, "unstable", "small disturbances grow"),
        (570.5942, 446.00634, 95.5875, "multistable", "another vibration is stable too"),
        (1041.759, 452.8423, 72.3823, "not_converged", "no vibration at the drive's own period was found"),
    ],
)
def test_a_point_of_a_batch_without_one_steady_vibration_says_which_it_is(
    voltage: float, frequency: float, load: float, status: str, told: str
) -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["vibration.amplitude_source=computed", "drive.voltage_offset=0V"])
    found = point_batch(rig, voltage_peak_to_peak=voltage, frequency=frequency, normal_load=load)
    alone = operating_points(rig, voltage_peak_to_peak=voltage, frequency=frequency, normal_load=load)
    assert STATUSES[found.status[0]] == status == str(alone.status.ravel()[0])
    assert told in found.reasons[found.reason[0]]
