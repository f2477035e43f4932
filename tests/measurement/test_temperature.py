"""Temperature: known rises and time constants are recovered, with the nominal coverage of their intervals."""

import numpy as np
from pytest import MonkeyPatch, approx, mark, raises
from scipy import stats
from scipy.optimize import least_squares

from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency
from sonolube.measurement.temperature import fit_temperature_response, temperature_rise_by_stage

TIME = np.linspace(0, 50, 501)


def noise(seed: int, scale: float) -> np.ndarray:
    return scale * np.random.default_rng(seed).standard_normal(TIME.size)


@mark.parametrize("count", [None, 1])
def test_one_time_constant_is_recovered(count: int | None) -> None:
    found = fit_temperature_response(time=TIME, temperature=80 - 60 * np.exp(-TIME / 6.0), exponentials=count)
    assert len(found.time_constants) == 1
    assert found.time_constants[0].value == approx(6.0)
    assert found.final_temperature.value == approx(80.0)
    assert found.temperature_change.value == approx(60.0)


def test_two_time_constants_are_distinguished_from_one() -> None:
    temperature = 70 - 30 * np.exp(-TIME / 1.5) - 20 * np.exp(-TIME / 15) + noise(1, 0.2)
    found = fit_temperature_response(time=TIME, temperature=temperature)
    short, long = found.time_constants
    assert short.lower < 1.5 < short.upper
    assert long.value == approx(15, rel=0.05)
    assert found.temperature_changes[0].value == approx(30, rel=0.1)
    assert found.temperature_deviation == approx(0.2, rel=0.15)
    single = fit_temperature_response(time=TIME, temperature=80 - 60 * np.exp(-TIME / 6.0) + noise(2, 0.5))
    assert len(single.time_constants) == 1


def test_intervals_of_time_constants_have_their_nominal_coverage() -> None:
    held = 0
    for seed in range(100):
        found = fit_temperature_response(
            time=TIME,
            temperature=80 - 60 * np.exp(-TIME / 6.0) + noise(seed, 2.0),
            exponentials=1,
            confidence_level=0.9,
        )
        held += found.time_constants[0].lower <= 6.0 <= found.time_constants[0].upper
    assert 81 <= held < 100  # 90 expected


def test_a_time_constant_longer_than_the_record_raises_a_caveat() -> None:
    found = fit_temperature_response(
        time=TIME, temperature=500 * (1 - np.exp(-TIME / 300)) + noise(3, 0.3), exponentials=1
    )
    assert "longer than the record" in found.caveats[0]


@mark.parametrize("scale", [0.0, 1e-3])
def test_two_equal_time_constants_whose_shares_cancel_are_refused(scale: float) -> None:
    # t exp(-t / 10 s) is the limit of two exponentials that approach 10 s, with shares beyond all bounds.
    rise_and_fall = 294.0 + TIME * np.exp(-TIME / 10.0) + noise(4, scale)
    with raises(InvalidInput, match=r"exponentials of (9\.|10\.?).* s and (9|10)\.?.* s cancel each other, .* choose"):
        fit_temperature_response(time=TIME, temperature=rise_and_fall, exponentials=2)


def test_rises_over_a_reference_test_are_found_stage_by_stage() -> None:
    without_time = np.linspace(0, 50, 333)
    without = 20 + 0.5 * without_time
    with_vibration = 20 + 0.5 * TIME + np.where(TIME < 25, -1.0, 2.0) + noise(4, 0.1)
    low, high = temperature_rise_by_stage(
        time=TIME,
        temperature=with_vibration,
        reference_time=without_time,
        reference_temperature=without,
        stages=[10.0, 24.9, 50.0],
    )
    assert low.temperature_rise == approx(-1.0, abs=0.05)
    assert high.temperature_rise == approx(2.0, abs=0.05)
    assert 0 < low.temperature_rise_uncertainty < 0.05


def test_spans_without_values_are_refused() -> None:
    both = {"time": TIME, "temperature": TIME, "reference_time": TIME, "reference_temperature": TIME}
    with raises(InvalidInput, match="stage 1, 60 to 70 s, holds 0 values"):
        temperature_rise_by_stage(**both, stages=[60.0, 70.0])
    with raises(InvalidInput, match="exponentials must be 1 or 2, got 3"):
        fit_temperature_response(time=TIME, temperature=TIME, exponentials=3)
    with raises(InvalidInput, match="8 values that vary"):
        fit_temperature_response(time=TIME, temperature=np.ones_like(TIME))


