"""Own runs against every model: synthetic runs of published closed forms give back their model and its parameter.

The ratios come from formulas written here: Coulomb friction across and along the sliding, and stick-slip of asperities
by brute force over phases.
"""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from pytest import approx
from scipy.special import ellipk, i0e
from scipy.stats import t as student

from sonolube.charts import Points
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.validation.assessment import Fit
from sonolube.validation.comparison import compare_models, compared_models, predict_runs
from sonolube.validation.figures import runs_fit_chart
from sonolube.validation.run_conditions import run_conditions
from sonolube.validation.runs_fit import RunsFit, fit_runs
from sonolube.validation.tables import runs_fit_dataset

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
FREQUENCY = 22e3
AMPLITUDES, SPEEDS = (0.5e-6, 1.2e-6, 2.5e-6), (0.02, 0.05, 0.15)
CONTACTLESS = ("kinematic", "kinematic-fitted", "coulomb-longitudinal-fitted", "coulomb-oblique-fitted")


def across(speed: ArrayLike, velocity: ArrayLike) -> NDArray[np.float64]:
    """Mean of v / sqrt(v^2 + V^2 cos^2) over a period: a complete elliptic integral."""
    v, peak = np.asarray(speed, float), np.asarray(velocity, float)
    whole = np.hypot(v, peak)
    return np.asarray(2 / np.pi * v / whole * ellipk((peak / whole) ** 2))


def along(speed: ArrayLike, velocity: ArrayLike) -> NDArray[np.float64]:
    """Mean sign of v + V cos: (2/pi) asin(v/V), one above the peak velocity."""
    return np.asarray(2 / np.pi * np.arcsin(np.minimum(np.asarray(speed) / np.asarray(velocity), 1)))


def stick_slip(beta: float, rate: float) -> float:
    """Elements at every depth c: springs grow with the phase, cut at the friction limit max(c - cos, 0)."""
    steps = 720
    depths = np.concatenate([np.linspace(-1, 3, 400), np.linspace(3, 12 / beta + 4, 200)[1:]])
    limits = np.maximum(depths[:, None] - np.cos(np.linspace(0, 2 * np.pi, steps, endpoint=False)), 0)
    spring, total = limits[:, 0].copy(), np.zeros(depths.size)
    for turn in range(3):
        for step in range(steps):
            spring = np.minimum(spring + rate * 2 * np.pi / steps, limits[:, step])
            if turn == 2:
                total += spring
    weight = np.exp(-beta * (depths + 1))
    return float(beta**2 / i0e(beta) * np.trapezoid(weight * total / steps, depths))


def runs(ratio: ArrayLike, amplitude: ArrayLike, speed: ArrayLike, **more: ArrayLike) -> xr.Dataset:
    columns = {"vibration_amplitude": amplitude, "sliding_speed": speed, "frequency": FREQUENCY, **more}
    size = np.size(ratio)
    data = {name: ("run", np.broadcast_to(np.asarray(values, float), (size,))) for name, values in columns.items()}
    return xr.Dataset(data | {"friction_reduction": ("run", 1 - np.asarray(ratio))}, attrs={"title": "mine"})


def conditions() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    amplitude, speed = np.meshgrid(AMPLITUDES, SPEEDS)
    return amplitude.ravel(), speed.ravel()


def fraction_of(result: RunsFit, model: str) -> tuple[float, tuple[float, float]]:
    found = next(one for one in result.models if one.name == model).parameters[0]
    assert found.interval is not None
    return found.value, found.interval


def test_runs_of_coulomb_friction_across_give_back_their_fraction_without_a_rig() -> None:
    amplitude, speed = conditions()
    noise = 0.01 * np.random.default_rng(1).standard_normal(amplitude.size)
    result = fit_runs(runs(across(speed, 0.4 * 2 * np.pi * FREQUENCY * amplitude) + noise, amplitude, speed))
    value, (low, high) = fraction_of(result, "kinematic-fitted")
    assert low < 0.4 < high
    assert value == approx(0.4, rel=0.05)
    true = next(one for one in result.models if one.name == "kinematic-fitted")
    assert true is result.models[0] or true.tied
    assert "a rig file (roughness and materials)" in result.inapplicable["asperity-stick-slip"]
    assert {one.name for one in result.models} <= set(CONTACTLESS)


def test_runs_of_coulomb_friction_along_rank_that_model_first() -> None:
    amplitude, speed = conditions()
    noise = 0.01 * np.random.default_rng(2).standard_normal(amplitude.size)
    result = fit_runs(runs(along(speed, 0.45 * 2 * np.pi * FREQUENCY * amplitude) + noise, amplitude, speed))
    names = [result.models[0].name, *(one.name for one in result.tied)]
    assert "coulomb-longitudinal-fitted" in names
    assert "kinematic-fitted" not in names
    measured = fit_runs(
        runs(along(speed, 2 * np.pi * FREQUENCY * amplitude) + noise, amplitude, speed, vibration_direction=0.0)
    )
    assert measured.models[0].name == "coulomb-in-plane"
    assert measured.models[0].rms_unseen == approx(np.sqrt(np.mean(noise**2)), rel=1e-6)


