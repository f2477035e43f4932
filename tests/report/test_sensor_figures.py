"""Figures of sensors: what is drawn against values by hand."""

import numpy as np
from pytest import approx

from sonolube.charts import Band, Line, Points, Rule
from sonolube.measurement.gauge.calibration import ForceEstimate, fit_preisach
from sonolube.report.measured.sensors import force_figure, loops_figure


def test_the_band_of_a_force_reaches_a_standard_uncertainty_to_either_side() -> None:
    time = np.linspace(0.0, 1.0, 5)
    estimate = ForceEstimate(applied_force=np.arange(5.0), applied_force_uncertainty=np.full(5, 0.25))
    chart = force_figure(time, estimate).drawing.chart
    assert chart is not None
    (band,) = (part for part in chart().panels[0].parts if isinstance(part, Band))
    assert band.low == approx(np.arange(5.0) - 0.25)
    assert band.high == approx(np.arange(5.0) + 0.25)


def test_loops_are_drawn_in_um_with_the_model_and_what_it_leaves_below() -> None:
    x = 1e-6 * np.concatenate([np.linspace(0, 10, 60), np.linspace(10, 0, 60), np.linspace(0, 10, 60)])
    force = 2e5 * x + 0.01 * np.sign(np.sin(np.arange(180)))
    calibration = fit_preisach(displacement=x, applied_force=force, levels=8)
    chart = loops_figure(x, force, calibration).drawing.chart
    assert chart is not None
    above, below = chart().panels
    measured, model = above.parts
    left, zero = below.parts
    assert isinstance(measured, Points)
    assert isinstance(model, Line)
    assert isinstance(left, Points)
    assert isinstance(zero, Rule)
    assert measured.x == approx(1e6 * x)
    assert measured.y == approx(force)
    assert left.y == approx(force - model.y)
    assert np.abs(left.y).max() < 0.2
    assert (zero.value, zero.along) == (0.0, "y")
    assert all(part.is_faint for part in (measured, left))  # many samples on one another
    assert (above.x.unit, above.y.unit, below.y.unit) == ("µm", "N", "N")
