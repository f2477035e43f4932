"""Chart of a temperature after a step of the heat."""

import numpy as np

from sonolube.charts import Axis, Chart, Line, envelope, one_panel
from sonolube.checks import Floats
from sonolube.measurement.temperature import TemperatureResponse
from sonolube.report.measured.sheet import captioned


@captioned(
    "Temperature after the step of the heat", "Rise of the samples in grey, with the fitted sum of exponentials."
)
def response_figure(t: Floats, temperature: Floats, found: TemperatureResponse) -> Chart:
    """Rise of a temperature over time with its fitted response."""
    known = np.isfinite(temperature)
    initial = found.final_temperature.value - found.temperature_change.value
    time, samples = envelope(t[known], temperature[known] - initial)
    rows = zip(found.time_constants, found.temperature_changes, strict=True)
    since = t - t[known][0]
    fitted = np.sum([change.value * -np.expm1(-since / tau.value) for tau, change in rows], axis=0)
    parts = Line(x=time, y=samples, label="samples", colour="0.6", weight=0.6), Line(x=t, y=fitted, label="fit")
    y = Axis("Temperature rise", "K")
    return one_panel(Axis("Time", "s"), y, parts, size=(6.4, 3.0), legend="top")
