"""Temperature: known rises and time constants are recovered, with the nominal coverage of their intervals."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
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
