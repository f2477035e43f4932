"""Figures of sweeps: curves, families, maps and scatter, by the number and kind of the swept keys."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.design import grid_plan, latin_hypercube_plan, sweep, sweep_figure, swept_variables

TRIBOMETER = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
VOLTS, SPEED, MODEL = "drive.voltage_peak_to_peak", "sliding.sliding_speed", "friction.model"


def test_one_swept_key_gives_curves_of_friction_amplitude_and_powers() -> None:
    swept = sweep(grid_plan(TRIBOMETER, over={VOLTS: np.linspace(5, 28, 4)}))
    figure = sweep_figure(swept)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "Friction ratio",
        "Amplitude [µm]",
        "Power of the amplifier [W]",
        "Power dissipated [W]",
    ]
    assert figure.axes[0].lines[0].get_ydata() == approx(swept["friction_ratio"].values)
    assert figure.axes[1].lines[0].get_ydata() == approx(1e6 * swept["vibration_amplitude"].values)


def test_each_text_value_gives_a_curve() -> None:
    over = {SPEED: np.geomspace(0.005, 0.2, 5), MODEL: np.array(["asperity_stick_slip", "kinematic"])}
    figure = sweep_figure(sweep(grid_plan(TRIBOMETER, over=over)))
    (axes,) = figure.axes
    assert axes.get_xscale() == "log"
    assert axes.get_xlabel() == "Sliding speed [mm/s]"
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {"asperity stick slip", "kinematic"}


def test_two_keys_of_many_values_give_a_contour_map() -> None:
    over = {SPEED: np.linspace(0.005, 0.1, 8), VOLTS: np.linspace(5, 28, 9)}
    figure = sweep_figure(sweep(grid_plan(TRIBOMETER, over=over)))
    assert {figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()} == {
        "Sliding speed [mm/s]",
        "Drive voltage, peak to peak [V]",
    }


@pytest.mark.parametrize("stored", [False, True])
def test_sampled_points_give_a_scatter_over_each_key(stored: bool, tmp_path: Path) -> None:
    over = {VOLTS: (5.0, 28.0), SPEED: (0.005, 0.1), "drive.frequency": (21e3, 23e3)}
    plan = latin_hypercube_plan(TRIBOMETER, over=over, points=80)
    swept = sweep(plan, folder=tmp_path if stored else None)
    assert len(swept_variables(swept)) == 3
    figure = sweep_figure(swept)
    assert {axes.get_xlabel() for axes in figure.axes} == {
        "Drive voltage, peak to peak [V]",
        "Sliding speed [mm/s]",
        "Frequency [kHz]",
    }
    heights = figure.axes[0].lines[0].get_ydata()
    assert np.sort(heights) == approx(np.sort(swept["friction_ratio"].values))


def test_points_without_a_result_are_left_out_of_the_quantiles() -> None:
    over = {VOLTS: [10.0, 20.0], SPEED: [0.01, 0.05], "contact.roughness.rms_height": [6e-6, -6e-6]}
    figure = sweep_figure(sweep(grid_plan(TRIBOMETER, over=over)))
    assert all(np.isfinite(axes.lines[1].get_ydata()).all() for axes in figure.axes if axes.lines)
