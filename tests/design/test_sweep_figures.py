"""Figures of sweeps: curves, families, maps and scatter, by the number and kind of the swept keys."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.charts import Field, Line, Points
from sonolube.design import grid_plan, latin_hypercube_plan, sweep, sweep_chart, swept_variables

TRIBOMETER = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
VOLTS, SPEED, MODEL = "drive.voltage_peak_to_peak", "sliding.sliding_speed", "friction.model"


def test_one_swept_key_gives_curves_of_friction_amplitude_and_powers() -> None:
    swept = sweep(grid_plan(TRIBOMETER, over={VOLTS: np.linspace(5, 28, 4)}))
    chart = sweep_chart(swept)
    assert [panel.y.text for panel in chart.panels] == [
        "Friction ratio",
        "Amplitude [µm]",
        "Power to supply [W]",
        "Power dissipated [W]",
    ]
    ratio, amplitude = (panel.parts[0] for panel in chart.panels[:2])
    assert isinstance(ratio, Line)
    assert ratio.x == approx(np.linspace(5, 28, 4))
    assert ratio.y == approx(swept["friction_ratio"].values)
    assert isinstance(amplitude, Line)
    assert amplitude.y == approx(1e6 * swept["vibration_amplitude"].values)


def test_each_text_value_gives_a_curve() -> None:
    over = {SPEED: np.geomspace(0.005, 0.2, 5), MODEL: np.array(["asperity_stick_slip", "kinematic"])}
    chart = sweep_chart(sweep(grid_plan(TRIBOMETER, over=over)))
    (panel,) = chart.panels
    assert panel.x.logarithmic
    assert panel.x.text == "Sliding speed [mm/s]"
    assert [part.label for part in panel.parts if isinstance(part, Line)] == ["asperity stick slip", "kinematic"]
    assert chart.legend_title == "Model"


def test_text_values_alone_are_points_over_words() -> None:
    chart = sweep_chart(sweep(grid_plan(TRIBOMETER, over={MODEL: np.array(["asperity_stick_slip", "kinematic"])})))
    ratio = chart.panels[0]
    assert ratio.x.words == ("asperity stick slip", "kinematic")
    assert [type(part) for part in ratio.parts] == [Points]


def test_two_keys_of_many_values_give_a_contour_map() -> None:
    over = {SPEED: np.linspace(0.005, 0.1, 8), VOLTS: np.linspace(5, 28, 9)}
    chart = sweep_chart(sweep(grid_plan(TRIBOMETER, over=over)))
    (panel,) = chart.panels
    (field,) = panel.parts
    assert isinstance(field, Field)
    assert {panel.x.text, panel.y.text} == {"Sliding speed [mm/s]", "Drive voltage, peak to peak [V]"}
    assert field.values.shape == (field.y.size, field.x.size)
    assert sorted([field.x[0], field.y[0]]) == approx([5, 5])
    assert sorted([field.x[-1], field.y[-1]]) == approx([28, 100])


@pytest.mark.parametrize("stored", [False, True])
def test_sampled_points_give_a_scatter_over_each_key(stored: bool, tmp_path: Path) -> None:
    over = {VOLTS: (5.0, 28.0), SPEED: (0.005, 0.1), "drive.frequency": (21e3, 23e3)}
    plan = latin_hypercube_plan(TRIBOMETER, over=over, points=80)
    swept = sweep(plan, folder=tmp_path if stored else None)
    assert len(swept_variables(swept)) == 3
    chart = sweep_chart(swept)
    assert {panel.x.text for panel in chart.panels} == {
        "Drive voltage, peak to peak [V]",
        "Sliding speed [mm/s]",
        "Frequency [kHz]",
    }
    points = chart.panels[0].parts[0]
    assert isinstance(points, Points)
    assert np.sort(points.y) == approx(np.sort(swept["friction_ratio"].values))


def test_points_without_a_result_are_left_out_of_the_quantiles() -> None:
    over = {VOLTS: [10.0, 20.0], SPEED: [0.01, 0.05], "contact.roughness.rms_height": [6e-6, -6e-6]}
    chart = sweep_chart(sweep(grid_plan(TRIBOMETER, over=over)))
    medians = [part for panel in chart.panels for part in panel.parts if isinstance(part, Line)]
    assert len(medians) == 3
    assert all(np.isfinite(median.y).all() for median in medians)
