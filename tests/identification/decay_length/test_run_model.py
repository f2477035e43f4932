"""Readings of a run against a circuit, a mass on two springs, and friction that is marched element by element."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from reliability import decay_length_recordings as made
from sonolube.identification import SwitchConditions, SwitchTable
from sonolube.identification.decay_length.run_model import (
    DIFFERENCE,
    PARAMETERS,
    Changes,
    RunModel,
    interpolated_ratio,
    noise_covariance,
    relaxation,
    run_channels,
    zero_free_ratio,
)
from sonolube.models.friction.models.asperity_stick_slip_sine import sine_stick_slip_ratio

S = np.arange(5.0, 300.0, 5.0)
LENGTH = 1e-6 * (0.7 + 1.3 * S / S[-1])


def test_interpolated_ratios_are_those_of_elements_marched_through_a_period() -> None:
    length, a = 1e-6 * np.array([0.5, 0.7, 1.0, 2.0, 3.0]), np.full(5, 2.3e-6)
    marched = made.stick_slip_ratio(length, a, 1.5e-6, steps=4800)
    speed = made.SLIDING_SPEED * length / (2 * np.pi * made.FREQUENCY * a * 1.5e-6)
    assert_allclose(interpolated_ratio(relative_amplitude=a / length, reduced_speed=speed), marched, atol=1e-3)


def test_without_relative_speed_reserve_nothing_sticks() -> None:
    assert interpolated_ratio(relative_amplitude=np.array([1.0]), reduced_speed=np.array([1.5]))[0] == 1


def test_a_relaxation_is_exponential_and_ends_at_one() -> None:
    course = relaxation(S, reach=np.array([60.0]), exponent=np.array([1.0]))[0]
    assert_allclose(course, (1 - np.exp(-S / 60)) / (1 - np.exp(-S[-1] / 60)))
    assert np.isfinite(relaxation(S, reach=np.array([1e-30, 1e30]), exponent=np.array([1e9, 1e-9]))).all()


def steady_model(**conditions: float) -> RunModel:
    """Model of a run whose readings do not matter here."""
    shift = np.full(S.size, 60.0)
    table = SwitchTable(
        sliding_distance=S,
        friction_force=np.full(S.size, 0.6) + 1e-3 * np.sin(S),
        intrinsic_friction_force=np.full(S.size, 1.0),
        force_zero=1e-3 * np.cos(S),
        stack_current=0.4 + 1e-3 * np.sin(2 * S),
        small_drive_shift=shift + np.sin(S),
        large_drive_shift=0.8 * shift + np.cos(S),
    )
    known = SwitchConditions(natural_frequency=40.0, **conditions)
    changes = Changes(grows=True, falls=True, drifts=False, follows=True)
    return RunModel(table, known, changes, channels=run_channels(table, known))


def deviates(model: RunModel, **values: float) -> np.ndarray:
    row = np.zeros((1, len(PARAMETERS)))
    for name, value in values.items():
        column = PARAMETERS.index(name)
        row[0, column] = (value - model.means[column]) / model.deviations[column]
    return row


def test_shifts_are_those_of_a_mass_between_its_own_spring_and_that_of_the_contact() -> None:
    model = steady_model(modal_mass=8.0)
    row = deviates(model, decay_length=np.log(0.8e-6), growth=0.0, fall=0.0, large_drive=np.log(2e-6))
    fitted = model.predicted(row)
    stiffness = made.NORMAL_LOAD / 0.8e-6
    exact = np.sqrt(40.0**2 + stiffness / (4 * np.pi**2 * 8.0)) - 40.0
    assert_allclose(fitted["small_drive_shift"], exact * (1 + exact / 80.0))
    share = made.contact_stiffness(np.array([0.8e-6]), np.array([2e-6]))[0] / stiffness
    assert_allclose(fitted["large_drive_shift"] / fitted["small_drive_shift"], share, rtol=1e-6)


@pytest.mark.parametrize("turned", [-50.0, 0.0, 50.0])
def test_the_current_is_that_of_a_resonator_beside_its_capacitance(turned: float) -> None:
    model = steady_model()
    row = deviates(model, capacitive_share=0.0, turned_share=turned, fall=np.log(2.0))
    fitted = model.predicted(row)["stack_current"][0]
    _, a = model.courses(row)
    relative = a[0] / np.exp(model.means[PARAMETERS.index("amplitude")])
    off = np.sign(turned) * np.sqrt(np.maximum(relative**-2 - 1, 0))
    motional = relative if turned == 0 else 1 / (1 + 1j * off)
    assert_allclose(np.exp(fitted), np.abs(0.4j + motional), rtol=1e-6)  # half of the largest share, 0.8


def test_noise_beside_a_course_has_its_true_variance_and_not_less_than_stated() -> None:
    rng = np.random.default_rng(0)
    found = [
        noise_covariance(S, 3 * np.exp(-S / 40) + 0.1 * rng.standard_normal(S.size), None)[0, 0] for _ in range(40)
    ]
    assert np.mean(found) == pytest.approx(0.01, rel=0.15)
    stated = noise_covariance(S, 3 * np.exp(-S / 40) + 0.1 * rng.standard_normal(S.size), np.full(S.size, 0.5))
    assert np.all(np.diag(stated) >= 0.25)


def test_a_relaxation_has_a_row_for_each_distance_and_exponent_within_limits() -> None:
    # 1 - exp(-(s/S)^n) over that at the end; S at most 100 and at least 0.001 ends, n from 0.1 to 8
    s = np.array([20.0, 50.0, 80.0])
    found = relaxation(s, reach=np.array([40.0, 100.0]), exponent=np.array([2.0, 0.5]))
    rows = [1 - np.exp(-((s / 40) ** 2)), 1 - np.exp(-((s / 100) ** 0.5))]
    assert_allclose(found, [row / row[-1] for row in rows])
    assert_allclose(relaxation(s, reach=np.array([1e9]))[0], s / 80, rtol=1e-2)
    flat, steep = 1 - np.exp(-((s / 40) ** 0.1)), 1 - np.exp(-((s / 40) ** 8.0))
    ends = relaxation(s, reach=np.array([40.0, 40.0]), exponent=np.array([1e-3, 50.0]))
    assert_allclose(ends, [flat / flat[-1], steep / steep[-1]])
    assert_allclose(relaxation(np.array([8e-4, 1.0]), reach=np.array([1e-9]))[0][0], 1 - np.exp(-0.8))


def test_interpolated_ratios_are_those_of_the_formula_and_those_of_its_edge_beyond_the_table() -> None:
    beta, v = np.array([0.05, 0.7, 3.0, 40.0]), np.array([0.9, 0.002, 0.1, 0.4])
    length, frequency = 2e-6, 1e4
    exact = sine_stick_slip_ratio(
        decay_length=length,
        vibration_amplitude=beta * length,
        frequency=frequency,
        sliding_speed=v * 2 * np.pi * frequency * beta * length,
        memory_length=length,
    )
    assert_allclose(interpolated_ratio(relative_amplitude=beta, reduced_speed=v), exact, atol=2e-3)
    edge = interpolated_ratio(relative_amplitude=np.array([60.0, 3.0]), reduced_speed=np.array([0.1, 1e-3]))
    beyond = interpolated_ratio(relative_amplitude=np.array([90.0, 3.0]), reduced_speed=np.array([0.1, 1e-4]))
    assert_allclose(beyond, edge)
    assert interpolated_ratio(relative_amplitude=np.array([3.0]), reduced_speed=np.array([1.0]))[0] == 1
    assert interpolated_ratio(relative_amplitude=np.array([9.0]), reduced_speed=np.array([0.98]))[0] < 1


def test_stated_uncertainties_weigh_the_white_noise_and_bound_it_from_below() -> None:
    stated = np.where(np.arange(S.size) % 2, 0.3, 0.1)
    signs = np.resize([1.0, -1.0, -1.0, 1.0], S.size)  # nothing that wanders
    found = noise_covariance(S, 1e-3 * stated * signs, stated)
    variances = np.diag(found)
    assert_allclose(variances[1::2] / variances[0:-1:2], 9.0)
    assert np.mean(variances) == pytest.approx(float(np.mean(stated**2)))  # whatever the readings
    assert_allclose(found - np.diag(variances), 0, atol=1e-12)
    none = noise_covariance(S, np.full(S.size, 5.0), None)
    assert np.diag(none) == pytest.approx(np.full(S.size, (5e-9) ** 2))  # not below a billionth of the readings


def test_noise_that_wanders_slowly_is_told_from_white_noise() -> None:
    # half of the variance wanders over a tenth of the run
    rng = np.random.default_rng(3)
    gaps = np.abs(np.subtract.outer(S, S)) / S[-1]
    true = 0.01 * (0.2 * np.eye(S.size) + 0.8 * np.exp(-gaps / 0.1))
    factor = np.linalg.cholesky(true)
    found = [noise_covariance(S, factor @ rng.standard_normal(S.size), None) for _ in range(12)]
    assert np.mean([each[0, 0] for each in found]) == pytest.approx(0.01, rel=0.4)
    assert np.mean([each[10, 11] for each in found]) == pytest.approx(true[10, 11], rel=0.5)
    white = [noise_covariance(S, 0.1 * rng.standard_normal(S.size), None)[10, 11] for _ in range(8)]
    assert abs(np.mean(white)) < 0.2 * true[10, 11]


def run_table(**columns: np.ndarray) -> SwitchTable:
    plain = {
        "sliding_distance": S,
        "friction_force": np.full(S.size, 0.6) + 1e-3 * np.sin(S),
        "intrinsic_friction_force": np.full(S.size, 1.0),
        "force_zero": 1e-3 * np.cos(S),
    }
    return SwitchTable(**(plain | columns))


def priors(changes: Changes, table: SwitchTable | None = None, **conditions: float) -> dict[str, tuple[float, float]]:
    table, known = table or run_table(), SwitchConditions(**conditions)
    model = RunModel(table, known, changes, channels=run_channels(table, known))
    return dict(zip(PARAMETERS, zip(model.means.tolist(), model.deviations.tolist(), strict=True), strict=True))


def test_the_priors_of_changes_are_those_of_the_two_published_decay_lengths_or_of_hardly_any_change() -> None:
    change = pytest.approx((np.log(2.0 / 0.7), 0.4))
    assert np.exp(DIFFERENCE) == pytest.approx(2.0 / 0.7)
    grows = priors(Changes(grows=True, falls=False, drifts=False, follows=True))
    assert grows["growth"] == change
    assert grows["fall"] == pytest.approx((0.0, 0.03))
    assert grows["drift"] == pytest.approx((0.0, 0.03))
    falls = priors(Changes(grows=False, falls=True, drifts=True, follows=False))
    assert falls["growth"] == pytest.approx((0.0, 0.05))
    assert falls["fall"] == change
    assert falls["drift"] == pytest.approx((0.0, 0.3))
    end = S[-1]
    distances = [np.exp(falls[f"{name}_distance"][0]) for name in ("growth", "fall", "drift")]
    assert distances == pytest.approx([end / 5, end / 2, end / 3])


def test_the_priors_of_levels_are_about_what_the_run_states() -> None:
    steady = Changes(grows=False, falls=False, drifts=False, follows=True)
    found = priors(steady, vibration_amplitude=1.7e-6)
    assert found["decay_length"] == pytest.approx((np.log(1.5e-6), 0.7))
    assert found["amplitude"] == pytest.approx((np.log(1.7e-6), 0.15))
    assert found["memory_length"] == pytest.approx((np.log(1.5e-6), 0.4))
    assert found["discrepancy_slope"] == pytest.approx((0.0, 0.08))
    assert found["large_drive"] == pytest.approx((np.log(1.7e-6), 0.3))
    assert found["shift_scale"] == pytest.approx((0.0, 2.0))  # no shift was read
    assert priors(steady, large_drive_amplitude=3e-6)["large_drive"][0] == pytest.approx(np.log(3e-6))
    shifts = {"small_drive_shift": 60.0 + np.sin(S), "large_drive_shift": 40.0 + np.cos(S)}
    by_level = priors(steady, run_table(**shifts))["shift_scale"]
    assert 40 < np.exp(by_level[0]) < 61
    assert by_level[1] == pytest.approx(2.0)
    known = priors(steady, run_table(**shifts), natural_frequency=40.0, modal_mass=8.0)
    assert known["shift_scale"] == pytest.approx((0.0, 0.15))
    half = priors(steady, run_table(**shifts), natural_frequency=40.0)
    assert half["shift_scale"][1] == pytest.approx(2.0)
    # of shifts that are next to none about zero the scale is a tenth of their size
    noise = {"small_drive_shift": np.where(np.arange(S.size) % 2, 1.0, -1.0)}
    assert np.exp(priors(steady, run_table(**noise))["shift_scale"][0]) == pytest.approx(0.1)


def test_the_friction_ratio_is_that_of_stick_slip_with_an_error_of_level_slope_and_drift() -> None:
    model = steady_model()
    row = deviates(
        model, decay_length=np.log(0.9e-6), amplitude=np.log(2.1e-6), memory_length=np.log(1.3e-6),
        growth=0.8, fall=0.2, discrepancy_slope=0.05, drift=-0.1,
        growth_distance=np.log(60.0), growth_exponent=np.log(1.4),
        fall_distance=np.log(90.0), fall_exponent=np.log(0.7), drift_distance=np.log(70.0),
    )  # fmt: skip
    grown, fallen, drifted = (
        (1 - np.exp(-((S / reach) ** n))) / (1 - np.exp(-((S[-1] / reach) ** n)))
        for reach, n in ((60.0, 1.4), (90.0, 0.7), (70.0, 1.0))
    )
    length, a = 0.9e-6 * np.exp(0.8 * grown), 2.1e-6 * np.exp(-0.2 * fallen)
    found_length, found_a = model.courses(row)
    assert_allclose(found_length[0], length)
    assert_allclose(found_a[0], a)
    ratio = sine_stick_slip_ratio(
        decay_length=length, vibration_amplitude=a, frequency=22e3, sliding_speed=65e-3, memory_length=1.3e-6
    )
    ratio = ratio + 0.05 * np.log(a / length / (2.1 / 0.9)) - 0.1 * drifted
    assert_allclose(model.predicted(row)["friction_ratio"][0], ratio, atol=2e-3)


def test_the_large_drive_follows_the_fall_of_the_vibration_only_where_it_is_said_to() -> None:
    table = run_table(small_drive_shift=60 + np.sin(S), large_drive_shift=48 + np.cos(S))
    known = SwitchConditions(normal_load=3.0)
    shares = []
    for follows in (True, False):
        changes = Changes(grows=False, falls=True, drifts=False, follows=follows)
        model = RunModel(table, known, changes, channels=run_channels(table, known))
        row = deviates(
            model, decay_length=np.log(0.8e-6), growth=0.0, fall=0.9, large_drive=np.log(2e-6), shift_scale=2.0
        )
        found = model.predicted(row)
        shares.append(found["large_drive_shift"][0] / found["small_drive_shift"][0])
        assert_allclose(found["small_drive_shift"][0], np.exp(2.0))  # over that at the beginning, times its scale
    weaker = made.contact_stiffness(np.array([0.8e-6, 0.8e-6]), 2e-6 * np.array([1.0, np.exp(-0.9)]))
    weaker = weaker / (made.NORMAL_LOAD / 0.8e-6)
    assert shares[0][-1] == pytest.approx(weaker[1], rel=1e-4)
    assert_allclose(shares[1], weaker[0], rtol=1e-4)


def test_white_residuals_have_the_sum_of_squares_of_the_inverse_covariance() -> None:
    model = steady_model()
    rows = np.vstack([np.zeros(len(PARAMETERS)), 0.3 * np.ones(len(PARAMETERS))])
    found, predicted = model.residuals(rows), model.predicted(rows)
    start = 0
    for channel in model.channels:
        rest = channel.values - predicted[channel.name][1, channel.rows]
        piece = found[1, start : start + rest.size]
        assert piece @ piece == pytest.approx(rest @ np.linalg.solve(channel.covariance, rest), rel=1e-6)
        start += rest.size
    assert found.shape == (2, start)


def test_channels_hold_the_readings_in_the_units_of_the_model_with_their_free_levels() -> None:
    shift = 60 + 5 * np.sin(S)
    table = run_table(
        stack_current=0.4 + 0.05 * np.sin(S),
        small_drive_shift=np.where(np.arange(S.size) == 3, np.nan, shift),
        large_drive_shift=np.where(np.arange(S.size) < 8, shift, np.nan),
        small_drive_shift_uncertainty=np.full(S.size, 2.0),
    )
    ratio, current, small, large = run_channels(table, SwitchConditions(natural_frequency=40.0))
    assert [each.name for each in (ratio, current, small, large)] == [
        "friction_ratio", "stack_current", "small_drive_shift", "large_drive_shift"
    ]  # fmt: skip
    assert [each.level for each in (ratio, current, small, large)] == [0.1, 10.0, 0.0, 0.0]
    assert_allclose(np.exp(current.values), 0.4 + 0.05 * np.sin(S))
    known = np.delete(shift, 3)
    assert_allclose(small.values, known * (1 + known / 80))
    assert small.rows.tolist() == [row for row in range(S.size) if row != 3]
    # standard uncertainties of 2 Hz, by the slope 1 + s/f_0 of the linear shift, bound the noise
    assert np.mean(np.diag(small.covariance)) >= 0.999 * np.mean((2 * (1 + known / 40)) ** 2)
    assert large.rows.tolist() == list(range(8))
    assert np.diag(ratio.covariance).min() > 0.01
    plain = run_channels(table, SwitchConditions())[2]
    assert_allclose(plain.values, known)
    few = run_table(large_drive_shift=np.where(np.arange(S.size) < 7, shift, np.nan))
    assert [each.name for each in run_channels(few, SwitchConditions())] == ["friction_ratio"]


def test_the_ratio_of_forces_without_their_zero_has_the_uncertainty_of_all_three() -> None:
    # (0.7 - 0.1)/(1.3 - 0.1) = 0.5: sqrt(0.03^2 + (0.5 0.04)^2 + (0.5 0.02)^2)/1.2
    count = S.size
    forces = {
        "friction_force": np.full(count, 0.7),
        "intrinsic_friction_force": np.full(count, 1.3),
        "force_zero": np.full(count, 0.1),
    }
    stated = {
        "friction_force_uncertainty": np.full(count, 0.03),
        "intrinsic_friction_force_uncertainty": np.full(count, 0.04),
        "force_zero_uncertainty": np.full(count, 0.02),
    }
    ratio, uncertainty = zero_free_ratio(run_table(**forces, **stated))
    assert_allclose(ratio, 0.5)
    assert uncertainty is not None
    assert_allclose(uncertainty, np.sqrt(0.03**2 + 0.02**2 + 0.01**2) / 1.2)
    for left_out in stated:
        some = {name: values for name, values in stated.items() if name != left_out}
        assert zero_free_ratio(run_table(**forces, **some))[1] is None


def test_fitted_readings_take_the_level_of_the_current_and_are_in_hertz() -> None:
    model = steady_model()
    row = np.zeros(len(PARAMETERS))
    fitted, predicted = model.fitted(row), model.predicted(row[None])
    level = float(np.mean(np.log(0.4 + 1e-3 * np.sin(2 * S)) - predicted["stack_current"][0]))
    assert_allclose(np.log(fitted["stack_current"]) - predicted["stack_current"][0], level, atol=0.3)
    linear = predicted["small_drive_shift"][0]
    shift = fitted["small_drive_shift"]
    assert_allclose(shift * (1 + shift / 80), linear)  # of a free frequency of 40 Hz
    plain = SwitchConditions()
    table = model.table
    other = RunModel(table, plain, Changes(True, True, False, True), channels=run_channels(table, plain))
    assert_allclose(other.fitted(row)["small_drive_shift"], other.predicted(row[None])["small_drive_shift"][0])