def test_runs_of_asperity_stick_slip_give_back_their_memory_length_on_the_rig() -> None:
    rig = read_rig(RIG)
    decay = resolved_rig(rig).decay_length
    amplitude, speed = conditions()
    rates = speed * decay / (2 * np.pi * FREQUENCY * amplitude * 1.1e-6)
    exact = [stick_slip(a / decay, rate) for a, rate in zip(amplitude, rates, strict=True)]
    assert (stick_slip(1.25, 0.3), stick_slip(5, 0.1)) == approx((0.663, 0.3235), abs=2e-3)
    noise = 0.008 * np.random.default_rng(3).standard_normal(amplitude.size)
    result = fit_runs(runs(np.array(exact) + noise, amplitude, speed), rig)
    value, (low, high) = fraction_of(result, "asperity-stick-slip-fitted")
    assert low < 1.1e-6 < high
    assert value == approx(1.1e-6, rel=0.1)
    true = next(one for one in result.models if one.name == "asperity-stick-slip-fitted")
    assert true is result.models[0] or true.tied


def test_the_interval_of_few_noisy_conditions_holds_the_truth_as_often_as_it_says() -> None:
    amplitude, speed = np.array([0.5e-6, 1e-6, 2e-6, 2.5e-6]), np.array([0.03, 0.03, 0.05, 0.1])
    exact = across(speed, 0.4 * 2 * np.pi * FREQUENCY * amplitude)
    noise = 0.02 * np.random.default_rng(4).standard_normal((40, 4))
    model = compared_models(["kinematic-fitted"])
    intervals = [
        fraction_of(fit_runs(runs(exact + each, amplitude, speed), models=model), model[0].name) for each in noise
    ]
    covered = sum(low < 0.4 < high for _, (low, high) in intervals)
    assert 34 <= covered <= 40


def test_the_true_model_is_seldom_told_apart_from_the_first() -> None:
    amplitude, speed = conditions()
    exact = across(speed, 0.4 * 2 * np.pi * FREQUENCY * amplitude)
    noise = 0.02 * np.random.default_rng(5).standard_normal((20, exact.size))
    models = compared_models(CONTACTLESS)
    lost = 0
    for each in noise:
        result = fit_runs(runs(exact + each, amplitude, speed), models=models)
        lost += "kinematic-fitted" not in {result.models[0].name, *(one.name for one in result.tied)}
    assert lost <= 3


def test_three_conditions_decide_nothing_and_the_next_one_lies_where_models_differ() -> None:
    amplitude, speed = np.array([1e-6, 2e-6, 2.5e-6]), np.array([0.02, 0.05, 0.1])
    result = fit_runs(runs(across(speed, 0.4 * 2 * np.pi * FREQUENCY * amplitude) + 0.01, amplitude, speed))
    assert result.verdict.startswith("not decided: 3 conditions are too few to rank models")
    for one in result.next_conditions:
        first, second = (
            next(model for model in result.models if model.name == name).fit.predict(one.condition)
            for name in (one.first, one.second)
        )
        assert one.contrast > 0
        assert (first, second) == approx((one.first_ratio, one.second_ratio))
        assert one.condition.strength is not None
        beyond = 2.0 if one.is_beyond else 1.0
        assert 1e-6 / beyond <= one.condition.strength * (1 + 1e-9)
        assert one.condition.strength <= 2.5e-6 * beyond * (1 + 1e-9)


def test_a_model_worse_than_the_mean_of_the_runs_is_not_said_to_be_decided() -> None:
    # one ratio whatever speed and amplitude: the mean of the others errs by noise alone, cos(theta) by tenths
    amplitude, speed = conditions()
    ratios = 0.5 + 0.01 * np.random.default_rng(6).standard_normal(amplitude.size)
    result = fit_runs(
        runs(ratios, amplitude, speed), models=compared_models(["kinematic", "coulomb-longitudinal-fitted"])
    )
    mean_of_others = (ratios.sum() - ratios) / (ratios.size - 1)
    assert result.rms_of_mean == approx(np.sqrt(np.mean((mean_of_others - ratios) ** 2)))
    assert result.models[0].rms_unseen > 5 * result.rms_of_mean
    assert not result.is_decided
    assert "no model predicts better than the mean of the other conditions" in result.verdict
    assert "decided" not in result.verdict.removeprefix("not decided")
    alone = fit_runs(runs(ratios, amplitude, speed), models=compared_models(["kinematic"]))
    assert alone.verdict.startswith("not decided: no model predicts better than the mean")


