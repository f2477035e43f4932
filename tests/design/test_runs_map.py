"""Gaussian process of measured runs against the normal distribution in many dimensions, and runs placed on maps."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises
from scipy.optimize import minimize
from scipy.stats import multivariate_normal

from sonolube.design.runs_map import (
    MIN_RUNS,
    _covariance,
    _kernel,
    _negative_log_likelihood,
    gaussian_process_map,
    require_mappable,
    runs_map,
    runs_on_map,
)
from sonolube.errors import InvalidInput
from sonolube.rig import AMPLITUDE, VOLTAGE, read_rig

LOGS = np.log([0.5, 2.0, 0.09, 0.0016])  # both length scales, variance 0.3^2, noise 0.04^2


def test_the_covariance_falls_with_the_distance_in_each_coordinate() -> None:
    # (0.3/0.5)^2 + (1/2)^2 = 0.61
    found = _kernel(LOGS, np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([[0.3, 1.0]]))
    assert found.shape == (2, 1)
    assert found[0, 0] == approx(0.09 * np.exp(-0.61 / 2))
    assert found[1, 0] == approx(0.09 * np.exp(-((0.7 / 0.5) ** 2) / 2))
    noisy = _covariance(LOGS, np.array([[0.0, 0.0], [0.3, 1.0]]), np.array([1e-4, 4e-4]))
    off = 0.09 * np.exp(-0.61 / 2)
    assert noisy == approx(np.array([[0.09 + 0.0016 + 1e-4, off], [off, 0.09 + 0.0016 + 4e-4]]))


def test_the_likelihood_is_that_of_a_normal_distribution_at_its_best_mean() -> None:
    rng = np.random.default_rng(1)
    x, z, noise = rng.uniform(-1, 1, (7, 2)), rng.uniform(0, 1, 7), np.full(7, 1e-3)
    covariance = _covariance(LOGS, x, noise)
    # the logarithm is a parabola over the mean
    means = np.array([0.0, 0.5, 1.0])
    parabola = np.polyfit(means, [multivariate_normal.logpdf(z, np.full(7, mean), covariance) for mean in means], 2)
    best = float(np.polyval(parabola, -parabola[1] / (2 * parabola[0])))
    assert _negative_log_likelihood(LOGS, x, z, noise) == approx(-best - 3.5 * np.log(2 * np.pi), rel=1e-9)


PLACES = np.array([[0.1, 1.0], [0.2, 3.0], [0.3, 2.0], [0.15, 5.0], [0.25, 4.0], [0.12, 2.5], [0.28, 1.2]])


def test_exact_runs_of_one_value_are_that_value_everywhere() -> None:
    found = gaussian_process_map(runs=PLACES, friction_reduction=np.full(7, 0.4), points=[[[0.2, 2.0], [0.9, 9.0]]])
    assert found.friction_reduction == approx(np.array([[0.4, 0.4]]), abs=1e-6)
    assert found.leave_one_out_error == approx(0.0, abs=1e-6)
    assert found.friction_reduction_uncertainty.shape == (1, 2)


def test_the_prediction_is_that_of_a_linear_combination_of_least_variance() -> None:
    # ordinary kriging as its system of equations with a multiplier for the unknown mean, D. Krige's own form
    reduction = 0.3 + PLACES[:, 0] - 0.02 * PLACES[:, 1] ** 2 / 5
    points = np.array([[0.18, 2.2], [0.26, 3.1]])
    found = gaussian_process_map(runs=PLACES, friction_reduction=reduction, points=points)
    units = PLACES.std(axis=0)
    x, x_star = PLACES / units, points / units

    def error(logs: np.ndarray) -> float:
        return _negative_log_likelihood(logs, x, reduction, np.zeros(7))

    bounds = ((-2.5, 2.5), (-2.5, 2.5), (-7.0, 1.0), (-12.0, 0.0))
    starts = ([0.5, 0.5, -2.0, -9.0], [-0.5, 1.0, -3.0, -6.0])
    logs = min(
        (minimize(error, start, method="Nelder-Mead", bounds=bounds, options={"maxiter": 800}) for start in starts),
        key=lambda fit: float(fit.fun),
    ).x
    system = np.ones((8, 8))
    system[:7, :7] = _covariance(logs, x, np.zeros(7))
    system[7, 7] = 0.0
    side = np.vstack([_kernel(logs, x, x_star), np.ones(2)])
    weights = np.linalg.solve(system, side)
    assert found.scatter == approx(float(np.exp(logs[3] / 2)), rel=0.1, abs=1e-3)
    assert found.friction_reduction == approx(weights[:7].T @ reduction, abs=2e-3)
    variance = np.exp(logs[2]) - np.sum(weights * side, axis=0)
    assert found.friction_reduction_uncertainty == approx(np.sqrt(np.maximum(variance, 0)), abs=3e-3)


def test_the_uncertainty_of_a_run_lets_the_map_pass_beside_it() -> None:
    reduction = np.array([0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.8])
    doubtful = np.array([0.01] * 6 + [0.5])
    sure, unsure = (
        gaussian_process_map(
            runs=PLACES, friction_reduction=reduction, points=PLACES[-1], friction_reduction_uncertainty=uncertainty
        ).friction_reduction
        for uncertainty in (0.0, doubtful)
    )
    assert float(unsure) < 0.6 < float(sure) + 0.11


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"runs": PLACES[:, :1]}, "runs and points must be pairs"),
        ({"points": [[1.0, 2.0, 3.0]]}, "runs and points must be pairs"),
        ({"runs": PLACES[:, 0]}, "runs and points must be pairs"),
        ({"friction_reduction_uncertainty": np.ones(3)}, "runs and points must be pairs"),
        ({"runs": np.where(PLACES == 5.0, np.inf, PLACES)}, "runs and points must be finite"),
        ({"points": [[np.nan, 1.0]]}, "runs and points must be finite"),
        ({"runs": np.column_stack([PLACES[:, 0], np.ones(7)])}, "all runs agree in a coordinate"),
        ({"friction_reduction_uncertainty": -0.1}, "friction_reduction_uncertainty must not be negative"),
    ],
)
def test_runs_that_are_none_are_refused(changes: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"runs": PLACES, "friction_reduction": np.full(7, 0.4), "points": [[0.2, 2.0]]} | changes
    with raises(InvalidInput, match=message):
        gaussian_process_map(**given)


def runs(**columns: list[float]) -> xr.Dataset:
    return xr.Dataset({name: ("run", values) for name, values in columns.items()})


def test_a_map_says_which_column_of_runs_is_missing() -> None:
    known = {"sliding_speed": [0.1] * 6, "friction_reduction": [0.1] * 6}
    with raises(InvalidInput, match="measured runs need a column actuator_power for a velocity-power map"):
        require_mappable(runs(**known), kind="velocity-power", commanded=VOLTAGE)
    with raises(InvalidInput, match="measured runs need a column sliding_speed for a velocity-power map"):
        require_mappable(runs(actuator_power=[1.0]), kind="velocity-power", commanded=VOLTAGE)
    require_mappable(runs(**known, actuator_power=[1.0] * 6), kind="velocity-power", commanded=VOLTAGE)
    require_mappable(runs(**known, voltage_peak_to_peak=[1.0] * 6), kind="velocity-power", commanded=VOLTAGE)
    require_mappable(runs(**known), kind="velocity-stress", commanded=VOLTAGE)  # of the rig's load and area


def test_runs_at_several_panels_that_would_be_interpolated_are_refused() -> None:
    known = {"sliding_speed": [0.1] * 6, "actuator_power": [1.0] * 6, "friction_reduction": [0.1] * 6}
    loads = [3.0, 3.0, 3.0, 3.0, 3.0, 4.0]
    with raises(InvalidInput, match="measured runs at several values of normal_load make several maps"):
        require_mappable(runs(**known, normal_load=loads), kind="velocity-power", commanded=VOLTAGE)
    require_mappable(runs(**known, normal_load=[3.0] * 6), kind="velocity-power", commanded=VOLTAGE)
    few = {name: values[:-1] for name, values in known.items()}
    require_mappable(runs(**few, normal_load=loads[1:]), kind="velocity-power", commanded=VOLTAGE)
    volts = {"sliding_speed": [0.1] * 6, "voltage_peak_to_peak": [1.0] * 5 + [2.0]}
    with raises(InvalidInput, match="several values of voltage_peak_to_peak"):
        require_mappable(runs(**volts), kind="velocity-stress", commanded=VOLTAGE)
    require_mappable(runs(**volts), kind="velocity-stress", commanded=AMPLITUDE)
    amplitudes = {"sliding_speed": [0.1] * 6, "vibration_amplitude": [1.0] * 5 + [2.0]}
    with raises(InvalidInput, match="several values of vibration_amplitude"):
        require_mappable(runs(**amplitudes), kind="velocity-stress", commanded=AMPLITUDE)


def a_map(kind: str, **dims: list[float]) -> xr.Dataset:
    """Map whose reduction is the sum of its coordinates, each in its unit."""
    coords = {name: (name, np.array(values)) for name, values in dims.items()}
    total = sum(np.meshgrid(*dims.values(), indexing="ij"))
    return xr.Dataset({"friction_reduction": (tuple(dims), np.asarray(total))}, coords=coords, attrs={"map": kind})


RIG: Any = SimpleNamespace(normal_load=5.0, contact=SimpleNamespace(nominal_area=2e-6), drive=None)


def power_map(growth: float = 0.0) -> xr.Dataset:
    """Map over power, which grows by a share from load to load."""
    found = a_map(
        "velocity-power", normal_load=[2.0, 4.0, 6.0], voltage_peak_to_peak=[10.0, 20.0], sliding_speed=[0.0, 0.1]
    )
    powers = [[1.0 + each, 4.0 * (1.0 + each)] for each in (0.0, growth, 2 * growth)]
    return found.assign_coords(power_to_supply=(("normal_load", "voltage_peak_to_peak"), powers))


def test_a_power_follows_from_the_voltage_of_a_run_where_none_was_measured() -> None:
    known = {"sliding_speed": [0.05] * 3, "normal_load": [4.0, 5.8, 4.0], "friction_reduction": [0.3] * 3}
    placed, _ = runs_on_map(runs(**known, voltage_peak_to_peak=[15.0, 20.0, 25.0]), RIG, power_map(1.0))
    assert placed["power_to_supply"].values.tolist() == [5.0, 12.0]  # halfway; under 6 N; 25 V lie beyond the map
    measured, _ = runs_on_map(runs(**known, actuator_power=[2.0, 3.0, 1.0]), RIG, power_map())
    assert measured["power_to_supply"].values.tolist() == [2.0, 3.0, 1.0]


def test_a_pressure_follows_from_the_load_of_a_run_or_of_the_rig() -> None:
    mapped = a_map(
        "velocity-stress", voltage_peak_to_peak=[10.0], normal_load=[2.0, 6.0], sliding_speed=[0.0, 0.1]
    ).assign_coords(nominal_pressure=("normal_load", [1e6, 3e6]))
    rig = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml")
    known = {"sliding_speed": [0.05] * 2, "friction_reduction": [0.3] * 2, "voltage_peak_to_peak": [10.0] * 2}
    placed, _ = runs_on_map(runs(**known, normal_load=[4.0, 5.0]), rig, mapped)
    assert placed["nominal_pressure"].values * rig.contact.nominal_area == approx([4.0, 5.0])
    own = runs_on_map(runs(**known), rig, mapped)[0]["nominal_pressure"].values
    assert own * rig.contact.nominal_area == approx([rig.normal_load] * 2)


def test_a_run_is_moved_to_the_nearest_panel_by_what_the_model_says_between_them() -> None:
    # the reduction of the map grows by one a newton: from 4.8 N to 4 N it falls by 0.8, from 5.2 N to 6 N it grows
    known = {"sliding_speed": [0.05] * 4, "actuator_power": [2.0] * 4, "friction_reduction": [0.3, 0.3, 0.3, 0.4]}
    placed, caveats = runs_on_map(runs(**known, normal_load=[4.8, 5.2, 4.0004, 7.0]), RIG, power_map())
    assert placed["panel"].values.tolist() == [1, 2, 1, -1]
    assert placed["is_moved"].values.tolist() == [True, True, False, False]
    assert placed["shown_friction_reduction"].values[:3] == approx([0.3 - 0.8, 0.3 + 0.8, 0.3])
    assert "2 of 4 runs are drawn at the normal load of the nearest panel, moved there by the model" in caveats
    assert "1 of 4 runs are not drawn: their normal load lies beyond the panels of the map" in caveats


def test_runs_at_their_panels_have_no_caveat() -> None:
    known = {"sliding_speed": [0.05] * 2, "actuator_power": [2.0] * 2, "friction_reduction": [0.3] * 2}
    placed, caveats = runs_on_map(runs(**known, normal_load=[2.0, 6.0]), RIG, power_map())
    assert placed["panel"].values.tolist() == [0, 2]
    assert not [line for line in caveats if "panel" in line]


def test_the_map_between_runs_spans_them_with_the_names_of_its_axes() -> None:
    rng = np.random.default_rng(3)
    speed, power = rng.uniform(0.05, 0.2, 9), rng.uniform(1.0, 5.0, 9)
    measured = runs(
        sliding_speed=speed.tolist(), power_to_supply=power.tolist(), friction_reduction=(power / 9).tolist()
    )
    found = runs_map(measured, kind="velocity-power")
    assert found is not None
    assert dict(found.sizes) == {"power_to_supply": 61, "sliding_speed": 61}
    assert found["sliding_speed"].values[[0, -1]] == approx([speed.min(), speed.max()])
    assert found["power_to_supply"].values[[0, -1]] == approx([power.min(), power.max()])
    expected = np.broadcast_to(found["power_to_supply"].values[:, np.newaxis] / 9, (61, 61))
    assert found["friction_reduction"].values == approx(expected, abs=0.01)
    assert found.attrs["title"] == "Friction reduction between 9 measured runs"
    assert (found.attrs["map"], found["sliding_speed"].attrs["units"]) == ("velocity-power", "m/s")
    assert found.attrs["scatter"] < 0.01
    assert found.attrs["leave_one_out_error"] < 0.05
    uncertain = measured.assign(friction_reduction_uncertainty=("run", np.full(9, 0.2)))
    wide = runs_map(uncertain, kind="velocity-power")
    assert wide is not None
    assert float(wide["friction_reduction_uncertainty"].mean()) > float(found["friction_reduction_uncertainty"].mean())
    assert MIN_RUNS == 6
    assert runs_map(measured.isel(run=slice(0, 5)), kind="velocity-power") is None
    assert runs_map(measured.isel(run=slice(0, 6)), kind="velocity-power") is not None
