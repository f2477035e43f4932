"""Efficiency line of runs made to lie on one, and the power for a target friction, by hand."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.charts import Band, Line, Points, Rule
from sonolube.design.efficiency import calibrate_efficiency, efficiency_chart, efficiency_dataset
from sonolube.errors import SonolubeError
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")  # 3 N, 2.25 mm2, 0.341, 20.3 mm/s
SPEEDS = np.array([0.02, 0.04, 0.06, 0.08, 0.1, 0.12])
SCATTER = np.array([1.0, -1.0, -1.0, 1.0, 1.0, -1.0]) * 1e-11
LINE = 2e-9 + 3e-8 * SPEEDS + SCATTER  # m2/N


def runs_on(coefficients: np.ndarray, *, load: float = 3.0, area: float = 2.25e-6, **more: Any) -> xr.Dataset:
    """Runs of a reduction of 0.4, and one of 0.95, whose powers give the coefficients: P = 0.4 F0 v A/(F_N e)."""
    reduction = np.array([0.4] * 5 + [0.95])
    power = reduction * 0.341 * load * SPEEDS * area / (load * coefficients)
    columns = {"sliding_speed": SPEEDS, "friction_reduction": reduction, "actuator_power": power, **more}
    return xr.Dataset({name: ("run", values) for name, values in columns.items()})


def calibrated(runs: xr.Dataset, *, force: float | None = None, speed: float | None = None) -> Any:
    return calibrate_efficiency(RIG, runs, friction_force=force, sliding_speed=speed, confidence_level=0.9)


def test_runs_have_the_coefficients_of_their_power_and_the_line_is_that_of_least_squares() -> None:
    found = calibrated(runs_on(LINE))
    assert found.efficiency_coefficient == approx(LINE)
    slope, intercept = np.polyfit(SPEEDS, LINE, 1)
    assert (found.fit.line.slope, found.fit.line.intercept) == approx((slope, intercept))
    assert found.saturated_runs == 1
    assert (found.estimate, found.target_speed, found.friction_force) == (None, None, None)


def test_loads_areas_and_friction_of_runs_take_the_place_of_those_of_the_rig() -> None:
    load, area, force = np.full(6, 5.0), np.full(6, 4e-6), np.full(6, 0.341 * 5.0)
    stated = runs_on(LINE, load=5.0, area=4e-6, normal_load=load, nominal_area=area, intrinsic_friction_force=force)
    assert calibrated(stated).efficiency_coefficient == approx(LINE)
    doubled = stated.assign(intrinsic_friction_force=("run", 2 * force))
    assert calibrated(doubled).efficiency_coefficient == approx(2 * LINE)


def test_the_power_of_a_target_is_that_of_the_line_at_its_speed() -> None:
    # P = (F0 - F) v A/(F_N e)
    for speed, at in ((None, 0.0203), (0.05, 0.05)):
        found = calibrated(runs_on(LINE), force=0.5, speed=speed)
        coefficient = found.fit.line.slope * at + found.fit.line.intercept
        assert found.target_speed == approx(at)
        assert found.estimate.actuator_power == approx((1.023 - 0.5) * at * 2.25e-6 / (3 * coefficient))
    with raises(SonolubeError):
        calibrated(runs_on(LINE), speed=5.0)  # beyond the runs


def test_the_dataset_and_the_chart_span_the_speeds_of_the_runs_with_both_bands() -> None:
    found = calibrated(runs_on(LINE))
    line = efficiency_dataset(found)
    v = line["sliding_speed"].values
    assert (v[0], v[-1]) == approx((0.02, 0.12))
    assert line["efficiency_coefficient"].values == approx(found.fit.line.slope * v + found.fit.line.intercept)
    low, high = line["lowest_run"].values, line["highest_run"].values
    assert np.all(low < line["lowest_line"].values)
    assert np.all(line["lowest_line"].values < line["efficiency_coefficient"].values)
    assert np.all(line["efficiency_coefficient"].values < line["highest_line"].values)
    assert np.all(line["highest_line"].values < high)
    (panel,) = efficiency_chart(found).panels
    one_more, band, fitted, points, zero = panel.parts
    assert isinstance(one_more, Band)
    assert isinstance(band, Band)
    assert (one_more.label, band.label) == ("one more run, 90 %", "line, 90 %")
    assert one_more.low == approx(1e9 * low)
    assert isinstance(fitted, Line)
    assert fitted.x == approx(1e3 * v)
    assert fitted.y == approx(1e9 * line["efficiency_coefficient"].values)
    assert isinstance(points, Points)
    assert points.x == approx(1e3 * SPEEDS)  # mm/s and mW mm2/(N W)
    assert points.y == approx(1e9 * LINE)
    assert isinstance(zero, Rule)
    assert (zero.value, zero.along) == (0.0, "y")