def test_a_model_better_than_the_mean_and_than_every_other_is_decided() -> None:
    amplitude, speed = conditions()
    noise = 0.003 * np.random.default_rng(8).standard_normal(amplitude.size)
    exact = across(speed, 2 * np.pi * FREQUENCY * amplitude)
    models = compared_models(["kinematic", "coulomb-longitudinal-fitted"])
    result = fit_runs(runs(exact + noise, amplitude, speed), models=models)
    assert result.is_decided
    assert result.verdict == "decided: kinematic predicts unseen conditions better than every other, by paired errors"


def test_repeats_count_as_one_condition_with_the_error_of_their_mean() -> None:
    ratios = np.array([0.48, 0.50, 0.52, 0.7])
    table = run_conditions(runs(ratios, [1e-6, 1e-6, 1e-6, 5e-7], 0.05))
    assert [one.repeats for one in table.conditions] == [3, 1]
    assert table.conditions[0].friction_ratio == approx(0.5)
    assert table.scatter == approx(0.02)
    assert table.conditions[0].uncertainty == approx(0.02 / np.sqrt(3))


def test_voltages_scale_the_amplitude_of_the_rig_and_need_one() -> None:
    rig = read_rig(RIG)
    assert rig.drive is not None
    assert rig.drive.voltage_peak_to_peak is not None
    of_volts = runs([0.5, 0.7], np.nan, 0.05, voltage_peak_to_peak=rig.drive.voltage_peak_to_peak * np.array([1, 0.5]))
    full, half = run_conditions(of_volts, rig).conditions
    assert full.vibration_amplitude is not None
    assert half.vibration_amplitude == approx(full.vibration_amplitude / 2)
    with pytest.raises(InvalidInput, match=r"add a column vibration_amplitude \[um\], or a rig file"):
        run_conditions(of_volts)


@pytest.mark.parametrize(
    ("ratios", "amplitudes", "message"),
    [
        ([0.5], [1e-6], r"1 run under one condition \(1 um, 50 mm/s\) rank no models: vary amplitude or speed"),
        ([0.5, 0.52], [1e-6, 1e-6], "2 runs under one condition"),
        ([0.5, 0.5, 0.5], [1e-6] * 3, "3 runs under one condition"),
        ([0.5, 2.5], [1e-6, 2e-6], "run 2 has a friction ratio of 2.5"),
        ([0.5, 0.6], [1e-6, -2e-6], "vibration_amplitude of run 2 must be positive"),
    ],
)
def test_runs_that_rank_no_models_are_refused_in_one_line(
    ratios: list[float], amplitudes: list[float], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message) as refusal:
        fit_runs(runs(ratios, amplitudes, 0.05))
    assert "\n" not in str(refusal.value)


def test_the_dataset_and_the_figure_hold_every_model() -> None:
    amplitude, speed = conditions()
    result = fit_runs(runs(across(speed, 0.4 * 2 * np.pi * FREQUENCY * amplitude), amplitude, speed))
    found = runs_fit_dataset(result)
    assert list(found["model"].to_numpy()) == [one.name for one in result.models]
    assert float(found["value"].sel(model="kinematic-fitted", parameter="amplitude_fraction")) == approx(0.4, rel=1e-3)
    assert found["unseen_ratio"].shape == (len(result.models), 9)
    measured, errors = runs_fit_chart(result).panels
    series = [part for part in measured.parts if isinstance(part, Points)]
    assert sum(part.x.size for part in series) == 9
    assert len(series) == 3
    assert errors.y.words == tuple(one.name.replace("-", " ") for one in result.models[::-1])


def test_models_of_published_tests_predict_own_runs_without_a_fit() -> None:
    amplitude, speed = conditions()
    fits = compare_models(compared_models(["kinematic", "asperity-stick-slip"]))
    exact, needs_contact = predict_runs(
        fits, run_conditions(runs(across(speed, 2 * np.pi * FREQUENCY * amplitude) - 0.05, amplitude, speed))
    )
    assert exact.model.name == "kinematic"
    assert (exact.rms, exact.mean) == approx((0.05, 0.05))
    assert needs_contact.rms is None
    assert "roughness and materials" in (needs_contact.reason or "")


def test_the_interval_of_a_fit_to_few_conditions_is_as_wide_as_students_of_its_degrees_of_freedom(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # n ln(1 + t^2/(n - p)) with the 97.5 % quantile t of n - p degrees of freedom, of n = 9 conditions and p parameters
    amplitude, speed = conditions()
    peak = 2 * np.pi * FREQUENCY * amplitude
    told: list[tuple[int, float | None]] = []

    def seen(fit: Fit, *given: object, largest_excess: float | None) -> tuple[()]:
        told.append((len(fit.values), largest_excess))
        return ()

    monkeypatch.setattr("sonolube.validation.runs_fit.fitted_parameters", seen)
    fit_runs(runs(across(speed, peak), amplitude, speed))
    known = {count: excess for count, excess in told if excess is not None}
    assert set(known) >= {1}
    for count, excess in known.items():
        assert excess == approx(9 * float(np.log1p(student.ppf(0.975, 9 - count) ** 2 / (9 - count))))