def test_one_exponential_has_students_intervals_of_first_order() -> None:
    tau, final, change = 6.0, 80.0, 60.0
    temperature = final - change * np.exp(-TIME / tau) + noise(7, 0.4)
    found = fit_temperature_response(time=TIME + 100, temperature=temperature, exponentials=1, confidence_level=0.9)
    (constant,), (part,) = found.time_constants, found.temperature_changes

    def model(p: np.ndarray) -> np.ndarray:
        return np.asarray(p[0] - p[1] * np.exp(-TIME / np.exp(p[2])) - temperature)

    fit = least_squares(model, [final, change, np.log(tau)], xtol=1e-14, ftol=1e-14)
    deviation = np.sqrt(2 * fit.cost / (501 - 3))
    assert (found.final_temperature.value, part.value) == approx(tuple(fit.x[:2]), rel=1e-5)
    assert constant.value == approx(np.exp(fit.x[2]), rel=1e-5)
    assert found.temperature_change.value == approx(part.value)
    assert found.temperature_deviation == approx(deviation, rel=1e-6)
    g = statistical_inefficiency(model(fit.x))
    errors = deviation * np.sqrt(g * np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    t = stats.t.ppf(0.95, 501 / g - 3)
    assert found.final_temperature.upper - found.final_temperature.value == approx(t * errors[0], rel=1e-3)
    assert part.value - part.lower == approx(t * errors[1], rel=1e-3)
    assert constant.upper / constant.value == approx(np.exp(t * errors[2]), rel=1e-4)
    assert constant.value / constant.lower == approx(constant.upper / constant.value)
    assert found.confidence_level == 0.9
    assert found.caveats == ()


def test_the_change_of_two_exponentials_is_their_sum_and_the_shorter_comes_first() -> None:
    temperature = 70 - 30 * np.exp(-TIME / 1.5) + 12 * np.exp(-TIME / 15)
    temperature[[3, 77]] = np.nan
    found = fit_temperature_response(time=TIME, temperature=temperature, exponentials=2)
    assert [one.value for one in found.time_constants] == approx([1.5, 15.0], rel=1e-4)
    assert [one.value for one in found.temperature_changes] == approx([30.0, -12.0], rel=1e-4)
    assert found.temperature_change.value == approx(18.0, rel=1e-4)
    assert found.final_temperature.value == approx(70.0, rel=1e-4)


def test_eight_values_are_enough_and_seven_are_not() -> None:
    t = np.arange(8.0)
    temperature = 20 - 5 * np.exp(-t / 2)
    assert fit_temperature_response(time=t, temperature=temperature, exponentials=1).time_constants[0].value == approx(
        2
    )
    temperature[4] = np.nan
    with raises(InvalidInput, match="a settling temperature needs 8 values that vary, got 7"):
        fit_temperature_response(time=t, temperature=temperature)
    with raises(InvalidInput, match="confidence_level"):
        fit_temperature_response(time=t, temperature=temperature, confidence_level=0.4)


def test_the_rise_of_a_stage_is_the_mean_over_the_interpolated_reference() -> None:
    found = temperature_rise_by_stage(
        time=[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        temperature=[10.0, 13.0, 14.0, np.nan, 19.0, 25.0],
        reference_time=[0.0, 2.0, 3.0, 4.0],
        reference_temperature=[8.0, 10.0, np.nan, 14.0],
        stages=[0.0, 1.0, 4.0],
    )
    # rises 2 and 4; 4, 4 (at 2 s) and 5; what the reference does not reach is left out
    assert [one.temperature_rise for one in found] == approx([3.0, 13 / 3])
    assert found[0].temperature_rise_uncertainty == approx(1.0)
    for stages in ([1.0], [2.0, 1.0], [1.0, 1.0]):
        with raises(InvalidInput, match="stages must be at least two increasing times"):
            temperature_rise_by_stage(
                time=TIME, temperature=TIME, reference_time=TIME, reference_temperature=TIME, stages=stages
            )
    with raises(InvalidInput, match=r"stage 2, 3 to 3\.05 s, holds 1 values; two are needed"):
        temperature_rise_by_stage(
            time=TIME, temperature=TIME, reference_time=TIME, reference_temperature=TIME, stages=[0.0, 3.0, 3.05]
        )


@mark.parametrize(
    ("inefficiency", "ratio"), [(6.0, 12.7062 / 6.31375), (2.4, 4.30265 / 2.91999), (2.0, 3.18245 / 2.35336)]
)
def test_correlated_values_count_as_fewer_and_leave_one_degree_of_freedom_at_least(
    monkeypatch: MonkeyPatch, inefficiency: float, ratio: float
) -> None:
    # 12 values less 3 parameters: Student's quantiles of 95 and 90 % with one, two and three degrees of freedom
    monkeypatch.setattr("sonolube.measurement.temperature.statistical_inefficiency", lambda residuals: inefficiency)
    time = np.arange(12.0)
    temperature = 80 - 60 * np.exp(-time / 3.0) + 0.1 * np.sin(2 * np.pi * time / 5)
    wide, narrow = (
        fit_temperature_response(
            time=time, temperature=temperature, exponentials=1, confidence_level=level
        ).final_temperature
        for level in (0.95, 0.9)
    )
    assert (wide.upper - wide.value) / (narrow.upper - narrow.value) == approx(ratio, rel=1e-4)
