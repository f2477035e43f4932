"""Figure of an efficiency calibration: measured coefficients over sliding speed, line and bands."""

from sonolube.charts import Axis, Band, Chart, Line, Part, Points, Rule, one_panel
from sonolube.design.efficiency import EfficiencyCalibration, efficiency_dataset

_PRINTED_UNIT = 1e9  # m2/N in mW mm2/(N W), the unit of D


def efficiency_chart(calibration: EfficiencyCalibration) -> Chart:
    """Efficiency coefficients of runs over sliding speed, with the line, its band and the prediction band."""
    line = efficiency_dataset(calibration)
    v = 1e3 * line["sliding_speed"].values
    level = f"{100 * calibration.confidence_level:g} %"
    bands: list[Part] = []
    for name, opacity, label in (("run", 0.12, f"one more run, {level}"), ("line", 0.3, f"line, {level}")):
        low, high = (_PRINTED_UNIT * line[f"{end}_{name}"].values for end in ("lowest", "highest"))
        bands.append(Band(x=v, low=low, high=high, label=label, opacity=opacity))
    speeds, coefficients = calibration.sliding_speed, calibration.efficiency_coefficient
    parts = (
        *bands,
        Line(x=v, y=_PRINTED_UNIT * line["efficiency_coefficient"].values, label="least squares"),
        Points(x=1e3 * speeds, y=_PRINTED_UNIT * coefficients, label="runs", colour=1),
        Rule(value=0.0, along="y", dash=0),
    )
    return one_panel(
        Axis("Sliding speed", "mm/s"), Axis("Efficiency coefficient", "mW mm²/(N W)"), parts, size=(5.4, 3.5)
    )
