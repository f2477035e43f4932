"""Figures of sensors: what is drawn against values by hand."""

import numpy as np
from pytest import approx

from sonolube.charts import Band
from sonolube.measurement.gauge.calibration import ForceEstimate
from sonolube.report.measured.sensors import force_figure


def test_the_band_of_a_force_reaches_a_standard_uncertainty_to_either_side() -> None:
    time = np.linspace(0.0, 1.0, 5)
    estimate = ForceEstimate(applied_force=np.arange(5.0), applied_force_uncertainty=np.full(5, 0.25))
    chart = force_figure(time, estimate).drawing.chart
    assert chart is not None
    (band,) = (part for part in chart().panels[0].parts if isinstance(part, Band))
    assert band.low == approx(np.arange(5.0) - 0.25)
    assert band.high == approx(np.arange(5.0) + 0.25)
